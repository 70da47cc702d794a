#include "contact/relaxed/crowd_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "contact/rows.hpp"

namespace plumb::detail {

// --- Contacts of a substep

template <class T>
bool CrowdContacts<T>::begin(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                             const Surroundings& surroundings, const GroundNow& ground, double h) {
  contacts_.clear();
  left_out_.clear();
  terms_.clear();
  turn_terms_.clear();
  turnings_.clear();
  has_woken_ = false;
  next_kept_.assign(cluster.size(), 0);
  const Substep in{cluster, crowd, surroundings, ground, h};
  place_hulls(crowd);
  touch_planes(in);
  touch_boxes(in);
  touch_segments(in);
  touch_ground(in);
  touch_pairs(in);
  touch_hull_pairs(in);
  if (has_woken_) return false;
  for (const Contact& contact : contacts_) {
    if (!(contact.push > 0)) continue;
    if (contact.sliding == contact.terms) {
      crowd.push(terms_of(contact.terms), contact.push * contact.normal + contact.across);
    } else {
      crowd.push(terms_of(contact.terms), contact.push * contact.normal);
      crowd.push(terms_of(contact.sliding), contact.across);
    }
    if (contact.turning != none) turn(crowd, turnings_[contact.turning], turnings_[contact.turning].push);
  }
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
Barycentric CrowdContacts<T>::body_of(const Substep& in, const Side& side) {
  const auto& particles = shape_of(in, side).body;
  const auto at = [&](int i) { return in.crowd.position_of(side.island, particles[i]); };
  return Barycentric({at(0), at(1), at(2), at(3)});
}

/// Returns where a side's place on the middle of its shape is, from the crowd's origin.
template <class T>
Vec3 CrowdContacts<T>::middle(const Substep& in, const Side& side) {
  Vec3 out;
  for (std::uint32_t k = 0; k < side.at->count; ++k)
    out += side.at->terms[k].weight * in.crowd.position_of(side.island, side.at->terms[k].particle);
  return out;
}

template <class T>
void CrowdContacts<T>::add(const Substep& in, const Side& one, const Side& other, const Touch& touch,
                           std::uint64_t key) {
  const Crowd<T>& crowd = in.crowd;
  const double h = in.h;
  const std::array<Side, 2> sides{one, other};
  Contact contact{.key = key, .normal = touch.normal};
  add_ends(in, sides, contact);
  double arriving = dot(touch.normal, crowd.velocity(terms_of(contact.terms)));
  if (other.rate != nullptr) {
    const Vec3 place = crowd.origin() + middle(in, one) - shape_of(in, one).radius * touch.normal;
    contact.carried = other.rate->moved(place, touch.normal, h);
    arriving -= dot(touch.normal, other.rate->at(place, touch.normal));
    contact.carried_at_end =
        dot(touch.normal, other.rate->later(h).at(place + contact.carried, touch.normal));
  }
  const Vec3 shift = crowd.moved(terms_of(contact.terms)) - contact.carried;
  const double closing = dot(touch.normal, shift);
  const bool comes = touch.gap + closing <= settings_.margin + 0.25 * norm(shift);
  const bool may_pass =
      other.island == none && kind_of(key) != KeyKind::plane && norm(shift) > settings_.margin;
  const bool is_watched = (is_hull(in, one) || is_hull(in, other) || may_pass) &&
                          touch.gap <= in_sight(norm(shift), settings_.length_scale);
  if (!(contact.over < INFINITY) || (!comes && !is_watched)) {
    terms_.resize(contact.terms.first);
    return;
  }
  for (const Side& side : sides) {
    if (!comes || !(touch.gap + closing < 0) || side.island == none) continue;
    if (LinkageState& state = *in.cluster[side.island]; state.asleep && !state.frozen) wake(state);
  }
  const double restitution = std::max(one.surface->restitution, other.surface->restitution);
  contact.gap = recovered(touch.gap, settings_.slop, h * recovery_rate_);
  contact.friction = std::sqrt(one.surface->friction * other.surface->friction);
  contact.approach = approach_of(touch.gap, closing, arriving, h);
  contact.bounce = bounce_of(restitution, settings_.bounce_speed, contact.approach);
  add_sliding(in, sides, touch, contact);
  add_turning(in, sides, contact);
  if (comes) start_from_kept(in, contact);
  (comes ? contacts_ : left_out_).push_back(contact);
}

/// Adds the places that the normal push acts on.
template <class T>
void CrowdContacts<T>::add_ends(const Substep& in, const std::array<Side, 2>& sides, Contact& contact) {
  contact.terms.first = static_cast<std::uint32_t>(terms_.size());
  double moves = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side& side = sides[i];
    contact.island[i] = side.island;
    contact.shape[i] = side.shape;
    contact.other_terms = static_cast<std::uint32_t>(terms_.size());
    if (side.island == none) continue;
    moves +=
        in.crowd.add_terms(*in.cluster[side.island]->linkage, side.island, *side.at, i == 0 ? 1 : -1, terms_);
  }
  contact.terms.end = static_cast<std::uint32_t>(terms_.size());
  contact.over = 1 / moves;
}

/// Adds the places that friction holds: those of bodies where they are touched. Two bodies are held at one
/// place, half way between their surfaces.
template <class T>
void CrowdContacts<T>::add_sliding(const Substep& in, const std::array<Side, 2>& sides, const Touch& touch,
                                   Contact& contact) {
  contact.sliding = contact.terms;
  contact.over_sliding = contact.over;
  if (!turns(in, sides[0]) && !turns(in, sides[1])) return;
  contact.sliding.first = static_cast<std::uint32_t>(terms_.size());
  double moves = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side& side = sides[i];
    if (side.island == none) continue;
    const double sign = i == 0 ? 1 : -1, apart = sides[1].island == none ? 0 : 0.5 * touch.gap;
    Combination at = *side.at;
    if (turns(in, side)) {
      const Linkage::Shape& shape = shape_of(in, side);
      const Vec3 arm = -sign * (shape.radius + apart) * touch.normal;
      const std::array<double, 4> weights = body_of(in, side).weights(middle(in, side) + arm);
      at.count = 4;
      for (std::uint32_t k = 0; k < 4; ++k) at.terms[k] = {shape.body[k], weights[k]};
    }
    moves += in.crowd.add_terms(*in.cluster[side.island]->linkage, side.island, at, sign, terms_);
  }
  contact.sliding.end = static_cast<std::uint32_t>(terms_.size());
  contact.over_sliding = 1 / moves;
}

/// Adds what resists rolling and spinning, if a body turns and a surface does.
template <class T>
void CrowdContacts<T>::add_turning(const Substep& in, const std::array<Side, 2>& sides, Contact& contact) {
  const Surface &one = *sides[0].surface, &two = *sides[1].surface;
  const double rolling = std::max(one.rolling, two.rolling), spinning = std::max(one.spinning, two.spinning);
  if (!(rolling > 0 || spinning > 0) || (!turns(in, sides[0]) && !turns(in, sides[1]))) return;
  const auto first = static_cast<std::uint32_t>(turn_terms_.size());
  // A torque turns by this matrix, symmetric and positive; no torque by more than its largest row sum.
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side& side = sides[i];
    if (!turns(in, side)) continue;
    const std::array<Vec3, 4> gradients = body_of(in, side).gradients();
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t particle = shape_of(in, side).body[k];
      const double inverse = in.crowd.inverse_mass(side.island, particle);
      const Vec3 g = gradients[k];
      turn_terms_.push_back(
          {side.island, in.crowd.number_of(side.island, particle), (i == 0 ? 1.0 : -1.0) * g, inverse});
      xx += 0.25 * inverse * (g.y * g.y + g.z * g.z);
      yy += 0.25 * inverse * (g.z * g.z + g.x * g.x);
      zz += 0.25 * inverse * (g.x * g.x + g.y * g.y);
      xy += 0.25 * inverse * g.x * g.y;
      yz += 0.25 * inverse * g.y * g.z;
      zx += 0.25 * inverse * g.z * g.x;
    }
  }
  const double most = std::max(
      {xx + std::abs(xy) + std::abs(zx), yy + std::abs(xy) + std::abs(yz), zz + std::abs(yz) + std::abs(zx)});
  contact.turning = static_cast<std::uint32_t>(turnings_.size());
  turnings_.push_back({.first = first,
                       .end = static_cast<std::uint32_t>(turn_terms_.size()),
                       .key = contact.key | turning_key,
                       .rolling = rolling,
                       .spinning = spinning,
                       .over = most > 0 ? 1 / most : 0});
  if (sides[1].rate != nullptr) turnings_.back().carried = in.h * sides[1].rate->spin;
}

/// Takes up the pushes that held a contact in the last substep.
template <class T>
void CrowdContacts<T>::start_from_kept(const Substep& in, Contact& contact) {
  const std::uint32_t island = contact.island[0];
  const LinkageState& state = *in.cluster[island];
  const double h2 = in.h * in.h;
  const KeptContact held = kept_at(state, contact.key, next_kept_[island]);
  if (held.key != contact.key) return;
  const double along = dot(held.force, contact.normal);
  contact.push = h2 * std::max(0.0, along);
  if (along > 0) contact.across = h2 * (held.force - along * contact.normal);
  if (contact.turning == none) return;
  Turning& turning = turnings_[contact.turning];
  const KeptContact turned = kept_at(state, turning.key, next_kept_[island]);
  if (turned.key == turning.key) turning.push = h2 * turned.force;
}

template <class T>
void CrowdContacts<T>::touch_planes(const Substep& in) {
  for (const Pair& pair : near_.on_planes()) {
    const Ball& each = near_.balls()[pair.one];
    const Plane& plane = in.ground.planes()[pair.other];
    const Vec3 at = in.crowd.origin() + in.crowd.position(near_.terms_of(each.center));
    const double gap = dot(plane.normal, at) - plane.offset - each.ball->radius;
    add(in, {each.island, each.ball->shape, &each.ball->center, &each.ball->surface},
        {.shape = in.surroundings.numbers.of_plane(pair.other),
         .surface = &plane.surface,
         .rate = in.ground.rate_of_plane(pair.other)},
        {gap, plane.normal}, contact_key(KeyKind::plane, each.number, 0, pair.other));
  }
}

template <class T>
void CrowdContacts<T>::touch_pairs(const Substep& in) {
  if (near_.pairs().empty()) return;
  const Crowd<T>& crowd = in.crowd;
  placed_lines_.clear();
  for (const Body& body : near_.bodies()) {
    const auto a = near_.terms_of(body.a), b = near_.terms_of(body.b);
    placed_lines_.push_back({{crowd.position(a), crowd.position(b), body.shape->radius},
                             std::max(norm(crowd.moved(a)), norm(crowd.moved(b)))});
  }
  for (const Pair& pair : near_.pairs()) {
    const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
    if (!crowd.is_moving(a.island) && !crowd.is_moving(b.island)) continue;
    const PlacedLine &line_a = placed_lines_[pair.one], &line_b = placed_lines_[pair.other];
    // What is farther apart does not come about in the substep, see add(). Rounding is far below the share.
    const double reach = settings_.margin + 1.26 * (line_a.moves + line_b.moves);
    if (are_apart(line_a.at, line_b.at, reach)) continue;
    const Touches near = touches(line_a.at, line_b.at, reach);
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
    const std::span<const Term> terms = terms_of(contact.terms), sliding = terms_of(contact.sliding);
    const bool is_one = contact.sliding == contact.terms;
    const Vec3 moved = crowd.moved(terms) - contact.carried;
    const double along = dot(contact.normal, moved);
    const double push = std::max(0.0, contact.push - contact.over * (contact.gap + along));
    const Vec3 slid = is_one ? moved : crowd.moved(sliding) - contact.carried;
    Vec3 across = contact.across - contact.over_sliding * (slid - dot(contact.normal, slid) * contact.normal);
    // What the normal push turned by since it was kept would pull along the normal.
    across = across - dot(across, contact.normal) * contact.normal;
    const double bound = contact.friction * push, square = dot(across, across);
    if (square > bound * bound) across = bound / std::sqrt(square) * across;
    const Vec3 by = (push - contact.push) * contact.normal, by_across = across - contact.across;
    contact.push = push;
    contact.across = across;
    if (contact.turning != none) resist(crowd, contact);
    if (by + by_across == Vec3{}) continue;
    if (is_one) {
      crowd.push(terms, by + by_across);
      most = std::max(most, norm(by + by_across) / contact.over);
    } else {
      crowd.push(terms, by);
      crowd.push(sliding, by_across);
      most = std::max({most, norm(by) / contact.over, norm(by_across) / contact.over_sliding});
    }
  }
  return most;
}

/// Turns the particles of bodies as a torque (kg m²) does.
template <class T>
void CrowdContacts<T>::turn(Crowd<T>& crowd, const Turning& turning, Vec3 by) const {
  for (std::uint32_t k = turning.first; k < turning.end; ++k) {
    const TurnTerm& term = turn_terms_[k];
    crowd.push(term.at, 0.5 * term.inverse_mass * cross(by, term.gradient));
  }
}

/// Sets the torque that resists turning, within what the normal push allows.
template <class T>
void CrowdContacts<T>::resist(Crowd<T>& crowd, const Contact& contact) {
  Turning& turning = turnings_[contact.turning];
  Vec3 turned = -1.0 * turning.carried;
  for (std::uint32_t k = turning.first; k < turning.end; ++k)
    turned += 0.5 * cross(turn_terms_[k].gradient, crowd.moved(turn_terms_[k].at));
  const Vec3 wanted = turning.push - turning.over * turned;
  const double most_spinning = turning.spinning * contact.push, most_rolling = turning.rolling * contact.push;
  const double spinning = dot(wanted, contact.normal);
  Vec3 rolling = wanted - spinning * contact.normal;
  const double square = dot(rolling, rolling);
  if (square > most_rolling * most_rolling) rolling = most_rolling / std::sqrt(square) * rolling;
  const Vec3 push = rolling + std::clamp(spinning, -most_spinning, most_spinning) * contact.normal;
  turn(crowd, turning, push - turning.push);
  turning.push = push;
}

template <class T>
double CrowdContacts<T>::depth(const Crowd<T>& crowd) const {
  double most = 0;
  for (const Contact& contact : contacts_)
    most = std::max(
        most, -contact.gap - dot(contact.normal, crowd.moved(terms_of(contact.terms)) - contact.carried));
  return most;
}

template <class T>
bool CrowdContacts<T>::bounce(Crowd<T>& crowd) {
  constexpr int sweeps = 4;
  const auto bounces = [](const Contact& contact) { return contact.bounce > 0 && contact.push > 0; };
  if (std::none_of(contacts_.begin(), contacts_.end(), bounces)) return false;
  for (int i = 0; i < sweeps; ++i)
    for (Contact& contact : contacts_) {
      if (!bounces(contact)) continue;
      const std::span<const Term> terms = terms_of(contact.terms);
      const double leaves = dot(contact.normal, crowd.velocity(terms)) - contact.carried_at_end;
      const double kick = std::max(0.0, contact.kick + contact.over * (contact.bounce - leaves));
      crowd.push_velocity(terms, (kick - contact.kick) * contact.normal);
      contact.kick = kick;
    }
  return true;
}

template <class T>
void CrowdContacts<T>::end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h) {
  for (LinkageState* const state : cluster)
    if (!state->asleep) state->kept.clear();
  for (const Contact& contact : contacts_) {
    const Vec3 push = contact.push * contact.normal + contact.across;
    if (push == Vec3{}) continue;
    if (LinkageState& state = *cluster[contact.island[0]]; !state.asleep) {
      state.kept.push_back({contact.key, 1 / (h * h) * push, {}});
      if (contact.turning != none)
        state.kept.push_back(
            {turnings_[contact.turning].key, 1 / (h * h) * turnings_[contact.turning].push, {}});
    }
    count_impulses(cluster, crowd, contact, h);
    count_touch(cluster, crowd, contact, h);
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
