#include <algorithm>
#include <cmath>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/rows.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

/// This is the place of a side on something fixed, which has no particles.
constexpr Combination nothing{};

/// Returns two unit vectors at right angles to each other and to the unit vector n.
std::pair<Vec3, Vec3> across(Vec3 n) {
  const Vec3 other = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 t = cross(n, other);
  const Vec3 first = (1 / norm(t)) * t;
  return {first, cross(n, first)};
}

/// Returns the distance (m) within which a contact is watched whose ends move by `moves` (m) in a substep.
double in_sight(double moves, double length_scale) {
  return sight * length_scale + sight_of_moves * moves;
}
}  // namespace

ClusterStepper::Sum ClusterStepper::add_sum(Island& island, const Combination& sum) {
  const auto first = static_cast<std::uint32_t>(island.terms.size());
  island.terms.insert(island.terms.end(), sum.terms.begin(), sum.terms.begin() + sum.count);
  return {first, first + sum.count};
}

std::uint32_t ClusterStepper::add_side(Island& island, const Side& side) {
  island.sides.push_back(side);
  return static_cast<std::uint32_t>(island.sides.size() - 1);
}

void ClusterStepper::add_contact(const Place& a, const Place& b, const Touch& touch, std::uint64_t key,
                                 double h) {
  Island* const one = &islands_[a.island];
  Island* const two = b.island == none ? nullptr : &islands_[b.island];
  const auto motion = [&](const Island* island, const Combination& sum, std::span<const Vec3> of) {
    return island && island->awake ? sum.of(of) : Vec3{};
  };
  const Vec3 shift = motion(one, a.at, one->d) - (two ? motion(two, b.at, two->d) : Vec3{});
  const double closing = dot(touch.normal, shift);
  if (!all_near_ && touch.gap + closing > settings_.margin + 0.25 * norm(shift)) {
    if (touch.gap < in_sight(norm(shift), settings_.length_scale))
      left_out_.push_back({a.island, b.island, add_sum(*one, a.at), two ? add_sum(*two, b.at) : Sum{},
                           touch.gap, touch.normal});
    return;
  }
  for (Island* island : {one, two})
    if (island && !island->awake) {
      if (island->state->asleep && touch.gap + closing < 0) {
        island->state->asleep = false;
        woken_ = true;
      }
      return;
    }
  if (two)
    add_contact_rows(a, b, touch, closing, key, h);
  else
    add_ground_contact(a, b, touch, closing, key, h);
}

/// Adds three rows: one along the normal and two along the directions of sliding.
void ClusterStepper::add_contact_rows(const Place& a, const Place& b, const Touch& touch, double closing,
                                      std::uint64_t key, double h) {
  Island &one = islands_[a.island], &two = islands_[b.island];
  const double arriving = dot(touch.normal, a.at.of(one.v) - b.at.of(two.v));
  const double restitution = std::max(a.surface.restitution, b.surface.restitution);
  const auto [t1, t2] = across(touch.normal);
  const KeptContact held = kept_at(*one.state, key, one.next_kept);
  const Vec3 axes[3] = {touch.normal, t1, t2};
  const Sum sum = add_sum(one, a.at), sum_other = add_sum(two, b.at);
  for (int axis = 0; axis < 3; ++axis) {
    Row& row = rows_.emplace_back();
    row.kind = axis == 0 ? Kind::normal : Kind::sliding;
    row.island[0] = a.island;
    row.side[0] = add_side(one, {sum, {}, axes[axis], {}});
    row.ends = 2;
    row.island[1] = b.island;
    row.side[1] = add_side(two, {sum_other, {}, -1.0 * axes[axis], {}});
    row.key = key;
    row.of[0] = a.shape;
    row.of[1] = b.shape;
    row.held = held.key == key;
    row.p = h * h * dot(held.force, axes[axis]);
    row.q = 0.5 * h * dot(held.end_force, axes[axis]);
    if (axis == 0) {
      row.gap = recovered(touch.gap, settings_.slop, h * recovery_rate_);
      row.bound = std::sqrt(a.surface.friction * b.surface.friction);
      row.bounce = bounce_of(restitution, settings_.bounce_speed, touch.gap, closing, arriving, h);
      row.p = std::max(row.p, 0.0);
      row.q = std::max(row.q, 0.0);
    }
  }
}

void ClusterStepper::add_ground_contact(const Place& a, const Place& b, const Touch& touch, double closing,
                                        std::uint64_t key, double h) {
  Island& island = islands_[a.island];
  const KeptContact held = kept_at(*island.state, key, island.next_kept);
  const double restitution = std::max(a.surface.restitution, b.surface.restitution);
  const double arriving = dot(touch.normal, a.at.of(island.v));
  island.ground.add(*island.state->linkage, {.at = a.at,
                                             .normal = touch.normal,
                                             .gap = recovered(touch.gap, settings_.slop, h * recovery_rate_),
                                             .friction = std::sqrt(a.surface.friction * b.surface.friction),
                                             .bounce = bounce_of(restitution, settings_.bounce_speed,
                                                                 touch.gap, closing, arriving, h),
                                             .key = key,
                                             .shape = a.shape,
                                             .is_held = held.key == key,
                                             .held = (h * h) * held.force,
                                             .held_end = (0.5 * h) * held.end_force});
}

/// Turns contacts with ground into rows if they are few.
void ClusterStepper::spread_ground(std::uint32_t i) {
  Island& island = islands_[i];
  const bool may_stand = island.state->laws.empty() && !island.state->linkage->is_redundant();
  if (may_stand && island.ground.size() > few_on_ground) return;
  island.ground.for_all([&](const GroundContact& contact) {
    const auto [t1, t2] = across(contact.normal);
    const Vec3 axes[3] = {contact.normal, t1, t2};
    const Sum sum = add_sum(island, contact.at);
    for (int axis = 0; axis < 3; ++axis) {
      Row& row = rows_.emplace_back();
      row.kind = axis == 0 ? Kind::normal : Kind::sliding;
      row.island[0] = i;
      row.side[0] = add_side(island, {sum, {}, axes[axis], {}});
      row.ends = 1;
      row.key = contact.key;
      row.of[0] = contact.shape;
      row.held = contact.is_held;
      row.p = dot(contact.held, axes[axis]);
      row.q = dot(contact.held_end, axes[axis]);
      if (axis == 0) {
        row.gap = contact.gap;
        row.bound = contact.friction;
        row.bounce = contact.bounce;
        row.p = std::max(row.p, 0.0);
        row.q = std::max(row.q, 0.0);
      }
    }
  });
  island.ground.clear();
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

/// Finds a box around every island within the substep, and how far the ends of its shapes move (m).
void ClusterStepper::find_bounds() {
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) {
      island.bounds = bounds_of(*island.state->linkage, island.state->x, settings_.margin);
      continue;
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
}

void ClusterStepper::find_contacts(const Surroundings& surroundings, double h) {
  rows_.clear();
  left_out_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    islands_[i].terms.clear();
    islands_[i].sides.clear();
    islands_[i].ground.clear();
    islands_[i].next_kept = 0;
  }
  find_bounds();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (island.awake) {
      touch_planes(i, surroundings.planes, h);
      touch_boxes(i, surroundings.boxes, h);
      spread_ground(i);
      add_angles(i, h);
    }
    for (std::uint32_t j = i + 1; j < count_; ++j) {
      const Island& other = islands_[j];
      if ((island.awake || other.awake) && island.bounds.overlaps(other.bounds)) touch_island(i, j, h);
    }
  }
}

void ClusterStepper::touch_planes(std::uint32_t i, std::span<const Plane> planes, double h) {
  const Island& island = islands_[i];
  const std::span<const Linkage::Ball> balls = island.state->linkage->balls();
  for (std::uint32_t p = 0; p < planes.size(); ++p) {
    const Plane& plane = planes[p];
    if (!all_near_ && height(island.bounds, plane) > in_sight(island.moves, settings_.length_scale)) continue;
    for (std::uint32_t k = 0; k < balls.size(); ++k) {
      const Linkage::Ball& ball = balls[k];
      const double gap = dot(plane.normal, ball.center.of(island.state->x)) - plane.offset - ball.radius;
      add_contact({i, ball.center, ball.surface, ball.shape}, {none, nothing, plane.surface},
                  {gap, plane.normal}, contact_key(KeyKind::plane, k, 0, p), h);
    }
  }
}

void ClusterStepper::touch_boxes(std::uint32_t i, std::span<const Surroundings::Solid> boxes, double h) {
  const Island& island = islands_[i];
  const std::span<const Linkage::Shape> shapes = island.state->linkage->shapes();
  const std::span<const Vec3> x = island.state->x;
  for (std::uint32_t b = 0; b < boxes.size(); ++b) {
    const Surroundings::Solid& box = boxes[b];
    if (!box.bounds.overlaps(island.bounds)) continue;
    for (std::uint32_t k = 0; k < shapes.size(); ++k) {
      const Linkage::Shape& shape = shapes[k];
      const Vec3 p = box.frame.to_local(shape.a.of(x) - box.center);
      const Vec3 q = box.frame.to_local(shape.b.of(x) - box.center);
      for_touches_with_box(p, q, shape.radius, box, [&](std::uint64_t which, double t, const Touch& touch) {
        add_contact({i, blend(shape.a, shape.b, t), shape.surface, k}, {none, nothing, box.surface}, touch,
                    contact_key(KeyKind::box, 16 * k + which, 0, b), h);
      });
    }
  }
}

void ClusterStepper::touch_island(std::uint32_t i, std::uint32_t j, double h) {
  const LinkageState &own = *islands_[i].state, &other = *islands_[j].state;
  const std::span<const Linkage::Shape> shapes = own.linkage->shapes(), others = other.linkage->shapes();
  for (std::uint32_t k = 0; k < shapes.size(); ++k) {
    const Linkage::Shape& a = shapes[k];
    const Segment first{a.a.of(own.x), a.b.of(own.x), a.radius};
    for (std::uint32_t l = 0; l < others.size(); ++l) {
      const Linkage::Shape& b = others[l];
      const Touches near = touches(first, {b.a.of(other.x), b.b.of(other.x), b.radius});
      for (std::uint32_t n = 0; n < near.count; ++n) {
        const Touch& at = near.at[n];
        add_contact({i, blend(a.a, a.b, at.a), a.surface, k}, {j, blend(b.a, b.b, at.b), b.surface, l}, at,
                    contact_key(KeyKind::island, 4 * k + n, other.number, l), h);
      }
    }
  }
}

/// Returns whether other contacts pushed something through a surface that it was not expected to reach.
bool ClusterStepper::is_contact_missed() const {
  return std::any_of(left_out_.begin(), left_out_.end(), [&](const LeftOut& each) {
    const auto moved = [&](std::uint32_t i, Sum at) {
      return i != none && islands_[i].awake ? islands_[i].of(at, islands_[i].d) : Vec3{};
    };
    const Vec3 shift = moved(each.island, each.at) - moved(each.other, each.at_other);
    return each.gap + dot(each.normal, shift) < -settings_.tolerance;
  });
}

}  // namespace plumb::detail
