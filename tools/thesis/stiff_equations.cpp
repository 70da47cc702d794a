#include "thesis/stiff_equations.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::tools {

StiffState explicit_step(StiffState state, double k, double h) {
  return {state.x + h * -state.x, state.y + h * (-k * state.y)};
}

// It is eq. 3.22 with the derivative diag(-1, -k), written so that 1/h may be 0.
StiffState implicit_step(StiffState state, double k, double h) {
  return {state.x - state.x / (1 / h + 1), state.y - k * state.y / (1 / h + k)};
}

std::vector<VelocitySample> sample_velocity(VelocityScheme scheme, double h, double duration) {
  std::vector<VelocitySample> samples;
  const auto add = [&](int step, double value) {
    const double t = step * h;
    samples.push_back({t, value, value + std::sin(t)});
  };
  const int steps = static_cast<int>(std::lround(duration / h));
  if (scheme == VelocityScheme::rk2) {
    double x = 1, v = 0;
    for (int i = 1; i <= steps; ++i) {
      const double middle_x = x + h / 2 * v, middle_v = v - h / 2 * x;
      x += h * middle_v;
      v -= h * middle_x;
      add(i, v);
    }
    return samples;
  }
  double before = 1, now = 1 - h * h / 2;  // The first step has its half: x + v h + a h²/2.
  for (int i = 1; i <= steps; ++i) {
    const double next = 2 * now - before - h * h * now;
    add(i, scheme == VelocityScheme::verlet_backward ? (now - before) / h : (next - before) / (2 * h));
    before = now;
    now = next;
  }
  return samples;
}

double velocity_error(VelocityScheme scheme, double h, double duration) {
  double largest = 0;
  for (const VelocitySample& sample : sample_velocity(scheme, h, duration))
    largest = std::max(largest, std::abs(sample.error));
  return largest;
}

}  // namespace plumb::tools
