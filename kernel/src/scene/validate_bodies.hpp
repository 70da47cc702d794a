#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "plumb/scene.hpp"

/// This file holds what validate() asks of bodies, joints, shapes and ground. Every function throws
/// InputError.
namespace plumb::detail {

/// Returns where four particles are, in m.
std::array<Vec3, 4> positions_of(const Scene& scene, const std::array<std::uint32_t, 4>& particles);

/// Checks body `i`, in the scene or to be added to it. It needs particles that exist and differ, places that
/// are not in one plane, and the mass of a solid.
void require_particles(const Scene& scene, std::size_t i, const std::array<std::uint32_t, 4>& particles);
void require_volume(std::size_t i, const std::array<Vec3, 4>& positions);
void require_solid(std::size_t i, const MassProperties& properties);

/// Each of these asks that the scene passes those before it, and that its particles and rods pass the checks
/// of validate().
void validate_bodies(const Scene& scene);
void validate_joints(const Scene& scene);
void validate_shapes(const Scene& scene);

/// Checks the pose of platform `i`, in the scene or to be taken.
void validate_pose(const Pose& pose, std::size_t i);

/// These refuse a place or a direction that is not there. `name` is for messages.
void validate_point(const Scene& scene, const Point& point, const std::string& name);
/// Returns its length, in m.
double validate_direction(const Scene& scene, const Direction& direction, const std::string& name);
/// Returns the way from a direction's start to its end, in m.
Vec3 along(const Scene& scene, const Direction& direction);
/// Points are one place if their weights differ by no more than this. The weights of a place on a flat body
/// are rounded by nearly as much.
inline constexpr double same_place = 1e-6;
/// Returns whether two points are one place of their particles, wherever these are.
inline bool are_one_place(const Point& a, const Point& b) {
  const auto weight = [](const Point& of, std::uint32_t particle) {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (of.particles[k] == particle) sum += of.weights[k];
    return sum;
  };
  const auto is_alike = [&](std::uint32_t particle) {
    return std::abs(weight(a, particle) - weight(b, particle)) <= same_place;
  };
  return std::all_of(a.particles.begin(), a.particles.end(), is_alike) &&
         std::all_of(b.particles.begin(), b.particles.end(), is_alike);
}
/// Returns whether some particle of it is movable.
bool moves(const Scene& scene, const Point& point);
bool moves(const Scene& scene, const Direction& direction);

}  // namespace plumb::detail
