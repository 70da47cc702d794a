#pragma once

#include <cstdint>
#include <vector>

#include "truth/model.hpp"

namespace plumb::truth {

inline constexpr std::uint32_t no_rod = 0xffffffffu;

/// A node is a movable particle and the rod to its parent, which is a fixed particle where a tree hangs on
/// something. The root of a tree that floats has no rod.
struct TreeNode {
  std::uint32_t particle = 0;
  std::uint32_t parent = 0;
  std::uint32_t rod = no_rod;
};

/// The tree has as many of a scene's rods as close no loop, with all fixed particles counted as one ground.
/// The others are the chords. Elastic rods whose mass couples nothing are neither, because they say nothing
/// about accelerations.
struct SpanningTree {
  std::vector<TreeNode> nodes;  ///< Every movable particle once, parents before their children.
  std::vector<std::uint32_t> chords;
};

/// Rods whose mass couples their ends come first, so that a particle with mass only from such rods has one of
/// them in the tree. Then the tree grows breadth first, so that trees in nets are shallow.
SpanningTree grow_spanning_tree(const Model& model);

}  // namespace plumb::truth
