// Worlds that are described as they are now, and begun again.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plumb/embedding/state_view.hpp"
#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 240;

Scene rope(Vec3 from, std::uint32_t rods, bool is_fixed) {
  Scene scene;
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back(
        {.position = from + Vec3{0.1 * i, 0, 0}, .mass = 0.2, .fixed = is_fixed && i == 0});
  for (std::uint32_t i = 0; i < rods; ++i) scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
  return scene;
}

/// Two bodies with a ball joint, an angle, a spring and a torsion between them.
Scene figure(Vec3 at) {
  Scene scene;
  const Vec3 below = at - Vec3{0, 0.4, 0}, middle = at - Vec3{0, 0.2, 0};
  MassProperties limb{
      .mass = 1, .center = at, .inertia = {.xx = 0.02, .yy = 0.004, .zz = 0.018, .xy = 0.001}};
  const std::uint32_t a = add_body(scene, limb);
  limb.center = below;
  const std::uint32_t b = add_body(scene, limb);
  const auto way = [&](std::uint32_t body, Vec3 from, Vec3 to) {
    return Direction{point_on_body(scene, body, from), point_on_body(scene, body, to)};
  };
  add_spherical(scene, point_on_body(scene, a, middle), point_on_body(scene, b, middle));
  scene.angles.push_back({.u = way(a, at, at + Vec3{0, 0, 1}),
                          .v = way(b, middle, below),
                          .lower = 1.2,
                          .upper = 1.9,
                          .stiffness = 2,
                          .damping = 0.1});
  scene.springs.push_back({.a = point_on_body(scene, a, at + Vec3{0.1, 0, 0}),
                           .b = point_on_body(scene, b, below + Vec3{0.1, 0, 0}),
                           .length = 0.35,
                           .stiffness = 5});
  scene.torsions.push_back({.axis = way(a, middle, middle + Vec3{1, 0, 0}),
                            .u = way(a, middle, at),
                            .v = way(b, below, middle),
                            .angle = 0.2,
                            .stiffness = 1});
  scene.hulls.push_back(box_on_body(b, {.center = below, .half_size = {0.05, 0.1, 0.03}}));
  for (Particle& each : scene.particles) each.velocity = {0.3, 0, 0.1};
  return scene;
}

void step(World& world, int times) {
  for (int i = 0; i < times; ++i) world.step(frame);
}

/// Returns how far (m) particles of a world that began anew are off those that are left of another.
double farthest(const World& world, const World& anew) {
  double most = 0;
  std::uint32_t k = 0;
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    if (world.handle<Particle>(i)) most = std::max(most, norm(world.position(i) - anew.position(k++)));
  EXPECT_EQ(k, anew.particle_count());
  return most;
}

// What was edited, added and removed is in it, with what programs changed of joints, and goes on alike.
TEST(SceneNow, GoesOnAlike) {
  Scene scene = rope({0, 0, 0}, 8, true);
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = -30});
  const Settings settings{.gradient = Gradient::mid, .substeps = 4, .tensions = true};
  World world(scene, settings);
  const Added gone = world.add(rope({0, 1, 1}, 3, false)), limbs = world.add(figure({2, 0, 0})),
              free = world.add(rope({0, 2, 2}, 5, false));
  step(world, 5);
  world.remove(gone.particle);
  world.cut(5);
  world.set_mass(free.particle + 2, 0.7);
  world.fix(free.particle);
  world.set_spring(limbs.spring, {.length = 0.3, .stiffness = 9, .damping = 0.2, .force = 0.1});
  world.set_angle(limbs.angle, {.lower = 1, .upper = 2, .target = 1.4, .stiffness = 3, .damping = 0.2});
  world.set_torsion(limbs.torsion, {.angle = 0.5, .stiffness = 2, .damping = 0.1, .torque = 0.05});
  world.set_length(free.rod + 1, 0.12);
  step(world, 20);
  const Scene now = world.scene();
  EXPECT_EQ(now.particles.size(), 9u + 8u + 6u);
  EXPECT_EQ(now.rods.size(), 7u + 12u + 5u);
  EXPECT_EQ(now.springs[0].stiffness, 9);
  EXPECT_EQ(now.torsions[0].torque, 0.05);
  EXPECT_EQ(now.angles[0].target, 1.4);
  validate(now);
  World anew(now, settings);
  EXPECT_EQ(farthest(world, anew), 0);
  EXPECT_LE(norm(anew.motion(0).velocity - world.motion(limbs.body).velocity), 1e-12);
  EXPECT_LE(norm(anew.motion(1).spin - world.motion(limbs.body + 1).spin), 1e-10);
  step(world, 1);
  step(anew, 1);
  EXPECT_LE(farthest(world, anew), 1e-11) << "which is what Newton leaves";
  step(world, 40);
  step(anew, 40);
  EXPECT_LE(farthest(world, anew), 1e-9);
  EXPECT_NEAR(anew.spring_force(0).x, world.spring_force(limbs.spring).x, 1e-7);
}

// A program need not keep a scene of its own to know the energy of a world.
TEST(SceneNow, HasTheEnergyOfTheWorld) {
  Scene scene = rope({0, 0, 0}, 8, true);
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = -30});
  World world(scene, {.gradient = Gradient::mid});
  world.add(figure({2, 0, 0}));
  const auto energy = [&] {
    const Scene now = world.scene();
    std::vector<Vec3> positions, velocities;
    for (const Particle& each : now.particles) {
      positions.push_back(each.position);
      velocities.push_back(each.velocity);
    }
    return measure_energy(now, positions, velocities).total();
  };
  step(world, 5);
  world.cut(3);
  step(world, 1);
  const double before = energy();
  step(world, 20);
  // The driven angle damps a little.
  EXPECT_NEAR(energy(), before, 2e-3 * std::abs(before));
  EXPECT_LE(energy(), before + 1e-9);
}

// Ground that platforms carry is where they are, and goes on from there.
TEST(SceneNow, HasGroundWherePlatformsAre) {
  Scene scene = rope({0, 0.02, 0}, 4, false);
  for (std::uint32_t i = 0; i < 4; ++i)
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  scene.platforms.push_back({});
  scene.boxes.push_back(
      {.center = {0, -0.5, 0}, .half_size = {2, 0.5, 2}, .motion = {.platform = 0, .belt = {0.1, 0, 0}}});
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = -5, .motion = {.platform = 0}});
  World world(scene, {});
  const double half = 0.5 * 0.2;  // rad
  for (int i = 0; i < 30; ++i) {
    world.move_platform(
        0, {.position = {0, 0.002 * i, 0}, .orientation = {std::cos(half), 0, std::sin(half), 0}});
    world.step(1.0 / 60);
  }
  World anew(world.scene(), {});
  EXPECT_EQ(anew.platform(0), world.platform(0));
  for (int i = 0; i < 30; ++i) {
    for (World* const each : {&world, &anew}) {
      each->move_platform(
          0, {.position = {0, 0.058 + 0.002 * i, 0}, .orientation = {std::cos(half), 0, std::sin(half), 0}});
      each->step(1.0 / 60);
    }
    EXPECT_LE(farthest(world, anew), 2e-4) << i;
  }
  EXPECT_GE(anew.position(0).y, 0.1);
}

// A wound rod keeps the mass matrix that it was made with, also where its inertia is given.
TEST(SceneNow, KeepsTheInertiaOfWhatIsWound) {
  Scene scene;
  scene.particles = {{.fixed = true}, {.position = {1, 0, 0}, .mass = 1}};
  scene.rods.push_back({.a = 0, .b = 1, .length = 1, .mass = 6, .inertia = 0.1});
  const Settings settings{.method = Method::direct, .gradient = Gradient::mid, .substeps = 4};
  World world(scene, settings), packed(scene, settings);
  for (int i = 0; i < 50; ++i)
    for (World* const each : {&world, &packed}) {
      each->set_length(0, 1 + 0.01 * (i + 1));
      each->step(frame);
    }
  step(world, 2);
  step(packed, 2);
  World anew(world.scene(), settings);
  packed.pack();
  for (World* const each : {&world, &packed, &anew}) step(*each, 50);
  EXPECT_LE(farthest(world, anew), 1e-9);
  EXPECT_LE(farthest(world, packed), 1e-9);
}

// A cut that waits is not done, and one that is done has ended what lay along its rod, whatever mass is left.
TEST(SceneNow, EndsWhatACutEnds) {
  Scene scene = rope({0, 0, 0}, 4, true);
  for (Rod& rod : scene.rods) rod.mass = 0.1;
  for (std::uint32_t i = 0; i < 4; ++i)
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  for (std::uint32_t i = 0; i < 3; ++i)
    scene.bends.push_back({.a = i, .b = i + 1, .c = i + 2, .stiffness = 0.1, .damping = 0.01});
  for (const bool has_shapes : {true, false}) {
    if (!has_shapes) scene.capsules.clear();
    const Settings settings{.method = Method::direct, .gradient = Gradient::mid, .substeps = 4};
    World world(scene, settings);
    step(world, 5);
    world.cut(1);
    EXPECT_EQ(world.scene().bends.size(), 3u);
    EXPECT_EQ(world.scene().capsules.size(), has_shapes ? 4u : 0u);
    step(world, 5);
    EXPECT_EQ(world.scene().bends.size(), 1u);
    EXPECT_EQ(world.scene().capsules.size(), has_shapes ? 3u : 0u);
    World anew(world.scene(), settings);
    step(world, 20);
    step(anew, 20);
    EXPECT_LE(farthest(world, anew), 1e-9);
  }
}

TEST(SceneNow, KeepsTwistsTacklesAndReels) {
  Scene scene = rope({0, 0, 0}, 6, true);
  scene.particles[1].fixed = true;
  scene.rods.erase(scene.rods.begin());
  scene.bends.push_back({.a = 1, .b = 2, .c = 3, .stiffness = 0.1});
  scene.twists.push_back({.particles = {0, 1, 2, 3, 4, 5, 6}, .stiffness = 0.01, .angle = 1});
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (int i = 0; i < 4; ++i)
    scene.particles.push_back({.position = {0, -0.2 * i, 3}, .mass = 0.5, .fixed = i == 0});
  for (std::uint32_t i = first; i < first + 3; ++i) scene.rods.push_back({.a = i, .b = i + 1});
  scene.reels.push_back({.particles = {first, first + 1, first + 2, first + 3}, .out = 0.5});
  const Settings settings{.gradient = Gradient::mid, .substeps = 8};
  World world(scene, settings);
  for (int i = 0; i < 20; ++i) {
    world.set_twist(0, 1 + 0.05 * i);
    world.set_reel(0, 0.5 - 0.005 * i);
    world.step(frame);
  }
  World anew(world.scene(), settings);
  EXPECT_NEAR(anew.twist(0), world.twist(0), 1e-12);
  EXPECT_NEAR(anew.reel_out(0), world.reel_out(0), 1e-12);
  step(world, 2);
  step(anew, 2);
  EXPECT_LE(farthest(world, anew), 1e-4);
}

TEST(SceneNow, IsRefusedWhereNothingIsEdited) {
  World world(rope({}, 3, true), {.method = Method::multipliers});
  test::expect_refusal("springs, multipliers and featherstone describe none", [&] { (void)world.scene(); });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
