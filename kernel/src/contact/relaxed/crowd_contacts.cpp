#include "contact/relaxed/crowd_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {
namespace {

/// A place may go this much farther in a step than it would at its velocity, because something pushes it.
constexpr double further = 1.25;

constexpr Combination nothing{};

Bounds grown(Vec3 from, Vec3 by, double radius) {
  Bounds out = nowhere;
  include(out, from, radius);
  include(out, from + further * by, radius);
  return out;
}

}  // namespace

// --- Who may touch

template <class T>
auto CrowdContacts<T>::add_terms(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                                 std::uint32_t island, const Combination& sum, std::vector<Term>& to) const
    -> TermRange {
  const auto first = static_cast<std::uint32_t>(to.size());
  crowd.add_terms(*cluster[island]->linkage, island, sum, 1, to);
  return {first, static_cast<std::uint32_t>(to.size())};
}

template <class T>
void CrowdContacts<T>::find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                            const Surroundings& surroundings, double dt, double recovery_rate) {
  recovery_rate_ = recovery_rate;
  ends_.clear();
  bodies_.clear();
  balls_.clear();
  bounds_.clear();
  ball_bounds_.clear();
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const double fall = 0.5 * dt * dt * norm(linkage.gravity()) + settings_.margin;
    const auto reach_of = [&](TermRange range, double radius) {
      const auto terms = ends_of(range);
      return grown(crowd.position(terms), dt * crowd.velocity(terms),
                   radius + (crowd.is_moving(i) ? fall : 0));
    };
    for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
      const Linkage::Shape& shape = linkage.shapes()[k];
      bodies_.push_back({i, k, &shape, add_terms(cluster, crowd, i, shape.a, ends_),
                         add_terms(cluster, crowd, i, shape.b, ends_)});
      Bounds around = reach_of(bodies_.back().a, shape.radius);
      const Bounds other = reach_of(bodies_.back().b, shape.radius);
      include(around, other.low, 0);
      include(around, other.high, 0);
      bounds_.push_back(around);
    }
    if (!crowd.is_moving(i)) continue;
    for (std::uint32_t k = 0; k < linkage.balls().size(); ++k) {
      const Linkage::Ball& ball = linkage.balls()[k];
      balls_.push_back({i, k, &ball, add_terms(cluster, crowd, i, ball.center, ends_)});
      ball_bounds_.push_back(reach_of(balls_.back().center, ball.radius));
    }
  }
  find_pairs();
  find_on_ground(crowd, surroundings);
}

template <class T>
void CrowdContacts<T>::find_pairs() {
  pairs_.clear();
  if (bodies_.empty() || bodies_.front().island == bodies_.back().island) return;
  double sum = 0;
  for (const Bounds& each : bounds_)
    sum += std::max({each.high.x - each.low.x, each.high.y - each.low.y, each.high.z - each.low.z});
  hash_.start(sum / static_cast<double>(bounds_.size()), 4 * bounds_.size());
  for (std::uint32_t i = 0; i < bodies_.size(); ++i)
    hash_.find_and_insert(i, bounds_[i], [&](std::uint32_t j) {
      if (bodies_[i].island != bodies_[j].island && bounds_[i].overlaps(bounds_[j])) pairs_.push_back({j, i});
    });
  const auto number = [](const Pair& pair) { return std::uint64_t{pair.one} << 32 | pair.other; };
  std::sort(pairs_.begin(), pairs_.end(),
            [&](const Pair& a, const Pair& b) { return number(a) < number(b); });
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end(),
                           [&](const Pair& a, const Pair& b) { return number(a) == number(b); }),
               pairs_.end());
}

template <class T>
void CrowdContacts<T>::find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings) {
  const auto absolute = [&](const Bounds& bounds) {
    return Bounds{bounds.low + crowd.origin(), bounds.high + crowd.origin()};
  };
  on_planes_.clear();
  on_boxes_.clear();
  for (std::uint32_t i = 0; i < balls_.size(); ++i)
    for (std::uint32_t p = 0; p < surroundings.planes.size(); ++p)
      if (height(absolute(ball_bounds_[i]), surroundings.planes[p]) <= 0) on_planes_.push_back({i, p});
  for (std::uint32_t i = 0; i < bodies_.size(); ++i)
    for (std::uint32_t b = 0; b < surroundings.boxes.size(); ++b)
      if (crowd.is_moving(bodies_[i].island) && surroundings.boxes[b].bounds.overlaps(absolute(bounds_[i])))
        on_boxes_.push_back({i, b});
}

// --- Contacts of a substep

template <class T>
bool CrowdContacts<T>::begin(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                             const Surroundings& surroundings, double h) {
  contacts_.clear();
  terms_.clear();
  has_woken_ = false;
  next_kept_.assign(cluster.size(), 0);
  const Substep in{cluster, crowd, h};
  touch_planes(in, surroundings.planes);
  touch_boxes(in, surroundings.boxes);
  touch_pairs(in);
  if (has_woken_) return false;
  for (const Contact& contact : contacts_)
    if (contact.push > 0) crowd.push(terms_of(contact.terms), contact.push * contact.normal + contact.across);
  return true;
}

template <class T>
void CrowdContacts<T>::wake(LinkageState& state) {
  state.asleep = false;
  state.slow_time = 0;
  state.pulls.begin_step();
  has_woken_ = true;
}

template <class T>
void CrowdContacts<T>::add(const Substep& in, const Side& one, const Side& other, const Touch& touch,
                           std::uint64_t key) {
  const auto& [cluster, crowd, h] = in;
  const auto first = static_cast<std::uint32_t>(terms_.size());
  double moves = crowd.add_terms(*cluster[one.island]->linkage, one.island, *one.at, 1, terms_);
  if (other.island != none)
    moves += crowd.add_terms(*cluster[other.island]->linkage, other.island, *other.at, -1, terms_);
  const TermRange range{first, static_cast<std::uint32_t>(terms_.size())};
  const Vec3 shift = crowd.moved(terms_of(range));
  const double closing = dot(touch.normal, shift);
  if (touch.gap + closing > settings_.margin + 0.25 * norm(shift) || !(moves > 0)) {
    terms_.resize(first);
    return;
  }
  for (const std::uint32_t island : {one.island, other.island}) {
    if (island == none || !cluster[island]->asleep || cluster[island]->frozen) continue;
    if (!(touch.gap + closing < 0)) continue;
    wake(*cluster[island]);
  }
  const double arriving = dot(touch.normal, crowd.velocity(terms_of(range)));
  const double restitution = std::max(one.surface->restitution, other.surface->restitution);
  const KeptContact held = kept_at(*cluster[one.island], key, next_kept_[one.island]);
  Contact& contact = contacts_.emplace_back();
  contact.terms = range;
  contact.island[0] = one.island;
  contact.island[1] = other.island;
  contact.shape[0] = one.shape;
  contact.shape[1] = other.shape;
  contact.key = key;
  contact.normal = touch.normal;
  contact.gap = recovered(touch.gap, settings_.slop, h * recovery_rate_);
  contact.friction = std::sqrt(one.surface->friction * other.surface->friction);
  contact.bounce = bounce_of(restitution, settings_.bounce_speed, touch.gap, closing, arriving, h);
  contact.over = 1 / moves;
  if (held.key != key) return;
  const double along = dot(held.force, touch.normal);
  contact.push = h * h * std::max(0.0, along);
  if (along > 0) contact.across = (h * h) * (held.force - along * touch.normal);
}

template <class T>
void CrowdContacts<T>::touch_planes(const Substep& in, std::span<const Plane> planes) {
  for (const Pair& pair : on_planes_) {
    const Ball& each = balls_[pair.one];
    const Plane& plane = planes[pair.other];
    const Vec3 at = in.crowd.origin() + in.crowd.position(ends_of(each.center));
    const double gap = dot(plane.normal, at) - plane.offset - each.ball->radius;
    add(in, {each.island, each.ball->shape, &each.ball->center, &each.ball->surface},
        {none, 0, &nothing, &plane.surface}, {gap, plane.normal},
        contact_key(KeyKind::plane, each.number, 0, pair.other));
  }
}

template <class T>
void CrowdContacts<T>::touch_boxes(const Substep& in, std::span<const Surroundings::Solid> boxes) {
  for (const Pair& pair : on_boxes_) {
    const Body& each = bodies_[pair.one];
    const Surroundings::Solid& box = boxes[pair.other];
    const Vec3 off = in.crowd.origin() - box.center;
    const Vec3 p = box.frame.to_local(off + in.crowd.position(ends_of(each.a)));
    const Vec3 q = box.frame.to_local(off + in.crowd.position(ends_of(each.b)));
    for_touches_with_box(
        p, q, each.shape->radius, box, [&](std::uint64_t which, double t, const Touch& touch) {
          const Combination at = blend(each.shape->a, each.shape->b, t);
          add(in, {each.island, each.number, &at, &each.shape->surface}, {none, 0, &nothing, &box.surface},
              touch, contact_key(KeyKind::box, 16 * each.number + which, 0, pair.other));
        });
  }
}

template <class T>
void CrowdContacts<T>::touch_pairs(const Substep& in) {
  const Crowd<T>& crowd = in.crowd;
  for (const Pair& pair : pairs_) {
    const Body &a = bodies_[pair.one], &b = bodies_[pair.other];
    if (!crowd.is_moving(a.island) && !crowd.is_moving(b.island)) continue;
    const Touches near =
        touches({in.crowd.position(ends_of(a.a)), in.crowd.position(ends_of(a.b)), a.shape->radius},
                {in.crowd.position(ends_of(b.a)), in.crowd.position(ends_of(b.b)), b.shape->radius});
    for (std::uint32_t n = 0; n < near.count; ++n) {
      const Touch& touch = near.at[n];
      const Combination at_a = blend(a.shape->a, a.shape->b, touch.a),
                        at_b = blend(b.shape->a, b.shape->b, touch.b);
      add(in, {a.island, a.number, &at_a, &a.shape->surface}, {b.island, b.number, &at_b, &b.shape->surface},
          touch, contact_key(KeyKind::island, 4 * a.number + n, in.cluster[b.island]->number, b.number));
    }
  }
}

// --- Visits

template <class T>
double CrowdContacts<T>::sweep(Crowd<T>& crowd) {
  double most = 0;
  for (Contact& contact : contacts_) {
    const std::span<const Term> terms = terms_of(contact.terms);
    const Vec3 moved = crowd.moved(terms);
    const double along = dot(contact.normal, moved);
    const double push = std::max(0.0, contact.push - contact.over * (contact.gap + along));
    Vec3 across = contact.across - contact.over * (moved - along * contact.normal);
    // What the normal push turned by since it was kept would pull along the normal.
    across = across - dot(across, contact.normal) * contact.normal;
    const double bound = contact.friction * push, square = dot(across, across);
    if (square > bound * bound) across = bound / std::sqrt(square) * across;
    const Vec3 by = (push - contact.push) * contact.normal + (across - contact.across);
    if (by == Vec3{}) continue;
    contact.push = push;
    contact.across = across;
    crowd.push(terms, by);
    most = std::max(most, norm(by) / contact.over);
  }
  return most;
}

template <class T>
void CrowdContacts<T>::bounce(Crowd<T>& crowd) {
  constexpr int sweeps = 4;
  const auto bounces = [](const Contact& contact) { return contact.bounce > 0 && contact.push > 0; };
  if (std::none_of(contacts_.begin(), contacts_.end(), bounces)) return;
  for (int i = 0; i < sweeps; ++i)
    for (Contact& contact : contacts_) {
      if (!bounces(contact)) continue;
      const std::span<const Term> terms = terms_of(contact.terms);
      const double leaves = dot(contact.normal, crowd.velocity(terms));
      const double kick = std::max(0.0, contact.kick + contact.over * (contact.bounce - leaves));
      crowd.push_velocity(terms, (kick - contact.kick) * contact.normal);
      contact.kick = kick;
    }
}

template <class T>
void CrowdContacts<T>::end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h) {
  for (LinkageState* const state : cluster)
    if (!state->asleep) state->kept.clear();
  for (const Contact& contact : contacts_) {
    const Vec3 push = contact.push * contact.normal + contact.across;
    if (push == Vec3{}) continue;
    if (LinkageState& state = *cluster[contact.island[0]]; !state.asleep)
      state.kept.push_back({contact.key, 1 / (h * h) * push, {}});
    const Vec3 impulse = 1 / h * push + contact.kick * contact.normal;
    for (int side = 0; side < 2; ++side) {
      if (contact.island[side] == none) continue;
      LinkagePulls& pulls = cluster[contact.island[side]]->pulls;
      if (!pulls.counts) continue;
      pulls.shapes[contact.shape[side]] += (side == 0 ? 1.0 : -1.0) * impulse;
      crowd.push_fixed(terms_of(contact.terms), contact.island[side], impulse, pulls);
    }
  }
}

template <class T>
std::size_t CrowdContacts<T>::count_pushes() const {
  return static_cast<std::size_t>(std::count_if(contacts_.begin(), contacts_.end(),
                                                [](const Contact& contact) { return contact.push > 0; }));
}

template class CrowdContacts<float>;
template class CrowdContacts<double>;

}  // namespace plumb::detail
