#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "contact/pair_order.hpp"
#include "contact/shapes/bounds.hpp"
#include "contact/spatial_hash.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Finds which of many boxes overlap, in time that grows linearly with them where each has few neighbours.
class NearPairs {
 public:
  struct Pair {
    std::uint32_t first, second;  ///< first < second
    auto operator<=>(const Pair&) const = default;
  };

  /// Finds all pairs of boxes that overlap, each once, ascending. They stand until the next call.
  std::span<const Pair> find(std::span<const Bounds> boxes) {
    pairs_.clear();
    if (boxes.size() < few) {
      for (std::uint32_t k = 0; k < boxes.size(); ++k)
        for (std::uint32_t l = k + 1; l < boxes.size(); ++l)
          if (boxes[k].overlaps(boxes[l])) pairs_.push_back({k, l});
      return pairs_;
    }
    const auto count = static_cast<std::uint32_t>(boxes.size());
    double sum = 0;
    for (const Bounds& each : boxes) {
      const Vec3 spread = each.high - each.low;
      sum += std::max({spread.x, spread.y, spread.z});
    }
    // Boxes that are not finite are looked for one by one, whatever the size of a cell.
    const double cell = sum / count;
    hash_.start(cell > 0 && cell < widest ? cell : 1, 4 * boxes.size());
    seen_.assign(count, count);
    for (std::uint32_t l = 0; l < count; ++l)
      hash_.find_and_insert(l, boxes[l], [&](std::uint32_t k) {
        if (std::exchange(seen_[k], l) == l) return;  // in another cell
        if (boxes[k].overlaps(boxes[l])) pairs_.push_back({std::min(k, l), std::max(k, l)});
      });
    order_.sort(pairs_, &Pair::first, count);
    return pairs_;
  }
  /// Returns what was found last.
  std::span<const Pair> found() const { return pairs_; }

 private:
  static constexpr std::size_t few = 8;    ///< boxes that are compared faster than put into cells
  static constexpr double widest = 1e100;  ///< m, of a cell

  SpatialHash hash_;
  Array<std::uint32_t> seen_;  ///< by box, for which other it was looked at last
  Array<Pair> pairs_;
  PairOrder<Pair> order_;
};

}  // namespace plumb::detail
