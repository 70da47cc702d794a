// This file makes the rows of contacts, with the levers by which they turn what they touch.

#include <algorithm>
#include <cmath>

#include "contact/rows.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

/// A contact is on a face if their normals have more than this cosine. With a smaller one, places on edges
/// would leave them.
constexpr double of_face = 1 - 1e-9;

}  // namespace

ClusterStepper::Sum ClusterStepper::add_sum(Island& island, Terms sum) {
  const auto first = static_cast<std::uint32_t>(island.terms.size());
  island.terms.insert(island.terms.end(), sum.begin(), sum.end());
  return {first, static_cast<std::uint32_t>(island.terms.size())};
}

std::uint32_t ClusterStepper::add_side(Island& island, const Side& side) {
  island.sides.push_back(side);
  return static_cast<std::uint32_t>(island.sides.size() - 1);
}

std::uint32_t ClusterStepper::add_side(Island& island, const Lever::Rate& rate, double sign) {
  return add_side(
      island, {add_sum(island, rate.a), add_sum(island, rate.b), sign * rate.along_a, sign * rate.along_b});
}

/// Adds three rows: one along the normal and two along the directions of sliding. With resistances there are
/// two more for rolling, and one for spinning.
void ClusterStepper::add_contact_rows(const GroundContact& contact, std::span<const ContactEnd> ends,
                                      double h) {
  note_touch(contact, ends);
  const auto first = static_cast<std::uint32_t>(rows_.size());
  const auto [t1, t2] = across(contact.normal);
  const Vec3 axes[3] = {contact.normal, t1, t2};
  rows_.resize(first + 3);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    Row& row = rows_[first + axis];
    row.kind = axis == 0 ? Kind::normal : Kind::sliding;
    row.along = axes[axis];
    row.key = contact.key;
    row.held = contact.is_held;
    row.p = dot(contact.held, axes[axis]);
    row.q = dot(contact.held_end, axes[axis]);
    row.given = dot(contact.more->carried, axes[axis]);
    row.given_at_end = dot(contact.more->carried_at_end, axes[axis]);
  }
  Row& normal = rows_[first];
  normal.gap = contact.gap;
  normal.closes = contact.closes;
  normal.bound = contact.friction;
  normal.bounce = contact.bounce;
  normal.p = std::max(normal.p, 0.0);
  normal.q = std::max(normal.q, 0.0);
  Levers levers{.along = contact.normal};
  bool any_turns = false;
  for (const ContactEnd& end : ends) {
    Island& island = islands_[end.island];
    const Linkage::Shape& shape = island.state->linkage->shape_of(end.shape);
    const double sign = &end == &ends[0] ? 1 : -1;
    const Sum sum = add_sum(island, end.at);
    const std::uint32_t side = add_side(island, Side{sum, {}, sign * axes[0], {}});
    levers.end[levers.ends++] = {end.island, end.shape, side, none, sum, end.arm};
    if (shape.turning == Linkage::Shape::Turning::none) {
      for (const Vec3 t : {t1, t2}) add_side(island, Side{sum, {}, sign * t, {}});
    } else {
      const Lever lever(shape, end.at, end.arm, island.state->x);
      const std::uint32_t sliding = add_side(island, lever.sliding(t1), sign);
      // Both directions share their sums.
      const Sum a = island.sides[sliding].a, b = island.sides[sliding].b;
      const Lever::Rate second = lever.sliding(t2);
      add_side(island, Side{a, b, sign * second.along_a, sign * second.along_b});
      any_turns = true;
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      rows_[first + axis].add_end(end.island, side + axis, end.shape);
  }
  if (!any_turns) return;
  levers_.push_back(levers);
  add_round_contact(contact, ends, first);
  if (contact.more->rolling > 0 || contact.more->spinning > 0) add_turning_rows(contact, ends, first, h);
}

/// Adds the rows that resist rolling and spinning to those of a contact, which begin at `normal`.
void ClusterStepper::add_turning_rows(const GroundContact& contact, std::span<const ContactEnd> ends,
                                      std::uint32_t normal, double h) {
  const auto [t1, t2] = across(contact.normal);
  const Vec3 axes[3] = {t1, t2, contact.normal};
  Island& one = islands_[ends[0].island];
  const std::uint64_t key = contact.key | turning_key;
  const KeptContact held = kept_at(*one.state, key, one.next_kept);
  const auto first = static_cast<std::uint32_t>(rows_.size());
  rows_.resize(first + 3);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    Row& row = rows_[first + axis];
    row.kind = axis < 2 ? Kind::rolling : Kind::spinning;
    row.along = axes[axis];
    row.key = key;
    row.normal = normal;
    row.held = held.key == key;
    row.bound = axis < 2 ? contact.more->rolling : contact.more->spinning;
    row.p = h * h * dot(held.force, axes[axis]);
    row.q = 0.5 * h * dot(held.end_force, axes[axis]);
    row.given_at_end = dot(contact.more->spin, axes[axis]);
    row.given = h * row.given_at_end;
  }
  for (const ContactEnd& end : ends) {
    Island& island = islands_[end.island];
    const Linkage::Shape& shape = island.state->linkage->shape_of(end.shape);
    if (shape.turning == Linkage::Shape::Turning::none) continue;
    const bool is_first = &end == &ends[0];
    const Lever lever(shape, end.at, end.arm, island.state->x);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t side = add_side(island, lever.turning(axes[axis]), is_first ? 1 : -1);
      if (axis == 0) levers_.back().end[is_first ? 0 : 1].turning = side;
      rows_[first + axis].add_end(end.island, side, end.shape);
    }
  }
}

/// Returns whether so much of an island that can be swept freely touched itself or others in the last substep
/// that pushes of the ground follow from theirs, and not from the island's matrix.
bool ClusterStepper::touches_others(std::uint32_t i) const {
  const LinkageState& state = *islands_[i].state;
  return state.laws.empty() && state.linkage->has_free_masses() &&
         static_cast<std::size_t>(std::count_if(
             state.kept.begin(), state.kept.end(),
             [](const KeptContact& each) { return kind_of(each.key) == KeyKind::island; })) > few_touching;
}

/// Turns contacts with ground into rows if they are few, or no more than can be swept where that is needed.
/// Rods that rock on what is round are held in the island's matrix alone, since rows keep to where they
/// touched.
void ClusterStepper::spread_ground(std::uint32_t i, double h) {
  Island& island = islands_[i];
  const Linkage& linkage = *island.state->linkage;
  bool may_stand = !linkage.is_redundant() && !touches_others(i), is_round = false;
  island.ground.for_all([&](const GroundContact& contact) {
    may_stand = may_stand && contact.more->rolling == 0 && contact.more->spinning == 0;
    is_round = is_round || contact.more->round;
  });
  // Where cables go slack and come taut, pushes are found more surely one after the other.
  const std::span<const ElasticLaw> laws = island.state->laws;
  const bool sweeps = sweeps_ground_ || std::any_of(laws.begin(), laws.end(),
                                                    [](const ElasticLaw& law) { return law.one_sided; });
  const std::size_t few = sweeps ? most_swept_ground : is_round && island.rocks ? 0 : few_on_ground;
  if (may_stand && island.ground.size() > few) return;
  island.ground.for_all([&](const GroundContact& contact) {
    const double radius = linkage.shape_of(contact.shape).radius;
    const ContactEnd end{i, contact.at, contact.shape, -radius * contact.normal};
    add_contact_rows(contact, {&end, 1}, h);
  });
  island.ground.clear();
}

bool ClusterStepper::turns(const Levers::End& end) const {
  const Linkage& linkage = *islands_[end.island].state->linkage;
  return linkage.shape_of(end.shape).turning != Linkage::Shape::Turning::none;
}

/// Returns whether a contact is on a hull's face, where `outward` is the contact's normal.
bool ClusterStepper::is_on_face(const Levers::End& end, Vec3 outward) {
  const PlacedShape shape = placed(islands_[end.island], end.shape);
  return std::any_of(shape.hull_at.normals.begin(), shape.hull_at.normals.end(),
                     [&](Vec3 normal) { return dot(normal, outward) > of_face; });
}

/// Lets a contact push a hull elsewhere, by that way (m) from where it touched it.
void ClusterStepper::move_place(const Levers::End& end, Vec3 by) {
  Island& island = islands_[end.island];
  const Linkage::HullShape* const hull = placed(island, end.shape).hull;
  if (hull == nullptr) return;
  const std::span<const Vec3> x = island.state->x;
  const Sum sum = add_sum(island, hull->at(hull->of(x), island.of(end.middle, x) + by));
  for (std::uint32_t axis = 0; axis < 3; ++axis) island.sides[end.normal + axis].a = sum;
}

/// Lets levers follow to where islands are at the end of the substep. Two shapes are again pushed at one
/// place: half way between those on both, or at that of the one that does not turn. What rolls on a hull's
/// face takes the place along, since a push on where it was would turn it on.
void ClusterStepper::renew_levers() {
  for (const Levers& contact : levers_) {
    const Levers::End &one = contact.end[0], &two = contact.end[1];
    if (contact.ends == 1) {
      renew_lever(contact, one, one.arm);
      continue;
    }
    const auto place = [&](const Levers::End& end) {
      const Island& island = islands_[end.island];
      return island.of(end.middle, island.state->x) + end.arm;
    };
    const bool on_one = is_on_face(one, -1.0 * contact.along), on_two = is_on_face(two, contact.along);
    const double share = on_one ? 1 : on_two || !turns(one) ? 0 : !turns(two) ? 1 : 0.5;
    const Vec3 apart = place(two) - place(one);
    if (turns(one)) renew_lever(contact, one, one.arm + share * apart);
    if (turns(two)) renew_lever(contact, two, two.arm - (1 - share) * apart);
    if (on_one) move_place(one, apart);
    if (on_two) move_place(two, -1.0 * apart);
  }
}

void ClusterStepper::renew_lever(const Levers& contact, const Levers::End& end, Vec3 arm) {
  Island& island = islands_[end.island];
  const double sign = &end == &contact.end[0] ? 1 : -1;
  const auto set = [&](Sum to, const Combination& sum) {
    std::copy_n(sum.terms.begin(), to.end - to.first, island.terms.begin() + to.first);
  };
  const auto renew = [&](std::uint32_t number, const Lever::Rate& rate) {
    Side& side = island.sides[number];
    set(side.a, rate.a);
    set(side.b, rate.b);
    side.along_a = sign * rate.along_a;
    side.along_b = sign * rate.along_b;
  };
  Combination at;
  for (std::uint32_t k = end.middle.first; k < end.middle.end; ++k)
    at.add(island.terms[k].particle, island.terms[k].weight);
  const Lever lever(island.state->linkage->shape_of(end.shape), at, arm, island.state->x);
  const auto [t1, t2] = across(contact.along);
  renew(end.normal + 1, lever.sliding(t1));
  renew(end.normal + 2, lever.sliding(t2));
  if (contact.ends == 2) {  // the normal push acts there, too
    const Lever::Rate rate = lever.sliding(contact.along);
    const Side& sliding = island.sides[end.normal + 1];
    island.sides[end.normal] = {sliding.a, sliding.b, sign * rate.along_a, sign * rate.along_b};
  }
  if (end.turning == none) return;
  renew(end.turning, lever.turning(t1));
  renew(end.turning + 1, lever.turning(t2));
  renew(end.turning + 2, lever.turning(contact.along));
}

}  // namespace plumb::detail
