#pragma once

#include "direct/trees/tree_state.hpp"

namespace plumb::detail {

/// Cuts one long line that hangs from a fixed particle into segments of equal length that lie side by side in
/// lanes. Node i is entry i mod s of lane i / s. See simd/tree/lines/segment_lanes.hpp. What happens rarely
/// is done on the line as a whole, a tree alone.
class LineSegments {
 public:
  /// Says whether a tree is such a line and long enough for segments to pay.
  static bool fits(const TreeTopology& topology, std::uint32_t lanes);

  LineSegments(std::uint32_t nodes, std::uint32_t lanes);

  std::uint32_t length() const { return length_; }
  std::uint32_t entry(std::uint32_t node) const { return node % length_; }
  std::uint32_t lane(std::uint32_t node) const { return node / length_; }
  std::uint32_t node(std::uint32_t entry, std::uint32_t lane) const { return lane * length_ + entry; }
  /// Says whether a node is the first of its segment. The rod to the node before then stands where ties do.
  bool begins(std::size_t node) const { return node % length_ == 0; }

  template <class T>
  TreeState<T> cut(const TreeState<T>& whole) const;

  /// These two copy what steps and users change.
  template <class T>
  void gather(const TreeState<T>& segments, TreeState<T>& whole) const;
  template <class T>
  void scatter(const TreeState<T>& whole, TreeState<T>& segments) const;
  /// Copies three numbers per node.
  template <class T>
  void scatter_nodes(std::span<T> whole, layouts::AlignedBuffer<T>& segments) const;

  /// link() comes before prepare. It puts the beginning of every lane's first rod, the last node of the lane
  /// before, where its tie is. trim() comes after it and takes away rods beyond the end of the line.
  template <class T>
  void link(TreeState<T>& segments) const;
  template <class T>
  void trim(TreeWorkspace<T>& work) const;
  /// Comes after find_stiffness, since the last node of every lane feels the first rod of the next, too.
  template <class T>
  void join_stiffness(const TreeState<T>& segments, TreeWorkspace<T>& work) const;

 private:
  /// Copies `fields` numbers per rod. The first rod of a segment stands where ties do.
  template <class Buffer>
  void scatter_rods(Buffer& to, Buffer& tie_to, std::uint32_t fields, const Buffer& from,
                    const Buffer& tie_from) const {
    for_numbers(fields,
                [&](std::size_t i, std::size_t j) { (begins(i / fields) ? tie_to : to)[j] = from[i]; });
    for (std::uint32_t c = 0; c < fields; ++c) tie_to[c * lanes_] = tie_from[c];
  }

  /// Calls f(place in the whole's array, place in the segments' array) for `fields` numbers of every node.
  template <class F>
  void for_numbers(std::uint32_t fields, F&& f) const {
    for (std::uint32_t i = 0; i < nodes_; ++i)
      for (std::uint32_t c = 0; c < fields; ++c)
        f(std::size_t{fields} * i + c, (std::size_t{fields} * entry(i) + c) * lanes_ + lane(i));
  }

  std::uint32_t nodes_, lanes_, length_;
};

}  // namespace plumb::detail
