// A load that a rigid cable has thrown back is pulled again only once it is at the end of the cable.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "plumb/plumb.hpp"
#include "support/direct.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

enum class Kind { winch, anchor, loop, cord, reel };
constexpr double length = 0.5;  // m

/// A load of 1 kg on a cable of `length`, without gravity. A loop is a triangle of rods behind the load.
Scene scene_of(Kind kind, Vec3 position, Vec3 velocity) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::fixed({0, 0, 0}), test::movable(position, 1, velocity)};
  const RodLaw cable{.one_sided = true};
  if (kind == Kind::cord)
    scene.tackles = {{.particles = {0, 1}, .length = length, .law = cable}};
  else
    scene.rods = {{.a = 0, .b = 1, .length = length, .law = cable}};
  if (kind == Kind::reel) scene.reels = {{.particles = {0, 1}}};
  if (kind != Kind::loop) return scene;
  for (const double y : {0.1, 0.2})
    scene.particles.push_back(test::movable(position - Vec3{0.1, y, 0}, 1e-6));
  for (const auto& [a, b] : {std::pair{1u, 2u}, {2u, 3u}, {3u, 1u}}) scene.rods.push_back({.a = a, .b = b});
  return scene;
}

/// The cable, and what it does.
struct Cable {
  Cable(Kind of, const Scene& scene) : kind(of), world(scene, settings()) {}
  static Settings settings() {
    Settings out = test::direct(Gradient::mid);
    out.tensions = true;
    return out;
  }
  /// Lets it be shorter by `hauled` (m) after a step of `dt` (s).
  void haul(double hauled, double dt) {
    if (kind == Kind::anchor)
      world.move_anchor(0, {-hauled, 0, 0});
    else if (kind == Kind::cord)
      world.set_tackle_length(0, length - hauled);
    else if (kind == Kind::reel)
      world.set_reel(0, length - hauled);
    else
      world.set_length(0, length - hauled);
    ASSERT_EQ(world.step(dt).unsolved, 0u);
    impulse += dt * (kind == Kind::cord ? world.tackle_tension(0) : world.tension(0));
    work += dt * (kind == Kind::cord ? world.tackle_power(0) : world.power(0));
  }

  Kind kind;
  World world;
  double impulse = 0, work = 0;  // N s, J
};

// A load comes to the end at 0.5 m/s and goes back as fast. What hauls at 0.3 m/s from the next step on is
// slower, so that nothing pulls. It changes its speed by what the light triangle takes, 2e-6 kg of 1 kg. It
// was hauled to 0.8 m/s by 0.3 N s.
TEST(ThrownBack, ALoadIsNotPulledByWhatIsSlower) {
  for (const Kind kind : {Kind::winch, Kind::anchor, Kind::loop, Kind::cord, Kind::reel})
    for (const double rate : {60.0, 960.0}) {
      Cable cable(kind, scene_of(kind, {length, 0, 0}, {0.5, 0, 0}));
      const double dt = 1 / rate;
      cable.world.step(dt);
      ASSERT_NEAR(cable.world.velocity(1).x, -0.5, 1e-5) << "it must have been thrown back";
      const double before = cable.world.velocity(1).x;
      for (int i = 1; i <= static_cast<int>(rate / 30); ++i) cable.haul(0.3 * i * dt, dt);
      EXPECT_NEAR(cable.world.velocity(1).x, before, 2e-6) << static_cast<int>(kind) << ' ' << rate;
      EXPECT_NEAR(cable.impulse, 0, 1e-12) << static_cast<int>(kind) << ' ' << rate;
    }
}

// What hauls at 0.9 m/s is faster: the cable comes tight again, and the load goes at 2 * 0.9 - 0.5 m/s in the
// frame of what hauls, as a ball off a wall. Energy gains what the cable tells.
TEST(ThrownBack, ALoadIsThrownAgainByWhatIsFaster) {
  for (const Kind kind : {Kind::winch, Kind::cord, Kind::loop}) {
    const double dt = 1.0 / 240;
    Cable cable(kind, scene_of(kind, {length, 0, 0}, {0.5, 0, 0}));
    cable.world.step(dt);
    for (int i = 1; i <= 8; ++i) cable.haul(0.9 * i * dt, dt);
    const double v = cable.world.velocity(1).x;
    EXPECT_NEAR(v, -1.3, 1e-5) << static_cast<int>(kind);
    EXPECT_NEAR(cable.work, (v * v - 0.25) / 2, 1e-5) << static_cast<int>(kind);
  }
}

// A winch that begins smoothly hauls a load that also goes sideways. Energy never gains more than its work,
// to rounding. In 1/60 s it was 3 % of the load's.
TEST(ThrownBack, ASmoothWinchGivesNoMoreThanItsWork) {
  for (const Kind kind : {Kind::winch, Kind::loop, Kind::cord})
    for (const double rate : {60.0, 960.0}) {
      const Vec3 along{0.6, -0.8, 0}, across{0.8, 0.6, 0};
      const Scene scene = scene_of(kind, length * along, 0.5 * along + 0.4 * across);
      Cable cable(kind, scene);
      const double start = test::energy_of(scene, cable.world).kinetic;
      for (int i = 1; i <= static_cast<int>(rate / 12); ++i) {
        cable.haul(0.05 * (1 - std::cos(4 * i / rate)), 1 / rate);
        EXPECT_LE(test::energy_of(scene, cable.world).kinetic - start, cable.work + 1e-12)
            << static_cast<int>(kind) << ' ' << rate << ' ' << i;
      }
    }
}

// A reel whose chain is one rod, all of it out, is a winch, whether it hauls slower than the load comes back,
// faster, or in jerks. The solver for loops moves one and that for trees the other, to rounding of 1 m and
// 1 m/s.
TEST(ThrownBack, AReelOfOneRodMovesItsLoadAsAWinch) {
  const Vec3 along{0.6, -0.8, 0}, across{0.8, 0.6, 0};
  for (const double speed : {0.3, 0.9})
    for (const double jerk : {0.0, 0.004}) {
      const auto scene = [&](Kind kind) {
        return scene_of(kind, length * along, 0.5 * along + 0.4 * across);
      };
      const double dt = 1.0 / 240;
      Cable winch(Kind::winch, scene(Kind::winch)), reel(Kind::reel, scene(Kind::reel));
      for (int i = 1; i <= 60; ++i) {
        const double hauled = speed * dt * i + (i % 7 == 0 ? jerk : 0);
        winch.haul(hauled, dt);
        reel.haul(hauled, dt);
        ASSERT_LT(norm(reel.world.velocity(1) - winch.world.velocity(1)), 1e-10) << speed << ' ' << i;
        ASSERT_NEAR(reel.impulse, winch.impulse, 1e-10) << speed << ' ' << i;
      }
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
