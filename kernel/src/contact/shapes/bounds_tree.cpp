#include "contact/shapes/bounds_tree.hpp"

#include <algorithm>
#include <numeric>

namespace plumb::detail {
namespace {

Vec3 doubled_center(const Bounds& bounds) {
  return bounds.low + bounds.high;
}

}  // namespace

BoundsTree::BoundsTree(std::span<const Bounds> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0u);
  nodes_.reserve(boxes.size());
  if (!boxes.empty()) build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
}

/// Halves the items along the axis in which their centres spread most. Items with equal centres go by number,
/// so that each half is the same on every machine.
void BoundsTree::build(std::span<const Bounds> boxes, std::uint32_t first, std::uint32_t end) {
  const std::size_t own = nodes_.size();
  nodes_.emplace_back();
  Bounds bounds = nowhere, centers = nowhere;
  for (std::uint32_t k = first; k < end; ++k) {
    include(bounds, boxes[items_[k]].low, 0);
    include(bounds, boxes[items_[k]].high, 0);
    include(centers, doubled_center(boxes[items_[k]]), 0);
  }
  nodes_[own].bounds = bounds;
  if (end - first <= at_leaf) {
    std::sort(items_.begin() + first, items_.begin() + end);
    nodes_[own].first = first;
    nodes_[own].end = end;
  } else {
    const Vec3 spread = centers.high - centers.low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    const auto along = [&](std::uint32_t item) {
      const Vec3 center = doubled_center(boxes[item]);
      return axis == 0 ? center.x : axis == 1 ? center.y : center.z;
    };
    const std::uint32_t middle = first + (end - first) / 2;
    std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double at_a = along(a), at_b = along(b);
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    build(boxes, first, middle);
    build(boxes, middle, end);
  }
  nodes_[own].next = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace plumb::detail
