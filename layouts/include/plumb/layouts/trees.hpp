#pragma once

#include <cstdint>
#include <optional>

#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// An island whose movable vertices form a tree, in an order for elimination.
///
/// Parents come before children, depth first, so that most parents directly precede their child. Everything
/// that hangs from a vertex can so be eliminated before the vertex itself. Edges to fixed vertices close no
/// cycle, since fixed vertices do not move.
struct Tree {
  /// An edge to a fixed vertex, as a rod to an anchor is.
  struct Tie {
    std::uint32_t vertex;  ///< The fixed vertex.
    std::uint32_t edge;    ///< The edge to it.
  };

  Array<std::uint32_t> vertex;     ///< Vertex of every node, the root first.
  Array<std::uint32_t> parent;     ///< Parent of every node, with a smaller number; the root has itself.
  Array<std::uint32_t> edge;       ///< Edge of every node to its parent; not used for the root.
  Array<std::uint32_t> tie_begin;  ///< Start of each node's entries in `ties`; nodes + 1 entries.
  Array<Tie> ties;                 ///< Edges to fixed vertices, by node, then by edge.

  /// Number of nodes.
  std::uint32_t nodes() const { return static_cast<std::uint32_t>(vertex.size()); }
};

/// Finds the tree of an island, or nothing if its movable vertices have a cycle.
///
/// The island is connected and has at least one movable vertex. The root is the first vertex with the most
/// edges to fixed ones, if these are more than one. Otherwise it is the vertex with the only such edge, the
/// smallest of several. Without any it is an end of the tree, so that a chain is numbered from one end to the
/// other. The search takes linear time and is deterministic.
std::optional<Tree> find_tree(const Graph& island);

}  // namespace plumb::layouts
