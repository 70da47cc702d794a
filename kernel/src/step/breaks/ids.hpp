#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Lists numbers of particles, rods or the like.
using Ids = Array<std::uint32_t>;

inline void append(Ids& to, std::span<const std::uint32_t> from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Puts numbers in ascending order, each once. Those at the front that are in order already cost little.
inline void sort_once(Ids& of) {
  const auto others = std::is_sorted_until(of.begin(), of.end());
  std::sort(others, of.end());
  std::inplace_merge(of.begin(), others, of.end());
  of.erase(std::unique(of.begin(), of.end()), of.end());
}

}  // namespace plumb::detail
