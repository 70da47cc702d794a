#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "contact/shapes/bounds.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Says how a box is swept through a QueryTree: from where, which way, and how large it is.
struct Way {
  Vec3 origin{};     ///< m, of its centre
  Vec3 direction{};  ///< unit vector
  Vec3 half{};       ///< m, half of its sides
};

/// This is a hierarchy of bounding volumes over boxes that move. It is built once, follows the boxes, and is
/// built anew when it has worn out.
///
/// BoundsTree is for boxes that stay. Here a node has the boxes of four children side by side, in float, so
/// that one vector operation looks at all of them and a node is two cache lines. Floats are rounded outward,
/// so that a search may see more than it must, and never less.
class QueryTree {
 public:
  /// Builds the hierarchy over boxes. Empty boxes (`nowhere`) are never found.
  void build(std::span<const Bounds> boxes);
  /// Lets it follow boxes, of which there are as many as it was built over.
  void fit(std::span<const Bounds> boxes);
  /// Returns whether its boxes have grown so much that building it anew pays.
  bool is_worn() const { return area_ > most_growth * built_area_; }
  /// Lists the numbers of boxes in the order in which searches call them.
  std::span<const std::uint32_t> order() const { return order_; }

  /// Calls visit(place in the order) for all boxes that are met within `best` (m), about from near to far.
  /// `visit` may lower it.
  template <class Visit>
  void along(const Way& way, double& best, Visit&& visit) const;
  /// Calls visit(place in the order) for all boxes that overlap one.
  template <class Visit>
  void within(const Bounds& bounds, Visit&& visit) const;
  /// Calls visit(place in the order) for all boxes that are nearer to a place than `best` (m), about from
  /// near to far. `visit` may lower it, also below 0, where only boxes that hold the place may count.
  template <class Visit>
  void near(Vec3 place, double& best, Visit&& visit) const;

 private:
  static constexpr std::uint32_t width = 4;    ///< children of a node
  static constexpr std::uint32_t at_leaf = 3;  ///< boxes that a leaf lists
  static constexpr double most_growth = 2;
  /// Parts of three quarters make one of 2^32 boxes in 77 splits. A level has two, and leaves three siblings
  /// waiting.
  static constexpr std::size_t most_open = 128;

  /// Four floats that g++ and clang take as one register of any x86. A loop over four it leaves scalar, which
  /// takes twice as long.
  using Lanes = float __attribute__((vector_size(16)));

  /// A child is a leaf with `count` boxes from `first` on in the order, or the node `first`. One that is not
  /// there is nowhere.
  struct alignas(64) Node {
    Lanes low[3], high[3];
    std::uint32_t first[width], count[width];
  };
  struct Open {
    float near;
    std::uint32_t first, count;
  };
  /// Prepares a way for nodes: planes are met at (plane - near or far)·over along each axis.
  struct FloatWay {
    FloatWay(const Way& way, Vec3 extent);
    float near[3], far[3], over[3];
    bool is_back[3];
  };

  std::uint32_t make(std::span<const Bounds> boxes, std::uint32_t first, std::uint32_t end);
  std::uint32_t split(std::span<const Bounds> boxes, std::uint32_t first, std::uint32_t end);
  Bounds fit(std::span<const Bounds> boxes, const Node& node, std::uint32_t child) const;
  static Bounds box(const Node& node, std::uint32_t k) {
    return {{node.low[0][k], node.low[1][k], node.low[2][k]},
            {node.high[0][k], node.high[1][k], node.high[2][k]}};
  }
  static void meet(const Node& node, const FloatWay& way, Lanes& near, Lanes& far);

  Array<Node> nodes_;  ///< each before its children
  Array<std::uint32_t> order_;
  Vec3 extent_{};  ///< m, the farthest coordinates of its boxes
  double area_ = 0, built_area_ = 0;
};

/// Finds where the way meets the boxes of all children of a node. What is not a number is as if it was met.
inline void QueryTree::meet(const Node& node, const FloatWay& way, Lanes& near, Lanes& far) {
  near = Lanes{};
  far = Lanes{INFINITY, INFINITY, INFINITY, INFINITY};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Lanes first = way.is_back[axis] ? node.high[axis] : node.low[axis];
    const Lanes last = way.is_back[axis] ? node.low[axis] : node.high[axis];
    const Lanes in = (first - way.near[axis]) * way.over[axis], out = (last - way.far[axis]) * way.over[axis];
    near = in > near ? in : near;
    far = out < far ? out : far;
  }
}

template <class Visit>
void QueryTree::along(const Way& way, double& best, Visit&& visit) const {
  if (nodes_.empty()) return;
  // Ten times what floats lose in three operations.
  constexpr float slack = 1 + 1e-6f;
  const FloatWay floats(way, extent_);
  std::array<Open, most_open> open;
  std::size_t count = 0;
  open[count++] = {0, 0, 0};
  auto limit = static_cast<float>(std::min(best, 1e38)) * slack;
  while (count > 0) {
    const Open now = open[--count];
    if (now.near > limit) continue;
    if (now.count > 0) {
      for (std::uint32_t k = now.first; k < now.first + now.count; ++k) visit(k);
      limit = static_cast<float>(std::min(best, 1e38)) * slack;
      continue;
    }
    const Node& node = nodes_[now.first];
    Lanes near, far;
    meet(node, floats, near, far);
    const auto is_met = near <= far * slack && near <= limit;
    const std::size_t below = count;
    for (std::uint32_t k = 0; k < width; ++k) {
      if (is_met[k] == 0) continue;
      std::size_t at = count++;
      for (; at > below && open[at - 1].near < near[k]; --at) open[at] = open[at - 1];
      open[at] = {near[k], node.first[k], node.count[k]};
    }
  }
}

template <class Visit>
void QueryTree::within(const Bounds& bounds, Visit&& visit) const {
  std::array<Open, most_open> open;
  std::size_t count = 0;
  if (!nodes_.empty()) open[count++] = {0, 0, 0};
  while (count > 0) {
    const Open now = open[--count];
    for (std::uint32_t k = now.first; k < now.first + now.count; ++k) visit(k);
    if (now.count > 0) continue;
    const Node& node = nodes_[now.first];
    for (std::uint32_t k = 0; k < width; ++k)
      if (box(node, k).overlaps(bounds)) open[count++] = {0, node.first[k], node.count[k]};
  }
}

template <class Visit>
void QueryTree::near(Vec3 place, double& best, Visit&& visit) const {
  std::array<Open, most_open> open;
  std::size_t count = 0;
  if (!nodes_.empty()) open[count++] = {0, 0, 0};
  const auto limit = [&] { return std::max(best, 0.0) * (1 + 1e-6); };
  while (count > 0) {
    const Open now = open[--count];
    if (now.near > limit()) continue;
    for (std::uint32_t k = now.first; k < now.first + now.count; ++k) visit(k);
    if (now.count > 0) continue;
    const Node& node = nodes_[now.first];
    const std::size_t below = count;
    for (std::uint32_t k = 0; k < width; ++k) {
      const Bounds child = box(node, k);
      if (child.is_empty()) continue;
      const double distance = std::sqrt(distance2(child, place));
      if (distance > limit()) continue;
      const auto rounded = static_cast<float>(std::min(distance, 1e38));
      std::size_t at = count++;
      for (; at > below && open[at - 1].near < rounded; --at) open[at] = open[at - 1];
      open[at] = {rounded, node.first[k], node.count[k]};
    }
  }
}

}  // namespace plumb::detail
