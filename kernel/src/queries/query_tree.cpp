#include "queries/query_tree.hpp"

#include <cmath>
#include <numeric>

namespace plumb::detail {
namespace {

/// Rounds outward, by up to twice what a float needs.
float below(double x) {
  if (!std::isfinite(x)) return static_cast<float>(x);
  const double low = x - 1.2e-7 * std::abs(x) - 1e-37;
  return low < -3e38 ? -INFINITY : static_cast<float>(std::min(low, 3e38));
}
float above(double x) {
  return -below(-x);
}

Vec3 center_of(const Bounds& box) {
  return box.is_empty() ? Vec3{} : 0.5 * (box.low + box.high);
}

Bounds around(const Bounds& a, const Bounds& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

/// Returns half of a box's surface (m²), which says how often rays meet it.
double half_area(const Bounds& box) {
  if (box.is_empty()) return 0;
  const Vec3 size = box.high - box.low;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Returns how many of boxes go to the first part when they are split across an axis, along which centres are
/// from `low` to `high`, as `along(number)` says. Of some places that is the one where rays meet least: the
/// sum over both parts of their surface times what they hold (MacDonald and Booth 1990; Wald 2007).
///
/// No part gets less than a quarter, so that the hierarchy stays low. Where no such place is, it is halved.
template <class Along>
std::uint32_t size_of_first(std::span<const Bounds> boxes, std::span<const std::uint32_t> numbers, double low,
                            double high, Along&& along) {
  constexpr std::size_t slices = 32;
  std::array<Bounds, slices> around_slice;
  around_slice.fill(nowhere);
  std::array<std::uint32_t, slices> held{};
  for (const std::uint32_t number : numbers) {
    const double share = slices * ((along(number) - low) / (high - low));
    const std::size_t slice = share >= 0 && share < slices ? static_cast<std::size_t>(share) : slices - 1;
    around_slice[slice] = around(around_slice[slice], boxes[number]);
    ++held[slice];
  }
  const auto all = static_cast<std::uint32_t>(numbers.size());
  std::array<double, slices> behind{};
  Bounds box = nowhere;
  std::uint32_t count = 0;
  for (std::size_t i = slices; i-- > 1;) {
    box = around(box, around_slice[i]);
    behind[i] = half_area(box) * (count += held[i]);
  }
  box = nowhere;
  count = 0;
  double best = INFINITY;
  std::uint32_t out = all / 2;
  for (std::size_t i = 0; i + 1 < slices; ++i) {
    box = around(box, around_slice[i]);
    count += held[i];
    const double cost = half_area(box) * count + behind[i + 1];
    if (4 * count < all || 4 * (all - count) < all || !(cost < best)) continue;
    best = cost;
    out = count;
  }
  return out;
}

}  // namespace

QueryTree::FloatWay::FloatWay(const Way& way, Vec3 extent) {
  const double origin[3] = {way.origin.x, way.origin.y, way.origin.z};
  const double along[3] = {way.direction.x, way.direction.y, way.direction.z};
  const double half[3] = {way.half.x, way.half.y, way.half.z};
  const double farthest[3] = {extent.x, extent.y, extent.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    is_back[axis] = along[axis] < 0;
    // Several times what floats lose of places. Slower ways than this one go nowhere across an axis.
    const double wider = half[axis] + 4e-7 * (std::abs(origin[axis]) + half[axis] + farthest[axis]);
    const double by = is_back[axis] ? -wider : wider;
    near[axis] = static_cast<float>(std::clamp(origin[axis] + by, -3e38, 3e38));
    far[axis] = static_cast<float>(std::clamp(origin[axis] - by, -3e38, 3e38));
    over[axis] = static_cast<float>(1 / std::max(std::abs(along[axis]), 1e-30)) * (is_back[axis] ? -1 : 1);
  }
}

void QueryTree::build(std::span<const Bounds> boxes) {
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.clear();
  if (!boxes.empty()) make(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
  fit(boxes);
  built_area_ = area_;
}

/// Splits what lies from `first` to `end` in the order across the axis along which centres spread most, and
/// returns where. Equal centres go by number, so that parts are the same on every machine.
std::uint32_t QueryTree::split(std::span<const Bounds> boxes, std::uint32_t first, std::uint32_t end) {
  Bounds centers = nowhere;
  for (std::uint32_t k = first; k < end; ++k) include(centers, center_of(boxes[order_[k]]), 0);
  const Vec3 spread = centers.high - centers.low;
  const auto split_across = [&](double Vec3::*axis) {
    const auto along = [&](std::uint32_t number) { return center_of(boxes[number]).*axis; };
    const std::uint32_t at = first + size_of_first(boxes, std::span(order_).subspan(first, end - first),
                                                   centers.low.*axis, centers.high.*axis, along);
    std::nth_element(order_.begin() + first, order_.begin() + at, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double at_a = along(a), at_b = along(b);
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    return at;
  };
  if (spread.x >= spread.y && spread.x >= spread.z) return split_across(&Vec3::x);
  return spread.y >= spread.z ? split_across(&Vec3::y) : split_across(&Vec3::z);
}

/// Makes the node over what lies from `first` to `end` in the order, and returns its number.
std::uint32_t QueryTree::make(std::span<const Bounds> boxes, std::uint32_t first, std::uint32_t end) {
  const auto own = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  std::uint32_t ends[width + 1] = {first};
  std::uint32_t parts = 0;
  const auto part = [&](std::uint32_t from, std::uint32_t to) {
    if (to - from > at_leaf) ends[++parts] = split(boxes, from, to);
    ends[++parts] = to;
  };
  if (end - first > at_leaf) {
    const std::uint32_t middle = split(boxes, first, end);
    part(first, middle);
    part(middle, end);
  } else {
    ends[++parts] = end;
  }
  Node node{};
  for (std::uint32_t k = 0; k < parts; ++k) {
    const std::uint32_t count = ends[k + 1] - ends[k];
    const bool is_leaf = count <= at_leaf;
    node.first[k] = is_leaf ? ends[k] : make(boxes, ends[k], ends[k + 1]);
    node.count[k] = is_leaf ? count : 0;
  }
  nodes_[own] = node;
  return own;
}

Bounds QueryTree::fit(std::span<const Bounds> boxes, const Node& node, std::uint32_t child) const {
  Bounds out = nowhere;
  const std::uint32_t first = node.first[child], count = node.count[child];
  for (std::uint32_t k = first; k < first + count; ++k) out = around(out, boxes[order_[k]]);
  // No node has the first one as a child.
  if (count == 0 && first > 0)
    for (std::uint32_t k = 0; k < width; ++k) out = around(out, box(nodes_[first], k));
  return out;
}

void QueryTree::fit(std::span<const Bounds> boxes) {
  area_ = 0;
  Bounds all = nowhere;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    for (std::uint32_t k = 0; k < width; ++k) {
      const Bounds now = fit(boxes, node, k);
      const bool is_inner = node.count[k] == 0;
      const double low[3] = {now.low.x, now.low.y, now.low.z};
      const double high[3] = {now.high.x, now.high.y, now.high.z};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // Boxes of nodes are rounded already.
        node.low[axis][k] = is_inner ? static_cast<float>(low[axis]) : below(low[axis]);
        node.high[axis][k] = is_inner ? static_cast<float>(high[axis]) : above(high[axis]);
      }
      area_ += half_area(now);
      if (n == 0) all = around(all, now);
    }
  }
  extent_ = {};
  if (all.is_empty()) return;
  extent_ = {std::max(std::abs(all.low.x), std::abs(all.high.x)),
             std::max(std::abs(all.low.y), std::abs(all.high.y)),
             std::max(std::abs(all.low.z), std::abs(all.high.z))};
}

}  // namespace plumb::detail
