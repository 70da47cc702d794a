#include "linear/elimination_order.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <utility>

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

class Dissection {
 public:
  Dissection(Index nodes, std::span<const std::pair<Index, Index>> edges)
      : neighbours_(nodes), part_(nodes, 0), level_(nodes) {
    for (const auto& [a, b] : edges) {
      neighbours_[a].push_back(b);
      neighbours_[b].push_back(a);
    }
  }

  Array<Index> run() {
    Array<Index> all(neighbours_.size());
    for (Index i = 0; i < all.size(); ++i) all[i] = i;
    cut(std::move(all));
    return std::move(order_);
  }

 private:
  static constexpr std::size_t smallest = 12;

  /// Returns the part of `start` by growing distance, and writes levels into level_.
  Array<Index> search(Index start) {
    const Index part = part_[start];
    const Index seen = ++last_part_;
    Array<Index> found{start};
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

  void cut(Array<Index> nodes) {
    const Index part = ++last_part_;
    for (const Index i : nodes) part_[i] = part;
    if (nodes.size() <= smallest) {
      order_.insert(order_.end(), nodes.begin(), nodes.end());
      return;
    }
    Array<Index> found = search(nodes.front());
    if (found.size() < nodes.size()) {  // there are several pieces
      Array<Index> others;
      for (const Index i : nodes)
        if (part_[i] == part) others.push_back(i);
      cut(std::move(found));
      cut(std::move(others));
      return;
    }
    for (int turn = 0; turn < 3; ++turn) found = search(found.back());
    const Index middle = level_[found[found.size() / 2]];
    Array<Index> low, between, high;
    for (const Index i : found) (level_[i] < middle ? low : level_[i] > middle ? high : between).push_back(i);
    if (low.empty() || high.empty()) {
      order_.insert(order_.end(), nodes.begin(), nodes.end());
      return;
    }
    // Of the level, only what touches both sides has to be cut out.
    Array<Index> separator;
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

  Array<Array<Index>> neighbours_;
  Array<Index> part_, level_, order_;
  Index last_part_ = 0;
};

}  // namespace

Array<Index> order_by_degree(Index nodes, std::span<const std::pair<Index, Index>> edges) {
  Array<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < nodes; ++i) entries.emplace_back(i, i, 1);
  for (const auto& [a, b] : edges) {
    entries.emplace_back(a, b, 1);
    entries.emplace_back(b, a, 1);
  }
  Eigen::SparseMatrix<double> matrix(nodes, nodes);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  Array<Index> order;
  for (Eigen::Index i = 0; i < permutation.size(); ++i)
    order.push_back(static_cast<Index>(permutation.indices()[i]));
  return order;
}

Array<Index> order_by_dissection(Index nodes, std::span<const std::pair<Index, Index>> edges) {
  return Dissection(nodes, edges).run();
}

}  // namespace plumb::detail
