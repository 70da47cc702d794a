#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace plumb::detail {

/// Lists numbers of particles, rods or the like.
using Ids = std::vector<std::uint32_t>;

/// Puts numbers in ascending order, each once.
inline void sort_once(Ids& of) {
  std::sort(of.begin(), of.end());
  of.erase(std::unique(of.begin(), of.end()), of.end());
}

}  // namespace plumb::detail
