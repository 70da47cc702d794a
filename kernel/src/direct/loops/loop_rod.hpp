#pragma once

#include <cstdint>

namespace plumb::detail {

/// A rod of an island goes from a movable node to another or to a fixed vertex.
struct LoopRod {
  std::uint32_t a, b;  ///< They are vertices, and a is movable.
};

}  // namespace plumb::detail
