#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "direct/loops/loop_rod.hpp"

namespace plumb::detail {

/// Finds the rods of an island by their ends.
class IslandRods {
 public:
  static constexpr std::uint32_t none = 0xffffffff;

  explicit IslandRods(std::span<const LoopRod> rods) {
    for (std::uint32_t k = 0; k < rods.size(); ++k) rods_[std::minmax(rods[k].a, rods[k].b)] = k;
  }
  std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    const auto at = rods_.find(std::minmax(a, b));
    return at == rods_.end() ? none : at->second;
  }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> rods_;
};

}  // namespace plumb::detail
