// Islands with bodies and joints under the three gradients: their orders, what they keep, and how they come
// to rest.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/mechanisms.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;
using test::Governor;

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};
constexpr double epsilon = std::numeric_limits<double>::epsilon();

Settings settings_of(Gradient gradient, std::uint32_t substeps = 1) {
  Settings out = test::body_settings(substeps);
  out.gradient = gradient;
  return out;
}

/// Three boxes on a ball joint and a hinge, free in the air, each turning about an axis of its own.
Scene thrown_boxes() {
  Scene scene;
  scene.gravity = {};
  MassProperties box = solid_box(1, {0.1, 0.2, 0.3});
  std::uint32_t bodies[3];
  for (int i = 0; i < 3; ++i) {
    box.center = {0.3 * i, 1, 0.02 * i};
    bodies[i] = add_body(scene, box);
  }
  add_spherical(scene, point_on_body(scene, bodies[0], {0.15, 1.05, 0}),
                point_on_body(scene, bodies[1], {0.15, 1.05, 0}));
  add_revolute(scene, bodies[1], bodies[2], {0.45, 1, 0}, {0, 0.6, 0.8});
  test::set_motion(scene, bodies[0], {1, 3, 0.5}, {2, 3, -1});
  test::set_motion(scene, bodies[1], {1, 3, 0.5}, {-1, 2, 4});
  test::set_motion(scene, bodies[2], {1, 3, 0.5}, {3, -2, 4});
  return scene;
}

/// The same with a spring between the outer two, of some 6 rad/s.
Scene sprung_boxes() {
  Scene scene = thrown_boxes();
  scene.springs = {{.a = point_on_body(scene, 0, {0, 1, 0}),
                    .b = point_on_body(scene, 2, {0.6, 1, 0}),
                    .length = 0.5,
                    .stiffness = 20,
                    .damping = 0.5}};
  return scene;
}

/// Two thin rods that hang on each other, and an air that takes half their speed in a second or two.
Scene rods_in_air() {
  Scene scene;
  scene.particles = {test::fixed({}), test::movable({1, 0, 0}, 0.5), test::movable({1, -1, 0.5}, 1)};
  for (std::uint32_t i = 0; i < 2; ++i)
    scene.rods.push_back({.a = i, .b = i + 1, .mass = 1, .linear_drag = 0.2, .orthogonal_drag = 0.8});
  return scene;
}

struct Named {
  const char* name;
  Scene scene;
};

std::vector<Vec3> after(const Scene& scene, const Settings& settings) {
  World world(scene, settings);
  const StepReport report = test::run(world, frame, 30);
  EXPECT_EQ(report.unsolved, 0u);
  EXPECT_EQ(report.halvings, 0u);
  return test::positions_of(world);
}

// An error that falls with h^p has the ratio 2^p between substeps and half of them, to within the next term:
// at some 0.01 rad a substep 0.05 of the exponent. The truth is by Runge-Kutta steps of order 6. Old sees air
// at velocities of a substep before, so that it is of first order there.
TEST(LinkageGradients, HaveTheirOrders) {
  const Named all[] = {{"boxes", thrown_boxes()},
                       {"boxes with a spring", sprung_boxes()},
                       {"governor", Governor::scene(true)},
                       {"rods in air", rods_in_air()}};
  for (const Named& each : all) {
    Settings finest = settings_of(Gradient::old, 64);
    finest.time_order = 6;
    const std::vector<Vec3> truth = after(each.scene, finest);
    for (const Gradient gradient : all_gradients) {
      SCOPED_TRACE(std::string(each.name) + ", " + std::string(to_string(gradient)));
      const bool sees_air_late = gradient == Gradient::old && each.scene.rods.front().orthogonal_drag > 0;
      double errors[3];
      for (const int k : {0, 1, 2})
        errors[k] = rms_distance(after(each.scene, settings_of(gradient, 16u << k)), truth);
      for (const int k : {0, 1})
        EXPECT_NEAR(std::log2(errors[k] / errors[k + 1]), gradient == Gradient::new_ || sees_air_late ? 1 : 2,
                    sees_air_late ? 0.15 : 0.05);
    }
  }
}

// Gradient mid keeps energy by construction; nothing corrects it. Each of 24,000 substeps rounds by some
// units in the last place, all to one side at worst.
TEST(LinkageGradients, MidKeepsEnergyToRounding) {
  for (const auto& [name, scene] :
       {Named{"boxes", thrown_boxes()}, Named{"governor", Governor::scene(true)}}) {
    World world(scene, settings_of(Gradient::mid, 4));
    const double first = test::energy_of(scene, world, MassModel::consistent);
    double most = 0;
    for (int i = 0; i < 6000; ++i) {
      EXPECT_EQ(world.step(frame).guarded_energy, 0u);
      most = std::max(most, std::abs(test::energy_of(scene, world, MassModel::consistent) - first));
    }
    EXPECT_LE(most, 2 * epsilon * 24000 * std::abs(first)) << name;
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-12) << name;
  }
}

// Gradient new takes energy from what turns, in every substep, and less of it in shorter ones.
TEST(LinkageGradients, NewDamps) {
  const Scene scene = thrown_boxes();
  double lost[2];
  for (const int k : {0, 1}) {
    World world(scene, settings_of(Gradient::new_, 4u << k));
    const double first = test::energy_of(scene, world, MassModel::consistent);
    double last = first;
    for (int i = 0; i < 30; ++i) {
      world.step(frame);
      const double now = test::energy_of(scene, world, MassModel::consistent);
      EXPECT_LT(now, last) << i;
      last = now;
    }
    lost[k] = first - last;
  }
  EXPECT_NEAR(std::log2(lost[0] / lost[1]), 1, 0.1);
}

// What pulls and is pulled gets opposite impulses along one line, so that momentum is kept to rounding. Old
// and mid keep angular momentum, too. With new velocities turn by a substep before they act: it changes, by
// less in shorter substeps.
TEST(LinkageGradients, KeepMomentum) {
  const Scene scene = thrown_boxes();
  for (const Gradient gradient : all_gradients) {
    double turned[2];
    for (const int k : {0, 1}) {
      World world(scene, settings_of(gradient, 4u << k));
      const Momentum first = test::momentum_of(scene, world);
      test::run(world, frame, 60);
      const Momentum last = test::momentum_of(scene, world);
      const double rounding = 10 * epsilon * 60 * (4u << k);
      EXPECT_LE(norm(last.linear - first.linear), rounding * norm(first.linear)) << to_string(gradient);
      turned[k] = norm(last.angular - first.angular);
      // About the origin, from which the boxes fly away by 3 m.
      if (gradient != Gradient::new_) {
        EXPECT_LE(turned[k], rounding * 3 * norm(first.linear)) << to_string(gradient);
      }
    }
    if (gradient == Gradient::new_) {
      EXPECT_NEAR(std::log2(turned[0] / turned[1]), 1, 0.1);
    }
  }
}

// Reactions and gravity make the change of momentum, to 1e-10 of the largest of them in a substep. So do
// those of old, but for the energy that it is given back in flight.
TEST(LinkageGradients, ReactionsMakeTheChangeOfMomentum) {
  Scene scene;
  MassProperties box = solid_box(2, {0.1, 0.2, 0.3});
  const std::uint32_t ground = test::add_fixed_body(scene);
  std::uint32_t above = ground;
  for (int i = 0; i < 3; ++i) {
    box.center = {0.15 + 0.3 * i, 0, 0};
    const std::uint32_t body = add_body(scene, box);
    add_spherical(scene, point_on_body(scene, above, {0.3 * i, 0, 0}),
                  point_on_body(scene, body, {0.3 * i, 0, 0}));
    above = body;
  }
  for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
    Settings settings = settings_of(gradient, 2);
    settings.tensions = true;
    World world(scene, settings);
    for (int i = 0; i < 60; ++i) {
      const Vec3 before = test::momentum_of(scene, world).linear;
      world.step(frame);
      Vec3 held = 6 * scene.gravity;
      for (const std::uint32_t particle : scene.bodies[ground].particles) held += world.reaction(particle);
      const Vec3 change = (1 / frame) * (test::momentum_of(scene, world).linear - before);
      EXPECT_LE(norm(change - held), 1e-10 * norm(held - 6 * scene.gravity)) << to_string(gradient) << i;
    }
  }
}

// An anchor that moves all at once takes what hangs straight below it along, and lets it stop with it. Mid
// alone would let its velocity swing about the anchor's for ever, between 0 and twice that. The matrix has
// 1e-11 of each constraint on its diagonal, which shows in velocities.
TEST(LinkageGradients, WhatHangsFollowsItsAnchor) {
  Scene scene;
  MassProperties box = solid_box(2, {0.1, 0.3, 0.2});
  box.center = {0, -0.25, 0};
  scene.particles = {test::fixed({})};
  const std::uint32_t body = add_body(scene, box);
  add_spherical(scene, point_at(0), point_on_body(scene, body, {}));
  for (const Gradient gradient : all_gradients) {
    World world(scene, settings_of(gradient, 2));
    for (int i = 0; i < 60; ++i) {
      const double speed = i < 20 || i >= 40 ? 0 : 0.5;
      world.move_anchor(0, world.position(0) + Vec3{0, speed * frame, 0});
      world.step(frame);
      EXPECT_NEAR(test::velocity_of(world, scene.bodies[body]).y, speed, 1e-10) << to_string(gradient) << i;
    }
  }
}

/// A figure, thrown so that it comes down head over heels.
Scene thrown_figure() {
  Scene scene = scenes::load_scene("humanoid:body=medium");
  for (Particle& each : scene.particles) {
    if (each.fixed) continue;
    each.asleep = false;
    each.velocity = Vec3{1, 2, 0.5} + cross({1, 0.5, 3}, each.position);
  }
  return scene;
}

// A figure that falls keeps its rods and its place above the ground, gains nothing, and comes to rest.
// Strains are those that solved contact leaves, 1e-8; the depth is that of a blow, less than the slop and a
// tenth of a millimetre.
TEST(LinkageGradients, AFigureFallsAndComesToRest) {
  const Scene scene = thrown_figure();
  for (const Gradient gradient : all_gradients) {
    SCOPED_TRACE(to_string(gradient));
    Settings settings = settings_of(gradient, 2);
    settings.sleep = true;
    World world(scene, settings);
    const double first = test::energy_of(scene, world, MassModel::consistent);
    double least = first, rise = 0, strain = 0, depth = -1;
    StepReport sum;
    for (int i = 0; i < 600; ++i) {
      sum += world.step(frame);
      const double now = test::energy_of(scene, world, MassModel::consistent);
      rise = std::max(rise, now - least);
      least = std::min(least, now);
      strain = std::max(strain, test::stretch_of(scene, world).max);
      depth = std::max(depth, test::deepest(scene, world));
    }
    EXPECT_EQ(sum.unsolved, 0u);
    EXPECT_EQ(sum.frozen_islands, 0u);
    EXPECT_EQ(sum.fell_asleep, 1u);
    EXPECT_LE(strain, 1e-7);
    EXPECT_LE(depth, settings.contact.slop + 1e-4);
    EXPECT_LE(rise, 1e-6 * first);
  }
}

// No gradient stands for old, bit for bit, and no precision changes that islands with joints are in double.
TEST(LinkageGradients, DefaultIsOld) {
  const Scene scene = thrown_figure();
  std::uint64_t hashes[3];
  for (const int k : {0, 1, 2}) {
    Settings settings = test::body_settings(2);
    if (k > 0) settings.gradient = Gradient::old;
    if (k > 1) settings.precision = Precision::single;
    World world(scene, settings);
    test::run(world, frame, 60);
    hashes[k] = world.state_hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[1], hashes[2]);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
