#pragma once

#include <Eigen/Core>

#include "reference/featherstone/articulated_body.hpp"

/// Bodies in reduced coordinates, as tests move them.
namespace plumb::test {

struct State {
  Eigen::VectorXd q, v;
};

inline State start_of(const detail::ArticulatedBody& body) {
  return {Eigen::VectorXd::Zero(body.coordinates()), Eigen::VectorXd::Zero(body.speeds())};
}

/// Classical Runge-Kutta.
inline void advance(detail::ArticulatedBody& body, State& s, const detail::BodyLoad& load, double duration,
                    int steps) {
  const double h = duration / steps;
  const auto slope = [&](const State& at) {
    State k;
    body.rates(at.q, at.v, k.q);
    body.accelerations(at.q, at.v, load, k.v);
    return k;
  };
  const auto moved = [&](const State& k, double by) { return State{s.q + by * k.q, s.v + by * k.v}; };
  for (int i = 0; i < steps; ++i) {
    const State k1 = slope(s), k2 = slope(moved(k1, h / 2)), k3 = slope(moved(k2, h / 2)),
                k4 = slope(moved(k3, h));
    s.q += h / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
    s.v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
    body.settle(s.q, s.v);
  }
}

}  // namespace plumb::test
