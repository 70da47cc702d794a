#pragma once

#include "direct/trees/tree_state.hpp"

namespace plumb::detail {

/// How one long line that hangs from a fixed particle is cut into segments of equal length that lie side by
/// side in lanes: node i is entry i mod s of lane i / s. See simd/tree/segment_lanes.hpp. What happens rarely
/// is done on the line as a whole, a tree alone.
class LineSegments {
 public:
  /// Whether a tree is such a line and long enough for segments to pay.
  static bool fits(const TreeTopology& topology, std::uint32_t lanes);

  LineSegments(std::uint32_t nodes, std::uint32_t lanes);

  std::uint32_t length() const { return length_; }
  std::uint32_t entry(std::uint32_t node) const { return node % length_; }
  std::uint32_t lane(std::uint32_t node) const { return node / length_; }
  /// Whether a node is the first of its segment: the rod to the node before stands where ties do.
  bool begins(std::size_t node) const { return node % length_ == 0; }

  template <class T>
  TreeState<T> cut(const TreeState<T>& whole) const;

  /// What steps and users change.
  template <class T>
  void gather(const TreeState<T>& segments, TreeState<T>& whole) const;
  template <class T>
  void scatter(const TreeState<T>& whole, TreeState<T>& segments) const;
  /// Three numbers per node.
  template <class T>
  void scatter_nodes(const layouts::AlignedBuffer<T>& whole, layouts::AlignedBuffer<T>& segments) const;

  /// Before prepare: puts the beginning of every lane's first rod, the last node of the lane before, where
  /// its tie is. After it: takes away rods beyond the end of the line.
  template <class T>
  void link(TreeState<T>& segments) const;
  template <class T>
  void trim(TreeWorkspace<T>& work) const;
  /// After find_stiffness: the last node of every lane feels the first rod of the next, too.
  template <class T>
  void join_stiffness(const TreeState<T>& segments, TreeWorkspace<T>& work) const;

 private:
  /// f(place in the whole's array, place in the segments' array) for `fields` numbers of every node.
  template <class F>
  void for_numbers(std::uint32_t fields, F&& f) const {
    for (std::uint32_t i = 0; i < nodes_; ++i)
      for (std::uint32_t c = 0; c < fields; ++c)
        f(std::size_t{fields} * i + c, (std::size_t{fields} * entry(i) + c) * lanes_ + lane(i));
  }

  std::uint32_t nodes_, lanes_, length_;
};

}  // namespace plumb::detail
