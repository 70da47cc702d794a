#pragma once

#include <cstdint>
#include <span>

#include "contact/shapes/bounds.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// This is a hierarchy of bounding volumes over boxes that do not move. It is built once, and lies in one
/// array in the order in which it is searched. Searching takes no memory.
class BoundsTree {
 public:
  BoundsTree() = default;
  explicit BoundsTree(std::span<const Bounds> boxes);

  bool is_empty() const { return nodes_.empty(); }
  /// Returns the box around all boxes.
  Bounds bounds() const { return nodes_.empty() ? nowhere : nodes_[0].bounds; }

  /// Calls `found(number)` for every box that overlaps `bounds`, and for some that are near. The order is
  /// always the same.
  template <class Found>
  void find(const Bounds& bounds, Found&& found) const {
    for (std::uint32_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      if (!node.bounds.overlaps(bounds)) {
        i = node.next;
        continue;
      }
      for (std::uint32_t k = node.first; k < node.end; ++k) found(items_[k]);
      ++i;
    }
  }

  /// Returns whether some box overlaps `bounds`, or a few that lie together almost do.
  bool reaches_into(const Bounds& bounds) const {
    for (std::uint32_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      const bool overlaps = node.bounds.overlaps(bounds);
      if (overlaps && node.first != node.end) return true;
      i = overlaps ? i + 1 : node.next;
    }
    return false;
  }

  /// Finds what is nearest to a point. `distance2_of(number)` returns the square (m²) of how far what a box
  /// holds is from it. What is farther than the square `least` need not be asked. Returns the least square.
  template <class Distance2Of>
  double find_nearest(Vec3 p, double least, Distance2Of&& distance2_of) const {
    visit_near_first([&](const Bounds& box) { return distance2(box, p); },
                     [&](double square) { return square < least; },
                     [&](std::uint32_t item) {
                       const double square = distance2_of(item);
                       if (square < least) least = square;
                     });
    return least;
  }

  /// Calls `met(number)` for every box that another one meets within `best` (m) while its centre goes along a
  /// unit vector, and for some that are near: about from near to far. `met` may lower `best`.
  template <class Met>
  void find_along(const Bounds& start, Vec3 along, double& best, Met&& met) const {
    visit_near_first([&](const Bounds& box) { return way_to(box, start, along); },
                     [&](double way) { return way <= best; }, met);
  }

 private:
  static constexpr int most_depth = 64;        ///< halving 2^32 boxes takes 32 levels
  static constexpr std::uint32_t at_leaf = 4;  ///< boxes that one node lists

  /// A leaf lists items; what lies below another node follows it, up to `next`.
  struct Node {
    Bounds bounds;
    std::uint32_t next = 0, first = 0, end = 0;
  };

  /// Calls visit(number) for the boxes of all nodes that counts(far_to(box around them)) lets in, about from
  /// near to far.
  template <class FarTo, class Counts, class Visit>
  void visit_near_first(FarTo&& far_to, Counts&& counts, Visit&& visit) const {
    std::uint32_t waiting[most_depth];
    int count = 0;
    if (!nodes_.empty()) waiting[count++] = 0;
    while (count > 0) {
      const std::uint32_t i = waiting[--count];
      const Node& node = nodes_[i];
      if (!counts(far_to(node.bounds))) continue;
      for (std::uint32_t k = node.first; k < node.end; ++k) visit(items_[k]);
      if (node.first != node.end) continue;
      const std::uint32_t left = i + 1, right = nodes_[left].next;
      const bool left_first = far_to(nodes_[left].bounds) <= far_to(nodes_[right].bounds);
      waiting[count++] = left_first ? right : left;
      waiting[count++] = left_first ? left : right;
    }
  }

  void build(std::span<const Bounds> boxes, std::uint32_t first, std::uint32_t end);

  Array<Node> nodes_;
  Array<std::uint32_t> items_;
};

}  // namespace plumb::detail
