#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/graph.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Returns whether an island with loops is thin: a ring, ladder or truss. It is factorised, and others are
/// solved by lines first.
bool is_thin(const layouts::Graph& island);

/// Returns whether an island with loops is so wide and large that it is never to be factorised.
bool is_vast(const layouts::Graph& island);

/// Returns whether some rods are not rigid.
bool has_laws(const Scene& scene, std::span<const std::uint32_t> rods);

/// Returns whether all rods are elastic.
bool all_elastic(const Scene& scene, std::span<const std::uint32_t> rods);

/// Returns whether rods carry masses that couple their ends.
bool carries_mass(const Scene& scene, std::span<const std::uint32_t> rods, MassModel model);

}  // namespace plumb::detail
