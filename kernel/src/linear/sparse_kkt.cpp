#include "linear/sparse_kkt.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>

namespace plumb::detail {
namespace {

/// Eliminates on the graph of nodes, each a triple or a constraint. One with the fewest neighbours goes
/// first, and of several the one that waits for the fewest others in a row: factor() and solve() wait for the
/// longest such row. A constraint comes after all its triples, or as the first one of a triple that is gone.
/// Its pivot is then well away from zero however the others lie.
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

  /// Puts nodes in their order into columns of a triple and a constraint, or of up to four constraints. Those
  /// share a column that go one after the other and are neighbours.
  std::vector<std::vector<std::uint32_t>> run() {
    std::vector<std::vector<std::uint32_t>> columns;
    std::uint32_t room = 0;
    std::set<std::uint32_t> last;  // it holds neighbours of the last one
    while (!queue_.empty()) {
      const std::uint32_t n = std::get<2>(*queue_.begin());
      queue_.erase(queue_.begin());
      if (n < threes_ || room == 0 || !last.contains(n)) {
        columns.emplace_back();
        room = 4;
      }
      columns.back().push_back(n);
      room -= n < threes_ ? 3 : 1;
      last = neighbours_[n];
      remove(n);
    }
    return columns;
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
      if (waiting_[c] == 0) continue;  // an earlier triple has queued it
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
  std::vector<std::vector<std::uint32_t>>
      own_;                             ///< A triple has its constraints here, and a constraint its triples.
  std::vector<std::uint32_t> waiting_;  ///< So many triples go before a constraint may be eliminated.
  std::vector<std::uint32_t> behind_;   ///< It is the longest row of neighbours that went one by one.
  std::set<Rank> queue_;
};

}  // namespace

KktPlan::KktPlan(std::uint32_t threes, std::uint32_t constraints,
                 std::span<const std::pair<std::uint32_t, std::uint32_t>> couplings, Isa isa)
    : kernels_(&simd::kkt_kernels(isa)) {
  position_.resize(3 * std::size_t{threes} + constraints);
  for (const std::vector<std::uint32_t>& nodes : Elimination(threes, constraints, couplings).run()) {
    std::uint32_t at = 4 * columns_;
    const auto put = [&](std::uint32_t unknown) { position_[unknown] = at++; };
    for (const std::uint32_t n : nodes) {
      if (n < threes)
        for (std::uint32_t axis = 0; axis < 3; ++axis) put(3 * n + axis);
      else
        put(n + 2 * threes);
    }
    ++columns_;
    while (at < 4 * columns_) padding_.push_back(at++);
  }

  std::vector<std::set<std::uint32_t>> below(columns_);
  for (const auto& [a, b] : couplings) {
    const auto [low, high] = std::minmax({position_[a] / 4, position_[b] / 4});
    if (low != high) below[low].insert(high);
  }
  for (std::uint32_t k = 0; k < columns_; ++k)
    for (auto i = below[k].begin(); i != below[k].end(); ++i) below[*i].insert(std::next(i), below[k].end());
  start_.assign(1, 0);
  for (const auto& column : below) {
    rows_.insert(rows_.end(), column.begin(), column.end());
    start_.push_back(static_cast<std::uint32_t>(rows_.size()));
  }
  for (std::uint32_t k = 0; k < columns_; ++k)
    for (std::uint32_t i = start_[k]; i < start_[k + 1]; ++i)
      for (std::uint32_t j = i; j < start_[k + 1]; ++j) targets_.push_back(block(rows_[i], rows_[j]));
}

std::uint32_t KktPlan::block(std::uint32_t column, std::uint32_t row) const {
  if (column == row) return column;
  const auto first = rows_.begin() + start_[column], last = rows_.begin() + start_[column + 1];
  const auto found = std::lower_bound(first, last, row);
  if (found == last || *found != row) throw std::logic_error("no such entry in the pattern");
  return static_cast<std::uint32_t>(columns_ + static_cast<std::size_t>(found - rows_.begin()));
}

std::uint32_t KktPlan::place(std::uint32_t a, std::uint32_t b) const {
  const auto [low, high] = std::minmax(position_[a], position_[b]);
  return 16 * block(low / 4, high / 4) + 4 * (low % 4) + high % 4;
}

std::vector<simd::Block> KktPlan::empty_matrix() const {
  std::vector<simd::Block> out(blocks(), simd::Block{});
  for (const std::uint32_t at : padding_) out[at / 4].of[5 * (at % 4)] = 1;
  return out;
}

bool KktPlan::factor(std::span<simd::Block> blocks) const {
  kernels_->factor(pattern(), targets_.data(), blocks.data());
  return std::all_of(blocks.begin(), blocks.begin() + columns_, [](const simd::Block& inverse) {
    return std::isfinite(inverse.of[12] + inverse.of[13] + inverse.of[14] + inverse.of[15]);
  });
}

void KktPlan::solve(std::span<const simd::Block> factors, std::span<simd::Quad> x) const {
  kernels_->solve(pattern(), factors.data(), x.data());
}

}  // namespace plumb::detail
