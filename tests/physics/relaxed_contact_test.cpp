// Contact, joints and springs under relaxation: rest, friction, blows, momentum, and where it converges to.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/relaxed/relaxed_stepper.hpp"
#include "plumb/measures.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/reactions.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

Settings relaxed(std::uint32_t substeps, std::uint32_t sweeps) {
  Settings settings{.method = Method::relax, .substeps = substeps, .tensions = true, .threads = 1};
  settings.stop.sweeps = sweeps;
  return settings;
}

/// A rope of capsules along x, with its lowest point `height` (m) above the ground.
Scene rope(std::uint32_t links, double height, const Surface& surface) {
  Scene scene;
  for (std::uint32_t i = 0; i <= links; ++i) {
    scene.particles.push_back(
        {.position = {0.05 * i, 0.011 + height + 0.001 * std::sin(0.7 * i), 0}, .mass = 0.05});
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.01, .surface = surface});
  }
  scene.planes.push_back({.surface = surface});
  return scene;
}

TEST(RelaxedContact, ARopeLandsLiesAndSleeps) {
  for (const Precision precision : {Precision::double_, Precision::single})
    for (const std::uint32_t links : {20u, 300u}) {
      const Scene scene = rope(links, 0.3, {.friction = 0.5});
      Settings settings = relaxed(8, 10);
      settings.precision = precision;
      World world(scene, settings);
      double before = test::energy_of(scene, world).total();
      for (int i = 0; i < 120; ++i) {
        world.step(frame);
        const double now = test::energy_of(scene, world).total();
        EXPECT_LT(now, before + 1e-4 * links * 0.05 * earth * 0.3);
        before = now;
        EXPECT_LT(test::deepest(scene, world), 1e-3) << i;
      }
      // Friction, which holds mu g h² in a substep, gives way to rods by a tenth of it in a substep's ten
      // sweeps.
      const double h = frame / 8;
      EXPECT_LT(test::stretch_of(scene, world).max, 4 * 0.5 * earth * h * h / 10 / 0.05);
      Vec3 sum;
      std::vector<Vec3> forces(scene.capsules.size());
      world.copy_contact_forces(forces);
      for (const Vec3 each : forces) sum += each;
      const double weight = (links + 1) * 0.05 * earth;
      EXPECT_LT(norm(sum - Vec3{0, weight, 0}), 1e-3 * weight);
      StepReport report;
      for (int i = 0; i < 60; ++i) report = world.step(frame);
      EXPECT_EQ(report.awake_islands, 0u);
    }
}

// It stops after v²/(2 mu g). A substep's friction is exact, and the way is that of symplectic Euler steps,
// half a substep's speed off.
TEST(RelaxedContact, FrictionStopsARope) {
  Scene scene = rope(20, 0, {.friction = 0.3});
  for (Particle& particle : scene.particles) {
    particle.position.y = 0.01;
    particle.velocity = {0, 0, 2};
  }
  World world(scene, relaxed(4, 10));
  test::run(world, frame, 90);
  const double way = 2 * 2 / (2 * 0.3 * earth), half = 0.5 * 2 * frame / 4;
  for (const std::uint32_t i : {0u, 9u, 20u}) EXPECT_NEAR(world.position(i).z, way - half, 2e-3);
}

TEST(RelaxedContact, HoldsOnASlopeUntilItIsTooSteep) {
  for (const double share : {0.99, 1.01}) {
    Scene scene = rope(12, 0, {.friction = 0.4});
    for (Particle& particle : scene.particles) particle.position.y = 0.01;
    const double angle = std::atan(0.4) * share;
    scene.gravity = earth * Vec3{0, -std::cos(angle), std::sin(angle)};
    Settings settings = relaxed(4, 10);
    settings.sleep = false;
    World world(scene, settings);
    test::run(world, frame, 240);
    const double slides = 0.5 * earth * (std::sin(angle) - 0.4 * std::cos(angle)) * 16;
    EXPECT_NEAR(world.position(6).z, std::max(0.0, slides), share < 1 ? 1e-6 : 0.02 * slides);
  }
}

TEST(RelaxedContact, BallsBounceWithTheirRestitution) {
  Scene scene;
  test::add_ball(scene, {0, 1, 0}, 0.1, 1);
  scene.capsules.back().surface = {.friction = 0, .restitution = 0.8};
  scene.planes.push_back({.surface = {.friction = 0, .restitution = 0.8}});
  World world(scene, relaxed(16, 5));
  double highest = 0;
  bool has_landed = false;
  for (int i = 0; i < 60; ++i) {
    world.step(frame);
    has_landed = has_landed || world.velocity(0).y > 0;
    if (has_landed) highest = std::max(highest, world.position(0).y);
  }
  EXPECT_NEAR(highest - 0.1, 0.64 * 0.9, 0.01);
}

// What ropes do to each other is equal and opposite, to the rounding of sums.
TEST(RelaxedContact, KeepsMomentumBetweenIslands) {
  Scene scene = rope(10, 0, {.friction = 0.5, .restitution = 0.3});
  scene.planes.clear();
  const Scene other = scene;
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (const Particle& particle : other.particles) {
    scene.particles.push_back(particle);
    scene.particles.back().position = {0.25 + 0.3 * particle.position.z, 0.1, particle.position.x - 0.2};
    scene.particles.back().velocity = {0.3, -2, 0.1};
    scene.particles.back().mass = 0.2;
  }
  for (std::uint32_t i = 1; i <= 10; ++i) {
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
    scene.capsules.push_back({.a = point_at(first + i - 1), .b = point_at(first + i), .radius = 0.01});
  }
  scene.gravity = {};
  World world(scene, relaxed(4, 10));
  const Momentum before = test::momentum_of(scene, world);
  std::uint64_t contacts = 0;
  for (int i = 0; i < 20; ++i) contacts += world.step(frame).contact_points;
  const Momentum after = test::momentum_of(scene, world);
  EXPECT_GT(contacts, 0u);
  EXPECT_LT(norm(after.linear - before.linear), 1e-12);
  // Rods and contacts push along lines between their places, but friction does so at the line's ends, a
  // radius apart: the angular momentum of what slides is off by that arm.
  EXPECT_LT(norm(after.angular - before.angular), 0.03 * norm(before.angular));
}

/// Where a struck humanoid's particles are after a while. Its rods' masses are at their ends, as they are for
/// relaxation. Without friction: directly solved it turns rods by its lever arm, and relaxed it does not.
std::vector<Vec3> struck(const Settings& settings, double seconds) {
  Scene scene = scenes::load_scene("crowd:humanoids=1,hit=1");
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    Rod& rod = scene.rods[i];
    const RodMass mass = rod_mass(scene, i, MassModel::lumped);
    scene.particles[rod.a].mass += mass.aa;
    scene.particles[rod.b].mass += mass.bb;
    rod.mass = 0;
    rod.inertia.reset();
  }
  for (Capsule& capsule : scene.capsules) capsule.surface.friction = 0;
  World world(scene, settings);
  test::run(world, frame, static_cast<int>(std::lround(seconds / frame)));
  return test::positions_of(world);
}

// The thesis's figure and ball: the more substeps and sweeps, the nearer to the direct solution of many
// substeps.
TEST(RelaxedContact, ConvergesToTheDirectSolutionOfAStruckFigure) {
  const std::vector<Vec3> truth = struck({.method = Method::direct, .substeps = 64, .threads = 1}, 0.5);
  const auto error = [&](std::uint32_t substeps) {
    const std::vector<Vec3> at = struck(relaxed(substeps, 60), 0.5);
    double most = 0;
    for (std::size_t i = 0; i < at.size(); ++i) most = std::max(most, norm(at[i] - truth[i]));
    return most;
  };
  const double coarse = error(8), fine = error(32);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(fine, 0.35 * coarse) << "of first order in the substep";
}

// Springs and ball joints pull as they do when solved directly, at rest. Visits along directions that turn
// within a substep rest off by that turn, squared: a quarter of it with half the substep.
TEST(RelaxedContact, JointsAndSpringsPullAsTheyShould) {
  Scene scene;
  scene.particles = {test::fixed({}), test::fixed({1, 0, 0})};
  MassProperties box = solid_box(2, {0.4, 0.2, 0.2});
  box.center = {0.5, -0.5, 0};
  const std::uint32_t body = add_body(scene, box);
  add_spherical(scene, point_at(0), point_on_body(scene, body, {}));
  scene.springs.push_back(
      {.a = point_at(1), .b = point_on_body(scene, body, {1, -0.5, 0}), .length = 0.3, .stiffness = 300});
  scene.drag = 8;
  const auto world_of = [&](const Settings& settings) {
    World world(scene, settings);
    test::run(world, frame, 600);
    return world;
  };
  Settings direct = test::body_settings(2);
  direct.tensions = true;
  const World solved = world_of(direct);
  for (const std::uint32_t substeps : {4u, 16u}) {
    Settings settings = relaxed(substeps, 400);
    settings.sleep = false;
    const World swept = world_of(settings);
    const double off = 16.0 / (substeps * substeps);
    for (std::uint32_t i = 0; i < swept.particle_count(); ++i)
      EXPECT_LT(norm(swept.position(i) - solved.position(i)), 4e-5 * off);
    EXPECT_LT(norm(swept.spring_force(0) - solved.spring_force(0)), 1e-2 * off);
    EXPECT_LT(norm(swept.pin_force(0) - solved.pin_force(0)), 1e-2 * off);
    EXPECT_LT(norm(test::sum_of_reactions(swept) - Vec3{0, 2 * earth, 0}), 1e-4);
  }
}

// In a heap some particle or other is always faster than what sleeps. Its ropes are not, and sleep after 5.2
// s.
TEST(RelaxedContact, HeapsOnTrianglesSleep) {
  Settings settings = relaxed(8, 5);
  settings.tensions = false;
  World world(scenes::load_scene("terrain:ropes=16,links=16,triangles=200"), settings);
  StepReport report;
  for (int i = 0; i < 360; ++i) report = world.step(frame);
  EXPECT_EQ(report.awake_islands, 0u);
}

// The figures are many clusters, each of which a thread moves. The ropes are one, which threads share.
TEST(RelaxedContact, HasTheSameBitsEverywhere) {
  for (const char* const scene : {"crowd:humanoids=30,hit=10", "terrain:ropes=24,links=12,triangles=200"})
    for (const Precision precision : {Precision::double_, Precision::single}) {
      std::vector<std::uint64_t> hashes;
      for (const Isa isa : all_isas()) {
        if (!is_supported(isa)) continue;
        for (const unsigned threads : {1u, 2u, 5u}) {
          Settings settings = relaxed(4, 5);
          settings.precision = precision;
          settings.isa = isa;
          settings.threads = threads;
          World world(scenes::load_scene(scene), settings);
          test::run(world, frame, 50);
          hashes.push_back(world.state_hash());
        }
      }
      for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes.front());
    }
}

// Thin ropes are shot through each other, up and down in turns: threads share which of them are fast, whom
// those meet, and substeps that are halved.
TEST(RelaxedContact, HasTheSameBitsOnAnyThreadsWhereShotsMeet) {
  Scene scene = scenes::load_scene("heap:ropes=24,links=12,radius=0.005,spacing=0.05");
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    scene.particles[i].velocity = {0, i / 13 % 2 == 0 ? 20.0 : -20.0, 0};
  std::vector<std::uint64_t> hashes;
  std::uint64_t halvings = 0;
  for (const unsigned threads : {1u, 2u, 5u}) {
    Settings settings = relaxed(1, 5);
    settings.threads = threads;
    World world(scene, settings);
    for (int i = 0; i < 20; ++i) halvings += world.step(frame).halvings;
    hashes.push_back(world.state_hash());
  }
  EXPECT_GT(halvings, 0u) << "something is missed, else nothing is tested";
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes.front());
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
