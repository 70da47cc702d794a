// What rods pull with beside bends: the force along them in a bent wire, what breaks it, and what a winch
// does.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// A wire with EI of 1 N m² that is bent to a closed ring of radius 1 m: nothing pulls along it.
Scene ring(std::uint32_t rods) {
  Scene scene;
  scene.gravity = {};
  const double length = 2 * std::sin(std::numbers::pi / rods);
  for (std::uint32_t i = 0; i < rods; ++i) {
    const double angle = 2 * std::numbers::pi * i / rods;
    scene.particles.push_back({.position = {std::cos(angle), std::sin(angle), 0}, .mass = 0.1});
    scene.rods.push_back({.a = i, .b = (i + 1) % rods});
    scene.bends.push_back({.a = i, .b = (i + 1) % rods, .c = (i + 2) % rods, .stiffness = 1 / length});
  }
  return scene;
}

/// A quarter of it between two clamps, which is a line.
Scene quarter(std::uint32_t rods) {
  Scene scene;
  scene.gravity = {};
  const double angle = std::numbers::pi / 2 / rods, length = 2 * std::sin(angle / 2);
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back({.position = {std::cos(angle * i), std::sin(angle * i), 0},
                               .mass = 0.1,
                               .fixed = i <= 1 || i + 1 >= rods});
  for (std::uint32_t i = 1; i + 1 < rods; ++i) scene.rods.push_back({.a = i, .b = i + 1});
  for (std::uint32_t i = 0; i + 2 <= rods; ++i)
    scene.bends.push_back({.a = i, .b = i + 1, .c = i + 2, .stiffness = 1 / length});
  return scene;
}

/// What makes a linkage of its island, and touches nothing.
Scene with_ball(Scene scene) {
  scene.capsules.push_back({point_at(2), point_at(2), 0.01});
  return scene;
}

double largest_tension(const Scene& scene, Settings settings) {
  settings.tensions = true;
  settings.threads = 1;
  World world(scene, settings);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(world.step(1.0 / 60).unsolved, 0u);
  double out = 0;
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) out = std::max(out, std::abs(world.tension(i)));
  return out;
}

// In a ring without load the force across rods is the same all round, and turns with them, so that it is 0.
// Multipliers alone tell -EI/R² of 1 N. What is left is rounding of EI/l² of 160 N.
TEST(BentTensions, OfARingAreNone) {
  for (const std::uint32_t rods : {10u, 40u}) {
    EXPECT_LT(largest_tension(ring(rods), {.method = Method::direct}), 1e-9) << rods;
    EXPECT_LT(largest_tension(quarter(rods), {.method = Method::direct}), 1e-9) << rods;
    EXPECT_LT(largest_tension(with_ball(ring(rods)), {.method = Method::direct, .gradient = Gradient::new_}),
              1e-9)
        << rods;
  }
}

// A wire that is curved twice as much at rest turns the sign: multipliers alone tell a pull of EI/R², of 1 N.
TEST(BentTensions, AreWhatBreaksRods) {
  for (const bool has_ball : {false, true}) {
    Scene scene = has_ball ? with_ball(ring(20)) : ring(20);
    const double angle = 2 * std::numbers::pi / 20;
    for (Bend& bend : scene.bends) bend.angle = 2 * angle;
    for (Rod& rod : scene.rods) rod.law.strength = 0.5;
    World world(scene, {.method = Method::direct, .threads = 1});
    EXPECT_EQ(world.step(1.0 / 60).broken_rods, 0u) << has_ball;
  }
}

/// Returns by how much energy differs from the work of a winch in two seconds, over the largest work.
double error_of_work(std::uint32_t winch, double stiffness, double dt) {
  Scene scene;
  scene.particles = {
      {.fixed = true}, {.position = {0.5, 0, 0}, .mass = 1}, {.position = {0.9, 0.3, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1, .length = 0.5}, {.a = 1, .b = 2, .length = 0.5}};
  for (Rod& rod : scene.rods) rod.law.stiffness = stiffness;
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 1}};
  World world(scene, {.method = Method::direct, .gradient = Gradient::mid, .tensions = true, .threads = 1});
  const double first = test::energy_of(scene, world).total();
  double work = 0, most = 0, worst = 0;
  const int steps = static_cast<int>(2 / dt);
  for (int i = 1; i <= steps; ++i) {
    scene.rods[winch].length = 0.5 - 0.1 * (1 - std::cos(3 * i * dt));
    world.set_length(winch, scene.rods[winch].length);
    world.step(dt);
    work += dt * world.power(winch);
    most = std::max(most, std::abs(work));
    worst = std::max(worst, std::abs(test::energy_of(scene, world).total() - first - work));
  }
  return worst / most;
}

// A bend's w depends on lengths, which a substep of rigid rods has at its end: the error is of first order.
// Without the bend's part it is 0.1 at every step.
TEST(BentTensions, AreWhatAWinchWorksAgainst) {
  for (const std::uint32_t winch : {0u, 1u}) {
    const double coarse = error_of_work(winch, INFINITY, 1.0 / 240),
                 fine = error_of_work(winch, INFINITY, 1.0 / 960);
    EXPECT_LT(fine, 5e-4) << winch;
    EXPECT_NEAR(coarse / fine, 4, 0.5) << winch;
    // A rod that is strained has the bend's part at another length: strains are 1e-2 here.
    EXPECT_LT(error_of_work(winch, 1e4, 1.0 / 240), 2e-3) << winch;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
