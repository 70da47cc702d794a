#include "linear/kkt_order.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "linear/elimination_order.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

/// Below so many triples the exact minimum degree costs less than what an approximate one could save.
constexpr Index least_approximate = 65;
/// Updates of tiles a column, beyond which it costs hundreds of factorisations to find the exact one. Chains
/// have 3 and figures 20. Square nets have 30 where they begin to be approximate, and 700 with 64 x 64.
constexpr std::size_t many_updates = 30;

/// Returns for every node its triples if it is a constraint, or else its constraints.
Array<Array<Index>> own_nodes(const KktGraph& graph) {
  Array<Array<Index>> own(graph.neighbours.size());
  for (Index n = 0; n < own.size(); ++n)
    for (const Index m : graph.neighbours[n])
      if (graph.is_triple(m) != graph.is_triple(n)) own[n].push_back(m);
  return own;
}

/// Returns for every constraint how many triples it has, and for every triple 0.
Array<Index> count_triples(const KktGraph& graph, const Array<Array<Index>>& own) {
  Array<Index> count(own.size(), 0);
  for (Index n = graph.threes; n < own.size(); ++n) count[n] = static_cast<Index>(own[n].size());
  return count;
}

/// Eliminates by the exact minimum degree. A node with the fewest neighbours goes first, and of several the
/// one that waits for the fewest others in a row: factors wait for the longest such row.
class Elimination {
 public:
  explicit Elimination(const KktGraph& graph)
      : graph_(graph), own_(own_nodes(graph)), waiting_(count_triples(graph, own_)), behind_(own_.size(), 0) {
    for (const Array<Index>& each : graph.neighbours) neighbours_.emplace_back(each.begin(), each.end());
    for (Index n = 0; n < neighbours_.size(); ++n)
      if (waiting_[n] == 0) queue_.insert(rank(n));
  }

  /// Constraints share a column that go one after the other and are neighbours.
  KktColumns run() {
    KktColumns columns;
    Index room = 0;
    std::set<Index> last;  // it holds neighbours of the last one
    while (!queue_.empty()) {
      const Index n = std::get<2>(*queue_.begin());
      queue_.erase(queue_.begin());
      if (graph_.is_triple(n) || room == 0 || !last.contains(n)) {
        columns.emplace_back();
        room = 4;
      }
      columns.back().push_back(n);
      room -= graph_.is_triple(n) ? 3 : 1;
      last = neighbours_[n];
      remove(n);
    }
    return columns;
  }

 private:
  using Rank = std::tuple<std::size_t, Index, Index>;

  Rank rank(Index n) const { return {neighbours_[n].size(), behind_[n], n}; }

  void remove(Index n) {
    for (const Index m : neighbours_[n]) {
      const bool queued = queue_.erase(rank(m)) > 0;
      behind_[m] = std::max(behind_[m], behind_[n] + 1);
      neighbours_[m].erase(n);
      for (const Index k : neighbours_[n])
        if (k != m) neighbours_[m].insert(k);
      if (queued) queue_.insert(rank(m));
    }
    if (!graph_.is_triple(n)) return;
    bool spent = false;
    for (const Index c : own_[n]) {
      if (waiting_[c] == 0) continue;  // an earlier triple has queued it
      --waiting_[c];
      if (waiting_[c] == 0 || !spent) {
        if (waiting_[c] > 0) spent = true;
        waiting_[c] = 0;
        queue_.insert(rank(c));
      }
    }
  }

  const KktGraph& graph_;
  Array<Array<Index>> own_;
  Array<std::set<Index>> neighbours_;
  Array<Index> waiting_;  ///< So many triples go before a constraint may be eliminated.
  Array<Index> behind_;   ///< It is the longest row of neighbours that went one by one.
  std::set<Rank> queue_;
};

/// Returns the pairs of triples that are coupled, or have a constraint in common.
Array<std::pair<Index, Index>> pairs_of_triples(const KktGraph& graph) {
  Array<std::pair<Index, Index>> pairs;
  for (Index n = 0; n < graph.neighbours.size(); ++n)
    for (const Index a : graph.neighbours[n]) {
      if (!graph.is_triple(a)) continue;
      if (graph.is_triple(n) && a < n) pairs.emplace_back(a, n);
      for (const Index b : graph.neighbours[n])
        if (!graph.is_triple(n) && graph.is_triple(b) && a < b) pairs.emplace_back(a, b);
    }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Puts constraints behind triples that are eliminated in this order: all that have no triple left, and one
/// of the others. That is the one whose last triple goes latest, since left waiting it would fill factors
/// until then. On square nets those have twice the updates if it is the one whose last triple goes first.
KktColumns follow_triples(const KktGraph& graph, const Array<Index>& order) {
  const Array<Array<Index>> own = own_nodes(graph);
  Array<Index> waiting = count_triples(graph, own);
  Array<Index> last(own.size(), 0);  // triple of a constraint, by elimination
  for (Index k = 0; k < order.size(); ++k)
    for (const Index c : own[order[k]]) last[c] = k;
  KktColumns columns;
  std::size_t room = 0;
  const auto put = [&](Index c) {
    if (room == 0) columns.emplace_back(), room = 4;
    columns.back().push_back(c);
    --room;
    waiting[c] = 0;
  };
  for (Index n = graph.threes; n < own.size(); ++n)
    if (waiting[n] == 0) put(n);
  for (Index k = 0; k < order.size(); ++k) {
    columns.push_back({order[k]});
    room = 1;
    const Array<Index>& constraints = own[order[k]];
    for (const Index c : constraints)
      if (last[c] == k && waiting[c] > 0) put(c);
    const auto latest = std::max_element(constraints.begin(), constraints.end(), [&](Index a, Index b) {
      return (waiting[a] > 0 ? last[a] : 0) < (waiting[b] > 0 ? last[b] : 0);
    });
    if (latest != constraints.end() && waiting[*latest] > 0) put(*latest);
  }
  return columns;
}

/// Returns the rows of each column's factor below the diagonal (Liu 1990).
Array<Array<Index>> rows_below(const KktGraph& graph, const KktColumns& columns) {
  constexpr Index none = std::numeric_limits<Index>::max();
  Array<Index> column_of(graph.neighbours.size());
  for (Index k = 0; k < columns.size(); ++k)
    for (const Index n : columns[k]) column_of[n] = k;
  // A column has the rows of its own, and of those columns whose first row it is.
  Array<Array<Index>> rows(columns.size()), children(columns.size());
  Array<Index> seen_by(columns.size(), none);
  for (Index k = 0; k < columns.size(); ++k) {
    const auto add = [&](Index row) {
      if (row > k && std::exchange(seen_by[row], k) != k) rows[k].push_back(row);
    };
    for (const Index n : columns[k])
      for (const Index m : graph.neighbours[n]) add(column_of[m]);
    for (const Index child : children[k])
      for (const Index row : rows[child]) add(row);
    std::sort(rows[k].begin(), rows[k].end());
    if (!rows[k].empty()) children[rows[k].front()].push_back(k);
  }
  return rows;
}

std::size_t count_updates(const Array<Array<Index>>& rows) {
  std::size_t sum = 0;
  for (const Array<Index>& each : rows) sum += each.size() * (each.size() + 1) / 2;
  return sum;
}

}  // namespace

KktGraph::KktGraph(Index threes_in, Index constraints, std::span<const std::pair<Index, Index>> couplings)
    : threes(threes_in), neighbours(std::size_t{threes_in} + constraints) {
  for (const auto& [a, b] : couplings) {
    const Index m = node(a), n = node(b);
    if (m == n) continue;
    neighbours[m].push_back(n);
    neighbours[n].push_back(m);
  }
  for (Array<Index>& each : neighbours) {
    std::sort(each.begin(), each.end());
    each.erase(std::unique(each.begin(), each.end()), each.end());
  }
}

KktOrder order_columns(const KktGraph& graph) {
  const auto with_rows = [&](KktColumns columns) {
    Array<Array<Index>> rows = rows_below(graph, columns);
    return KktOrder{std::move(columns), std::move(rows)};
  };
  if (graph.threes >= least_approximate) {
    KktOrder order = with_rows(follow_triples(graph, order_by_degree(graph.threes, pairs_of_triples(graph))));
    if (count_updates(order.rows) > many_updates * order.columns.size()) return order;
  }
  return with_rows(Elimination(graph).run());
}

}  // namespace plumb::detail
