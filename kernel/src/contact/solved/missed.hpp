#pragma once

#include <cstdint>

#include "contact/linkage/combination.hpp"
#include "contact/shapes/touch.hpp"

/// This file says what a substep has to keep apart that it did not expect to touch.
namespace plumb::detail {

/// A shape went into ground unexpectedly.
struct MissedGround {
  std::uint32_t island, shape, ground, number;
  Combination at;
  Touch touch;
};

/// Capsules of two islands went through each other unexpectedly.
struct MissedPair {
  std::uint32_t island, shape, other, other_shape, number;
  Touch touch;
};

}  // namespace plumb::detail
