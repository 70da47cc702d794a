#pragma once

#include <functional>
#include <span>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/vec3.hpp"

namespace plumb {

/// Shows a load the middle of the step that it acts in, as the start of the step predicts it.
struct LoadState {
  double time;                       ///< Simulated time of the middle, in s.
  std::span<const Vec3> positions;   ///< Positions in m, in the scene's particle order.
  std::span<const Vec3> velocities;  ///< Velocities in m/s, in the same order.
};

/// Adds forces (N) that depend on time and state to `forces`, which has one entry per particle and is zero.
using Load = std::function<void(const LoadState& state, std::span<Vec3> forces)>;

/// Returns where a place is, in m. The particles of `point` must be among `positions` (m).
PLUMB_API Vec3 position_of(const Point& point, std::span<const Vec3> positions);

/// Adds a force (N) at a place of a body or a rod to `forces`. Its work is exact: particles get it in
/// proportion to their weights. The particles of `point` must be among `forces`.
PLUMB_API void add_force(const Point& point, Vec3 force, std::span<Vec3> forces);

/// Adds a torque (N m) on a body to `forces` (N): a couple of forces on its four particles, which add up to
/// zero. Its work is exact for every turn of the body. Particles must be among `positions` (m) and `forces`.
PLUMB_API void add_torque(const Body& body, Vec3 torque, std::span<const Vec3> positions,
                          std::span<Vec3> forces);

}  // namespace plumb
