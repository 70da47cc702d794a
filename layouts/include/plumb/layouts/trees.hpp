#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "plumb/layouts/graph.hpp"

namespace plumb::layouts {

/// An island whose movable vertices form a tree, in an order in which everything hanging from a vertex can be
/// eliminated before the vertex itself: parents before children, depth first, so that most parents directly
/// precede their child. Edges to fixed vertices are pins; they close no cycle, since fixed vertices do not
/// move.
struct Tree {
  struct Pin {
    std::uint32_t vertex;  ///< the fixed one
    std::uint32_t edge;
  };

  std::vector<std::uint32_t> vertex;     ///< per node, the root first
  std::vector<std::uint32_t> parent;     ///< per node, a node with a smaller number; the root has itself
  std::vector<std::uint32_t> edge;       ///< per node, to the parent; not used for the root
  std::vector<std::uint32_t> pin_begin;  ///< nodes + 1 entries, into pins
  std::vector<Pin> pins;                 ///< by node, then by edge

  std::uint32_t nodes() const { return static_cast<std::uint32_t>(vertex.size()); }
};

/// The tree of an island (connected, at least one movable vertex), or nothing if its movable vertices have a
/// cycle. The root is the first vertex with the most pins, if that is more than one, else the one with the
/// pin of the smallest edge, without pins an end of the tree, so that a chain is numbered from one end to the
/// other. Linear time, deterministic.
std::optional<Tree> find_tree(const Graph& island);

}  // namespace plumb::layouts
