// This file finds where hulls of islands are, and where they touch each other.

#include "contact/ground/placed_hulls.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {

void ClusterStepper::place_hulls(Island& island) {
  island.hulls.clear();
  for (const Linkage::HullShape& hull : island.state->linkage->hulls())
    island.hulls.add(hull, hull.of(island.state->x));
}

/// Returns a shape of an island, or a hull, by its number.
PlacedShape ClusterStepper::placed(Island& island, std::uint32_t number) {
  const std::span<const Linkage::Shape> shapes = island.state->linkage->shapes();
  const auto lines = static_cast<std::uint32_t>(shapes.size());
  if (number >= lines) return {island.hulls, number - lines};
  const Linkage::Shape& shape = shapes[number];
  return {shape, number, shape.a.of(island.state->x), shape.b.of(island.state->x)};
}

/// Finds where hulls of two islands touch each other and capsules.
void ClusterStepper::touch_island_hulls(std::uint32_t i, std::uint32_t j, double h) {
  Island &own = islands_[i], &other = islands_[j];
  const double reach = settings_.margin + own.moves + other.moves;
  const auto count = [](const Island& island) {
    const auto lines = static_cast<std::uint32_t>(island.state->linkage->shapes().size());
    return std::pair{lines, lines + island.hulls.size()};
  };
  const auto [own_lines, own_end] = count(own);
  const auto [other_lines, other_end] = count(other);
  for (std::uint32_t k = 0; k < own_end; ++k) {
    const PlacedShape a = placed(own, k);
    for (std::uint32_t l = k < own_lines ? other_lines : 0; l < other_end; ++l) {
      if (!plumb::may_touch(own.state->linkage->shape_of(k).filter, other.state->linkage->shape_of(l).filter))
        continue;
      const PlacedShape b = placed(other, l);
      for_pair_touches(
          a, b, reach, other.state->number,
          [&](std::uint64_t key, const Combination& at_a, const Combination& at_b, const Touch& touch) {
            add_contact({i, at_a, *a.surface, a.number}, {j, at_b, *b.surface, b.number}, touch, key, h);
          });
    }
  }
}

}  // namespace plumb::detail
