#pragma once

#include <cstdint>
#include <vector>

/// These are the thesis's two small examples of what an integrator does, apart from any scene.
namespace plumb::tools {

/// A particle is tied to the origin along x and, stiffly, to the line y = 0: x' = -x, y' = -k y (thesis
/// eq. 3.13).
struct StiffState {
  double x = 1;
  double y = 1;
};
/// Steps by forward Euler (eq. 3.14). It multiplies y by 1 - h k, so y grows beyond h k = 2 (eq. 3.15).
StiffState explicit_step(StiffState state, double k, double h);
/// Steps by backward Euler (eq. 3.24). It divides x by 1 + h and y by 1 + h k, so that a step without end is
/// at rest (eq. 3.25). h may be infinite.
StiffState implicit_step(StiffState state, double k, double h);

enum class VelocityScheme : std::uint8_t {
  rk2,              ///< The midpoint rule takes it (thesis figure 3.12a).
  verlet_backward,  ///< It is (x - x*)/h, the velocity that eq. 3.6 stands for (figure 3.12b).
  verlet_central    ///< It is (x_next - x*)/2h, which has to wait for the next position.
};
struct VelocitySample {
  double t = 0;      ///< Time, in s.
  double value = 0;  ///< Velocity, in m/s.
  double error = 0;  ///< Velocity less the exact one, in m/s.
};
/// Follows the velocity of a particle on a spring, x'' = -x, from x = 1 and x' = 0. It returns every step of
/// h seconds until `duration`.
std::vector<VelocitySample> sample_velocity(VelocityScheme scheme, double h, double duration);
/// Returns the largest |error| of those.
double velocity_error(VelocityScheme scheme, double h, double duration);

}  // namespace plumb::tools
