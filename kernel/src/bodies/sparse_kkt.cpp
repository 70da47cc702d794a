#include "sparse_kkt.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>

namespace plumb::detail {
namespace {

/// Eliminates on the graph of nodes, a triple or a constraint each, one with the fewest neighbours first, of
/// several the one that waits for the shortest chain of others: factor() and solve() wait for arithmetic
/// along the longest. A constraint comes after all its triples, or as the first one of a triple that is gone:
/// its pivot is then well away from zero however the others lie.
class Elimination {
 public:
  Elimination(std::uint32_t threes, std::uint32_t constraints,
              std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings)
      : threes_(threes),
        neighbours_(threes + constraints),
        waiting_(neighbours_.size(), 0),
        behind_(neighbours_.size(), 0) {
    for (const auto& [a, b] : couplings) {
      const std::uint32_t m = node(a), n = node(b);
      if (m == n || !neighbours_[m].insert(n).second) continue;
      neighbours_[n].insert(m);
    }
    own_.resize(neighbours_.size());
    for (std::uint32_t n = 0; n < neighbours_.size(); ++n)
      for (const std::uint32_t m : neighbours_[n])
        if ((m < threes_) != (n < threes_)) own_[n].push_back(m);
    for (std::uint32_t n = threes_; n < waiting_.size(); ++n)
      waiting_[n] = static_cast<std::uint32_t>(own_[n].size());
    for (std::uint32_t n = 0; n < neighbours_.size(); ++n)
      if (waiting_[n] == 0) queue_.insert(rank(n));
  }

  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> order;
    while (!queue_.empty()) {
      const std::uint32_t n = std::get<2>(*queue_.begin());
      queue_.erase(queue_.begin());
      order.push_back(n);
      remove(n);
    }
    return order;
  }

 private:
  using Rank = std::tuple<std::size_t, std::uint32_t, std::uint32_t>;

  Rank rank(std::uint32_t n) const { return {neighbours_[n].size(), behind_[n], n}; }
  std::uint32_t node(std::uint32_t unknown) const {
    return unknown < 3 * threes_ ? unknown / 3 : unknown - 2 * threes_;
  }

  void remove(std::uint32_t n) {
    for (const std::uint32_t m : neighbours_[n]) {
      const bool queued = queue_.erase(rank(m)) > 0;
      behind_[m] = std::max(behind_[m], behind_[n] + 1);
      neighbours_[m].erase(n);
      for (const std::uint32_t k : neighbours_[n])
        if (k != m) neighbours_[m].insert(k);
      if (queued) queue_.insert(rank(m));
    }
    if (n >= threes_) return;
    bool spent = false;
    for (const std::uint32_t c : own_[n]) {
      if (waiting_[c] == 0) continue;  // already queued, by an earlier triple
      --waiting_[c];
      if (waiting_[c] == 0 || !spent) {
        if (waiting_[c] > 0) spent = true;
        waiting_[c] = 0;
        queue_.insert(rank(c));
      }
    }
  }

  std::uint32_t threes_;
  std::vector<std::set<std::uint32_t>> neighbours_;
  std::vector<std::vector<std::uint32_t>> own_;  ///< of a triple its constraints, of a constraint its triples
  std::vector<std::uint32_t> waiting_;           ///< triples to go before a constraint may be eliminated
  std::vector<std::uint32_t> behind_;            ///< the longest chain of neighbours that went one by one
  std::set<Rank> queue_;
};

}  // namespace

KktPlan::KktPlan(std::uint32_t threes, std::uint32_t constraints,
                 std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings) {
  for (const std::uint32_t n : Elimination(threes, constraints, couplings).run()) {
    if (n < threes)
      order_.insert(order_.end(), {3 * n, 3 * n + 1, 3 * n + 2});
    else
      order_.push_back(n + 2 * threes);
  }
  const auto size = static_cast<std::uint32_t>(order_.size());
  position_.resize(size);
  for (std::uint32_t k = 0; k < size; ++k) position_[order_[k]] = k;

  std::vector<std::set<std::uint32_t>> columns(size);
  for (const auto& [a, b] : couplings) {
    const auto [low, high] = std::minmax(position_[a], position_[b]);
    columns[low].insert(high);
  }
  for (std::uint32_t k = 0; k < size; ++k)
    for (auto i = columns[k].begin(); i != columns[k].end(); ++i)
      columns[*i].insert(std::next(i), columns[k].end());
  start_.assign(1, 0);
  for (const auto& column : columns) {
    rows_.insert(rows_.end(), column.begin(), column.end());
    start_.push_back(static_cast<std::uint32_t>(rows_.size()));
  }
  for (std::uint32_t k = 0; k < size; ++k)
    for (std::uint32_t i = start_[k]; i < start_[k + 1]; ++i)
      for (std::uint32_t j = i; j < start_[k + 1]; ++j)
        targets_.push_back(place(order_[rows_[i]], order_[rows_[j]]));
}

std::uint32_t KktPlan::place(std::uint32_t a, std::uint32_t b) const {
  const auto [low, high] = std::minmax(position_[a], position_[b]);
  if (low == high) return low;
  const auto first = rows_.begin() + start_[low], last = rows_.begin() + start_[low + 1];
  const auto found = std::lower_bound(first, last, high);
  if (found == last || *found != high) throw std::logic_error("no such entry in the pattern");
  return static_cast<std::uint32_t>(order_.size() + static_cast<std::size_t>(found - rows_.begin()));
}

// The diagonal first, then the columns: values[k], values[n + start[k] ...]. In the end the diagonal holds
// the inverses of the pivots.
bool KktPlan::factor(std::span<double> values) const {
  const auto size = static_cast<std::uint32_t>(order_.size());
  const std::uint32_t* target = targets_.data();
  double* const v = values.data();
  bool sound = true;
  for (std::uint32_t k = 0; k < size; ++k) {
    const double over = 1 / v[k];
    sound = sound && std::isfinite(over);
    v[k] = over;
    double* const column = v + size + start_[k];
    const std::uint32_t count = start_[k + 1] - start_[k];
    for (std::uint32_t i = 0; i < count; ++i) {
      const double entry = column[i], scaled = entry * over;
      for (std::uint32_t j = i; j < count; ++j) v[*target++] -= scaled * column[j];
      column[i] = scaled;
    }
  }
  return sound;
}

void KktPlan::solve(std::span<const double> factors, std::span<double> x) const {
  const auto size = static_cast<std::uint32_t>(order_.size());
  const double* const diagonal = factors.data();
  const double* const entries = factors.data() + size;
  for (std::uint32_t k = 0; k < size; ++k) {
    const double y = x[k];
    for (std::uint32_t i = start_[k]; i < start_[k + 1]; ++i) x[rows_[i]] -= entries[i] * y;
  }
  for (std::uint32_t k = size; k-- > 0;) {
    double y = x[k] * diagonal[k];
    for (std::uint32_t i = start_[k]; i < start_[k + 1]; ++i) y -= entries[i] * x[rows_[i]];
    x[k] = y;
  }
}

simd::KktView KktPlan::view(std::span<const double> factors) const {
  return {unknowns(), start_.data(), rows_.data(), factors.data(), factors.data() + order_.size()};
}

}  // namespace plumb::detail
