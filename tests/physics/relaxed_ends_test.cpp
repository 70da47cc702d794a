// Relaxed ropes and nets on round ground, whose ends alone keep their lines out of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/measures.hpp"
#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

constexpr double link = 0.02, thickness = 0.005, ball = 0.3;

/// A level rope whose middle is above a sphere or a capsule across it, all on a plane.
Scene rope_over(bool sphere, std::uint32_t links, double height, Vec3 velocity, double friction) {
  Scene scene;
  const Surface surface{.friction = friction};
  for (std::uint32_t i = 0; i <= links; ++i) {
    scene.particles.push_back(
        {.position = {link * (i - 0.5 * links), 2 * ball + thickness + height, 1e-3 * std::sin(i)},
         .velocity = velocity,
         .mass = 0.01});
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .length = link});
    scene.capsules.push_back(
        {.a = point_at(i - 1), .b = point_at(i), .radius = thickness, .surface = surface});
  }
  const Vec3 across{0, 0, sphere ? 0 : 0.5};
  scene.ground_capsules.push_back(
      {.a = Vec3{0, ball, 0} - across, .b = Vec3{0, ball, 0} + across, .radius = ball, .surface = surface});
  scene.planes.push_back({.surface = surface});
  return scene;
}

Settings relaxed(std::uint32_t substeps, std::uint32_t sweeps, Precision precision) {
  Settings settings{.method = Method::relax, .precision = precision, .substeps = substeps, .threads = 1};
  settings.stop.sweeps = sweeps;
  return settings;
}

/// How deep the middles of a rope's lines and its particles are in round ground, at most, m.
double depth_in_round(const Scene& scene, const World& world) {
  const std::vector<Vec3> x = test::positions_of(world);
  const GroundCapsule& round = scene.ground_capsules[0];
  double most = -1;
  const auto see = [&](Vec3 p) {
    const Vec3 along = round.b - round.a;
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(dot(p - round.a, along) / square, 0.0, 1.0) : 0;
    most = std::max(most, round.radius + thickness - norm(p - round.a - t * along));
  };
  for (const Rod& rod : scene.rods) {
    see(x[rod.a]);
    see(0.5 * (x[rod.a] + x[rod.b]));
  }
  return most;
}

// Ends are kept out to within the slop of 0.5 mm, and between them a line sags by link²/(8 R) = 0.16 mm.
TEST(RelaxedEnds, KeepARopeOutOfRoundGround) {
  for (const Precision precision : {Precision::double_, Precision::single})
    for (const bool sphere : {true, false}) {
      const Scene scene = rope_over(sphere, 40, 0.05, {}, 0.8);
      World world(scene, relaxed(8, 20, precision));
      double deepest = -1;
      for (int i = 0; i < 90; ++i) {
        world.step(frame);
        deepest = std::max(deepest, depth_in_round(scene, world));
      }
      EXPECT_GT(deepest, -1e-3) << "it touches";
      EXPECT_LT(deepest, 0.5e-3 + link * link / (8 * (ball + thickness)));
    }
}

// Without friction a rope that lies on a plane glides on: nothing changes its momentum. Rounding of 720
// substeps at 1 m/s is below 1e-12 each.
TEST(RelaxedEnds, GlideWithoutFriction) {
  Scene scene = rope_over(true, 40, 0, {0, 0, 1}, 0);
  scene.ground_capsules.clear();
  double from = 0, to = 0;
  for (Particle& particle : scene.particles) {
    particle.position.y = thickness;
    from += particle.position.z;
  }
  World world(scene, relaxed(8, 10, Precision::double_));
  test::run(world, frame, 90);
  for (const Vec3 each : test::positions_of(world)) to += each.z;
  EXPECT_NEAR((to - from) / 41, 1.5, 1e-9);
  EXPECT_LT(test::deepest(scene, world), 0.5e-3);
}

// At 60 m/s a rope goes through the sphere's whole height in a step of one substep, yet it is not missed.
TEST(RelaxedEnds, DoNotLetFastLinesThrough) {
  for (const double speed : {5.0, 20.0, 60.0}) {
    const Scene scene = rope_over(true, 20, 0.05, {0, -speed, 0}, 0.5);
    World world(scene, relaxed(1, 10, Precision::double_));
    std::uint64_t missed = 0;
    for (int i = 0; i < 20; ++i) missed += world.step(frame).missed_contacts;
    EXPECT_EQ(missed, 0u) << speed;
    EXPECT_LT(depth_in_round(scene, world), 2e-3) << speed;
  }
}

// What holds a contact is kept from step to step: a rope that lies has its weight borne from the first
// substep on, so that it does not start to sink.
TEST(RelaxedEnds, BearTheWeightOfWhatLies) {
  Scene scene = rope_over(true, 40, 0, {}, 0.5);
  scene.ground_capsules.clear();
  for (Particle& particle : scene.particles) particle.position.y = thickness;
  Settings settings = relaxed(4, 10, Precision::double_);
  settings.sleep = false;
  settings.tensions = true;
  World world(scene, settings);
  test::run(world, frame, 60);
  std::vector<Vec3> forces(scene.capsules.size());
  world.copy_contact_forces(forces);
  Vec3 sum;
  for (const Vec3 each : forces) sum += each;
  const double weight = 41 * 0.01 * earth;
  EXPECT_NEAR(sum.y, weight, 1e-6 * weight);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
