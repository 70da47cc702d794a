#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "direct/loops/loop_state.hpp"
#include "linear/elimination_order.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

/// Rods, bends and twists of an island with so many nodes.
struct Parts {
  const std::vector<LoopRod>& rods;
  const std::vector<LoopBend>& bends;
  const std::vector<LoopTwist>& twists;
  Index nodes;
};

/// Returns the pairs of nodes that rods, bends and twists couple.
std::vector<std::pair<Index, Index>> edges_of(const Parts& of) {
  const auto& [rods, bends, twists, nodes] = of;
  std::vector<std::pair<Index, Index>> out;
  for (const LoopRod rod : rods)
    if (rod.b < nodes) out.emplace_back(rod.a, rod.b);
  const auto add = [&](Index a, Index b) {
    if (a < nodes && b < nodes) out.emplace_back(a, b);
  };
  for (const LoopBend& bend : bends)
    for (const auto [i, j] : LoopBend::pairs)
      if (i != j) add(bend.vertices[i], bend.vertices[j]);
  for (const LoopTwist& twist : twists)
    for (Index k = 0; k < twist.joints(); ++k) {
      const auto [a, b, c] = twist.joint(k);
      add(a, b);
      add(b, c);
      add(a, c);
    }
  return out;
}

/// Puts nodes in the order given and every rod right after the second of its ends. A rod's pivot is then what
/// both of its ends can yield, which is never zero but for rods that others make redundant. Torques come
/// last, since they meet all of a chain.
std::vector<Index> with_rods(const std::vector<Index>& nodes, const Parts& of) {
  const std::vector<LoopRod>& rods = of.rods;
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
  for (std::size_t k = 0; k < of.twists.size(); ++k) order.push_back(n + static_cast<Index>(rods.size() + k));
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

/// Adds what a twist couples, as add_bend() does. `torque` is its variable.
void add_twist(const LoopTwist& twist, Index nodes, Index torque, Index at, SparsePattern& pattern,
               std::vector<SparseEntry>& entries) {
  for (Index k = 0; k < twist.joints(); ++k) {
    const std::array<Index, 3> joint = twist.joint(k);
    for (const Index a : joint)
      for (const Index b : joint)
        for (Index c = 0; c < 9; ++c, ++at)
          if (a < nodes && b < nodes) entries.push_back({a, c / 3, b, c % 3, at});
    for (const bool is_row : {false, true})
      for (const Index a : joint)
        for (Index c = 0; c < 3; ++c, ++at)
          if (a < nodes)
            entries.push_back(is_row ? SparseEntry{torque, 0, a, c, at} : SparseEntry{a, c, torque, 0, at});
    for (Index i = 0; i < 3; ++i) {
      const Index a = joint[i], b = joint[(i + 1) % 3];
      if (a < nodes) pattern.meet.emplace_back(a, torque);
      if (a < nodes && b < nodes) pattern.meet.emplace_back(a, b);
    }
  }
  entries.push_back({torque, 0, torque, 0, at});
}

SparseAnalysis analyse(const Parts& of, bool couples) {
  const auto& [rods, bends, twists, nodes] = of;
  SparsePattern pattern;
  pattern.size.assign(nodes, 3);
  pattern.size.resize(nodes + rods.size() + twists.size(), 1);
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
  auto torque = nodes + static_cast<Index>(rods.size());
  for (const LoopTwist& twist : twists) {
    add_twist(twist, nodes, torque++, at, pattern, entries);
    at += twist.values();
  }
  const std::vector<std::pair<Index, Index>> edges = edges_of(of);
  pattern.order = with_rods(order_by_degree(nodes, edges), of);
  if (nodes > least_dissected) {
    SparsePattern other = pattern;
    other.order = with_rods(order_by_dissection(nodes, edges), of);
    if (SparseAnalysis::estimate(other) < SparseAnalysis::estimate(pattern)) pattern = std::move(other);
  }
  return SparseAnalysis(pattern, entries);
}

}  // namespace

LoopSystem::LoopSystem(const std::vector<LoopRod>& of, std::uint32_t count, bool coupled,
                       const std::vector<LoopBend>& bent, const std::vector<LoopTwist>& twisted)
    : nodes(count),
      rods(static_cast<std::uint32_t>(of.size())),
      bends(static_cast<std::uint32_t>(bent.size())),
      couples(coupled),
      analysis(analyse({of, bent, twisted, count}, coupled)) {
  for (const LoopTwist& twist : twisted) twist_values += twist.values();
}

}  // namespace plumb::detail
