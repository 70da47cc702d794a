// This file lets contacts of lines follow where they touch as they turn.
//
// Rods that pull rock on what is round about as stiffly as waves run along them. Rows that keep to the places
// that touched as a substep began lag behind that, and rock them more and more.

#include <algorithm>
#include <cmath>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Returns whether rods of an island pull so much that they rock on what is round about as fast as a substep
/// of h (s) can follow, or faster.
bool ClusterStepper::may_rock(std::uint32_t i, double h) const {
  const LinkageState& state = *islands_[i].state;
  double stiffest = 0, lightest = INFINITY;
  for (const double each : state.stiffness) stiffest = std::max(stiffest, each);
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k)
    lightest = std::min(lightest, state.linkage->mass_of(k));
  return h * h * stiffest > rocks * lightest;
}

/// Lets a contact follow whose rows begin at `row`, and whose levers are the last ones, if lines touch of
/// which one is a rod that rocks.
void ClusterStepper::add_round_contact(const GroundContact& contact, std::span<const ContactEnd> ends,
                                       std::uint32_t row) {
  const GroundContact::More& more = *contact.more;
  const bool any_rocks = std::any_of(ends.begin(), ends.end(), [&](const ContactEnd& end) {
    const Island& island = islands_[end.island];
    const Linkage::Shape& shape = island.state->linkage->shape_of(end.shape);
    return island.rocks && shape.turning == Linkage::Shape::Turning::line;
  });
  if (!more.round || !any_rocks || more.rolling > 0 || more.spinning > 0) return;
  round_contacts_.push_back({static_cast<std::uint32_t>(levers_.size() - 1), row, *more.round, more.carried,
                             contact.gap, more.apart});
}

/// Returns where the lines of a contact are nearest, as the substep begins or, `with_motion`, as it ends.
Touch ClusterStepper::nearest(const RoundContact& contact, bool with_motion) const {
  const Levers& levers = levers_[contact.levers];
  const auto line = [&](const Levers::End& end) {
    const Island& island = islands_[end.island];
    const Linkage::Shape& shape = island.state->linkage->shapes()[end.shape];
    Segment out{shape.a.of(island.state->x), shape.b.of(island.state->x), shape.radius};
    if (with_motion && island.awake) {
      out.p += shape.a.of(island.d);
      out.q += shape.b.of(island.d);
    }
    return out;
  };
  if (levers.ends == 2) return touch(line(levers.end[0]), line(levers.end[1]));
  const Segment& other = contact.other;
  return touch(line(levers.end[0]), {other.p + contact.carried, other.q + contact.carried, other.radius});
}

/// Lets gaps be those where lines are taken to, rather than those of the places that touched.
void ClusterStepper::follow_gaps() {
  for (const RoundContact& contact : round_contacts_) {
    Row& row = rows_[contact.row];
    row.gap = contact.gap + nearest(contact, true).gap - (contact.apart + opened(row));
  }
}

/// Lets contacts push where lines touch as the substep has ended. What pushed them stays as it is.
void ClusterStepper::follow_round() {
  for (const RoundContact& contact : round_contacts_) {
    const std::span<Row> rows = std::span(rows_).subspan(contact.row, 3);
    rows[0].gap = contact.gap;
    if (rows[0].p == 0) continue;
    const Touch near = nearest(contact, false);
    const auto sum = [&](double Row::*of) {
      return rows[0].*of * rows[0].along + rows[1].*of * rows[1].along + rows[2].*of * rows[2].along;
    };
    const Vec3 position = sum(&Row::p), velocity = sum(&Row::q);
    if (dot(position, near.normal) <= 0) continue;
    const auto [t1, t2] = across(near.normal);
    const Vec3 axes[3] = {near.normal, t1, t2};
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      rows[axis].along = axes[axis];
      rows[axis].p = dot(position, axes[axis]);
      rows[axis].q = dot(velocity, axes[axis]);
    }
    Levers& levers = levers_[contact.levers];
    levers.along = near.normal;
    for (std::uint32_t end = 0; end < levers.ends; ++end)
      move_end(levers.end[end], axes, end == 0 ? near.a : near.b, end == 0 ? 1 : -1,
               levers.ends == 2 ? 0.5 * near.gap : 0);
  }
}

/// Lets a contact push one end at a share of its line from its first end on, along new axes. The place that
/// is pushed is that far (m) beyond the surface.
void ClusterStepper::move_end(Levers::End& end, std::span<const Vec3> axes, double share, double sign,
                              double beyond) {
  Island& island = islands_[end.island];
  const Linkage::Shape& shape = island.state->linkage->shapes()[end.shape];
  const Combination at = blend(shape.a, shape.b, share);
  end.middle = add_sum(island, at);
  end.arm = (-sign * (shape.radius + beyond)) * axes[0];
  const Lever lever(shape, at, end.arm, island.state->x);
  island.sides[end.normal] = {end.middle, {}, sign * axes[0], {}};
  for (std::uint32_t axis = 1; axis < 3; ++axis) {
    const Lever::Rate rate = lever.sliding(axes[axis]);
    island.sides[end.normal + axis] = {add_sum(island, rate.a), add_sum(island, rate.b), sign * rate.along_a,
                                       sign * rate.along_b};
  }
}

}  // namespace plumb::detail
