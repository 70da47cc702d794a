#pragma once

#include <cstdint>
#include <vector>

/// The thesis's two small examples of what an integrator does, apart from any scene.
namespace plumb::tools {

/// A particle tied to the origin along x and, stiffly, to the line y = 0: x' = -x, y' = -k y (thesis
/// eq. 3.13).
struct StiffState {
  double x = 1;
  double y = 1;
};
/// Forward Euler (eq. 3.14): y is multiplied by 1 - h k, and grows beyond h k = 2 (eq. 3.15).
StiffState explicit_step(StiffState state, double k, double h);
/// Backward Euler (eq. 3.24): x is divided by 1 + h and y by 1 + h k, so that a step without end is at rest
/// (eq. 3.25). h may be infinite.
StiffState implicit_step(StiffState state, double k, double h);

enum class VelocityScheme : std::uint8_t {
  rk2,              ///< the midpoint rule (thesis figure 3.12a)
  verlet_backward,  ///< (x - x*)/h, the velocity that eq. 3.6 stands for (figure 3.12b)
  verlet_central    ///< (x_next - x*)/2h, which has to wait for the next position
};
struct VelocitySample {
  double t = 0;      ///< s
  double value = 0;  ///< m/s
  double error = 0;  ///< m/s, value - exact
};
/// The velocity of a particle on a spring, x'' = -x, from x = 1 and x' = 0, at every step of h seconds until
/// `duration`.
std::vector<VelocitySample> sample_velocity(VelocityScheme scheme, double h, double duration);
/// Largest |error| of those.
double velocity_error(VelocityScheme scheme, double h, double duration);

}  // namespace plumb::tools
