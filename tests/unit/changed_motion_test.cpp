// How things move on where settings change while a world runs.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/boxes.hpp"
#include "support/changed_settings.hpp"
#include "support/edited_worlds.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::apart;
using test::for_changes;
using test::methods;
using test::settings_of;

constexpr double frame = 1.0 / 60;

TEST(ChangedMotion, GoOnAsAWorldThatStartsSo) {
  const Scene scene = test::swinging();
  std::vector<Settings> all;
  for (const Method method : methods)
    for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
      all.push_back(settings_of(method));
      all.back().gradient = gradient;
      all.push_back(all.back());
      all.back().substeps = 9;
    }
  all.push_back(settings_of(Method::automatic));
  all.back().accuracy = 1e-4;
  for (const Settings& settings : all) {
    SCOPED_TRACE(std::string(to_string(settings.method)) + ' ' +
                 std::string(to_string(gradient_of(settings))) + ' ' + std::to_string(settings.substeps));
    World world(scene, {.method = Method::direct, .precision = Precision::single, .gradient = Gradient::mid});
    test::run(world, frame, 20);
    Scene now = scene;
    for (std::uint32_t i = 0; i < now.particles.size(); ++i) {
      now.particles[i].position = world.position(i);
      now.particles[i].velocity = world.velocity(i);
    }
    for (std::size_t i = 0; i < now.rods.size(); ++i) now.rods[i].length = rod_length(scene, i);
    World fresh(now, settings);
    world.set_settings(settings);
    for (int i = 0; i < 3; ++i) {
      world.step(frame);
      fresh.step(frame);
      // A start also takes out of velocities what pulls on rods, where sweeps do so as they go. Errors that
      // an accuracy allows are relative to the scene as it began.
      const double most = settings.method == Method::relax ? 5e-3 : settings.accuracy ? 5e-6 : 1e-11;
      EXPECT_LE(apart(world, fresh), most) << i;
    }
  }
}

TEST(ChangedMotion, MakeNoEnergy) {
  const Scene scene = test::swinging();
  for_changes([&](Settings before, Settings after) {
    if (before.method == Method::relax) before.stop.sweeps = 1000;  // what strain holds is not made
    for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
      after.gradient = gradient;
      World world(scene, before);
      test::run(world, frame, 20);
      const double energy = test::relative_energy(scene, world);
      world.set_settings(after);
      EXPECT_EQ(test::relative_energy(scene, world), energy);
      for (int i = 0; i < 5; ++i) {
        world.step(frame);
        EXPECT_LE(test::relative_energy(scene, world) - energy, 5e-3)
            << to_string(gradient) << ", step " << i;
        EXPECT_GE(test::relative_energy(scene, world) - energy, -3e-2)
            << to_string(gradient) << ", step " << i;
      }
    }
  });
}

TEST(ChangedMotion, TakeOutWithoutABlowWhatSweepsLeft) {
  Scene scene;
  test::add_net(scene, {0, 0, 0}, 12);
  Settings settings{.method = Method::relax, .gradient = Gradient::new_, .substeps = 2, .threads = 1};
  settings.stop.sweeps = 3;
  World world(scene, settings);
  test::run(world, frame, 60);
  ASSERT_GE(test::stretch_of(scene, world).max, 0.02);
  const double before = measure_energy(scene, test::positions_of(world), test::velocities_of(world)).kinetic;
  world.set_settings({.method = Method::direct, .gradient = Gradient::mid, .substeps = 8, .threads = 1});
  world.step(frame);
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-8);
  const double after = measure_energy(scene, test::positions_of(world), test::velocities_of(world)).kinetic;
  EXPECT_LE(after, 1.5 * before + 0.05);
}

TEST(ChangedMotion, FollowASteadyAnchorWithoutABlow) {
  Scene scene;
  test::add_rope(scene, {0, 0, 0}, {1, 0, 0}, 6, true);
  scene.gravity = {};
  for (Particle& particle : scene.particles) particle.velocity = {particle.fixed ? 0.0 : 1.0, 0, 0};
  for_changes([&](const Settings& before, const Settings& after) {
    World world(scene, before);
    for (int i = 1; i <= 12; ++i) {
      world.move_anchor(0, {i * frame, 0, 0});
      if (i == 6) world.set_settings(after);
      world.step(frame);
      if (i == 1) continue;
      EXPECT_LE(norm(world.velocity(6) - Vec3{1, 0, 0}), 0.02) << i;
    }
  });
}

TEST(ChangedMotion, KeepLengthsThatChanged) {
  Scene scene;
  test::add_rope(scene, {0, 0, 0}, {0, -1, 0}, 3, true);
  Settings settings = settings_of(Method::direct);
  World world(scene, settings);
  for (int i = 1; i <= 10; ++i) {
    world.set_length(0, 0.1 + 0.01 * i);
    world.step(frame);
  }
  const Vec3 velocity = world.velocity(3);
  EXPECT_NEAR(velocity.y, -0.6, 0.01);
  settings.gradient = Gradient::old;
  world.set_settings(settings);
  world.set_length(0, 0.21);
  world.step(frame);
  EXPECT_NEAR(world.velocity(3).y, -0.6, 0.01);
  test::run(world, frame, 2);
  EXPECT_NEAR(norm(world.position(1)), 0.21, 1e-9);
  world.set_settings(settings_of(Method::relax));
  test::run(world, frame, 60);
  EXPECT_NEAR(norm(world.position(1)), 0.21, 1e-3);
}

TEST(ChangedMotion, KeepSpringsThatChanged) {
  const Scene scene = test::touching();
  for_changes([&](const Settings& before, const Settings& after) {
    World world(scene, before), plain(scene, before);
    Spring stiff = scene.springs[0];
    stiff.stiffness = 2000;
    stiff.length = 0.2;
    world.set_spring(0, stiff);
    const auto length = [&](const World& of) { return norm(of.position(24) - of.position(27)); };
    for (World* each : {&world, &plain}) each->set_settings(after);
    for (World* each : {&world, &plain}) test::run(*each, frame, 240);
    EXPECT_LE(length(world), length(plain) - 0.03);
  });
}

TEST(ChangedMotion, LetsWhatLiesLie) {
  Scene scene;
  scene.planes.push_back({});
  for (int i = 0; i < 3; ++i) test::add_box(scene, {0.01 * i, 0.1 + 0.2 * i, 0}, {0.1, 0.1, 0.1}, 1, {});
  for_changes([&](Settings before, Settings after) {
    before.sleep = after.sleep = false;
    World world(scene, before);
    test::run(world, frame, 120);
    const test::Motion motion = test::motion_of(world);
    world.set_settings(after);
    EXPECT_EQ(test::motion_of(world), motion);
    for (int i = 0; i < 30; ++i) {
      world.step(frame);
      for (std::uint32_t particle = 0; particle < world.particle_count(); ++particle)
        ASSERT_LE(norm(world.velocity(particle)), 0.03) << i;  // relaxed boxes tremble with up to half of it
    }
  });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
