#include <algorithm>
#include <numeric>

#include "linear/sparse_ldu.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;
constexpr Index none = 0xffffffff;

/// Fronts up to this many numbers wide are merged with their parents whatever zeros that stores.
constexpr Index narrow = 16;

/// Returns the later neighbours of each variable, in numbers of the elimination order.
Array<Array<Index>> later_neighbours(const SparsePattern& pattern, const Array<Index>& number) {
  Array<Array<Index>> later(pattern.size.size());
  for (const auto& [a, b] : pattern.meet) {
    const auto [first, second] = std::minmax(number[a], number[b]);
    if (first != second) later[first].push_back(second);
  }
  for (auto& list : later) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return later;
}

/// Finds the elimination tree (Liu 1990) by path compression.
Array<Index> elimination_tree(const Array<Array<Index>>& later) {
  const auto n = static_cast<Index>(later.size());
  Array<Array<Index>> earlier(n);
  for (Index i = 0; i < n; ++i)
    for (const Index j : later[i]) earlier[j].push_back(i);
  Array<Index> parent(n, none), ancestor(n, none);
  for (Index j = 0; j < n; ++j)
    for (Index i : earlier[j])
      while (i != none && i < j) {
        const Index next = ancestor[i];
        ancestor[i] = j;
        if (next == none) parent[i] = j;
        i = next;
      }
  return parent;
}

/// Puts children before parents, a parent right after its last child, and the widest subtrees last.
Array<Index> postorder(const Array<Index>& parent) {
  const auto n = static_cast<Index>(parent.size());
  Array<Index> head(n + std::size_t{1}, none), next(n, none), order, stack;
  for (Index i = n; i-- > 0;) {
    const Index p = parent[i] == none ? n : parent[i];
    next[i] = head[p];
    head[p] = i;
  }
  order.reserve(n);
  for (Index root = head[n]; root != none; root = next[root]) {
    stack.push_back(root);
    while (!stack.empty()) {
      const Index top = stack.back(), child = head[top];
      if (child == none) {
        order.push_back(top);
        stack.pop_back();
      } else {
        head[top] = next[child];
        stack.push_back(child);
      }
    }
  }
  return order;
}

double operations_of(std::size_t pivots, std::size_t rows) {
  double sum = 0;
  for (std::size_t k = 0; k < pivots; ++k) {
    const auto left = static_cast<double>(rows - k);
    sum += left * left;
  }
  return sum;
}

}  // namespace

/// The order is made a postorder here, and the structure of the factor is found.
struct SparseAnalysis::Symbolic {
  Array<Index> order, number, parent;
  Array<Array<Index>> below;  ///< Per variable, its elimination touches these after it.
  Array<Index> start;         ///< The numbers of each variable begin here; the end follows.

  Index numbers(Index i) const { return start[i + 1] - start[i]; }
};

SparseAnalysis::Symbolic SparseAnalysis::analyse(const SparsePattern& pattern) {
  const auto n = static_cast<Index>(pattern.size.size());
  Symbolic s;
  s.order = pattern.order;
  s.number.resize(n);
  const auto renumber = [&] {
    for (Index i = 0; i < n; ++i) s.number[s.order[i]] = i;
  };
  renumber();
  const Array<Index> post = postorder(elimination_tree(later_neighbours(pattern, s.number)));
  Array<Index> order(n);
  for (Index i = 0; i < n; ++i) order[i] = s.order[post[i]];
  s.order = std::move(order);
  renumber();
  s.below = later_neighbours(pattern, s.number);
  s.parent.assign(n, none);
  Array<Array<Index>> children(n);
  Array<Index> mark(n, none);
  for (Index j = 0; j < n; ++j) {
    auto& rows = s.below[j];
    mark[j] = j;
    for (const Index i : rows) mark[i] = j;
    for (const Index c : children[j])
      for (const Index i : s.below[c])
        if (mark[i] != j) {
          mark[i] = j;
          rows.push_back(i);
        }
    std::sort(rows.begin(), rows.end());
    if (rows.empty()) continue;
    s.parent[j] = rows.front();
    children[rows.front()].push_back(j);
  }
  s.start.assign(n + std::size_t{1}, 0);
  for (Index i = 0; i < n; ++i) s.start[i + 1] = s.start[i] + pattern.size[s.order[i]];
  return s;
}

double SparseAnalysis::estimate(const SparsePattern& pattern) {
  const Symbolic s = analyse(pattern);
  double sum = 0;
  for (Index i = 0; i < s.order.size(); ++i) {
    std::size_t rows = pattern.size[s.order[i]];
    for (const Index j : s.below[i]) rows += pattern.size[s.order[j]];
    sum += operations_of(pattern.size[s.order[i]], rows);
  }
  return sum;
}

SparseAnalysis::SparseAnalysis(const SparsePattern& pattern, std::span<const SparseEntry> entries) {
  const Symbolic s = analyse(pattern);
  const auto n = static_cast<Index>(s.order.size());
  position_.resize(n);
  for (Index i = 0; i < n; ++i) position_[s.order[i]] = s.start[i];
  size_ = s.start[n];
  link_fronts(s, find_fronts(s), entries);
}

/// Fronts are runs of variables, each the parent of the one before, with nearly the same rows. Returns the
/// front of every variable.
Array<Index> SparseAnalysis::find_fronts(const Symbolic& s) {
  const auto n = static_cast<Index>(s.order.size());
  Array<Index> front_of(n);
  for (Index i = 0; i < n;) {
    const Index first = i;
    Index width = s.numbers(i);
    for (const Index j : s.below[i]) width += s.numbers(j);
    while (i + 1 < n && s.parent[i] == i + 1) {
      Index next_width = s.start[i + 1] - s.start[first];
      next_width += s.numbers(i + 1);
      for (const Index j : s.below[i + 1]) next_width += s.numbers(j);
      if (next_width > width && next_width > narrow) break;
      width = next_width;
      ++i;
    }
    Front front{};
    front.first = s.start[first];
    front.pivots = s.start[i + 1] - s.start[first];
    front.rows = width;
    front.parent = none;
    front.row_begin = rows_.size();
    for (const Index j : s.below[i])
      for (Index part = 0; part < s.numbers(j); ++part) rows_.push_back(s.start[j] + part);
    front.stride = layouts::round_up(width, simd::logical_width<double>);
    front.factor = padded_;
    padded_ += std::size_t{front.pivots} * front.stride;
    numbers_ += std::size_t{front.pivots} * (2 * std::size_t{front.rows} - front.pivots);
    operations_ += operations_of(front.pivots, front.rows);
    widest_ = std::max(widest_, front.stride);
    for (Index j = first; j <= i; ++j) front_of[j] = static_cast<Index>(fronts_.size());
    fronts_.push_back(front);
    ++i;
  }
  return front_of;
}

/// Finds who passes its rows on to whom and where they are there, and where every entry goes.
void SparseAnalysis::link_fronts(const Symbolic& s, const Array<Index>& front_of,
                                 std::span<const SparseEntry> entries) {
  const auto n = static_cast<Index>(s.order.size());
  Array<Index> variable_of(size_), local(size_);
  for (Index i = 0; i < n; ++i)
    for (Index k = s.start[i]; k < s.start[i + 1]; ++k) variable_of[k] = i;
  Array<Array<Index>> children(fronts_.size());
  relative_.resize(rows_.size());
  const auto number_rows = [&](const Front& front) {
    for (Index k = 0; k < front.pivots; ++k) local[front.first + k] = k;
    for (Index k = front.pivots; k < front.rows; ++k) local[rows_[front.row_begin + k - front.pivots]] = k;
  };
  Array<Array<Index>> entries_of(fronts_.size());
  for (Index e = 0; e < entries.size(); ++e)
    entries_of[front_of[std::min(s.number[entries[e].row], s.number[entries[e].column])]].push_back(e);
  std::size_t used = 0;
  for (Index f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    number_rows(front);
    front.child_begin = static_cast<Index>(children_.size());
    for (const Index c : children[f]) {
      const Front& child = fronts_[c];
      const Index passed = child.rows - child.pivots;
      for (Index k = 0; k < passed; ++k) relative_[child.row_begin + k] = local[rows_[child.row_begin + k]];
      used -= std::size_t{passed} * passed;
      children_.push_back(c);
    }
    front.child_end = static_cast<Index>(children_.size());
    front.place_begin = places_.size();
    for (const Index e : entries_of[f]) {
      const SparseEntry& entry = entries[e];
      const Index row = local[position_[entry.row] + entry.row_part];
      const Index column = local[position_[entry.column] + entry.column_part];
      places_.push_back({row * front.stride + column, entry.value});
    }
    const std::size_t passed = front.rows - front.pivots;
    used += passed * passed;
    stack_ = std::max(stack_, used);
    if (passed == 0) continue;
    front.parent = front_of[variable_of[rows_[front.row_begin]]];
    children[front.parent].push_back(f);
  }
}

}  // namespace plumb::detail
