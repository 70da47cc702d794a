// Anchors draw islands beyond the length of their rods and back: what they do afterwards.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/direct.hpp"
#include "support/worlds.hpp"

namespace plumb {
namespace {

constexpr double frame = 1.0 / 60;

/// A line of `rods` rods, 2 m long, between anchors 1.6 m apart. A triangle of rods hangs from its middle.
Scene line(std::uint32_t rods, bool triangle) {
  Scene scene;
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const Vec3 at{1.6 * i / rods, 0, 0};
    scene.particles.push_back(i == 0 || i == rods ? test::fixed(at) : test::movable(at, 0.5 / rods));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = 2.0 / rods});
  }
  if (!triangle) return scene;
  scene.particles.push_back(test::movable({0.8, -0.5, 0}, 0.2));
  for (const std::uint32_t end : {rods / 2, rods / 2 + 1})
    scene.rods.push_back({.a = end, .b = rods + 1, .length = 0.5});
  return scene;
}

// A line with a triangle is drawn 0.2 mm beyond its 2 m for half a second and put back. From then on rods
// fit, and nothing may damp its swing. Gradient mid keeps energy to what rounding of positions leaves: 1e-8
// of it.
TEST(DrawnTooFar, AnIslandSwingsOnOnceItsRodsFit) {
  for (const bool automatic : {true, false}) {
    const Scene scene = line(4, true);
    World world(scene, automatic ? Settings{} : test::direct(Gradient::mid));
    const auto at = [&](double share) { return Vec3{1.9 + share * 0.1002, 0, 0}; };
    const auto step = [&](Vec3 anchor) {
      world.move_anchor(4, anchor);
      return world.step(frame);
    };
    StepReport total;
    for (int i = 0; i <= 30; ++i) total += step(at(i / 30.0));
    for (int i = 0; i < 30; ++i) total += step(at(1));
    EXPECT_GE(total.elastic_substeps, 30u) << "it must have been too short all the time";
    for (int i = 29; i >= 0; --i) step(at(i / 30.0));
    for (std::uint32_t i = 1; i < 4; ++i) world.set_force(i, {0, 0, 1});
    for (int i = 0; i < 15; ++i) world.step(frame);
    for (std::uint32_t i = 1; i < 4; ++i) world.set_force(i, {});
    const double start = test::energy_of(scene, world).total();
    const double swing = test::energy_of(scene, world).kinetic;
    for (int i = 0; i < 240; ++i) {
      EXPECT_EQ(world.step(frame).fallbacks, 0u) << automatic << ' ' << i;
      ASSERT_NEAR(test::energy_of(scene, world).total(), start, 1e-8 * swing) << automatic << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace plumb
