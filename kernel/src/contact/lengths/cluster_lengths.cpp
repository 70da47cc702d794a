// This file brings rods to their lengths where relaxation has left them off, and out of ground.

#include <algorithm>
#include <utility>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Takes rods back to where they were off their lengths, before they were brought to them.
void ClusterStepper::keep_strain() {
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (!islands_[i].awake) continue;
    islands_[i].state->x = islands_[i].there;
    islands_[i].state->strain = std::max(islands_[i].state->strain, Strain::drawn);
  }
}

/// Finds the ground that an island touches or is near where it is, as contacts.
void ClusterStepper::find_ground_now(std::uint32_t i) {
  Island& island = islands_[i];
  const double h = instant, rate = std::exchange(recovery_rate_, 1 / h);
  const std::size_t terms = island.terms.size();
  island.d.assign(island.state->x.size(), Vec3{});
  island.v = island.state->v;
  island.ground.clear();
  missed_ground_.clear();
  find_bounds(island);
  touch_planes(i, h);
  touch_ground(i, h);
  touch_boxes(i, h);
  touch_anchored(i, h);
  recovery_rate_ = rate;
  left_out_.clear();
  island.terms.resize(terms);
}

/// Lists planes that an island may not go through from where it is, wherever it is brought to: from within
/// something thin the nearest way out may be on its other side.
void ClusterStepper::find_walls(std::uint32_t i) {
  find_ground_now(i);
  Island& island = islands_[i];
  island.ground.for_all([&](const GroundContact& contact) {
    const double now = dot(contact.normal, contact.at.of(island.state->x));
    projection_.walls.push_back({contact.at, contact.normal, std::min(now, now - contact.gap)});
  });
  island.ground.clear();
}

/// Lists planes between an island and the lines that it was near at Island::there, of islands that are where
/// they are to be. It may be no deeper in these than it was then.
void ClusterStepper::find_walls_of_others(std::uint32_t i) {
  for (const auto [one, two] : close_islands_.found()) {
    if (one == i && islands_[two].is_placed) find_walls_between(i, two);
    if (two == i && islands_[one].is_placed) find_walls_between(i, one);
  }
}

/// Lists those between an island and one other.
void ClusterStepper::find_walls_between(std::uint32_t i, std::uint32_t j) {
  const LinkageState &state = *islands_[i].state, &other = *islands_[j].state;
  const std::span<const Linkage::Shape> shapes = state.linkage->shapes(), others = other.linkage->shapes();
  const auto line = [&](std::uint32_t of, const Linkage::Shape& shape) {
    const std::span<const Vec3> x = islands_[of].there;
    return Segment{shape.a.of(x), shape.b.of(x), shape.radius};
  };
  for (std::uint32_t k = 0; k < shapes.size(); ++k) {
    const Segment own = line(i, shapes[k]);
    if (!grown(island_bounds_[j], own.radius).overlaps(box_around(own.p, own.q))) continue;
    for (std::uint32_t l = 0; l < others.size(); ++l) {
      const Segment of_other = line(j, others[l]);
      const double apart = own.radius + of_other.radius, reach = most_approach * apart;
      if (!plumb::may_touch(shapes[k].filter, others[l].filter) || are_apart(own, of_other, reach) ||
          hang_together(state, k, other, l))
        continue;
      const Touches near = touches(own, of_other, reach);
      for (const Touch& at : std::span(near.at, near.count)) {
        const Vec3 to = blend(others[l].a, others[l].b, at.b).of(other.x);
        projection_.walls.push_back({blend(shapes[k].a, shapes[k].b, at.a), at.normal,
                                     dot(at.normal, to) + apart + std::min(at.gap, 0.0)});
      }
    }
  }
}

/// Lists where an island is deeper in ground than it may be and was at Island::there, among what is to be
/// held out of it. Returns whether it is.
bool ClusterStepper::find_depths(std::uint32_t i) {
  find_ground_now(i);
  Island& island = islands_[i];
  bool is_deeper = false;
  deepest_ = 0;
  island.ground.for_all([&](const GroundContact& contact) {
    deepest_ = std::max(deepest_, -contact.gap);
    const double now = dot(contact.normal, contact.at.of(island.state->x));
    const double least = std::min(now - contact.gap, dot(contact.normal, contact.at.of(island.there)));
    if (least <= now + settings_.slop) return;
    projection_.holds.push_back({contact.at, contact.normal, least});
    is_deeper = true;
  });
  for (const Hold& wall : projection_.walls) {
    const double depth = wall.least - dot(wall.along, wall.at.of(island.state->x));
    if (depth <= settings_.slop) continue;
    deepest_ = std::max(deepest_, depth);
    projection_.holds.push_back(wall);
    is_deeper = true;
  }
  island.ground.clear();
  return is_deeper;
}

/// Returns whether what was relaxed for h (s) lies deeper in ground than in before_.
bool ClusterStepper::have_sunk(double h) {
  const auto deepest = [&] {
    double out = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (!islands_[i].awake) continue;
      find_depths(i);
      out = std::max(out, deepest_);
    }
    return out;
  };
  const auto swap_places = [&] {
    for (std::uint32_t i = 0; i < count_; ++i) std::swap(islands_[i].state->x, before_[i].x);
  };
  swap_places();
  ground_.find(*surroundings_, now_);
  const double was = deepest();
  swap_places();
  ground_.find(*surroundings_, now_ + h);
  return deepest() > was + settings_.tolerance;
}

/// Brings the rods of an island to their lengths from where it is, which may leave a violation of `most`, and
/// out of ground that it is in more than at Island::there. What is to be held is among holds already. Returns
/// false where rods are too far from their lengths, or something passed ground on its way. Rods that may keep
/// what they lack do so rather than press something into ground, unless that is by far the less.
bool ClusterStepper::bring_to_lengths(std::uint32_t i, double most, const Surroundings& surroundings) {
  Island& island = islands_[i];
  LinkageState& state = *island.state;
  if (strain_ != Strain::none) find_walls(i);
  const double left = project_positions(state, projection_);
  if (!(left <= most)) {
    projection_.walls.clear();
    return false;
  }
  const auto farthest = [&] {
    double out = 0;
    for (std::uint32_t k = 0; k < state.linkage->movable(); ++k)
      out = std::max(out, norm(state.x[k] - island.there[k]));
    return out;
  };
  const double moved = farthest();
  most_moved_ = std::max(most_moved_, moved);
  const std::size_t of_ground = projection_.walls.size();
  if (count_ > 1 && most_moved_ > settings_.slop) find_walls_of_others(i);
  bool is_held = !find_depths(i);
  const double depth = deepest_;
  for (int tries = 0; !is_held && tries < most_holds && project_positions(state, projection_) == 0; ++tries)
    is_held = !find_depths(i);
  for (std::size_t k = of_ground; k < projection_.walls.size(); ++k) {
    const Hold& wall = projection_.walls[k];
    const double depth_in_other = wall.least - dot(wall.along, wall.at.of(state.x));
    goes_through_ = goes_through_ || depth_in_other > most_in_others * state.linkage->thinness();
  }
  projection_.walls.clear();
  // Where nothing holds it out, it may be brought to where nothing is.
  is_held = is_held && farthest() <= moved + most_pushed * depth;
  if (!is_held && moved <= most_drawn * depth && strain_ != Strain::none) {
    state.strain = Strain::pressed;
    return false;
  }
  gives_up_missed_ = gives_up_missed_ || deepest_ > settings_.slop;
  if (passes_ground(island, surroundings)) return false;
  project_velocities(state, projection_);
  std::fill(state.acceleration.begin(), state.acceleration.end(), Vec3{});
  state.energy.reset();
  // To try again is in vain for a net, and takes long. A bridge of planks may fit as soon as a load goes on.
  state.strain = left > noticed && state.linkage->is_net() ? Strain::drawn : Strain::none;
  return true;
}

/// Returns whether an island goes into others as its rods are brought to their lengths, or is a net that went
/// so far that it may have passed through what it touches.
bool ClusterStepper::has_gone_far(std::uint32_t i) {
  if (std::exchange(goes_through_, false)) return true;
  const Island& island = islands_[i];
  const Linkage& linkage = *island.state->linkage;
  if (count_ == 1 || !linkage.is_net()) return false;
  const double most = most_approach * linkage.thinness();
  for (std::uint32_t k = 0; k < linkage.movable(); ++k)
    if (norm(island.state->x[k] - island.there[k]) > most) return true;
  return false;
}

/// Brings the rods of what is awake to their lengths, or leaves an island as it is if it may keep its strain.
/// What hangs on anchors comes first, and keeps off what lies on it.
bool ClusterStepper::bring_to_lengths(const Surroundings& surroundings) {
  island_bounds_.clear();
  most_moved_ = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    LinkageState& state = *islands_[i].state;
    islands_[i].awake = !state.asleep && !state.frozen;
    islands_[i].is_placed = !islands_[i].awake;
    islands_[i].there = state.x;
    if (count_ > 1) island_bounds_.push_back(bounds_of(*state.linkage, state.x, settings_.margin));
  }
  close_islands_.find(island_bounds_);
  for (const bool hangs : {true, false})
    for (std::uint32_t i = 0; i < count_; ++i)
      if (!islands_[i].is_placed && islands_[i].state->linkage->is_grounded() == hangs) {
        if (!try_lengths(i, surroundings)) return false;
        islands_[i].is_placed = true;
      }
  return true;
}

/// Brings the rods of an island to their lengths, or leaves it as it is. Returns false if it may not be left
/// so.
bool ClusterStepper::try_lengths(std::uint32_t i, const Surroundings& surroundings) {
  LinkageState& state = *islands_[i].state;
  projection_.holds.clear();
  goes_through_ = false;
  const bool fits = bring_to_lengths(i, may_strain_ ? most_left : 0, surroundings);
  if (fits && !has_gone_far(i)) return true;
  if (strain_ == Strain::none && !(fits && may_strain_)) return false;
  state.x = islands_[i].there;
  state.strain = std::max(state.strain, Strain::drawn);
  return true;
}

/// Brings the rods of a cluster to their lengths, once in a step, before it is tried again: a substep may
/// have failed because rods that are off their lengths do not fit to what else resists. Returns false, and
/// nothing has moved, where they were at their lengths or cannot be brought there.
bool ClusterStepper::fit(std::span<LinkageState* const> cluster, const Surroundings& surroundings) {
  if (std::exchange(is_fitted_, true)) return false;
  keep_motion(cluster);
  bool moves = false;
  if (bring_to_lengths(surroundings))
    for (std::size_t i = 0; i < cluster.size(); ++i)
      for (std::size_t k = 0; k < cluster[i]->x.size(); ++k)
        moves = moves || norm(cluster[i]->x[k] - before_[i].x[k]) > unfitting * cluster[i]->linkage->size();
  if (!moves) return_to_motion(cluster);
  return moves;
}

}  // namespace plumb::detail
