#pragma once

#include <cstdint>
#include <vector>

#include "truth/model.hpp"

namespace plumb::truth {

inline constexpr std::uint32_t no_rod = 0xffffffffu;

/// A movable particle and the rod to its parent, a particle that is fixed where a tree hangs on something.
/// The root of a tree that floats has no rod.
struct TreeNode {
  std::uint32_t particle = 0;
  std::uint32_t parent = 0;
  std::uint32_t rod = no_rod;
};

/// Of a scene's rods, as many as close no loop, all fixed particles counted as one ground; the others are
/// the chords.
struct SpanningTree {
  std::vector<TreeNode> nodes;  ///< every movable particle once, parents before their children
  std::vector<std::uint32_t> chords;
};

/// Rods whose mass couples their ends come first, so that a particle that has mass only from such rods has
/// one of them in the tree; then a breadth-first tree, so that trees in nets are shallow.
SpanningTree grow_spanning_tree(const Model& model);

}  // namespace plumb::truth
