// Ropes that hang straight down and are lowered onto ground, which pushes along their rods.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "plumb/joints.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"

namespace plumb {
namespace {

constexpr double frame = 1.0 / 60, radius = 0.02, rod = 0.1;
constexpr std::uint32_t rods = 10;

/// A rope from an anchor at the height of 2 m, with capsules along its rods, above a plane at 0.
Scene hanging_rope(bool is_cable) {
  Scene scene;
  scene.planes.push_back({});
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back({.position = {0, 2 - rod * i, 0}, .mass = 0.1, .fixed = i == 0});
  for (std::uint32_t i = 0; i < rods; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.rods[i].law.one_sided = is_cable;
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = radius});
  }
  return scene;
}

/// Says what became of a rope whose anchor was lowered.
struct Landing {
  double deepest = 0, strain = 0;
  std::uint64_t missed = 0;
};

Landing lower(const Scene& scene, const Settings& settings, double to) {
  World world(scene, settings);
  Landing out;
  for (int i = 0; i < 420; ++i) {
    const double share = std::clamp((i - 29) / 240.0, 0.0, 1.0);
    world.move_anchor(0, {0, 2 + share * (to - 2), 0});
    out.missed += world.step(frame).missed_contacts;
    for (std::uint32_t k = 1; k <= rods; ++k) {
      out.deepest = std::max(out.deepest, radius - world.position(k).y);
      const double strain = norm(world.position(k) - world.position(k - 1)) / rod - 1;
      out.strain = std::max(out.strain, scene.rods[k - 1].law.one_sided ? strain : std::abs(strain));
    }
  }
  return out;
}

// As deep as ContactSettings::tolerance lets be, and as exact as solved rods that touch are.
TEST(LoweredRopes, LieDownAndDoNotGoThrough) {
  for (const bool is_cable : {false, true})
    for (const Method method : {Method::automatic, Method::direct})
      for (const std::uint32_t substeps : {1u, 4u}) {
        SCOPED_TRACE((is_cable ? "cables, " : "rods, ") + std::string(to_string(method)) + ", " +
                     std::to_string(substeps));
        const Landing landing = lower(hanging_rope(is_cable), {.method = method, .substeps = substeps}, 0.5);
        EXPECT_LE(landing.deepest, 1e-3);
        EXPECT_LE(landing.strain, 1e-6);
        EXPECT_EQ(landing.missed, 0u);
      }
}

// The floor bears a cable's end as soon as it stands there: what is left hangs from the anchor.
TEST(LoweredRopes, LetTheFloorBearWhatLies) {
  Scene scene = hanging_rope(true);
  for (Particle& particle : scene.particles) particle.position.y -= 1 - radius + 0.01;
  World world(scene, {.tensions = true});
  for (int i = 0; i < 240; ++i) world.step(frame);
  EXPECT_LE(radius - world.position(rods).y, 2e-3);
  EXPECT_NEAR(world.contact_force(ShapeId{.kind = ShapeKind::plane}).y, -0.1 * 9.81, 1e-6);
  EXPECT_NEAR(world.reaction(0).y, 0.1 * 9.81 * (rods - 1), 1e-6);
}

// A rigid rod that starts in the floor, straight below its anchor, has nowhere to go, and reports say so.
TEST(LoweredRopes, AreReportedWhereTheyCannotPart) {
  Scene scene;
  scene.planes.push_back({});
  scene.particles = {{.position = {0, 1.05, 0}, .fixed = true}, {.position = {0, 0.05, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};
  scene.capsules = {{.a = point_at(1), .b = point_at(1), .radius = 0.1}};
  World world(scene);
  EXPECT_GT(world.step(frame).missed_contacts, 0u);
}

}  // namespace
}  // namespace plumb
