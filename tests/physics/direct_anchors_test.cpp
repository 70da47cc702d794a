// Fixed particles that are moved, and what method direct hangs from them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// A rigid body on a pivot that goes along x, in its angle t from straight down: I t'' = -m c g sin(t); a
/// jump of the pivot's speed by dv changes t' by -(m c/I) cos(t) dv. `reach` is I/(m c) in m. Classical
/// Runge-Kutta with steps of 0.1 ms: 1e-12.
struct Pendulum {
  double reach;
  double angle = 0, rate = 0, pivot_speed = 0;

  void advance(double speed, double duration) {
    rate -= std::cos(angle) * (speed - pivot_speed) / reach;
    pivot_speed = speed;
    const int n = static_cast<int>(std::ceil(duration / 1e-4));
    const double h = duration / n;
    const auto pull = [&](double a) { return -9.81 / reach * std::sin(a); };
    for (int i = 0; i < n; ++i) {
      const double a1 = rate, r1 = pull(angle), a2 = rate + h / 2 * r1, r2 = pull(angle + h / 2 * a1),
                   a3 = rate + h / 2 * r2, r3 = pull(angle + h / 2 * a2), a4 = rate + h * r3,
                   r4 = pull(angle + h * a3);
      angle += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      rate += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
    }
  }
};

/// The end of a rod of 0.6 m after half a second in which its pivot goes back and forth in straight pieces
/// of 1/30 s, against the closed equation of motion. m.
double error(const Rod& rod, double mass, double reach, Gradient gradient, std::uint32_t substeps) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({0, -0.6, 0}, mass)};
  scene.rods = {rod};
  World world(scene, test::direct(gradient, substeps));
  Pendulum pendulum{.reach = reach};
  const double dt = 1.0 / 30;
  double x = 0;
  for (int i = 1; i <= 15; ++i) {
    const double next = 0.2 * std::sin(0.4 * i);
    world.move_anchor(0, {next, 0, 0});
    world.step(dt);
    pendulum.advance((next - x) / dt, dt);
    x = next;
  }
  return norm(world.position(1) -
              Vec3{x + 0.6 * std::sin(pendulum.angle), -0.6 * std::cos(pendulum.angle), 0});
}

// Second order, with a point on a massless rod and with a rod that has mass up to the pivot.
TEST(DirectAnchors, PendulumOnAMovingPivot) {
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const Rod massless{.a = 0, .b = 1}, uniform{.a = 0, .b = 1, .mass = 3};
    const double point = error(massless, 1, 0.6, gradient, 8), body = error(uniform, 0, 0.4, gradient, 8);
    EXPECT_LE(point, 1e-3) << to_string(gradient);
    EXPECT_LE(body, 1e-3) << to_string(gradient);
    EXPECT_NEAR(point / error(massless, 1, 0.6, gradient, 16), 4, 0.5) << to_string(gradient);
    EXPECT_NEAR(body / error(uniform, 0, 0.4, gradient, 16), 4, 0.5) << to_string(gradient);
  }
}

// An anchor that stops dead leaves no velocity along rods that gradient mid would carry from substep to
// substep: they stay below a hundredth of the anchor's speed. Nor does one that starts.
TEST(DirectAnchors, GradientMidDoesNotRing) {
  for (const double rod_mass : {0.0, 1.0}) {
    Scene scene = scenes::make_chain(5);
    for (Rod& rod : scene.rods) rod.mass = rod_mass;
    World world(scene, test::direct(Gradient::mid, 8));
    for (int i = 1; i <= 60; ++i) {
      if (i <= 20) world.move_anchor(0, {0, 0.03 * i, 0.02 * i});
      world.step(1.0 / 60);
      if (i <= 20) continue;
      Scene now = scene;
      for (std::uint32_t p = 0; p <= 5; ++p) now.particles[p].position = world.position(p);
      EXPECT_LE(test::largest_stretching_rate(now, test::velocities_of(world)), 0.02)
          << "step " << i << ", rods of " << rod_mass << " kg";
    }
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-9);
  }
}

// An anchor that pulls a straight line beyond its length leaves nothing to search for: steps end, and the
// line is named and evenly strained.
TEST(DirectAnchors, ThatPullTooFarEndTheirSteps) {
  for (const std::uint32_t rods : {2u, 3u, 7u}) {
    Scene scene;
    for (std::uint32_t i = 0; i <= rods; ++i) {
      const Vec3 at = (i / norm(Vec3{0.3, 0.8, -0.2})) * Vec3{0.3, 0.8, -0.2};
      scene.particles.push_back({.position = at, .mass = 1, .fixed = i == 0 || i == rods});
      if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
    }
    World world(scene, {});
    for (int i = 1; i <= 60; ++i) {
      world.move_anchor(rods, (1 + 0.1 * i / 60) * scene.particles[rods].position);
      world.step(1.0 / 60);
    }
    EXPECT_FALSE(world.problems().empty());
    for (std::uint32_t i = 0; i < rods; ++i)
      EXPECT_NEAR(norm(world.position(i) - world.position(i + 1)), 1.1, 1e-3) << rods << " rod " << i;
  }
}

// An anchor that goes on at constant speed is an inertial frame: Galileo. The path's rounding, 1e-16 m over
// 1/60 s, grows by the motion's own divergence.
TEST(DirectAnchors, AtConstantSpeedAreAnInertialFrame) {
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    const Scene still = scenes::make_chain(4);
    Scene moving = still;
    for (Particle& particle : moving.particles)
      if (!particle.fixed) particle.velocity.z = 1.5;
    World a(still, test::direct(gradient, 4)), b(moving, test::direct(gradient, 4));
    for (int i = 1; i <= 60; ++i) {
      b.move_anchor(0, {0, 0, i * 1.5 / 60});
      a.step(1.0 / 60);
      b.step(1.0 / 60);
    }
    for (std::uint32_t i = 0; i <= 4; ++i)
      EXPECT_LE(norm(b.position(i) - a.position(i) - Vec3{0, 0, 1.5}), 1e-9)
          << to_string(gradient) << ", particle " << i;
  }
}

// A lane that is left over rests at a velocity. It must not take from its neighbours what the mass of rods
// passes on from an anchor.
TEST(DirectAnchors, MoveEqualTreesAsTheyMoveOne) {
  const auto pendulums = [](std::uint32_t count) {
    Scene scene;
    for (std::uint32_t i = 0; i < count; ++i) {
      scene.particles.insert(scene.particles.end(), {test::fixed({}), test::movable({0.3, -0.2, 0.1}, 0.5),
                                                     test::movable({0.5, -0.3, 0.3}, 1)});
      scene.rods.insert(scene.rods.end(), {{.a = 3 * i, .b = 3 * i + 1, .mass = 0.3},
                                           {.a = 3 * i + 1, .b = 3 * i + 2, .mass = 0.3}});
    }
    return scene;
  };
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World one(pendulums(1), test::direct(gradient, 1)), three(pendulums(3), test::direct(gradient, 1));
    for (int step = 0; step < 10; ++step) {
      const Vec3 to = 0.01 * std::sin(0.3 * step) * Vec3{0.3, 0.2, -0.2};
      one.move_anchor(0, to);
      for (const std::uint32_t anchor : {0u, 3u, 6u}) three.move_anchor(anchor, to);
      one.step(1.0 / 60);
      three.step(1.0 / 60);
      for (const std::uint32_t i : {1u, 2u})
        EXPECT_EQ(three.position(i + 3), one.position(i)) << to_string(gradient) << ", step " << step;
    }
  }
}

TEST(DirectAnchors, AreExactlyWhereTheyWereSent) {
  World world(scenes::make_chain(5), test::direct(Gradient::mid, 3));
  for (int i = 1; i <= 60; ++i) {
    const Vec3 target{0.3 * std::sin(0.1 * i), 0.01 * i, 0.7 * std::cos(0.13 * i) - 0.7};
    world.move_anchor(0, {5, 5, 5});
    world.move_anchor(0, target);
    world.step(1.0 / 60);
    ASSERT_EQ(world.position(0), target) << "step " << i;
    ASSERT_LE(test::stretch_of(scenes::make_chain(5), world).max, 1e-9);
  }
}

// A net that is raised steadily goes as fast as its anchors, by its velocities, too; a force that is set then
// does not jerk it.
TEST(DirectAnchors, CarryIslandsWithLoops) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
    Scene scene;  // a ladder that hangs from two anchors
    scene.gravity = {};
    for (std::uint32_t i = 0; i < 12; ++i) {
      const Vec3 at{0.1 * (i % 2), -0.1 * (i / 2), 0};
      scene.particles.push_back(i < 2 ? test::fixed(at) : test::movable(at));
      if (i >= 2) scene.rods.push_back({.a = i - 2, .b = i});
      if (i >= 2 && i % 2 == 1) scene.rods.push_back({.a = i - 1, .b = i});
    }
    Settings settings = test::direct(gradient, 2);
    settings.tensions = true;
    World world(scene, settings);
    double most = 0;
    for (int i = 1; i <= 60; ++i) {
      for (std::uint32_t p = 0; p < scene.particles.size(); ++p)
        if (scene.particles[p].fixed)
          world.move_anchor(p, scene.particles[p].position + Vec3{0, 0.02 * i, 0});
      if (i > 40) world.set_force(world.particle_count() - 1, {0, 1e-6 * i, 0});
      world.step(0.01);
      if (i > 42)
        for (std::uint32_t rod = 0; rod < world.rod_count(); ++rod)
          most = std::max(most, std::abs(world.tension(rod)));
    }
    for (std::uint32_t p = 0; p < scene.particles.size(); ++p)
      if (!scene.particles[p].fixed) {
        EXPECT_NEAR(world.velocity(p).y, 2, 1e-3) << to_string(gradient);
      }
    EXPECT_LT(most, 1) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
