// Bodies that are relaxed keep their shape: six rods allow their mirror image, too.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/plumb.hpp"
#include "scene/barycentric.hpp"
#include "support/bodies.hpp"
#include "support/boxes.hpp"
#include "support/ragdolls.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

std::vector<double> volumes(const Scene& scene, const World& world) {
  std::vector<double> out;
  for (const Body& body : scene.bodies) {
    std::array<Vec3, 4> at;
    for (std::size_t i = 0; i < 4; ++i) at[i] = world.position(body.particles[i]);
    out.push_back(detail::signed_volume(at));
  }
  return out;
}

Settings relaxed(std::uint32_t substeps) {
  return {.method = Method::relax, .substeps = substeps, .threads = 1};
}

/// Expects that no body is inside out or frozen in any of some frames, and that poses are rotations.
void expect_whole(const Scene& scene, const Settings& settings, int frames) {
  World world(scene, settings);
  const std::vector<double> first = volumes(scene, world);
  for (int k = 0; k < frames; ++k) {
    ASSERT_EQ(world.step(frame).frozen_islands, 0u) << k;
    const std::vector<double> now = volumes(scene, world);
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
      ASSERT_GT(now[i] / first[i], 0) << "body " << i << ", frame " << k;
      const auto [w, x, y, z] = world.pose(i).orientation;
      ASSERT_NEAR(w * w + x * x + y * y + z * z, 1, 1e-12) << "body " << i << ", frame " << k;
    }
  }
}

/// Of 100 limbs that were thrown so, 40 were inside out in the end, and islands froze.
TEST(RelaxedBodies, OfThrownRagdollsAreNeverInsideOut) {
  for (const std::uint32_t substeps : {1u, 4u})
    for (int i = 0; i < 5; ++i) {
      SCOPED_TRACE(testing::Message() << substeps << " substeps, " << i);
      Scene scene;
      scene.joint_drag = 1;
      scene.planes.push_back({});
      test::add_ragdoll(scene, {0, 0.2, 0});
      for (Particle& each : scene.particles)
        each.velocity =
            Vec3{8, 4, 0} + cross(Vec3{0.3 * i - 1, 0.2 * i, 0.5 - 0.1 * i}, each.position - Vec3{0, 1, 0});
      expect_whole(scene, relaxed(substeps), 240);
    }
}

/// What sweeps leave in a long substep is no speed in the next one, which is far shorter. A figure that fell
/// so was at 40 to 90 m/s, and had gained 5e4 J.
TEST(RelaxedBodies, GainNoEnergyWhereAnAccuracyChangesSubsteps) {
  for (int i = 0; i < 3; ++i) {
    Scene scene;
    scene.joint_drag = 0.3;
    scene.planes.push_back({});
    test::add_ragdoll(scene, {0.1 * i, 1 + 0.3 * i, 0});
    Settings settings = relaxed(1);
    settings.accuracy = 1e-1;
    World world(scene, settings);
    std::vector<Vec3> x(scene.particles.size()), v(x.size());
    const auto energy = [&] {
      world.copy_positions(x);
      world.copy_velocities(v);
      return measure_energy(scene, x, v).total();
    };
    const double before = energy();
    for (int k = 0; k < 60; ++k) {
      world.step(frame);
      // Pushing out of the ground lifts it by millimetres.
      ASSERT_LT(energy(), before + 1e-3 * before) << i << ", frame " << k;
    }
  }
}

/// Planks that hang together by hinges and springs are struck by crates. Ten of fourteen were inside out.
TEST(RelaxedBodies, OfABridgeBelowCratesAreNeverInsideOut) {
  constexpr int planks = 10;
  constexpr double length = 0.42;
  Scene scene;
  const auto add_box = [&](Vec3 center, Vec3 half, double mass) {
    MassProperties box = solid_box(mass, 2.0 * half);
    box.center = center;
    const std::uint32_t body = add_body(scene, box);
    scene.hulls.push_back(box_on_body(body, {.center = center, .half_size = half}));
    return body;
  };
  for (int i = 0; i < planks; ++i) {
    add_box({(i + 0.5) * length, 0, 0}, {0.2, 0.03, 0.5}, 5);
    if (i > 0) add_revolute(scene, i - 1, i, {i * length, 0, 0}, {0, 0, 1});
  }
  for (const double z : {-0.4, 0.4})
    for (const int end : {0, planks}) {
      const Vec3 at{end * length, 0, z};
      scene.particles.push_back({.position = at, .fixed = true});
      const Point anchor = point_at(static_cast<std::uint32_t>(scene.particles.size() - 1));
      const Point plank = point_on_body(scene, end == 0 ? 0 : planks - 1, at);
      if (end == 0)
        add_spherical(scene, anchor, plank);
      else
        scene.springs.push_back({.a = anchor, .b = plank, .stiffness = 20000, .damping = 300});
    }
  for (int i = 0; i < 4; ++i) add_box({0.8 + 0.7 * i, 1.0 + 0.3 * i, 0}, {0.2, 0.2, 0.2}, 20);
  for (const std::uint32_t substeps : {1u, 8u}) expect_whole(scene, relaxed(substeps), 240);
}

/// A body and its mirror image have rods of the same lengths, and are two kinds all the same.
TEST(RelaxedBodies, OfAMirrorImageStayIt) {
  Scene scene;
  scene.gravity = {};
  add_body(scene, solid_box(1, Vec3{0.2, 0.3, 0.5}));
  add_body(scene, solid_box(1, Vec3{0.2, 0.3, 0.5}));
  for (const std::uint32_t i : scene.bodies[1].particles)
    scene.particles[i].position.x = -scene.particles[i].position.x;
  World world(scene, relaxed(1));
  const std::vector<double> first = volumes(scene, world);
  EXPECT_LT(first[0] * first[1], 0);
  world.step(frame);
  const std::vector<double> now = volumes(scene, world);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(now[i] / first[i], 1, 1e-12) << i;
}

/// What is no number freezes where it was, whatever brakes its joints.
TEST(RelaxedBodies, ThatAreNotFiniteFreezeWhereTheyWere) {
  for (const double drag : {0.0, 1.0}) {
    Scene scene;
    scene.joint_drag = drag;
    scene.planes.push_back({});
    test::add_ragdoll(scene, {0, 0.2, 0});
    World world(scene, relaxed(1));
    world.step(frame);
    std::vector<Vec3> before(world.particle_count()), after(before);
    world.copy_positions(before);
    const std::uint32_t first[] = {0};
    const Vec3 fast[] = {{1e200, 0, 0}};
    world.teleport(first, std::span(before).first(1), fast);
    EXPECT_EQ(world.step(frame).frozen_islands, 1u);
    world.step(frame);
    world.copy_positions(after);
    for (std::size_t k = 0; k < after.size(); ++k) EXPECT_LE(norm(after[k] - before[k]), 1e-15) << drag;
  }
}

// A knee that starts straight, beyond its lower limit, has no direction to bend in. Pushed along what
// rounding made of one, its rods grew 10^9 times. It stays whole, and turns no faster than it was thrown to,
// but for what takes it back to its limit.
TEST(RelaxedBodies, OfAKneeThatStartsStraightBeyondItsLimitStayWhole) {
  for (const std::uint32_t substeps : {1u, 4u})
    for (const double spin : {0.0, 6.0}) {
      SCOPED_TRACE(testing::Message() << substeps << " substeps, " << spin << " rad/s");
      Scene scene;
      std::array<std::uint32_t, 2> bodies{};
      for (std::size_t i = 0; i < 2; ++i)
        bodies[i] =
            test::add_box(scene, {0, 0.3 - 0.3 * static_cast<double>(i), 0}, {0.05, 0.14, 0.05}, 1, {});
      for (const std::uint32_t particle : scene.bodies[bodies[1]].particles)
        scene.particles[particle].velocity = cross({0, 0, spin}, scene.particles[particle].position);
      for (const Vec3 at : {Vec3{0, 0.15, 0}, Vec3{0, 0.15, 0.05}})
        scene.pins.push_back({point_on_body(scene, bodies[0], at), point_on_body(scene, bodies[1], at)});
      const auto down = [&](std::size_t i) {
        const Vec3 from = scene.bodies[bodies[i]].center;
        return Direction{point_on_body(scene, bodies[i], from),
                         point_on_body(scene, bodies[i], from - Vec3{0, 0.1, 0})};
      };
      scene.angles.push_back({.u = down(0), .v = down(1), .lower = 0.05, .upper = 2});
      World world(scene, relaxed(substeps));
      double fastest = 0;
      for (int k = 0; k < 90; ++k) {
        world.step(frame);
        fastest = std::max(fastest, norm(world.motion(bodies[1]).spin));
        ASSERT_LE(test::stretch_of(scene, world).max, 0.05) << k;
      }
      EXPECT_LE(fastest, 2 * spin + 1);
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
