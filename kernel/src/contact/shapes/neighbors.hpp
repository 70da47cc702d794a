#pragma once

#include <cstdint>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Says which capsules of an island may touch each other, see Filter::own_island.
class Neighbors {
 public:
  /// No capsules may.
  Neighbors() = default;
  /// `part` is one island.
  explicit Neighbors(const Scene& part);

  bool any_may_touch() const { return !own_.empty(); }
  /// Returns whether two capsules may, as their numbers in the part say.
  bool may_touch(std::uint32_t one, std::uint32_t other) const;

 private:
  Array<std::uint8_t> own_;  ///< by capsule, whether it touches its island at all; none if none does
  Array<Array<std::uint32_t>> neighbors_;  ///< of each, with itself, ascending
};

}  // namespace plumb::detail
