// Anchors and winches draw loads against a ceiling that their ropes pass. It holds, and rods are off their
// lengths: before, loads were pulled through, which `missed_contacts` alone told.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "support/boxes.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr double below = 1.15;  ///< m, where the ceiling begins, which is 10 cm thick
constexpr double half = 0.2;    ///< m, of loads

/// A rope from an anchor at 3 m straight through the ceiling down to a load, which hangs `aside` (m).
Scene make_crane(std::uint32_t rods, const RodLaw& law, double aside, bool is_box) {
  constexpr double mass = 20;
  Scene scene;
  scene.particles = {test::fixed({0, 3, 0})};
  for (std::uint32_t i = 1; i <= rods; ++i) {
    const double along = 1.0 * i / rods;
    scene.particles.push_back(
        test::movable({aside * along, 3 - 2.5 * along, 0}, i == rods && !is_box ? mass : 0.1));
    scene.rods.push_back({.a = i - 1, .b = i, .law = law});
  }
  scene.boxes.push_back({.center = {0, below + 0.05, 0}, .half_size = {1, 0.05, 1}});
  if (is_box) {
    test::add_box(scene, {aside, 0.5 - half, 0}, {half, half, half}, mass, {});
    scene.pins.push_back({point_at(rods), point_on_body(scene, 0, {aside, 0.5, 0})});
  } else {
    scene.capsules.push_back(sphere_at(point_at(rods), half));
  }
  return scene;
}

// Up to 1.4 m beyond what the rods allow.
TEST(PulledIntoGround, BallsStayBelowACeiling) {
  for (const RodLaw& law : {RodLaw{}, RodLaw{.one_sided = true}, RodLaw{.strength = 1e12}})
    for (const std::uint32_t rods : {1u, 2u, 10u})
      for (const double speed : {0.5, 2.0})
        for (const bool is_winch : {false, true}) {
          if (is_winch && (law.one_sided || law.strength < INFINITY)) continue;  // refused
          SCOPED_TRACE(testing::Message() << rods << " rods, " << speed << " m/s, winch " << is_winch
                                          << ", cables " << law.one_sided << ", strength " << law.strength);
          const Scene scene = make_crane(rods, law, 0, false);
          World world(scene, {.threads = 1});
          StepReport report;
          double top = 0;
          for (int i = 1; i * frame * speed < 2; ++i) {
            const double way = i * frame * speed;
            if (is_winch)
              world.set_length(0, std::max(0.01, 2.5 / rods - way));
            else
              world.move_anchor(0, {0, 3 + way, 0});
            report += world.step(frame);
            top = std::max(top, world.position(rods).y);
          }
          EXPECT_LT(top, below - half + 2e-3);
          EXPECT_EQ(report.unsolved + report.frozen_islands, 0u);
        }
}

// A winch pays out again, and the load hangs from rods that fit.
TEST(PulledIntoGround, RodsFitAgainOnceTheyMay) {
  const Scene scene = make_crane(10, {}, 0, false);
  World world(scene, {.threads = 1});
  for (int i = 1; i <= 120; ++i) {
    world.move_anchor(0, {0, 3 + i * frame, 0});
    world.step(frame);
  }
  EXPECT_GT(test::stretch_of(scene, world).max, 0.1);
  for (int i = 1; i <= 120; ++i) {
    world.move_anchor(0, {0, 5 - i * frame, 0});
    world.step(frame);
  }
  EXPECT_LT(test::stretch_of(scene, world).max, 1e-6);
  EXPECT_NEAR(world.position(10).y, 0.5, 1e-2);
}

// Boxes press with four corners. Up to 0.3 m beyond what the rods allow.
TEST(PulledIntoGround, BoxesStayBelowACeiling) {
  for (const std::uint32_t rods : {1u, 40u}) {
    const Scene scene = make_crane(rods, {}, 0, true);
    World world(scene, {.threads = 1});
    double top = 0;
    for (int i = 1; i <= 129; ++i) {
      world.move_anchor(0, {0, 3 + 0.5 * i * frame, 0});
      world.step(frame);
      top = std::max(top, test::middle_of(scene, world, 0).y);
    }
    EXPECT_LT(top, below - half + 2e-3) << rods;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
