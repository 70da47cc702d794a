// Loads by function of time and state: their order, their work, and what they may not do.

#include "step/inputs/loads.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "plumb/loads.hpp"
#include "plumb/plumb.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;

/// A pendulum of 1 m and 1 kg that starts level.
Scene pendulum() {
  Scene scene;
  scene.particles = {fixed({}), movable({1, 0, 0})};
  scene.rods = {{.a = 0, .b = 1}};
  return scene;
}

/// A thrust along the pendulum's path that changes with time, and a brake that grows with speed.
double torque(double t, double rate) {
  return 4 * std::sin(3 * t) - 0.8 * rate;
}
void thrust(const LoadState& state, std::span<Vec3> forces) {
  const Vec3 arm = state.positions[1] - state.positions[0];
  const Vec3 across = 1 / norm(arm) * Vec3{-arm.y, arm.x, 0};
  forces[1] += torque(state.time, dot(across, state.velocities[1])) * across;
}

/// Where it is after t (s), with phi'' = torque - g cos(phi), by Runge and Kutta's method.
Vec3 truth_at(double t) {
  const auto slope = [](double time, std::array<double, 2> s) {
    return std::array{s[1], torque(time, s[1]) - 9.81 * std::cos(s[0])};
  };
  const auto moved = [](std::array<double, 2> s, double by, std::array<double, 2> rate) {
    return std::array{s[0] + by * rate[0], s[1] + by * rate[1]};
  };
  std::array<double, 2> s{0, 0};
  constexpr int steps = 4000;
  const double h = t / steps;
  for (int i = 0; i < steps; ++i) {
    const double now = i * h;
    const auto a = slope(now, s), b = slope(now + h / 2, moved(s, h / 2, a)),
               c = slope(now + h / 2, moved(s, h / 2, b)), d = slope(now + h, moved(s, h, c));
    for (std::size_t k = 0; k < 2; ++k) s[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {std::cos(s[0]), std::sin(s[0]), 0};
}

TEST(Loads, MotionIsOfSecondOrderWhereForcesFollowTimeAndState) {
  const Vec3 truth = truth_at(1);
  struct Case {
    Settings settings;
    double order;
  };
  // Gradient new is of first order itself.
  const Case cases[] = {{{.method = Method::direct, .gradient = Gradient::mid}, 2},
                        {{.method = Method::direct, .gradient = Gradient::old}, 2},
                        {{.method = Method::direct, .gradient = Gradient::mid, .substeps = 3}, 2},
                        {{.method = Method::direct, .gradient = Gradient::new_}, 1},
                        {{.method = Method::relax, .gradient = Gradient::old}, 2},
                        {{.method = Method::multipliers}, 2},
                        {{.method = Method::featherstone}, 2}};
  for (const auto& [settings, order] : cases) {
    const auto error = [&, settings = settings](int steps) {
      World world(pendulum(), settings);
      world.set_load(thrust);
      test::run(world, 1.0 / steps, steps);
      return norm(world.position(1) - truth);
    };
    const double fine = error(400);
    EXPECT_NEAR(std::log2(error(200) / fine), order, 0.25) << to_string(settings.method);
    EXPECT_LT(fine, order == 2 ? 1e-3 : 1e-1) << to_string(settings.method);
  }
}

TEST(Loads, ForcesThatAreSetFromTheStartOfAStepAreOfFirstOrder) {
  const Vec3 truth = truth_at(1);
  const auto error = [&](int steps, bool as_load) {
    World world(pendulum(), {.method = Method::direct, .gradient = Gradient::mid});
    if (as_load) world.set_load(thrust);
    for (int i = 0; i < steps; ++i) {
      if (!as_load) {
        const std::array<Vec3, 2> x{world.position(0), world.position(1)}, v{Vec3{}, world.velocity(1)};
        std::array<Vec3, 2> forces{};
        thrust({world.time(), x, v}, forces);
        world.set_force(1, forces[1]);
      }
      world.step(1.0 / steps);
    }
    return norm(world.position(1) - truth);
  };
  EXPECT_NEAR(std::log2(error(200, false) / error(400, false)), 1, 0.2);
  EXPECT_GT(error(1600, false), 10 * error(1600, true));
}

TEST(Loads, AddToForcesThatAreSetAndEnd) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {movable({}, 2)};
  World world(scene);
  world.set_force(0, {1, 0, 0});
  world.set_load([](const LoadState&, std::span<Vec3> forces) { forces[0] += Vec3{0, 3, 0}; });
  world.step(0.5);
  EXPECT_LT(norm(world.velocity(0) - Vec3{0.25, 0.75, 0}), 1e-14);
  world.set_force(0, {});
  world.step(0.5);
  EXPECT_LT(norm(world.velocity(0) - Vec3{0.25, 1.5, 0}), 1e-14);
  world.set_load({});
  world.step(0.5);
  EXPECT_LT(norm(world.velocity(0) - Vec3{0.25, 1.5, 0}), 1e-14);
}

TEST(Loads, ALoadThatFailsLeavesTheWorldAsItWas) {
  World world(pendulum());
  int calls = 0;
  world.set_load([&](const LoadState&, std::span<Vec3> forces) {
    if (++calls == 3) throw std::runtime_error("no wind");
    forces[1].x = calls == 4 ? std::numeric_limits<double>::quiet_NaN() : 1;
  });
  test::run(world, 0.01, 2);
  const std::uint64_t before = world.state_hash();
  EXPECT_THROW(world.step(0.01), std::runtime_error);
  EXPECT_EQ(test::refusal([&] { world.step(0.01); }).substr(0, 44),
            "particle 1: the load's force is not finite: ");
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_DOUBLE_EQ(world.time(), 0.02);
  world.step(0.01);
  EXPECT_NE(world.state_hash(), before);
}

TEST(Loads, SleepersWakeWhenALoadChanges) {
  Scene scene = pendulum();
  scene.particles[1].position = {0, -1, 0};
  World world(scene);
  double push = 0;
  world.set_load([&](const LoadState&, std::span<Vec3> forces) { forces[1].x = push; });
  EXPECT_EQ(test::run(world, 1.0 / 60, 60).awake_islands, 0u);
  push = 1;
  EXPECT_EQ(world.step(1.0 / 60).awake_islands, 1u);
  EXPECT_GT(world.velocity(1).x, 0.01);
}

TEST(Loads, ForcesAndTorquesOnBodiesDoTheirWork) {
  Scene scene;
  scene.gravity = {};
  const Inertia inertia{.xx = 2, .yy = 3, .zz = 4};
  const std::uint32_t body = add_body(scene, {.mass = 5, .center = {1, 2, 3}, .inertia = inertia});
  const Body& solid = scene.bodies[body];
  std::vector<Vec3> x, forces(scene.particles.size());
  for (const Particle& particle : scene.particles) x.push_back(particle.position);
  const auto work = [&](Vec3 velocity, Vec3 spin) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += dot(forces[i], velocity + cross(spin, x[i] - Vec3{1, 2, 3}));
    return sum;
  };
  const Vec3 twist{0.3, -2, 0.7};
  add_torque(solid, twist, x, forces);
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    EXPECT_NEAR(work(axis, {}), 0, 1e-14);
    EXPECT_NEAR(work({}, axis), dot(twist, axis), 1e-14);
  }
  forces.assign(x.size(), {});
  const Point place = point_on_body(scene, body, {1.5, 2, 3});
  EXPECT_LT(norm(position_of(place, x) - Vec3{1.5, 2, 3}), 1e-14);
  add_force(place, {0, 1, 0}, forces);
  EXPECT_NEAR(work({0, 1, 0}, {}), 1, 1e-14);
  EXPECT_NEAR(work({}, {0, 0, 1}), 0.5, 1e-14);  // the force is half a metre from the centre

  // A body that starts at rest turns by a constant torque along an axis of inertia.
  World world(scene);
  world.set_load([&](const LoadState& state, std::span<Vec3> all) {
    add_torque(scene.bodies[0], {0, 0, 2}, state.positions, all);
  });
  test::run(world, 0.01, 100);
  const Momentum now =
      measure_momentum(scene, test::positions_of(world), test::velocities_of(world), MassModel::consistent);
  EXPECT_LT(norm(now.linear), 1e-9);
  EXPECT_NEAR(now.angular.z, 2, 1e-4);  // the couple is that of the predicted place, to second order
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
