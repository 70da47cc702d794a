#pragma once

#include <vector>

#include "plumb/layouts/memory.hpp"
#include "plumb/world.hpp"
#include "relax/block.hpp"

namespace plumb::detail {

/// Says what a block is and how it lies in memory.
template <class T>
BlockInfo describe(const Block<T>& block);

/// Adds a block to a list in which equal blocks stand once, with their sums.
void add_to_list(std::vector<BlockInfo>& list, BlockInfo info);

}  // namespace plumb::detail
