#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Returns for each vertex the first one in its place, so that triangles which share a place share a vertex.
Array<std::uint32_t> weld(std::span<const Vec3> vertices);

}  // namespace plumb::detail
