// Capsules that meet at anchors overlap there, and nothing can take them apart.

#include <gtest/gtest.h>

#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

Settings settings_of(Method method) {
  if (method == Method::relax) return {.method = method, .substeps = 8, .stop = {.sweeps = 20}, .threads = 1};
  return {.method = method, .threads = 1};
}

void add_capsule(Scene& scene, std::uint32_t a, std::uint32_t b) {
  scene.capsules.push_back({.a = point_at(a), .b = point_at(b), .radius = 0.02});
}

/// Adds a rope of 6 rods with capsules from an anchor of its own.
void add_rope(Scene& scene, Vec3 at, Vec3 along) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= 6; ++i) {
    const Vec3 place = at + static_cast<double>(i) * along;
    scene.particles.push_back(i == 0 ? test::fixed(place) : test::movable(place, 0.1));
    if (i == 0) continue;
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
    add_capsule(scene, first + i - 1, first + i);
  }
}

void expect_no_gain(const Scene& scene, const Settings& settings) {
  World world(scene, settings);
  const double before = test::energy_of(scene, world).total();
  for (int i = 0; i < 240; ++i) {
    world.step(frame);
    ASSERT_LE(test::energy_of(scene, world).total(), before + 1e-6) << i;
  }
  EXPECT_LT(test::stretch_of(scene, world).max, 0.01);
}

// Two ropes and a fixed capsule begin in places that differ by rounding, or a little more. A push near an
// anchor would throw the other end of a rod: energies of 10¹⁵⁰ J were gained like that.
TEST(SharedAnchors, ThrowNothing) {
  for (const Method method : {Method::relax, Method::automatic})
    for (const double apart : {0.0, 1e-17, 1e-12, 1e-7, 1e-3}) {
      Scene scene;
      add_rope(scene, {}, {0.2, 0, 0});
      add_rope(scene, {apart, 0, 0}, {0.05, 0, 0.19});
      scene.particles.push_back(test::fixed({apart, 0, 0}));
      scene.particles.push_back(test::fixed({0, -0.2, 0}));
      add_capsule(scene, 14, 15);
      SCOPED_TRACE(apart);
      expect_no_gain(scene, settings_of(method));
    }
}

// A net hangs between two fixed sides that have capsules, too. Those are neighbours of the rods that begin
// there. Before, a trampoline of 8 x 8 took 287,660 sweeps in one step.
TEST(SharedAnchors, AreNoContactOfCapsulesBetweenFixedOnes) {
  constexpr std::uint32_t n = 8;
  Scene scene;
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec3 at{0.2 * i, 2, 0.2 * j};
      scene.particles.push_back(i == 0 || i + 1 == n ? test::fixed(at) : test::movable(at, 0.05));
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t here = n * j + i;
      const bool is_side = i == 0 || i + 1 == n;
      if (i + 1 < n) {
        scene.rods.push_back({.a = here, .b = here + 1, .length = 0.21});
        add_capsule(scene, here, here + 1);
      }
      if (j + 1 == n) continue;
      if (!is_side) scene.rods.push_back({.a = here, .b = here + n});
      add_capsule(scene, here, here + n);
    }
  for (const Method method : {Method::relax, Method::automatic}) {
    World world(scene, settings_of(method));
    const StepReport total = test::run(world, frame, 120);
    EXPECT_EQ(total.frozen_islands, 0u);
    EXPECT_EQ(total.contact_points, 0u);
    EXPECT_LT(test::stretch_of(scene, world).max, method == Method::relax ? 0.05 : 1e-6);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
