#pragma once

#include <array>
#include <cstdint>

#include "plumb/scene.hpp"

/// What validate() asks of bodies, joints, shapes and ground. Everything here throws InputError.
namespace plumb::detail {

/// Where four particles are, in m.
std::array<Vec3, 4> positions_of(const Scene& scene, const std::array<std::uint32_t, 4>& particles);

/// Of body `i`, there or to be added: particles that exist and differ, places that are not in one plane, and
/// the mass of a solid.
void require_particles(const Scene& scene, std::size_t i, const std::array<std::uint32_t, 4>& particles);
void require_volume(std::size_t i, const std::array<Vec3, 4>& positions);
void require_solid(std::size_t i, const MassProperties& properties);

/// Each asks that the scene passes those before it, and its particles and rods the checks of validate().
void validate_bodies(const Scene& scene);
void validate_joints(const Scene& scene);
void validate_shapes(const Scene& scene);

}  // namespace plumb::detail
