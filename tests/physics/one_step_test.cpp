// What one step over all solvers promises: an island that nothing can reach is moved as if it were alone,
// what has come to rest costs nothing and changes no bit, and linkages in the air have accuracy and time
// orders.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/bodies.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// Chains side by side, 10 m apart, every rod with a shape.
Scene curtain(std::uint32_t chains, std::uint32_t links) {
  Scene scene;
  for (std::uint32_t c = 0; c < chains; ++c) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    const double x = 10.0 * c;
    scene.particles.push_back(test::fixed({x, 0, 0}));
    for (std::uint32_t i = 1; i <= links; ++i) {
      scene.particles.push_back(test::movable({x + 0.06 * i, -0.08 * i, 0}));
      scene.rods.push_back({.a = first + i - 1, .b = first + i});
      scene.capsules.push_back({.a = point_at(first + i - 1), .b = point_at(first + i), .radius = 0.02});
    }
  }
  return scene;
}

/// A ball that flies along the first ten chains.
std::uint32_t throw_ball(Scene& scene) {
  const std::uint32_t ball = test::add_ball(scene, {-3, -1, 0}, 0.3, 5);
  scene.particles[ball].velocity = {100, 4, 0};
  return ball;
}

TEST(OneStep, IslandsOutOfReachKeepTheirBits) {
  const Scene alone = curtain(60, 12);
  Scene with_ball = alone;
  throw_ball(with_ball);
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const Precision precision : {Precision::single, Precision::double_}) {
      const Settings settings{.method = method, .precision = precision, .substeps = 4, .threads = 1};
      World with(with_ball, settings), without(alone, settings);
      std::uint64_t contacts = 0;
      for (int i = 0; i < 60; ++i) {
        contacts += with.step(frame).contact_points;
        without.step(frame);
      }
      EXPECT_GT(contacts, 0u) << to_string(method);
      std::uint32_t touched = 0;
      for (std::uint32_t c = 0; c < 60; ++c) {
        bool same = true;
        for (std::uint32_t i = 13 * c; i < 13 * (c + 1); ++i)
          same = same && with.position(i) == without.position(i) && with.velocity(i) == without.velocity(i);
        touched += !same;
      }
      EXPECT_GE(touched, 1u) << to_string(method);
      EXPECT_LE(touched, 12u) << to_string(method) << ", " << to_string(precision);
    }
}

// The ground is near the first chain alone; the others swing far above where it ends.
TEST(OneStep, GroundDoesNotChangeWhatItCannotReach) {
  const Scene free = curtain(4, 10);
  Scene grounded = free;
  grounded.planes.push_back({.offset = -50});
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_})
    for (const bool controlled : {false, true}) {
      Settings settings{.method = Method::direct, .gradient = gradient, .threads = 1};
      if (controlled) settings.accuracy = 1e-4;
      World a(free, settings), b(grounded, settings);
      test::run(a, frame, 40);
      test::run(b, frame, 40);
      EXPECT_EQ(a.state_hash(), b.state_hash()) << to_string(gradient) << controlled;
    }
}

/// A chain that hangs straight, at rest.
Scene hanging(std::uint32_t links) {
  Scene scene;
  scene.particles.push_back(test::fixed({0, 0, 0}));
  for (std::uint32_t i = 1; i <= links; ++i) {
    scene.particles.push_back(test::movable({0, -0.1 * i, 0}));
    scene.rods.push_back({.a = i - 1, .b = i});
  }
  return scene;
}

// A twin that is told of the same force before every step never stands still. What both differ by is
// rounding.
TEST(OneStep, WhatHangsStillFallsAsleepWhereItWouldStay) {
  for (const Method method : {Method::direct, Method::automatic, Method::relax}) {
    const std::uint32_t links = method == Method::relax ? 10 : 1000;
    const Scene scene = hanging(links);
    World sleeper(scene, {.method = method, .threads = 1}), twin(scene, {.method = method, .threads = 1});
    StepReport last;
    for (int i = 0; i < 1200; ++i) {
      last = sleeper.step(frame);
      twin.set_force(links, {});
      ASSERT_EQ(twin.step(frame).awake_islands, 1u);
    }
    EXPECT_EQ(last.awake_islands, 0u) << to_string(method);
    const double apart = rms_distance(test::positions_of(sleeper), test::positions_of(twin));
    EXPECT_LE(apart, 1e-9 * bounding_diagonal(scene)) << to_string(method);
    for (World* const world : {&sleeper, &twin}) world->set_force(links, {3, 0, 0});
    EXPECT_EQ(sleeper.step(frame).awake_islands, 1u);
    twin.step(frame);
    EXPECT_GT(sleeper.position(links).x, 0) << to_string(method);
    EXPECT_NEAR(sleeper.position(links).x, twin.position(links).x, 1e-9) << to_string(method);
  }
}

TEST(OneStep, AnAnchorWakesWhatHangsFromIt) {
  World world(hanging(20), {.method = Method::direct, .threads = 1});
  StepReport last;
  for (int i = 0; i < 60; ++i) last = world.step(frame);
  ASSERT_EQ(last.awake_islands, 0u);
  world.move_anchor(0, {0.05, 0, 0});
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  EXPECT_NE(world.position(20).x, 0);
}

/// Four boxes on hinges along different axes, one of which spins, in the air.
Scene tumbler() {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < 4; ++i) {
    MassProperties box = solid_box(1 + i, {0.3, 0.2, 0.1});
    box.center = {0.4 * i, 0, 0};
    add_body(scene, box);
  }
  const Vec3 axes[] = {{0, 0, 1}, {0, 1, 0}, {0, 0.6, 0.8}};
  for (std::uint32_t i = 0; i < 3; ++i) add_revolute(scene, i, i + 1, {0.4 * i + 0.2, 0, 0}, axes[i]);
  test::set_motion(scene, 0, {0, 0, 0}, {0, 2, 3});
  return scene;
}

std::vector<Vec3> after_a_second(const Scene& scene, std::uint32_t order, std::uint32_t substeps) {
  World world(scene, {.method = Method::direct,
                      .gradient = Gradient::old,
                      .substeps = substeps,
                      .time_order = order,
                      .threads = 1});
  test::run(world, 1.0 / 30, 30);
  return test::positions_of(world);
}

TEST(OneStep, LinkagesInTheAirHaveTimeOrders) {
  const Scene scene = tumbler();
  const std::vector<Vec3> truth = after_a_second(scene, 6, 16);
  double errors[2][2];
  for (const std::uint32_t order : {2u, 4u})
    for (const int fine : {0, 1})
      errors[order / 4][fine] = rms_distance(after_a_second(scene, order, fine ? 2 : 1), truth);
  EXPECT_NEAR(std::log2(errors[0][0] / errors[0][1]), 2, 0.3) << errors[0][0] << " " << errors[0][1];
  EXPECT_GT(std::log2(errors[1][0] / errors[1][1]), 3.5) << errors[1][0] << " " << errors[1][1];
  EXPECT_LT(errors[1][0], 0.05 * errors[0][0]);
}

TEST(OneStep, LinkagesInTheAirKeepEnergyAndMomentumAtEveryOrder) {
  const Scene scene = tumbler();
  for (const std::uint32_t order : {2u, 4u, 6u}) {
    World world(scene,
                {.method = Method::direct, .gradient = Gradient::old, .time_order = order, .threads = 1});
    const auto energy = [&] {
      return measure_energy(scene, test::positions_of(world), test::velocities_of(world),
                            MassModel::consistent)
          .total();
    };
    const Momentum before = test::momentum_of(scene, world);
    const double first = energy();
    test::run(world, 1.0 / 30, 600);
    const Momentum after = test::momentum_of(scene, world);
    EXPECT_NEAR(energy(), first, 1e-9 * first) << order;
    EXPECT_LE(norm(after.angular - before.angular), 1e-9 * norm(before.angular)) << order;
    EXPECT_LE(norm(after.linear - before.linear), 1e-9) << order;
  }
}

/// The same four boxes hang from an anchor, and drag, air, joint drag and a damper brake them.
Scene braked_tumbler() {
  Scene scene = tumbler();
  scene.gravity = {0, -9.81, 0};
  scene.drag = 0.3;
  scene.joint_drag = 0.2;
  scene.particles.push_back(test::fixed({-0.15, 0, 0}));
  const auto anchor = static_cast<std::uint32_t>(scene.particles.size() - 1);
  scene.pins.push_back({point_at(anchor), point_on_body(scene, 0, {-0.15, 0, 0})});
  scene.rods[0].mass = 0.02;
  scene.rods[0].linear_drag = 0.1;
  scene.rods[0].orthogonal_drag = 0.4;
  const auto side = [&](std::uint32_t body, Vec3 along) {
    const Vec3 center = scene.bodies[body].center;
    return Direction{point_on_body(scene, body, center), point_on_body(scene, body, center + along)};
  };
  scene.angles.push_back({.u = side(0, {0.1, 0, 0}), .v = side(1, {0, 0.1, 0}), .damping = 0.002});
  return scene;
}

// Runge-Kutta steps have all these forces from their own accelerations; substeps of order 2 are another way.
TEST(OneStep, LinkagesInTheAirAreBrakedAlikeAtEveryOrder) {
  const Scene scene = braked_tumbler();
  const auto swing = [&](std::uint32_t order, std::uint32_t substeps) {
    World world(scene, {.method = Method::direct,
                        .gradient = Gradient::old,
                        .substeps = substeps,
                        .time_order = order,
                        .threads = 1});
    for (int i = 1; i <= 30; ++i) {
      world.move_anchor(16, {-0.15 + 0.01 * i, 0, 0.005 * i});
      world.step(1.0 / 30);
    }
    return test::positions_of(world);
  };
  const std::vector<Vec3> truth = swing(6, 16);
  EXPECT_LE(rms_distance(swing(2, 256), truth), 2e-6);
  const double coarse = rms_distance(swing(4, 2), truth), fine = rms_distance(swing(4, 4), truth);
  EXPECT_LE(coarse, 1e-4);
  EXPECT_GT(std::log2(coarse / fine), 3.5) << coarse << " " << fine;
}

// The error asked for is of the scene's size a second; what motion makes of it is left a factor of three.
TEST(OneStep, LinkagesInTheAirKeepAnAccuracy) {
  const Scene scene = tumbler();
  const std::vector<Vec3> truth = after_a_second(scene, 6, 16);
  for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
    World world(scene, {.method = Method::automatic, .accuracy = accuracy, .threads = 1});
    const StepReport report = test::run(world, 1.0 / 30, 30);
    EXPECT_LE(rms_distance(test::positions_of(world), truth) / bounding_diagonal(scene), 3 * accuracy)
        << accuracy;
    EXPECT_EQ(report.inaccurate_steps, 0u) << accuracy;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
