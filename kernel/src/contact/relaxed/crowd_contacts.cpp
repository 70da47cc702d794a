#include "contact/relaxed/crowd_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "contact/rows.hpp"

namespace plumb::detail {
namespace {

/// Contacts are found kind by kind: with planes, boxes, anchored shapes, other ground by lines, ends and
/// hulls, and of lines and hulls with each other.
constexpr std::uint32_t kinds = 8;
/// More batches than threads even out what they cost.
constexpr std::uint32_t batches_per_thread = 4;

/// Nothing is pushed where no movable particle has this weight, which is close to an anchor: by the lever of
/// such a place an overlap of millimetres would throw the rod's other end by its length.
constexpr double least_weight = 0.02;

/// Appends terms, multiplied by a sign. Returns what a push of one on their sum moves it by, 1/kg.
template <class Term>
double add_terms(std::span<const Term> terms, double sign, Array<Term>& to) {
  double moves = 0;
  for (const Term& each : terms) {
    to.push_back({each.at, sign * each.weight, sign * each.move});
    moves += each.weight * each.move;
  }
  return moves;
}

}  // namespace

// --- Contacts of a step

template <class T>
void CrowdContacts<T>::find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                            const Surroundings& surroundings, const GroundNow& ground, double dt,
                            double recovery_rate) {
  recovery_rate_ = recovery_rate;
  moved_ = -1;
  way_ = 0;
  near_.find(cluster, crowd, surroundings, ground, dt);
  ends_.clear();
  ends_.add(cluster, crowd, near_, surroundings, ground, near_.plain_ends());
  longest_ = -1;
  if (near_.may_meet() || meets_) lines_.begin_step(cluster, crowd, near_);
  meets_ = near_.may_meet();
}

// --- Contacts of a substep

template <class T>
bool CrowdContacts<T>::begin(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                             const Surroundings& surroundings, const GroundNow& ground, double h,
                             Team* team) {
  is_fast_ = false;
  place_hulls(crowd);
  if (moved_ < 0) moved_ = crowd.most_moved();
  see_fast(crowd, surroundings, team);
  if (!near_.pairs().empty())
    lines_.find(cluster, crowd, near_, {&placed_lines_.front().p.x, h, h * recovery_rate_}, team);
  find_in_batches(cluster, crowd, surroundings, ground, h, team);
  if (wake(cluster)) return false;
  ends_.find(crowd, surroundings, h, h * recovery_rate_);
  ends_.start(crowd);
  lines_.start(crowd);
  for_contacts([&](const Batch& batch, const Contact& contact) {
    if (!(contact.push > 0)) return;
    const Rare& rare = batch.rare_of(contact);
    if (!rare.slides_apart) {
      crowd.push(batch.terms_of(contact.terms), contact.push * contact.normal + contact.across);
    } else {
      crowd.push(batch.terms_of(contact.terms), contact.push * contact.normal);
      crowd.push(batch.terms_of(rare.sliding), contact.across);
    }
    if (rare.turning != none) {
      const Turning& turning = batch.turnings[rare.turning];
      turn(crowd, batch, turning, turning.push);
    }
  });
  lay_out(crowd);
  return true;
}

/// Finds the contacts of each kind one after the other, in as many batches as threads may work through.
template <class T>
void CrowdContacts<T>::find_in_batches(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                                       const Surroundings& surroundings, const GroundNow& ground, double h,
                                       Team* team) {
  // Hulls are placed in one working memory.
  const bool is_shared = team != nullptr && near_.hulls().empty();
  const std::uint32_t shares = is_shared ? batches_per_thread * team->parts() : 1;
  batches_.resize(std::max<std::size_t>(kinds * shares, batches_.size()));
  for (Batch& batch : batches_) batch.clear();
  kept_.clear();
  if (!near_.are_all_plain()) kept_.gather(cluster);
  const bool counts = is_counted(cluster);
  const auto find = [&](std::uint32_t number) {
    const std::uint32_t kind = number / shares;
    const Share share{number % shares, shares};
    Batch& batch = batches_[number];
    const Substep in{cluster, crowd, surroundings, ground, h, batch, counts};
    if (kind == 0) {
      touch_planes(in, share.of(near_.on_planes()));
    } else if (kind == 1) {
      touch_boxes(in, share.of(near_.on_boxes()));
    } else if (kind == 2) {
      touch_segments(in, share.of(near_.on_segments()));
    } else if (kind == 3) {
      touch_lines_and_ground(in, share.of(near_.on_ground()));
    } else if (kind == 4) {
      touch_ends_and_ground(in, share.of(near_.ends_on_ground()));
    } else if (kind == 5) {
      touch_hulls_and_ground(in);
      // Few are fast. Ground near them is listed in one working memory.
      if (share.number == 0) touch_in_passing(in);
    } else if (kind == 6) {
      touch_pairs(in, share.of(lines_.left()));
    } else {
      touch_hull_pairs(in);
    }
  };
  if (is_shared) {
    team->for_each(kinds * shares, [&](std::uint32_t number, unsigned) { find(number); });
  } else {
    for (std::uint32_t number = 0; number < kinds; ++number) find(number);
  }
}

/// Returns whether somebody asks what pushes an island.
template <class T>
bool CrowdContacts<T>::is_counted(std::span<LinkageState* const> cluster) {
  return std::any_of(cluster.begin(), cluster.end(),
                     [](const LinkageState* state) { return state->pulls.are_asked_for(); });
}

template <class T>
bool CrowdContacts<T>::wake(std::span<LinkageState* const> cluster) {
  if (std::none_of(cluster.begin(), cluster.end(), [](const auto* state) { return state->asleep; }))
    return false;
  bool any = false;
  const auto wake_heap = [&](std::uint32_t island) {
    if (island == none || !cluster[island]->asleep || cluster[island]->frozen) return;
    any = true;
    for (LinkageState* const each : cluster) {
      if (!each->asleep || each->heap != cluster[island]->heap) continue;
      each->asleep = false;
      each->slow_time = 0;
      each->pulls.begin_step();
    }
  };
  for (const Batch& batch : batches_) std::for_each(batch.woken.begin(), batch.woken.end(), wake_heap);
  for_contacts([&](const Batch&, const Contact& contact) {
    if (contact.push > 0) std::for_each(std::begin(contact.island), std::end(contact.island), wake_heap);
  });
  return any;
}

template <class T>
Barycentric CrowdContacts<T>::body_of(const Substep& in, const Side& side) {
  const auto& particles = shape_of(in, side).turners;
  const auto at = [&](int i) { return in.crowd.position_of(side.island, particles[i]); };
  return Barycentric({at(0), at(1), at(2), at(3)});
}

template <class T>
Middle<T> CrowdContacts<T>::middle_of(const Substep& in, const Body& body, double t) const {
  const bool has_ends = body.is_plain() && body.at[0] != body.at[1];
  if (has_ends) return {near_.terms_of(body.a).front(), near_.terms_of(body.b).front(), t};
  return {in.crowd, *in.cluster[body.island]->linkage, body.island, blend(body.shape->a, body.shape->b, t)};
}

template <class T>
void CrowdContacts<T>::add(const Substep& in, const Side& one, const Side& other, const Touch& touch,
                           std::uint64_t key) {
  const Crowd<T>& crowd = in.crowd;
  const double h = in.h;
  Batch& to = in.to;
  const std::array<Side, 2> sides{one, other};
  Contact contact;
  contact.normal = touch.normal;
  contact.key = key;
  Rare rare;
  add_ends(in, sides, contact);
  double arriving = dot(touch.normal, crowd.velocity(to.terms_of(contact.terms)));
  if (other.rate != nullptr) {
    const Vec3 place = crowd.origin() + crowd.position(one.at) - shape_of(in, one).radius * touch.normal;
    rare.carried = other.rate->moved(place, touch.normal, h);
    arriving -= dot(touch.normal, other.rate->at(place, touch.normal));
    rare.carried_at_end = dot(touch.normal, other.rate->later(h).at(place + rare.carried, touch.normal));
  }
  const Vec3 shift = crowd.moved(to.terms_of(contact.terms)) - rare.carried;
  const double closing = dot(touch.normal, shift);
  const bool comes = touch.gap + closing <= settings_.margin + 0.25 * norm(shift);
  const bool may_pass =
      other.island == none && kind_of(key) != KeyKind::plane && norm(shift) > settings_.margin;
  const auto is_hull = [&](const Side& side) {
    return side.island != none && side.shape >= in.cluster[side.island]->linkage->shapes().size();
  };
  const bool is_watched = (is_hull(one) || is_hull(other) || may_pass) &&
                          touch.gap <= in_sight(norm(shift), settings_.length_scale);
  if (!(contact.over < INFINITY) || (!comes && !is_watched)) {
    to.terms.resize(contact.terms.first);
    return;
  }
  for (const Side& side : sides) {
    if (!comes || !(touch.gap + closing < 0) || side.island == none) continue;
    if (const LinkageState& state = *in.cluster[side.island]; state.asleep && !state.frozen)
      to.woken.push_back(side.island);
  }
  const double restitution = std::max(one.surface->restitution, other.surface->restitution);
  contact.gap = recovered(touch.gap, settings_.slop, h * recovery_rate_);
  contact.width =
      is_hull(one) ? near_.hull_of(one.island, one.shape)->shape->half_width : shape_of(in, one).radius;
  contact.friction = std::sqrt(one.surface->friction * other.surface->friction);
  rare.approach = relaxed_approach_of(touch.gap, closing, arriving, h);
  rare.bounce = bounce_of(restitution, settings_.bounce_speed, rare.approach);
  add_sliding(in, sides, touch, rare);
  add_turning(in, sides, contact, rare);
  if (rare.slides_apart || rare.turning != none || other.rate != nullptr || rare.bounce > 0 || in.counts) {
    contact.rare = static_cast<std::uint32_t>(to.rares.size());
    to.rares.push_back(rare);
  }
  if (comes) start_from_kept(in, contact);
  (comes ? to.contacts : to.left_out).push_back(contact);
}

/// Adds the places that the normal push acts on.
template <class T>
void CrowdContacts<T>::add_ends(const Substep& in, const std::array<Side, 2>& sides, Contact& contact) {
  contact.terms.first = static_cast<std::uint32_t>(in.to.terms.size());
  double moves = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side& side = sides[i];
    contact.island[i] = side.island;
    contact.shape[i] = side.shape;
    contact.other_terms = static_cast<std::uint32_t>(in.to.terms.size());
    if (side.island == none) continue;
    moves += add_terms(side.at, i == 0 ? 1 : -1, in.to.terms);
  }
  contact.terms.end = static_cast<std::uint32_t>(in.to.terms.size());
  double heaviest = 0;
  for (std::uint32_t i = contact.terms.first; i < contact.terms.end; ++i)
    if (const Term& each = in.to.terms[i]; each.move != 0)
      heaviest = std::max(heaviest, std::abs(static_cast<double>(each.weight)));
  contact.over = heaviest < least_weight ? INFINITY : 1 / moves;
}

/// Adds the places that friction holds: those of bodies where they are touched. Two bodies are held at one
/// place, half way between their surfaces.
template <class T>
void CrowdContacts<T>::add_sliding(const Substep& in, const std::array<Side, 2>& sides, const Touch& touch,
                                   Rare& rare) {
  if (!turns(in, sides[0]) && !turns(in, sides[1])) return;
  rare.slides_apart = true;
  rare.sliding.first = static_cast<std::uint32_t>(in.to.terms.size());
  double moves = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side& side = sides[i];
    if (side.island == none) continue;
    const double sign = i == 0 ? 1 : -1, apart = sides[1].island == none ? 0 : 0.5 * touch.gap;
    if (!turns(in, side)) {
      moves += add_terms(side.at, sign, in.to.terms);
      continue;
    }
    const Linkage::Shape& shape = shape_of(in, side);
    const Vec3 arm = -sign * (shape.radius + apart) * touch.normal;
    const std::array<double, 4> weights = body_of(in, side).weights(in.crowd.position(side.at) + arm);
    Combination at;
    for (std::uint32_t k = 0; k < 4; ++k) at.terms[at.count++] = {shape.turners[k], weights[k]};
    moves += in.crowd.add_terms(*in.cluster[side.island]->linkage, side.island, at, sign, in.to.terms);
  }
  rare.sliding.end = static_cast<std::uint32_t>(in.to.terms.size());
  rare.over_sliding = 1 / moves;
}

/// Adds what resists rolling and spinning, if a body turns and a surface does.
template <class T>
void CrowdContacts<T>::add_turning(const Substep& in, const std::array<Side, 2>& sides,
                                   const Contact& contact, Rare& rare) {
  const Surface &one = *sides[0].surface, &two = *sides[1].surface;
  const double rolling = std::max(one.rolling, two.rolling), spinning = std::max(one.spinning, two.spinning);
  if (!(rolling > 0 || spinning > 0) || (!turns(in, sides[0]) && !turns(in, sides[1]))) return;
  const auto first = static_cast<std::uint32_t>(in.to.turn_terms.size());
  // A torque turns by this matrix, symmetric and positive; no torque by more than its largest row sum.
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side& side = sides[i];
    if (!turns(in, side)) continue;
    const std::array<Vec3, 4> gradients = body_of(in, side).gradients();
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t particle = shape_of(in, side).turners[k];
      const double inverse = in.crowd.inverse_mass(side.island, particle);
      const Vec3 g = gradients[k];
      in.to.turn_terms.push_back(
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
  rare.turning = static_cast<std::uint32_t>(in.to.turnings.size());
  in.to.turnings.push_back({.first = first,
                            .end = static_cast<std::uint32_t>(in.to.turn_terms.size()),
                            .key = contact.key | turning_key,
                            .rolling = rolling,
                            .spinning = spinning,
                            .over = most > 0 ? 1 / most : 0});
  if (sides[1].rate != nullptr) in.to.turnings.back().carried = in.h * sides[1].rate->spin;
}

/// Takes up the pushes that held a contact in the last substep.
template <class T>
void CrowdContacts<T>::start_from_kept(const Substep& in, Contact& contact) {
  const std::uint32_t island = contact.island[0];
  const LinkageState& state = *in.cluster[island];
  const double h2 = in.h * in.h;
  // What is fast, or turns out to be missed, which one thread finds, may be the first that asks.
  if (!kept_.is_gathered()) kept_.gather(in.cluster);
  const KeptContact* const held = kept_.find(state, island, contact.key, in.to.next_kept);
  if (held == nullptr) return;
  const double along = dot(held->force, contact.normal);
  contact.push = h2 * std::max(0.0, along);
  if (along > 0) contact.across = h2 * (held->force - along * contact.normal);
  const std::uint32_t number = in.to.rare_of(contact).turning;
  if (number == none) return;
  Turning& turning = in.to.turnings[number];
  const KeptContact* const turned = kept_.find(state, island, turning.key, in.to.next_kept);
  if (turned != nullptr) turning.push = h2 * turned->force;
}

template <class T>
void CrowdContacts<T>::touch_planes(const Substep& in, std::span<const Pair> pairs) {
  for (const Pair& pair : pairs) {
    const Ball& each = near_.balls()[pair.one];
    const Plane& plane = in.ground.planes()[pair.other];
    const Vec3 at = in.crowd.origin() + in.crowd.position(near_.terms_of(each.center));
    const double gap = dot(plane.normal, at) - plane.offset - each.ball->radius;
    add(in, side_of(each),
        {.shape = in.surroundings.numbers.of_plane(pair.other),
         .surface = &plane.surface,
         .rate = in.ground.rate_of_plane(pair.other)},
        {gap, plane.normal}, contact_key(KeyKind::plane, each.number, 0, pair.other));
  }
}

template <class T>
void CrowdContacts<T>::end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h) {
  for (LinkageState* const state : cluster)
    if (!state->asleep) state->kept.clear();
  const bool counts = is_counted(cluster);
  for_contacts([&](const Batch& batch, const Contact& contact) {
    const Vec3 push = contact.push * contact.normal + contact.across;
    if (push == Vec3{}) return;
    if (LinkageState& state = *cluster[contact.island[0]]; !state.asleep) {
      state.kept.push_back({contact.key, 1 / (h * h) * push, {}});
      if (const std::uint32_t number = batch.rare_of(contact).turning; number != none) {
        const Turning& turning = batch.turnings[number];
        state.kept.push_back({turning.key, 1 / (h * h) * turning.push, {}});
      }
    }
    if (!counts) return;
    count_impulses(cluster, crowd, batch, contact, h);
    count_touch(cluster, crowd, batch, contact, h);
  });
  ends_.end(cluster, crowd, h);
  lines_.end(cluster, crowd, near_, h);
  way_ += moved_;
}

template <class T>
std::size_t CrowdContacts<T>::count_contacts() const {
  std::size_t out = 0;
  for (const Batch& batch : batches_) out += batch.contacts.size();
  return out;
}

template <class T>
std::size_t CrowdContacts<T>::count_pushes() const {
  std::size_t out = ends_.count_pushes() + lines_.count_pushes();
  for_contacts([&](const Batch&, const Contact& contact) { out += contact.push > 0; });
  return out;
}

template class CrowdContacts<float>;
template class CrowdContacts<double>;

}  // namespace plumb::detail
