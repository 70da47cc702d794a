#pragma once

#include <cstdint>

#include "plumb/layouts/trees.hpp"

namespace plumb::test {

/// A line of `nodes` movable particles, tied to what `ends` names: 1 is the root's anchor, `nodes`, and 2 the
/// tip's, one more.
inline layouts::Tree line_tree(std::uint32_t nodes, int ends) {
  layouts::Tree tree;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    tree.vertex.push_back(i);
    tree.parent.push_back(i == 0 ? 0 : i - 1);
    tree.edge.push_back(i);
    tree.tie_begin.push_back(static_cast<std::uint32_t>(tree.ties.size()));
    if (i == 0 && (ends & 1) != 0) tree.ties.push_back({nodes, 0});
    if (i + 1 == nodes && (ends & 2) != 0) tree.ties.push_back({nodes + 1, nodes});
  }
  tree.tie_begin.push_back(static_cast<std::uint32_t>(tree.ties.size()));
  return tree;
}

}  // namespace plumb::test
