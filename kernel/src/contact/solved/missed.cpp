// This file finds what is where it should not be, in ground or beyond others, as rods turned or others pushed
// it.

#include <algorithm>

#include "contact/rows.hpp"
#include "contact/shapes/passing.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {

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
      const auto plane = search.passed(a, b);
      if (!plane) continue;
      missed_pairs_.push_back({i, k, j, l, static_cast<std::uint32_t>(missed_pairs_.size()), *plane});
      wake(i);
      wake(j);
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

}  // namespace plumb::detail
