// A slack cable catches a load and lets it go again: its impulse against the exact one-sided problem, by
// substeps to half a swing of the stretched cable.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "support/direct.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double mass = 3, gravity = 9.81, rope = 1;  // kg, m/s^2, m

/// A load on a cable of `stiffness` (N/m) starts `slack` (m) above the point where it pulls, and goes
/// sideways with `sideways` (m/s).
struct Drop {
  double slack, stiffness, sideways = 0;
};

/// A load at (x, y), with its velocity and the impulse of the cable so far.
using Flight = std::array<double, 5>;

Flight slope_of(const Flight& f, double stiffness) {
  const double length = std::hypot(f[0], f[1]), pull = stiffness * std::max(length - rope, 0.0);
  const double over = pull / (mass * length);
  return {f[2], f[3], -over * f[0], -gravity - over * f[1], pull};
}
Flight moved(const Flight& f, double h, const Flight& slope) {
  Flight out = f;
  for (std::size_t i = 0; i < f.size(); ++i) out[i] += h * slope[i];
  return out;
}
/// One step of the classical Runge-Kutta method.
Flight stepped(const Flight& f, double h, double stiffness) {
  const Flight a = slope_of(f, stiffness), b = slope_of(moved(f, h / 2, a), stiffness);
  const Flight c = slope_of(moved(f, h / 2, b), stiffness), d = slope_of(moved(f, h, c), stiffness);
  Flight out = f;
  for (std::size_t i = 0; i < f.size(); ++i) out[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  return out;
}
bool is_taut(const Flight& f) {
  return std::hypot(f[0], f[1]) > rope;
}

/// The exact flight: its end `after` (s) the cable has let go, the time of that, and for how long it pulled.
struct Truth {
  Flight end;
  double time, taut;
};
Truth fly(const Drop& drop, double after) {
  const double swing = std::numbers::pi * std::sqrt(mass / drop.stiffness), h = swing / 4000;
  Flight f{0, drop.slack - rope, drop.sideways, 0, 0};
  double time = 0, caught = 0;
  // A step that the cable becomes taut or slack in ends there. Both of its parts are smooth, so that all is
  // of order 4.
  const auto go = [&](bool taut) {
    while (is_taut(stepped(f, h, drop.stiffness)) == taut) f = stepped(f, h, drop.stiffness), time += h;
    double from = 0, to = h;
    for (int i = 0; i < 60; ++i) {
      const double middle = (from + to) / 2;
      (is_taut(stepped(f, middle, drop.stiffness)) == taut ? from : to) = middle;
    }
    f = stepped(f, to, drop.stiffness);
    time += to;
  };
  go(false);
  caught = time;
  go(true);
  const double taut = time - caught;
  f = {f[0] + after * f[2], f[1] + after * (f[3] - gravity * after / 2), f[2], f[3] - gravity * after, f[4]};
  return {f, time + after, taut};
}

/// Errors of a run by `substeps` to the time that the cable is taut: of its impulse, and of the momentum at
/// the end over that impulse.
struct Errors {
  double impulse, momentum;
};
Errors errors(const Drop& drop, const Settings& settings, double substeps) {
  const Truth truth = fly(drop, 0.05);
  const int steps = static_cast<int>(std::ceil(truth.time / truth.taut * substeps));
  Scene scene;
  scene.particles = {
      {.position = {0, 0, 0}, .fixed = true},
      {.position = {0, drop.slack - rope, 0}, .velocity = {drop.sideways, 0, 0}, .mass = mass}};
  scene.rods = {{.a = 0, .b = 1, .length = rope, .law = {.stiffness = drop.stiffness, .one_sided = true}}};
  Settings counted = settings;
  counted.tensions = true;
  World world(scene, counted);
  double impulse = 0;
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(world.step(truth.time / steps).unsolved, 0u);
    impulse += truth.time / steps * world.tension(0);
  }
  const Vec3 off = world.velocity(1) - Vec3{truth.end[2], truth.end[3], 0};
  return {std::abs(impulse / truth.end[4] - 1), mass * norm(off) / truth.end[4]};
}

constexpr Drop drops[] = {{0.4, 1e4}, {0.4, 1e6}, {0.05, 1e4}, {0.05, 1e6}, {0.3, 1e4, 1.5}};

// The truth of a straight drop is that of an oscillator: it leaves with the speed that it came with, and
// gravity acts meanwhile.
TEST(CatchingCables, TruthIsTheOscillators) {
  const Drop drop{0.4, 1e4};
  const Truth truth = fly(drop, 0);
  const double speed = std::sqrt(2 * gravity * drop.slack), omega = std::sqrt(drop.stiffness / mass);
  const double taut = 2 * std::atan2(speed / omega, -mass * gravity / drop.stiffness) / omega;
  EXPECT_NEAR(truth.taut, taut, 1e-12);
  EXPECT_NEAR(truth.end[3], speed, 1e-11);
  EXPECT_NEAR(truth.end[4] / (2 * mass * speed + mass * gravity * taut), 1, 1e-11);
}

// Gradient mid is as exact over the kink as elsewhere: its impulse is off by (omega h)^2/12 of the time in
// which gravity acts on the taut cable, wherever in a substep that becomes taut.
TEST(CatchingCables, MidHasTheImpulseWith500Substeps) {
  for (const Drop& drop : drops) {
    const std::string what = std::to_string(drop.slack) + " m, " + std::to_string(drop.stiffness) + " N/m";
    const Settings mid = test::direct(Gradient::mid, 1);
    EXPECT_LT(errors(drop, mid, 500).impulse, 1e-6) << what;
    EXPECT_LT(errors(drop, mid, 500).momentum, 2e-6) << what;
    for (const double substeps : {80.0, 81.3, 83.7})
      EXPECT_NEAR(std::log2(errors(drop, mid, substeps).impulse / errors(drop, mid, 2 * substeps).impulse), 2,
                  0.1)
          << what;
  }
}

// Gradient old takes the mean of the elongations at both ends. In the substep that the cable becomes taut in,
// that is off by chance, by its square.
TEST(CatchingCables, OldHasTheImpulseWith1500Substeps) {
  for (const Drop& drop : drops) {
    const Settings old = test::direct(Gradient::old, 1);
    EXPECT_LT(errors(drop, old, 1500).impulse, 1e-6) << drop.slack << " m, " << drop.stiffness << " N/m";
    EXPECT_LT(errors(drop, old, 100).impulse, 1e-4) << drop.slack << " m, " << drop.stiffness << " N/m";
  }
}

// Substeps that are composed go backwards, too, where kicks of the substep before pull the other way. In the
// substep of the kink they are off by chance, by up to (omega h)^2/8 = 1.2e-6 of the blow.
TEST(CatchingCables, ComposedSubstepsComeToTheSameImpulse) {
  for (const std::uint32_t order : {4u, 6u})
    for (const Drop& drop : drops) {
      Settings composed = test::direct(Gradient::old, 1);
      composed.time_order = order;
      EXPECT_LT(errors(drop, composed, 100).impulse, 1.2e-4) << drop.slack << " m, order " << order;
      EXPECT_LT(errors(drop, composed, 1000).impulse, 1.2e-6) << drop.slack << " m, order " << order;
    }
}

// A hoist that stops lets its load fly on, since its cables do not push. Mid projects velocities there, which
// must let go of them: as many rods as may be, of a tree or of an island with loops.
TEST(CatchingCables, DoNotPushWhereAHoistStops) {
  for (const bool has_loop : {false, true})
    for (const bool sinks : {false, true}) {
      Scene scene;
      const RodLaw cable{.one_sided = true};
      scene.particles.push_back(test::fixed({0, 0, 0}));
      for (std::uint32_t i = 1; i <= 3; ++i) {
        scene.particles.push_back(test::movable({0, -0.5 * i, 0}));
        scene.rods.push_back({.a = i - 1, .b = i, .law = cable});
      }
      if (has_loop) {
        scene.particles.push_back(test::movable({-0.05, -1.6, 0}));
        scene.particles.push_back(test::movable({0.05, -1.6, 0}));
        for (const auto& [a, b] : {std::pair{3u, 4u}, {4u, 5u}, {5u, 3u}})
          scene.rods.push_back({.a = a, .b = b});
      }
      Settings settings = test::direct(Gradient::mid, 1);
      settings.tensions = true;
      World world(scene, settings);
      const double speed = 2, dt = 0.01;
      double height = 0;
      for (int i = 0; i < 50; ++i) {
        if (!sinks) world.move_anchor(0, {0, height += speed * dt, 0});
        world.step(dt);
      }
      if (sinks) world.move_anchor(0, {0, height -= speed * dt, 0});  // else it stops
      const double before = world.velocity(3).y;
      world.step(dt);
      EXPECT_NEAR(world.velocity(3).y - before, -gravity * dt, 0.02 * gravity * dt) << has_loop << sinks;
      for (std::uint32_t rod = 0; rod < 3; ++rod) EXPECT_GE(world.tension(rod), -1e-6) << has_loop << sinks;
    }
}

/// A chain of `links` links of 0.1 m, drawn straight at an angle (rad) from the vertical, with `drawn` times
/// that length between particles. The shape at its end makes it a linkage.
Scene shaped_chain(std::uint32_t links, const RodLaw& law, double angle, double drawn = 1) {
  Scene scene;
  scene.particles.push_back(test::fixed({0, 0, 0}));
  for (std::uint32_t i = 1; i <= links; ++i) {
    const double way = 0.1 * drawn * i;
    scene.particles.push_back(
        test::movable({way * std::sin(angle), -way * std::cos(angle), drawn < 1 ? 0.003 * std::sin(i) : 0}));
    scene.rods.push_back({.a = i - 1, .b = i, .length = 0.1, .law = law});
  }
  scene.capsules.push_back({point_at(links), point_at(links), 0.01});
  return scene;
}
constexpr RodLaw rigid_cable{.one_sided = true};
const Settings in_frames{.tensions = true, .threads = 1};

// In free flight all of a chain falls by the same way, so that its uppermost cable alone would be too long.
TEST(CatchingCables, HangStillUnderWhatHasAShape) {
  constexpr std::uint32_t links = 40;
  const Scene scene = shaped_chain(links, rigid_cable, 0);
  World world(scene, in_frames);
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    for (std::uint32_t i = 0; i < links; ++i)
      ASSERT_NEAR(world.tension(i) / (-scene.gravity.y * (links - i)), 1, 1e-9) << frame << ' ' << i;
  }
  EXPECT_NEAR(world.position(links).y, -0.1 * links, 1e-9);
}

// Rods that may break are rows as cables are, which push as well. So both swing alike as long as all are
// taut.
TEST(CatchingCables, SwingAsRodsUnderWhatHasAShape) {
  constexpr std::uint32_t links = 12;
  World cables(shaped_chain(links, rigid_cable, 0.5), in_frames);
  World rods(shaped_chain(links, {.strength = 1e9}, 0.5), in_frames);
  for (int frame = 0; frame < 60; ++frame) {
    cables.step(1.0 / 60);
    rods.step(1.0 / 60);
    for (std::uint32_t i = 0; i < links; ++i) ASSERT_GT(rods.tension(i), 0) << "it is taut";
    for (std::uint32_t i = 1; i <= links; ++i)
      ASSERT_LT(norm(cables.position(i) - rods.position(i)), 1e-9) << frame << ' ' << i;
  }
}

TEST(CatchingCables, AreNeverTooLongUnderWhatHasAShape) {
  for (const std::uint32_t links : {6u, 20u, 40u})
    for (const double angle : {0.3, 1.2}) {
      World world(shaped_chain(links, rigid_cable, angle, 0.8), in_frames);
      for (int frame = 0; frame < 120; ++frame) {
        ASSERT_EQ(world.step(1.0 / 60).unsolved, 0u);
        for (std::uint32_t i = 0; i < links; ++i) {
          ASSERT_LE(norm(world.position(i + 1) - world.position(i)), 0.1 * (1 + 1e-7)) << frame << ' ' << i;
          ASSERT_GE(world.tension(i), -1e-6) << frame << ' ' << i;
        }
      }
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
