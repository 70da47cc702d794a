#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// The graph of a matrix [M Jᵀ; J -e]. Its first nodes are triples of unknowns of M, and each of the others
/// is a constraint.
struct KktGraph {
  /// `couplings` are the places off the diagonal, in any order: those of triples in threes, then constraints.
  KktGraph(std::uint32_t threes, std::uint32_t constraints,
           std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings);

  std::uint32_t node(std::uint32_t unknown) const {
    return unknown < 3 * threes ? unknown / 3 : unknown - 2 * threes;
  }
  bool is_triple(std::uint32_t node) const { return node < threes; }

  std::uint32_t threes;
  Array<Array<std::uint32_t>> neighbours;  ///< of every node, ascending
};

/// Nodes by columns, in the order of elimination: a triple, with a constraint that is eliminated right after
/// it if there is one, or up to four constraints.
using KktColumns = Array<Array<std::uint32_t>>;

struct KktOrder {
  KktColumns columns;
  Array<Array<std::uint32_t>> rows;  ///< of each column's factor below the diagonal, ascending
};

/// Finds an order that fills the factors with little. A constraint comes after all its triples, or as the
/// first one of a triple that is gone. Its pivot is then away from zero by what that triple alone yields.
KktOrder order_columns(const KktGraph& graph);

}  // namespace plumb::detail
