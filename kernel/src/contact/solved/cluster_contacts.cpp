#include <algorithm>
#include <cmath>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/rows.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

/// How ground that moves carries what touches it.
struct Carried {
  Vec3 by{}, now{}, at_end{};  ///< m in a substep, and m/s at its start and its end
};

/// Returns how far apart (m) things may end that a row keeps apart, if one moves by `shift` (m) against the
/// other, which may be fixed. What flies does not leave gradient mid for what it will not reach.
double reach_of_rows(const ClusterIsland& one, const ClusterIsland* other, bool may_touch, double margin,
                     Vec3 shift) {
  const bool flies = !may_touch && (one.theta == 0.5 || (other && other->theta == 0.5));
  return flies ? 0 : margin + 0.25 * norm(shift);
}

/// Returns how ground carries a place that moves by `by` (m) itself in a substep of h (s).
Carried carried_by(const GroundRate& rate, Vec3 place, Vec3 normal, Vec3 by, double h) {
  return {rate.moved(place, normal, h), rate.at(place, normal), rate.later(h).at(place + by, normal)};
}

}  // namespace

void ClusterStepper::add_contact(const Place& a, const Place& b, const Touch& touch, std::uint64_t key,
                                 double h) {
  Island* const one = &islands_[a.island];
  Island* const two = b.island == none ? nullptr : &islands_[b.island];
  const auto motion = [&](const Island* island, const Combination& sum, std::span<const Vec3> of) {
    return island && island->awake ? sum.of(of) : Vec3{};
  };
  const double radius = one->state->linkage->shape_of(a.shape).radius;
  Carried carried;
  if (b.rate)
    carried = carried_by(*b.rate, a.at.of(one->state->x) - radius * touch.normal, touch.normal,
                         motion(one, a.at, one->d), h);
  const Vec3 shift = motion(one, a.at, one->d) - (two ? motion(two, b.at, two->d) : carried.by);
  const double closing = dot(touch.normal, shift);
  const auto leave_out = [&] {
    left_out_.push_back({a.island, b.island, add_sum(*one, a.at), two ? add_sum(*two, b.at) : Sum{},
                         touch.gap, touch.normal, carried.by});
  };
  if (touch.gap + closing > reach_of_rows(*one, two, may_touch_, settings_.margin, shift)) {
    if (touch.gap >= in_sight(norm(shift), settings_.length_scale)) return;
    if (!all_near_) return leave_out();
  }
  for (const std::uint32_t i : {a.island, b.island}) {
    if (i == none || islands_[i].awake) continue;
    if (!islands_[i].state->asleep) return;
    return touch.gap + closing < 0 ? wake(i) : leave_out();
  }
  const KeptContact held = kept_at(*one->state, key, one->next_kept);
  const double arriving = dot(touch.normal, a.at.of(one->v) - (two ? b.at.of(two->v) : carried.now));
  const double approach = approach_of(touch.gap, closing, arriving, h);
  const GroundContact::More more{.rolling = std::max(a.surface.rolling, b.surface.rolling),
                                 .spinning = std::max(a.surface.spinning, b.surface.spinning),
                                 .carried = carried.by,
                                 .carried_at_end = carried.at_end,
                                 .spin = b.rate ? b.rate->spin : Vec3{},
                                 .round = b.round,
                                 .apart = touch.gap};
  const bool has_more = more.rolling > 0 || more.spinning > 0 || b.rate || b.round;
  const GroundContact contact{.at = a.at,
                              .normal = touch.normal,
                              .gap = recovered(touch.gap, settings_.slop, h * recovery_rate_),
                              .closes = -closing,
                              .friction = std::sqrt(a.surface.friction * b.surface.friction),
                              .bounce = bounce_of(std::max(a.surface.restitution, b.surface.restitution),
                                                  settings_.bounce_speed, approach),
                              .approach = approach,
                              .key = key,
                              .shape = a.shape,
                              .other = b.shape,
                              .is_held = held.key == key,
                              .held = (h * h) * held.force,
                              .held_end = (0.5 * h) * held.end_force,
                              .more = has_more ? &more : &GroundContact::no_more};
  if (!two) return one->ground.add(contact, one->state->heaviest(contact.at));
  // Both are pushed at one place, half way between their surfaces.
  const double other_radius = two->state->linkage->shape_of(b.shape).radius;
  const ContactEnd ends[] = {{a.island, a.at, a.shape, -(radius + 0.5 * touch.gap) * touch.normal},
                             {b.island, b.at, b.shape, (other_radius + 0.5 * touch.gap) * touch.normal}};
  add_contact_rows(contact, ends, h);
}

/// Wakes an island if it sleeps, with all of its heap, since a blow goes through that at once.
void ClusterStepper::wake(std::uint32_t i) {
  if (!islands_[i].state->asleep) return;
  for (std::uint32_t k = 0; k < count_; ++k)
    if (islands_[k].state->heap == islands_[i].state->heap) islands_[k].state->asleep = false;
}

void ClusterStepper::add_angles(std::uint32_t i, double h) {
  Island& island = islands_[i];
  const LinkageState& state = *island.state;
  for (std::size_t k = 0; k < state.angle_rules.size(); ++k) {
    const Linkage::AngleRule& rule = state.angle_rules[k];
    if (rule.lower == 0 && rule.upper == std::numbers::pi && rule.friction == 0) continue;
    const Linkage::Angle& angle = state.linkage->angles()[k];
    const auto [value, along_u, along_v] = Linkage::slope(angle, state.x);
    const Side side{add_sum(island, angle.u), add_sum(island, angle.v), along_u, along_v};
    const double by = dot(along_u, island.of(side.a, island.d)) + dot(along_v, island.of(side.b, island.d));
    const auto add = [&](Kind kind, double sign) -> Row& {
      Row& row = rows_.emplace_back();
      row.kind = kind;
      row.island[0] = i;
      row.ends = 1;
      row.side[0] = add_side(island, {side.a, side.b, sign * side.along_a, sign * side.along_b});
      row.key = contact_key(KeyKind::angle, k, static_cast<std::uint64_t>(kind), sign < 0);
      row.of[0] = static_cast<std::uint32_t>(k);
      row.of[1] = sign < 0;
      const KeptContact held = kept_at(state, row.key, island.next_kept);
      row.held = held.key == row.key;
      row.p = h * h * held.force.x;
      row.q = 0.5 * h * held.end_force.x;
      return row;
    };
    const double near = 0.05 + std::abs(by);
    if (rule.lower > 0 && value + by - rule.lower < near)
      add(Kind::limit, 1).gap = recovered(value - rule.lower, 0, h * recovery_rate_);
    if (rule.upper < std::numbers::pi && rule.upper - value - by < near)
      add(Kind::limit, -1).gap = recovered(rule.upper - value, 0, h * recovery_rate_);
    if (rule.friction > 0) {
      // Friction acts with half of its impulse in either half of the substep.
      Row& row = add(Kind::brake, 1);
      row.bound = 0.5 * h * h * rule.friction;
      row.bounce = 0.5 * h * rule.friction;
    }
  }
}

/// Finds a box around an island within the substep, and how far the ends of its shapes move (m).
void ClusterStepper::find_bounds(Island& island) const {
  place_hulls(island);
  if (!island.awake) {
    island.bounds = bounds_of(*island.state->linkage, island.state->x, settings_.margin);
    return;
  }
  island.bounds = nowhere;
  double square = 0;
  for (const Linkage::Ball& ball : island.state->linkage->balls()) {
    const Vec3 at = ball.center.of(island.state->x), by = ball.center.of(island.d);
    include(island.bounds, at, ball.radius + settings_.margin);
    include(island.bounds, at + 1.25 * by, ball.radius + settings_.margin);
    square = std::max(square, dot(by, by));
  }
  island.moves = std::sqrt(square);
}

/// Finds the boxes beyond which capsules cannot be in sight of others, see add_contact().
void ClusterStepper::find_sights(Island& island) const {
  // Two shares of this are at least in_sight() of what both islands move by.
  const double moves = island.awake ? island.moves : 0;
  const double share =
      std::max(0.5 * settings_.margin, 0.5 * in_sight(0, settings_.length_scale)) + 2 * moves;
  island.sights.clear();
  island.sight = nowhere;
  for (const Linkage::Shape& shape : island.state->linkage->shapes()) {
    Bounds& bounds = island.sights.emplace_back(nowhere);
    for (const Terms end : {shape.a, shape.b}) include(bounds, end.of(island.state->x), shape.radius + share);
    include(island.sight, bounds.low, 0);
    include(island.sight, bounds.high, 0);
  }
}

void ClusterStepper::find_contacts(double h) {
  rows_.clear();
  left_out_.clear();
  levers_.clear();
  touches_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    islands_[i].terms.clear();
    islands_[i].sides.clear();
    islands_[i].ground.clear();
    islands_[i].next_kept = 0;
  }
  round_contacts_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    find_bounds(islands_[i]);
    islands_[i].rocks = islands_[i].awake && may_rock(i, h);
  }
  island_bounds_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    island_bounds_.push_back(islands_[i].bounds);
    if (count_ > 1) find_sights(islands_[i]);
  }
  const std::span<const NearPairs::Pair> pairs = near_islands_.find(island_bounds_);
  auto pair = pairs.begin();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (island.awake) {
      touch_planes(i, h);
      touch_ground(i, h);
      touch_boxes(i, h);
      touch_anchored(i, h);
      spread_ground(i, h);
      if (island.state->linkage->neighbors().any_may_touch()) touch_itself(i, h);
      add_angles(i, h);
    }
    for (; pair != pairs.end() && pair->first == i; ++pair) {
      const std::uint32_t j = pair->second;
      const Island& other = islands_[j];
      if (!(island.awake || other.awake)) continue;
      touch_island(i, j, h);
      touch_missed_pairs(i, j, h);
      if (island.hulls.size() + other.hulls.size() > 0) touch_island_hulls(i, j, h);
    }
  }
}

void ClusterStepper::touch_planes(std::uint32_t i, double h) {
  const Island& island = islands_[i];
  const std::span<const Linkage::Ball> balls = island.state->linkage->balls();
  for (std::uint32_t p = 0; p < ground_.planes().size(); ++p) {
    const Plane& plane = ground_.planes()[p];
    const GroundRate* const rate = ground_.rate_of_plane(p);
    const double moves = island.moves + h * fastest(rate, island.bounds, h);
    if (!all_near_ && height(island.bounds, plane) > in_sight(moves, settings_.length_scale)) continue;
    for (std::uint32_t k = 0; k < balls.size(); ++k) {
      const Linkage::Ball& ball = balls[k];
      if (!plumb::may_touch(ball.filter, plane.filter)) continue;
      const double gap = dot(plane.normal, ball.center.of(island.state->x)) - plane.offset - ball.radius;
      add_contact({i, ball.center, ball.surface, ball.shape},
                  {none, no_particles, plane.surface, surroundings_->numbers.of_plane(p), rate},
                  {gap, plane.normal}, contact_key(KeyKind::plane, k, 0, p), h);
    }
  }
}

void ClusterStepper::touch_boxes(std::uint32_t i, double h) {
  Island& island = islands_[i];
  const std::span<const Linkage::Shape> shapes = island.state->linkage->shapes();
  const std::span<const Vec3> x = island.state->x;
  for (std::uint32_t b = 0; b < ground_.boxes().size(); ++b) {
    const Surroundings::Solid& box = ground_.boxes()[b];
    if (!box.motion.platform) continue;  // it is among the other shapes
    const GroundRate* const rate = ground_.rate_of_box(b);
    const double moves = h * fastest(rate, island.bounds, h);
    if (!box.bounds.overlaps(grown(island.bounds, moves))) continue;
    const Place other{none, no_particles, box.surface, surroundings_->numbers.of_box(b), rate};
    for (std::uint32_t k = 0; k < shapes.size(); ++k) {
      const Linkage::Shape& shape = shapes[k];
      if (!plumb::may_touch(shape.filter, box.filter)) continue;
      const Vec3 p = box.frame.to_local(shape.a.of(x) - box.center);
      const Vec3 q = box.frame.to_local(shape.b.of(x) - box.center);
      for_touches_with_box(p, q, shape.radius, box, [&](std::uint64_t which, double t, const Touch& touch) {
        add_contact({i, blend(shape.a, shape.b, t), shape.surface, k}, other, touch,
                    contact_key(KeyKind::box, 16 * k + which, 0, b), h);
      });
    }
    for (std::uint32_t k = 0; k < island.hulls.size(); ++k)
      if (const PlacedShape hull{island.hulls, k}; plumb::may_touch(hull.hull->filter, box.filter))
        for_touches_with_moving(hull, ground_.solid_of_box(b), settings_.margin + island.moves + moves,
                                KeyKind::box, b,
                                [&](std::uint64_t key, const Combination& at, const Touch& touch) {
                                  add_contact({i, at, *hull.surface, hull.number}, other, touch, key, h);
                                });
  }
}

void ClusterStepper::touch_anchored(std::uint32_t i, double h) {
  Island& island = islands_[i];
  const std::span<const Linkage::Shape> shapes = island.state->linkage->shapes(), others = ground_.shapes();
  for (std::uint32_t l = 0; l < others.size(); ++l) {
    const Segment& other = ground_.segments()[l];
    const GroundRate* const rate = ground_.rate_of_segment(l);
    const double moves = h * fastest(rate, island.bounds, h);
    if (!grown(island.bounds, moves + other.radius).overlaps(box_around(other.p, other.q))) continue;
    const Place place{none, no_particles, others[l].surface, surroundings_->numbers.of_anchored(l), rate};
    for (std::uint32_t k = 0; k < shapes.size(); ++k) {
      const Linkage::Shape& shape = shapes[k];
      if (!plumb::may_touch(shape.filter, others[l].filter) || hang_together(*island.state, k, others[l]))
        continue;
      const Segment first{shape.a.of(island.state->x), shape.b.of(island.state->x), shape.radius};
      const Touches found = touches(first, other);
      for (std::uint32_t n = 0; n < found.count; ++n)
        add_contact({i, blend(shape.a, shape.b, found.at[n].a), shape.surface, k},
                    {none, no_particles, place.surface, place.shape, rate,
                     n == 0 ? std::optional(other) : std::nullopt},
                    found.at[n], contact_key(KeyKind::segment, 4 * k + n, 0, l), h);
    }
    for (std::uint32_t k = 0; k < island.hulls.size(); ++k)
      if (const PlacedShape hull{island.hulls, k}; plumb::may_touch(hull.hull->filter, others[l].filter) &&
                                                   !hang_together(*island.state, hull.number, others[l]))
        for_touches_with_moving(hull, ground_.solid_of_segment(l), settings_.margin + island.moves + moves,
                                KeyKind::segment, l,
                                [&](std::uint64_t key, const Combination& at, const Touch& touch) {
                                  add_contact({i, at, *hull.surface, hull.number}, place, touch, key, h);
                                });
  }
}

void ClusterStepper::touch_island(std::uint32_t i, std::uint32_t j, double h) {
  const Island &island = islands_[i], &other = islands_[j];
  const std::span<const Linkage::Shape> shapes = island.state->linkage->shapes(),
                                        others = other.state->linkage->shapes();
  for (std::uint32_t k = 0; k < shapes.size(); ++k) {
    if (!island.sights[k].overlaps(other.sight)) continue;
    for (std::uint32_t l = 0; l < others.size(); ++l)
      if (island.sights[k].overlaps(other.sights[l]) &&
          plumb::may_touch(shapes[k].filter, others[l].filter) &&
          !hang_together(*island.state, k, *other.state, l))
        touch_capsules(i, k, j, l, h);
  }
}

/// Adds contacts between capsule k of island i and capsule l of island j.
void ClusterStepper::touch_capsules(std::uint32_t i, std::uint32_t k, std::uint32_t j, std::uint32_t l,
                                    double h) {
  const LinkageState &own = *islands_[i].state, &other = *islands_[j].state;
  const Linkage::Shape &a = own.linkage->shapes()[k], &b = other.linkage->shapes()[l];
  const Segment second{b.a.of(other.x), b.b.of(other.x), b.radius};
  const Touches near = touches({a.a.of(own.x), a.b.of(own.x), a.radius}, second);
  for (std::uint32_t n = 0; n < near.count; ++n) {
    const Touch& at = near.at[n];
    add_contact(
        {i, blend(a.a, a.b, at.a), a.surface, k},
        {j, blend(b.a, b.b, at.b), b.surface, l, nullptr, n == 0 ? std::optional(second) : std::nullopt}, at,
        contact_key(KeyKind::island, 4 * k + n, other.number, l), h);
  }
}

/// Finds where capsules of an island touch each other.
void ClusterStepper::touch_itself(std::uint32_t i, double h) {
  const Island& island = islands_[i];
  const Linkage& linkage = *island.state->linkage;
  const std::span<const Linkage::Shape> shapes = linkage.shapes();
  own_bounds_.clear();
  for (const Linkage::Shape& shape : shapes) {
    Bounds& bounds = own_bounds_.emplace_back(nowhere);
    for (const Terms end : {shape.a, shape.b}) {
      const Vec3 at = end.of(island.state->x);
      include(bounds, at, shape.radius + settings_.margin);
      include(bounds, at + 1.25 * end.of(island.d), shape.radius + settings_.margin);
    }
  }
  for (const auto [k, l] : own_pairs_.find(own_bounds_))
    if (linkage.neighbors().may_touch(k, l) && plumb::may_touch(shapes[k].filter, shapes[l].filter))
      touch_capsules(i, k, i, l, h);
}

/// Returns whether other contacts pushed something through a surface that it was not expected to reach. Wakes
/// what sleeps there.
bool ClusterStepper::find_missed_contacts() {
  bool any = false;
  for (const LeftOut& each : left_out_) {
    const auto moved = [&](std::uint32_t i, Sum at) {
      return i != none && islands_[i].awake ? islands_[i].of(at, islands_[i].d) : Vec3{};
    };
    const Vec3 shift = moved(each.island, each.at) - moved(each.other, each.at_other) - each.carried;
    if (each.gap + dot(each.normal, shift) >= -settings_.tolerance) continue;
    any = true;
    for (const std::uint32_t i : {each.island, each.other})
      if (i != none) wake(i);
  }
  return any;
}

}  // namespace plumb::detail
