#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Sorts pairs by their first number, then by their second, in time that grows linearly with them.
template <class Pair>
class PairOrder {
 public:
  /// Sorts pairs as they are found for one second number after the other, ascending, and leaves each of them
  /// once. `first` is the member that names their first number, which is below `count`.
  void sort(Array<Pair>& pairs, std::uint32_t Pair::*first, std::uint32_t count) {
    if (pairs.empty()) return;
    next_.assign(count, 0);
    for (const Pair& pair : pairs) ++next_[pair.*first];
    std::uint32_t before = 0;
    for (std::uint32_t& next : next_) before += std::exchange(next, before);
    sorted_.resize(pairs.size());
    for (const Pair& pair : pairs) sorted_[next_[pair.*first]++] = pair;
    sorted_.erase(std::unique(sorted_.begin(), sorted_.end()), sorted_.end());
    pairs.swap(sorted_);
  }

 private:
  Array<std::uint32_t> next_;  ///< by first number, where its next pair goes
  Array<Pair> sorted_;
};

}  // namespace plumb::detail
