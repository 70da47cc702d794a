#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "direct/loops/loop_state.hpp"
#include "linear/elimination_order.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

/// Returns the pairs of nodes that rods and bends couple.
std::vector<std::pair<Index, Index>> edges_of(const std::vector<LoopRod>& rods,
                                              const std::vector<LoopBend>& bends, Index nodes) {
  std::vector<std::pair<Index, Index>> out;
  for (const LoopRod rod : rods)
    if (rod.b < nodes) out.emplace_back(rod.a, rod.b);
  for (const LoopBend& bend : bends)
    for (const auto [i, j] : LoopBend::pairs)
      if (i != j && bend.vertices[i] < nodes && bend.vertices[j] < nodes)
        out.emplace_back(bend.vertices[i], bend.vertices[j]);
  return out;
}

/// Puts nodes in the order given and every rod right after the second of its ends. A rod's pivot is then what
/// both of its ends can yield, which is never zero but for rods that others make redundant.
std::vector<Index> with_rods(const std::vector<Index>& nodes, const std::vector<LoopRod>& rods) {
  const auto n = static_cast<Index>(nodes.size());
  std::vector<Index> number(n);
  for (Index i = 0; i < n; ++i) number[nodes[i]] = i;
  std::vector<std::vector<Index>> after(n);
  for (Index k = 0; k < rods.size(); ++k)
    after[rods[k].b < n ? std::max(number[rods[k].a], number[rods[k].b]) : number[rods[k].a]].push_back(k);
  std::vector<Index> order;
  for (Index i = 0; i < n; ++i) {
    order.push_back(nodes[i]);
    for (const Index k : after[i]) order.push_back(n + k);
  }
  return order;
}

/// Adds what bends couple to a pattern and its entries. Of a bend's values `at` is the first.
void add_bend(const LoopBend& bend, Index nodes, Index at, SparsePattern& pattern,
              std::vector<SparseEntry>& entries) {
  for (const auto [i, j] : LoopBend::pairs) {
    const Index a = bend.vertices[i], b = bend.vertices[j];
    for (Index row = 0; row < 3; ++row)
      for (Index column = 0; column < 3; ++column, ++at) {
        if (a >= nodes || b >= nodes) continue;
        entries.push_back({a, row, b, column, at});
        if (a != b) entries.push_back({b, row, a, column, at});
      }
    if (a < nodes && b < nodes && a != b) pattern.meet.emplace_back(a, b);
  }
}

SparseAnalysis analyse(const std::vector<LoopRod>& rods, const std::vector<LoopBend>& bends, Index nodes,
                       bool couples) {
  SparsePattern pattern;
  pattern.size.assign(nodes, 3);
  pattern.size.resize(nodes + rods.size(), 1);
  std::vector<SparseEntry> entries;
  for (Index i = 0; i < nodes; ++i)
    for (Index c = 0; c < 3; ++c) entries.push_back({i, c, i, c, i});
  for (Index k = 0; k < rods.size(); ++k) {
    const auto [a, b] = rods[k];
    const Index rod = nodes + k, at = nodes + LoopSystem::per_rod * k;
    pattern.meet.emplace_back(a, rod);
    if (b < nodes) pattern.meet.emplace_back(b, rod);
    if (b < nodes && couples) pattern.meet.emplace_back(a, b);
    for (Index c = 0; c < 3; ++c) {
      entries.push_back({a, c, rod, 0, at + 4 + c});
      entries.push_back({rod, 0, a, c, at + 7 + c});
      if (b >= nodes) continue;
      entries.push_back({b, c, rod, 0, at + 1 + c});
      entries.push_back({rod, 0, b, c, at + 10 + c});
      if (!couples) continue;
      entries.push_back({a, c, b, c, at});
      entries.push_back({b, c, a, c, at});
    }
    entries.push_back({rod, 0, rod, 0, at + 13});
  }
  auto at = nodes + LoopSystem::per_rod * static_cast<Index>(rods.size());
  for (const LoopBend& bend : bends) {
    add_bend(bend, nodes, at, pattern, entries);
    at += LoopBend::values;
  }
  const std::vector<std::pair<Index, Index>> edges = edges_of(rods, bends, nodes);
  pattern.order = with_rods(order_by_degree(nodes, edges), rods);
  if (nodes > least_dissected) {
    SparsePattern other = pattern;
    other.order = with_rods(order_by_dissection(nodes, edges), rods);
    if (SparseAnalysis::estimate(other) < SparseAnalysis::estimate(pattern)) pattern = std::move(other);
  }
  return SparseAnalysis(pattern, entries);
}

}  // namespace

LoopSystem::LoopSystem(const std::vector<LoopRod>& of, std::uint32_t count, bool coupled,
                       const std::vector<LoopBend>& bent)
    : nodes(count),
      rods(static_cast<std::uint32_t>(of.size())),
      bends(static_cast<std::uint32_t>(bent.size())),
      couples(coupled),
      analysis(analyse(of, bent, count, coupled)) {}

}  // namespace plumb::detail
