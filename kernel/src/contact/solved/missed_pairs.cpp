// This file finds capsules of two islands that went through each other, as rods turned or others pushed them.

#include <algorithm>

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

/// Returns whether something on one particle has gone far into another island. Few sweeps do not carry what
/// is heavy on light rods.
bool ClusterStepper::has_ball_sunk() {
  const auto place = [](const LinkageState& state, std::uint32_t k) {
    const Linkage::Shape& shape = state.linkage->shapes()[k];
    return Segment{shape.a.of(state.x), shape.b.of(state.x), shape.radius};
  };
  const auto lies_deep = [&](const LinkageState& one, std::uint32_t k, const LinkageState& other) {
    const Segment ball = place(one, k);
    const std::span<const Linkage::Shape> shapes = other.linkage->shapes();
    for (std::uint32_t l = 0; l < shapes.size(); ++l) {
      const double most = settings_.slop + most_sunk * std::min(ball.radius, shapes[l].radius);
      if (touch(ball, place(other, l)).gap < -most &&
          plumb::may_touch(one.linkage->shapes()[k].filter, shapes[l].filter) &&
          !hang_together(one, k, other, l))
        return true;
    }
    return false;
  };
  const auto lies_in = [&](const LinkageState& one, const LinkageState& other) {
    for (std::uint32_t k = 0; one.linkage->movable() == 1 && k < one.linkage->shapes().size(); ++k)
      if (lies_deep(one, k, other)) return true;
    return false;
  };
  island_bounds_.clear();
  for (std::uint32_t i = 0; i < count_; ++i)
    island_bounds_.push_back(bounds_of(*islands_[i].state->linkage, islands_[i].state->x, 0));
  const std::span<const NearPairs::Pair> pairs = near_islands_.find(island_bounds_);
  return std::any_of(pairs.begin(), pairs.end(), [&](const NearPairs::Pair& pair) {
    const LinkageState &one = *islands_[pair.first].state, &other = *islands_[pair.second].state;
    return lies_in(one, other) || lies_in(other, one);
  });
}

}  // namespace plumb::detail
