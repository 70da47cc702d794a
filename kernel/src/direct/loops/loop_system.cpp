#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "direct/loops/loop_state.hpp"
#include "linear/elimination_order.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

/// Returns the ends of rods between nodes.
std::vector<std::pair<Index, Index>> edges_of(const std::vector<LoopRod>& rods, Index nodes) {
  std::vector<std::pair<Index, Index>> out;
  for (const LoopRod rod : rods)
    if (rod.b < nodes) out.emplace_back(rod.a, rod.b);
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

SparseAnalysis analyse(const std::vector<LoopRod>& rods, Index nodes, bool couples) {
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
  const std::vector<std::pair<Index, Index>> edges = edges_of(rods, nodes);
  pattern.order = with_rods(order_by_degree(nodes, edges), rods);
  if (nodes > least_dissected) {
    SparsePattern other = pattern;
    other.order = with_rods(order_by_dissection(nodes, edges), rods);
    if (SparseAnalysis::estimate(other) < SparseAnalysis::estimate(pattern)) pattern = std::move(other);
  }
  return SparseAnalysis(pattern, entries);
}

}  // namespace

LoopSystem::LoopSystem(const std::vector<LoopRod>& rods, std::uint32_t count, bool coupled)
    : nodes(count), couples(coupled), analysis(analyse(rods, count, coupled)) {}

}  // namespace plumb::detail
