// A chain that hangs above a scale and is let go presses on it with three times the weight that lies there:
// what has come to rest weighs lambda g x, and what comes to rest brings lambda v² = 2 lambda g x.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr int links = 80;
constexpr double link = 0.05, mass = 0.05, radius = 0.005;

/// A chain along y, the lowest particle of which touches the ground. Its links are a little aside, as those
/// of a chain that hangs are, or they would stand on each other.
Scene chain_above_scale(bool is_cable) {
  Scene scene;
  const Surface surface{.friction = 0.5};
  scene.planes.push_back({.surface = surface});
  for (std::uint32_t i = 0; i <= links; ++i) {
    const Vec3 aside{i % 2 == 0 ? -2.5e-4 : 2.5e-4, 0, 1.8e-4 * std::sin(1.7 * i)};
    scene.particles.push_back(test::movable(Vec3{0, radius + link * i, 0} + aside, i == 0 ? mass / 2 : mass));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .law = {.one_sided = is_cable}});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = radius, .surface = surface});
  }
  return scene;
}

/// When a length has come down, s.
double time_of(double length) {
  return std::sqrt(2 * length / test::earth);
}

/// The mean force on the scale while each tenth of the chain comes down, as a share of 3 lambda g x. The mass
/// of a link is in its particles, so that a tenth begins and ends half way between two of them.
std::vector<double> shares_of_force(const Scene& scene, double dt) {
  Settings settings = test::body_settings(1);
  settings.tensions = true;
  World world(scene, settings);
  std::vector<Vec3> forces(scene.capsules.size());
  std::vector<double> shares;
  double begin = 0, impulse = 0;
  for (int tenth = 1; tenth <= 10; ++tenth) {
    while (world.time() < time_of(link * (8 * tenth + 0.49))) {
      EXPECT_EQ(world.step(dt).unsolved, 0u);
      world.copy_contact_forces(forces);
      impulse += dt * std::accumulate(forces.begin(), forces.end(), Vec3{}).y;
    }
    const double end = world.time();
    const double all = 0.5 * mass / link * test::earth * test::earth *
                       (std::pow(end, 3) - std::pow(begin, 3));  // the integral of 3 lambda g (g t²/2)
    shares.push_back(impulse / all);
    impulse = 0;
    begin = end;
  }
  return shares;
}

// Links that only pull let what is above fall freely. Particles come to rest one by one, and none does so
// within a step of where a tenth ends. What remains is the step in which one does, half of which its weight
// counts too early or too late: 0.26 ms of 45 ms and more, a tenth of which is weight. The bar is 3 %.
TEST(FallingChain, PressesWithThreeTimesItsWeight) {
  for (const double share : shares_of_force(chain_above_scale(true), 1.0 / 1920)) EXPECT_NEAR(share, 1, 3e-3);
}

// Rigid links also push: what has landed topples under what comes, and the scale feels a blow a tenth early
// or late, up to a fifth of a tenth's force. On the whole all of it is the chain's momentum.
TEST(FallingChain, OfRodsThatPushPressesSoOnTheWhole) {
  const std::vector<double> shares = shares_of_force(chain_above_scale(false), 1.0 / 1920);
  double all = 0, wanted = 0;
  for (std::size_t tenth = 0; tenth < shares.size(); ++tenth) {
    const double weight = std::pow(tenth + 1, 1.5) - std::pow(tenth, 1.5);  // the impulse of a tenth
    all += weight * shares[tenth];
    wanted += weight;
  }
  EXPECT_NEAR(all / wanted, 1, 0.03);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
