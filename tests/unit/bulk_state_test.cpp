// What is read of all particles at once is what is read of each, to the bit.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"

namespace plumb {
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
      for (const char* const scene :
           {"ensemble:chains=13,links=9", "chain:links=150", "ring", "net:width=6,height=5", "tree"})
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

}  // namespace
}  // namespace plumb
