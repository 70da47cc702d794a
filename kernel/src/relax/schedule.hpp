#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relax/block.hpp"

namespace plumb::detail {

/// Positions [begin, end) of a block, which one thread takes through all substeps of a step.
struct LoneWork {
  std::uint32_t block;
  std::uint32_t begin;
  std::uint32_t end;
};

/// Who does what in a step.
struct Schedule {
  std::vector<std::uint32_t> shared_blocks;  ///< all threads work on one after the other
  std::vector<std::uint32_t> lone_blocks;    ///< the others,
  std::vector<LoneWork> lone_work;           ///< and the pieces they are cut into
};

/// Independent positions are pieces of their own; of the other blocks, those with at least `shared_rods` rods
/// are shared.
template <class T>
Schedule make_schedule(std::span<const Block<T>> blocks, std::uint32_t shared_rods);

}  // namespace plumb::detail
