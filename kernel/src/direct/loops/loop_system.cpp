#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "direct/loops/loop_state.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

/// Orders the graph of nodes by approximate minimum degree (Amestoy, Davis, Duff 1996).
std::vector<Index> by_degree(const std::vector<LoopRod>& rods, Index nodes) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < nodes; ++i) entries.emplace_back(i, i, 1);
  for (const LoopRod rod : rods)
    if (rod.b < nodes) {
      entries.emplace_back(rod.a, rod.b, 1);
      entries.emplace_back(rod.b, rod.a, 1);
    }
  Eigen::SparseMatrix<double> matrix(nodes, nodes);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  std::vector<Index> order;
  for (Eigen::Index i = 0; i < permutation.size(); ++i)
    order.push_back(static_cast<Index>(permutation.indices()[i]));
  return order;
}

/// Cuts the graph of nodes in two through the middle level of a breadth-first search from an end of it, and
/// the halves again (George 1973). Small parts are left in the order found.
class Dissection {
 public:
  Dissection(const std::vector<LoopRod>& rods, Index nodes)
      : neighbours_(nodes), part_(nodes, 0), level_(nodes) {
    for (const LoopRod rod : rods)
      if (rod.b < nodes) {
        neighbours_[rod.a].push_back(rod.b);
        neighbours_[rod.b].push_back(rod.a);
      }
  }

  std::vector<Index> run() {
    std::vector<Index> all(neighbours_.size());
    for (Index i = 0; i < all.size(); ++i) all[i] = i;
    cut(std::move(all));
    return std::move(order_);
  }

 private:
  static constexpr std::size_t smallest = 12;

  /// Returns the part of `start` by growing distance, and writes levels into level_.
  std::vector<Index> search(Index start) {
    const Index part = part_[start];
    const Index seen = ++last_part_;
    std::vector<Index> found{start};
    level_[start] = 0;
    part_[start] = seen;
    for (std::size_t k = 0; k < found.size(); ++k)
      for (const Index next : neighbours_[found[k]])
        if (part_[next] == part) {
          part_[next] = seen;
          level_[next] = level_[found[k]] + 1;
          found.push_back(next);
        }
    return found;
  }

  void cut(std::vector<Index> nodes) {
    const Index part = ++last_part_;
    for (const Index i : nodes) part_[i] = part;
    if (nodes.size() <= smallest) {
      order_.insert(order_.end(), nodes.begin(), nodes.end());
      return;
    }
    std::vector<Index> found = search(nodes.front());
    if (found.size() < nodes.size()) {  // there are several pieces
      std::vector<Index> others;
      for (const Index i : nodes)
        if (part_[i] == part) others.push_back(i);
      cut(std::move(found));
      cut(std::move(others));
      return;
    }
    for (int turn = 0; turn < 3; ++turn) found = search(found.back());
    const Index middle = level_[found[found.size() / 2]];
    std::vector<Index> low, between, high;
    for (const Index i : found) (level_[i] < middle ? low : level_[i] > middle ? high : between).push_back(i);
    if (low.empty() || high.empty()) {
      order_.insert(order_.end(), nodes.begin(), nodes.end());
      return;
    }
    // Of the level, only what touches both sides has to be cut out.
    std::vector<Index> separator;
    for (const Index i : between) {
      const bool touches = std::any_of(neighbours_[i].begin(), neighbours_[i].end(), [&](Index next) {
        return part_[next] == part_[i] && level_[next] == middle + 1;
      });
      (touches ? separator : low).push_back(i);
    }
    cut(std::move(low));
    cut(std::move(high));
    order_.insert(order_.end(), separator.begin(), separator.end());
  }

  std::vector<std::vector<Index>> neighbours_;
  std::vector<Index> part_, level_, order_;
  Index last_part_ = 0;
};

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

/// Returns rods and, as if they were rods, what bends couple.
std::vector<LoopRod> couplings(const std::vector<LoopRod>& rods, const std::vector<LoopBend>& bends,
                               Index nodes) {
  std::vector<LoopRod> out = rods;
  for (const LoopBend& bend : bends)
    for (const auto [i, j] : LoopBend::pairs)
      if (i != j && bend.vertices[i] < nodes && bend.vertices[j] < nodes)
        out.push_back({bend.vertices[i], bend.vertices[j]});
  return out;
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
  const std::vector<LoopRod> graph = couplings(rods, bends, nodes);
  pattern.order = with_rods(by_degree(graph, nodes), rods);
  // On square nets degree wins below 10,000 particles, dissection by a tenth above.
  if (nodes > 64) {
    SparsePattern other = pattern;
    other.order = with_rods(Dissection(graph, nodes).run(), rods);
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
