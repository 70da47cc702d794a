#pragma once

#include <array>
#include <cstdint>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Names a body's four particles, with their places (m) as the scene stands.
struct BodyShape {
  std::array<std::uint32_t, 4> particles;
  std::array<Vec3, 4> places;
};

}  // namespace plumb::detail
