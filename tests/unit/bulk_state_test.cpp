// What is read of all particles at once is what is read of each, to the bit.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

struct Case {
  std::string scene;
  Method method;
  Precision precision = Precision::double_;
  LayoutChoice layout = LayoutChoice::automatic;
};

/// All kinds of solvers and layouts: equal trees in lanes, lines in segments, loops, nets, blocks, and what
/// touches, which another solver moves for a while.
std::vector<Case> cases() {
  std::vector<Case> out;
  for (const Precision precision : {Precision::single, Precision::double_})
    for (const Method method : {Method::direct, Method::relax})
      for (const char* const scene : {"ensemble:chains=13,links=9", "ensemble:chains=70,links=6",
                                      "chain:links=150", "ring", "net:width=6,height=5", "tree"})
        out.push_back({scene, method, precision});
  for (const LayoutChoice layout : {LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa})
    out.push_back({"net:width=9,height=7", Method::relax, Precision::double_, layout});
  for (const char* const scene :
       {"heap:ropes=3,links=6", "crowd:humanoids=3,hit=1", "graph:particles=200", "boxes", "rope", "winch"})
    out.push_back({scene, Method::automatic});
  return out;
}

TEST(BulkState, IsThatOfEachParticle) {
  for (const Case& of : cases()) {
    Scene scene = scenes::load_scene(of.scene);
    scene.particles.push_back({.position = {7, 8, 9}, .fixed = true});  // nothing hangs from it
    World world(scene, {.method = of.method, .precision = of.precision, .layout = of.layout, .threads = 1});
    std::vector<Vec3> positions(world.particle_count()), velocities(world.particle_count());
    for (int step = 0; step <= 40; ++step) {
      world.copy_positions(positions);
      world.copy_velocities(velocities);
      for (std::uint32_t i = 0; i < world.particle_count(); ++i) {
        ASSERT_EQ(positions[i], world.position(i)) << of.scene << ' ' << step << ' ' << i;
        ASSERT_EQ(velocities[i], world.velocity(i)) << of.scene << ' ' << step << ' ' << i;
      }
      for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
        if (scene.particles[i].fixed && i + 1 < scene.particles.size())
          world.move_anchor(i, world.position(i) + Vec3{0.001, 0, 0});
      world.step(1.0 / 60);
    }
  }
}

// Numbers are given anew, solvers come and go, and runs of particles end where those changed.
TEST(BulkState, IsThatOfEachParticleAfterEdits) {
  for (const Method method : {Method::direct, Method::relax}) {
    World world(scenes::load_scene("ensemble:chains=40,links=30"), {.method = method, .threads = 1});
    Scene more = scenes::load_scene("ensemble:chains=3,links=12");
    more.particles.push_back({.position = {7, 8, 9}, .fixed = true});  // nothing hangs from it
    const Scene wide = scenes::load_scene("net:width=9,height=40");
    std::vector<Vec3> positions, velocities;
    const auto compare = [&](const char* what) {
      positions.resize(world.particle_count());
      velocities.resize(world.particle_count());
      world.copy_positions(positions);
      world.copy_velocities(velocities);
      for (std::uint32_t i = 0; i < world.particle_count(); ++i) {
        const bool is_there = bool(world.handle<Particle>(i));
        ASSERT_EQ(positions[i], is_there ? world.position(i) : Vec3{}) << what << ' ' << i;
        ASSERT_EQ(velocities[i], is_there ? world.velocity(i) : Vec3{}) << what << ' ' << i;
      }
    };
    world.step(1.0 / 60);
    world.remove(31 * 7 + 3);
    world.remove(31 * 20 + 3);
    compare("removed");
    const Added first = world.add(more);
    world.add(wide);
    compare("added");
    world.cut(31 * 11);
    world.fix(31 * 12 + 5);
    world.step(1.0 / 60);
    compare("cut");
    world.remove(first.particle + 1);
    world.add(more);
    world.step(1.0 / 60);
    compare("added again");
  }
}

/// Bodies are found several at a time, and the last few one by one. Strains of a few sweeps take more
/// iterations for some of them than for others.
// Numbers of what was added and removed again are nowhere, also in a world that only heard of that.
TEST(BulkState, IsZeroWhereNothingIs) {
  Scene scene, added;
  scene.particles = {{.position = {1, 0, 0}, .mass = 1}};
  for (std::uint32_t i = 0; i < 10; ++i)
    added.particles.push_back({.position = {1.0 * i, 1, 0}, .mass = 1, .fixed = i == 0});
  for (std::uint32_t i = 1; i < 10; ++i) added.rods.push_back({.a = i - 1, .b = i});
  const Settings settings{.method = Method::direct, .threads = 1};
  World world(scene, settings), other(scene, settings);
  world.add(added);
  world.remove(5);
  std::vector<std::byte> snapshot(world.snapshot_size());
  world.save(snapshot);
  other.restore(snapshot);
  world.set_settings({.method = Method::direct, .gradient = Gradient::old, .threads = 1});
  for (World* const each : {&world, &other}) {
    std::vector<Vec3> positions(each->particle_count(), {9, 9, 9}), velocities = positions;
    ASSERT_EQ(positions.size(), 11u);
    each->copy_positions(positions);
    each->copy_velocities(velocities);
    for (std::size_t i = 1; i < positions.size(); ++i) {
      EXPECT_EQ(positions[i], Vec3{}) << i;
      EXPECT_EQ(velocities[i], Vec3{}) << i;
    }
  }
}

TEST(BulkState, IsThatOfEachBody) {
  Scene scene;
  for (std::uint32_t i = 0; i < 21; ++i) {
    const Vec3 at{1.0 * i, 0, 0}, spin{1, 5.0 * (i % 3), 20.0 * (i % 4)};
    const std::uint32_t body =
        add_body(scene, {.mass = 1, .center = at, .inertia = {.xx = 0.02, .yy = 0.025, .zz = 0.03}});
    for (const std::uint32_t particle : scene.bodies[body].particles)
      scene.particles[particle].velocity = cross(spin, scene.particles[particle].position - at);
  }
  for (const Method method : {Method::direct, Method::relax}) {
    Settings settings{.method = method, .threads = 1};
    if (method == Method::relax) settings.stop.sweeps = 2;
    World world(scene, settings);
    std::vector<Pose> poses(world.body_count());
    std::vector<BodyMotion> motions(world.body_count());
    for (int step = 0; step <= 20; ++step) {
      world.copy_poses(poses);
      world.copy_motions(motions);
      for (std::uint32_t i = 0; i < world.body_count(); ++i) {
        ASSERT_EQ(poses[i], world.pose(i)) << step << ' ' << i;
        ASSERT_EQ(motions[i], world.motion(i)) << step << ' ' << i;
      }
      world.step(1.0 / 60);
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
