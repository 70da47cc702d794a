#pragma once

#include <cstdint>

namespace plumb::detail {

/// One rod of an island, from a movable node to another or to a fixed vertex.
struct LoopRod {
  std::uint32_t a, b;  ///< vertices; a is movable
};

}  // namespace plumb::detail
