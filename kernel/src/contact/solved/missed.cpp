// This file finds what is where it should not be, in ground or beyond others, as rods turned or others pushed
// it, and brings rods to their lengths outside of it.

#include <algorithm>
#include <utility>

#include "contact/rows.hpp"
#include "contact/shapes/passing.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Finds what went into ground or through others where it was not expected. It keeps off it when positions
/// are sought again. Returns whether there is any.
bool ClusterStepper::find_missed() {
  const bool any_ground = find_missed_ground(), any_pairs = find_missed_pairs();
  return any_ground || any_pairs;
}

bool ClusterStepper::find_missed_pairs() {
  const std::size_t before = missed_pairs_.size();
  for (const auto [i, j] : near_islands_.found())
    if (islands_[i].awake || islands_[j].awake) find_missed_pairs(i, j);
  return missed_pairs_.size() > before;
}

void ClusterStepper::find_missed_pairs(std::uint32_t i, std::uint32_t j) {
  const PairSearch search{settings_.margin, settings_.tolerance};
  const std::span<const Linkage::Shape> shapes = islands_[i].state->linkage->shapes(),
                                        others = islands_[j].state->linkage->shapes();
  const auto motion = [&](std::uint32_t island, const Linkage::Shape& shape) -> MovingSegment {
    if (islands_[island].awake) return motion_of(islands_[island], shape);
    const std::span<const Vec3> x = islands_[island].state->x;
    return {.at = {shape.a.of(x), shape.b.of(x), shape.radius}};
  };
  for (std::uint32_t k = 0; k < shapes.size(); ++k) {
    const MovingSegment a = motion(i, shapes[k]);
    const Bounds way = bounds_of(a);
    for (std::uint32_t l = 0; l < others.size(); ++l) {
      const MovingSegment b = motion(j, others[l]);
      if (!search.is_fast(moves_between(a, b), std::min(a.at.radius, b.at.radius)) ||
          !way.overlaps(bounds_of(b)) || !plumb::may_touch(shapes[k].filter, others[l].filter) ||
          hang_together(*islands_[i].state, k, *islands_[j].state, l))
        continue;
      if (const auto plane = search.passed(a, b))
        missed_pairs_.push_back({i, k, j, l, static_cast<std::uint32_t>(missed_pairs_.size()), *plane});
    }
  }
}

void ClusterStepper::touch_missed_pairs(std::uint32_t i, std::uint32_t j, double h) {
  for (const MissedPair& each : missed_pairs_) {
    if (each.island != i || each.other != j) continue;
    const LinkageState& other = *islands_[j].state;
    const Linkage::Shape &a = islands_[i].state->linkage->shapes()[each.shape],
                         &b = other.linkage->shapes()[each.other_shape];
    const std::uint64_t missed = std::uint64_t{1} << 40;
    add_contact({i, blend(a.a, a.b, each.touch.a), a.surface, each.shape},
                {j, blend(b.a, b.b, each.touch.b), b.surface, each.other_shape}, each.touch,
                contact_key(KeyKind::island, missed | each.shape, other.number, each.number), h);
  }
}

/// Returns whether something on one particle has gone deeper into another island than in before_. Few sweeps
/// do not carry what is heavy on light rods.
bool ClusterStepper::has_ball_sunk(double most) {
  if (std::none_of(islands_.begin(), islands_.begin() + count_,
                   [](const Island& each) { return each.state->linkage->movable() == 1; }))
    return false;
  const auto place = [&](std::uint32_t i, std::uint32_t k, std::span<const Vec3> x) {
    const Linkage::Shape& shape = islands_[i].state->linkage->shapes()[k];
    return Segment{shape.a.of(x), shape.b.of(x), shape.radius};
  };
  const auto sinks = [&](std::uint32_t i, std::uint32_t k, std::uint32_t j, std::uint32_t l) {
    const LinkageState &one = *islands_[i].state, &other = *islands_[j].state;
    const double gap = touch(place(i, k, one.x), place(j, l, other.x)).gap;
    return gap < -most - settings_.tolerance &&
           gap < touch(place(i, k, before_[i].x), place(j, l, before_[j].x)).gap &&
           plumb::may_touch(one.linkage->shapes()[k].filter, other.linkage->shapes()[l].filter) &&
           !hang_together(one, k, other, l);
  };
  const auto sinks_in = [&](std::uint32_t i, std::uint32_t j) {
    const Linkage &one = *islands_[i].state->linkage, &other = *islands_[j].state->linkage;
    for (std::uint32_t k = 0; one.movable() == 1 && k < one.shapes().size(); ++k)
      for (std::uint32_t l = 0; l < other.shapes().size(); ++l)
        if (sinks(i, k, j, l)) return true;
    return false;
  };
  island_bounds_.clear();
  for (std::uint32_t i = 0; i < count_; ++i)
    island_bounds_.push_back(bounds_of(*islands_[i].state->linkage, islands_[i].state->x, 0));
  const std::span<const NearPairs::Pair> pairs = near_islands_.find(island_bounds_);
  return std::any_of(pairs.begin(), pairs.end(), [&](const NearPairs::Pair& pair) {
    return sinks_in(pair.first, pair.second) || sinks_in(pair.second, pair.first);
  });
}

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
  projection_.walls.clear();
  if (strain_ != Strain::none) find_walls(i);
  if (!(project_positions(state, projection_) <= most)) return false;
  const auto farthest = [&] {
    double out = 0;
    for (std::uint32_t k = 0; k < state.linkage->movable(); ++k)
      out = std::max(out, norm(state.x[k] - island.there[k]));
    return out;
  };
  const double moved = farthest();
  bool is_held = !find_depths(i);
  const double depth = deepest_;
  for (int tries = 0; !is_held && tries < most_holds && project_positions(state, projection_) == 0; ++tries)
    is_held = !find_depths(i);
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
  return true;
}

/// Brings the rods of what is awake to their lengths, or leaves an island as it is if it may keep its strain.
bool ClusterStepper::bring_to_lengths(const Surroundings& surroundings) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    const LinkageState& state = *islands_[i].state;
    islands_[i].awake = !state.asleep && !state.frozen;
    if (!islands_[i].awake) continue;
    islands_[i].there = state.x;
    projection_.holds.clear();
    const bool fits = bring_to_lengths(i, most_left, surroundings);
    if (!fits && strain_ == Strain::none) return false;
    if (!fits) islands_[i].state->x = islands_[i].there;
    islands_[i].state->strain = fits ? Strain::none : std::max(state.strain, Strain::drawn);
  }
  return true;
}

}  // namespace plumb::detail
