// Method direct on wide nets, which conjugate gradients over lines solve.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/graphs.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

Settings direct(Gradient gradient, std::uint32_t substeps) {
  return {.method = Method::direct, .gradient = gradient, .substeps = substeps, .threads = 1};
}

/// Held along one side, uneven masses, pulled sideways so that no symmetry is left.
Scene sideways_net(std::uint32_t n) {
  test::Random random(n);
  Scene scene = scenes::make_net({.width = n, .height = n, .level = 1});
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.mass = 1.5 + test::signed_unit(random);
  scene.gravity = {3, -9, 2};
  return scene;
}

Frame after(const Scene& scene, Gradient gradient, std::uint32_t substeps, int steps) {
  World world(scene, direct(gradient, substeps));
  const StepReport report = test::run(world, frame, steps);
  EXPECT_EQ(report.halvings, 0u);
  EXPECT_EQ(report.unsolved, 0u);
  return {steps * frame, test::positions_of(world), test::velocities_of(world)};
}

// A rod with a mass, however small, couples its ends, and the island is factorised.
TEST(Nets, MoveAsTheFactorisationMovesThem) {
  Scene scene = sideways_net(14);
  scene.drag = 0.2;
  Scene coupled = scene;
  coupled.rods[30].mass = 1e-14;
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World lines(scene, direct(gradient, 8)), factors(coupled, direct(gradient, 8));
    for (int i = 0; i < 20; ++i)
      for (World* world : {&lines, &factors}) {
        world->move_anchor(3, scene.particles[3].position + 1e-3 * i * Vec3{0, 1, 0.3});
        world->set_force(100, {5, 0, i % 3 - 1.0});
        EXPECT_EQ(world->step(frame).halvings, 0u);
      }
    // What is left of lengths, 1e-11, and what motion makes of it.
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
      EXPECT_LE(norm(lines.position(i) - factors.position(i)), 1e-9) << to_string(gradient);
      EXPECT_LE(norm(lines.velocity(i) - factors.velocity(i)), 1e-7) << to_string(gradient);
    }
  }
}

// Against gradient mid with 1/8 of the finer step, which adds 1/64 of its error.
TEST(Nets, OrderOfGradientsOldAndMidIsTwo) {
  const Scene scene = sideways_net(16);
  const Frame truth = after(scene, Gradient::mid, 128, 20);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const Frame coarse = after(scene, gradient, 8, 20), fine = after(scene, gradient, 16, 20);
    EXPECT_NEAR(std::log2(rms_distance(coarse.positions, truth.positions) /
                          rms_distance(fine.positions, truth.positions)),
                2, 0.15)
        << to_string(gradient);
    EXPECT_NEAR(std::log2(rms_distance(coarse.velocities, truth.velocities) /
                          rms_distance(fine.velocities, truth.velocities)),
                2, 0.2)
        << to_string(gradient);
  }
}

TEST(Nets, GradientMidKeepsEnergy) {
  const Scene scene = sideways_net(20);
  World world(scene, direct(Gradient::mid, 8));
  const auto energy = [&] {
    return measure_energy(scene, test::positions_of(world), test::velocities_of(world)).total() /
           energy_range(scene);
  };
  const double before = energy();
  double largest = 0;
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(world.step(frame).unsolved, 0u);
    largest = std::max(largest, std::abs(energy() - before));
  }
  EXPECT_LE(largest, 1e-10);  // of either sign, from 1e-11 of |C|/L^2 in each of 480 substeps
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-10);
}

TEST(Nets, InFreeFlightKeepTheirMomentum) {
  test::Random random(7);
  Scene scene = scenes::make_net({.width = 15, .height = 15, .level = 1});
  scene.gravity = {};
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    Particle& particle = scene.particles[i];
    if (particle.fixed && i + 1 < 15) scene.rods.push_back({.a = i, .b = i + 1});
    particle.fixed = false;
    particle.mass = 1;
    particle.velocity = {test::signed_unit(random), test::signed_unit(random), test::signed_unit(random)};
  }
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    World world(scene, direct(gradient, 16));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world));
    };
    const Momentum before = momentum();
    test::run(world, frame, 30);
    const Momentum now = momentum();
    EXPECT_LE(norm(now.linear - before.linear), 1e-12 * scene.particles.size());
    EXPECT_LE(norm(now.angular - before.angular), 1e-12 * scene.particles.size());
  }
}

// With a tolerance rods keep no more strain than that, and some of it, in half the iterations or less, and
// go nearly the same way: what a substep leaves the next one takes back.
TEST(Nets, StopAtATolerance) {
  const Scene scene = sideways_net(14);
  for (const Gradient gradient : {Gradient::old, Gradient::new_}) {
    World exact(scene, direct(gradient, 4));
    const StepReport to_rounding = test::run(exact, frame, 30);
    for (const double tolerance : {1e-4, 1e-6}) {
      World world(scene, direct(gradient, 4));
      world.set_stop_rule({.tolerance = tolerance});
      double largest = 0;
      std::uint64_t newton = 0;
      for (int i = 0; i < 30; ++i) {
        newton += world.step(frame).newton;
        largest = std::max(largest, test::stretch_of(scene, world).max);
      }
      EXPECT_LE(newton, 0.75 * to_rounding.newton) << to_string(gradient);
      EXPECT_LE(largest, 1.01 * tolerance);  // C/L^2 is the strain but for its square
      EXPECT_GE(largest, 1e-2 * tolerance);  // an iteration takes one or two digits off
      EXPECT_LE(test::relative_error(scene, world, test::positions_of(exact)), tolerance);
    }
  }
}

// Mid keeps energy by solving to rounding, whatever the tolerance. A hundredth of an accuracy, at most 1e-6,
// is one; if both are set the lesser counts: strain is a velocity, the greater the shorter substeps are, and
// no accuracy could be had.
TEST(Nets, TakeTheirToleranceFromWhatIsAskedFor) {
  const Scene scene = sideways_net(14);
  const auto strain = [&](Settings settings, std::optional<double> tolerance,
                          std::optional<double> accuracy) {
    settings.stop.tolerance = tolerance;
    settings.accuracy = accuracy;
    World world(scene, settings);
    double largest = 0;
    for (int i = 0; i < 30; ++i) {
      world.step(frame);
      largest = std::max(largest, test::stretch_of(scene, world).max);
    }
    return largest;
  };
  EXPECT_LE(strain(direct(Gradient::mid, 4), 1e-4, {}), 1e-10);
  const Settings automatic{.method = Method::automatic, .threads = 1};
  const double of_coarse = strain(automatic, {}, 1e-3), of_fine = strain(automatic, {}, 1e-6),
               of_both = strain(automatic, 1e-4, 1e-6);
  EXPECT_LE(of_coarse, 1.01e-6);
  EXPECT_GE(of_coarse, 1e-8);
  EXPECT_LE(of_fine, 1.01e-8);
  EXPECT_LE(of_both, 1.01e-8);
}

// No finite pull holds a straight row between fixed corners, and none has to: its particles are locked.
TEST(Nets, HangFromAStraightRow) {
  const Scene scene = scenes::make_net(14, 14);
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World world(scene, direct(gradient, 2));
    const StepReport report = test::run(world, frame, 20);
    EXPECT_EQ(report.halvings + report.elastic_substeps + report.fallbacks + report.unsolved, 0u)
        << to_string(gradient);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-10) << to_string(gradient);
  }
}

// A row too short for its corners shares what it lacks: counted, and everything stays finite and near.
TEST(Nets, ThatCannotHangSagAndAreCounted) {
  Scene scene = scenes::make_net(14, 14);
  for (Rod& rod : scene.rods) rod.length = 0.1;
  scene.particles[13].position.x *= 1.001;
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    World world(scene, direct(gradient, 2));
    const StepReport report = test::run(world, frame, 20);
    EXPECT_GT(report.elastic_substeps + report.fallbacks, 0u);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_TRUE(test::all_finite(world));
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-2) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
