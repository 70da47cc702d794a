#pragma once

#include <cstdint>

namespace plumb::detail {

/// A rod of an island goes from a movable node to another or to a fixed vertex.
struct LoopRod {
  std::uint32_t a, b;  ///< They are vertices, and a is movable.
};

/// A load of an island did this in a substep, in units of delta . M delta. The scale is that of its parts,
/// which may cancel.
struct LoopWork {
  double done = 0, scale = 0;
};

}  // namespace plumb::detail
