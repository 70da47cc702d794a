#pragma once

#include "direct/bends/loop_bend.hpp"
#include "direct/reels/loop_reel.hpp"
#include "direct/tackles/loop_tackle.hpp"
#include "direct/twists/loop_twist.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// An island has these elements beside its rods, by its vertices.
struct LoopElements {
  Array<LoopBend> bends{};
  Array<LoopTackle> tackles{};
  Array<LoopTwist> twists{};
  Array<LoopReel> reels{};

  /// Returns how many pulleys have friction.
  std::uint32_t pulleys() const {
    std::uint32_t sum = 0;
    for (const LoopTackle& tackle : tackles) sum += tackle.pulleys();
    return sum;
  }

  bool any() const { return !bends.empty() || !tackles.empty() || !twists.empty() || !reels.empty(); }
  friend bool operator==(const LoopElements&, const LoopElements&) = default;
  friend auto operator<=>(const LoopElements&, const LoopElements&) = default;
};

}  // namespace plumb::detail
