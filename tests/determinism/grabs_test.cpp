// What is grabbed has the same bits on every instruction set, on one thread and on two.

#include <gtest/gtest.h>

#include <string>

#include "determinism/scenes.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "support/executors.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Pulls some particles here and there, and lets them go.
void pull(World& world, const Scene& scene, int steps) {
  std::vector<Handle<Grab>> grabs;
  std::vector<std::uint32_t> held;
  for (std::uint32_t i = 3; i < scene.particles.size();
       i += 1 + static_cast<std::uint32_t>(scene.particles.size() / 7))
    if (!scene.particles[i].fixed) held.push_back(i);
  for (const std::uint32_t particle : held)
    grabs.push_back(
        world.grab(Grab::particle(particle, world.position(particle), 1e3 * (1 + particle % 3), 3)));
  for (int frame = 0; frame < steps; ++frame) {
    for (std::size_t k = 0; k < grabs.size(); ++k)
      world.move_grab(grabs[k], world.position(held[k]) + Vec3{0.01, 0.02 * (frame % 3), -0.005});
    if (frame == steps / 2) {
      world.release(grabs.back());
      grabs.pop_back();
    }
    world.step(1.0 / 60);
  }
}

TEST(GrabbedBits, AreTheSameOnAllInstructionSetsAndThreads) {
  struct Case {
    const char* name;
    Scene scene;
  };
  const Case cases[] = {
      {"ensemble", scenes::make_ensemble({.chains = 40, .links = 16})},
      {"chain", scenes::make_chain(200, 0.1, 10)},
      {"net", scenes::make_net(16, 16)},
      {"crowd", scenes::make_crowd({.humanoids = 9, .hit = 2})},
  };
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, test::early);
  for (const auto& [name, scene] : cases)
    for (const Method method : {Method::relax, Method::direct})
      for (const Precision precision : {Precision::single, Precision::double_}) {
        Settings settings{.method = method, .precision = precision, .isa = Isa::scalar, .threads = 1};
        World reference(scene, settings);
        pull(reference, scene, 60);
        ASSERT_TRUE(test::all_finite(reference));
        for (const Isa isa : test::supported_isas())
          for (const unsigned threads : {1u, 2u}) {
            settings.isa = isa;
            settings.threads = threads;
            settings.executor = threads == 2 ? &eager : nullptr;
            World world(scene, settings);
            pull(world, scene, 60);
            EXPECT_EQ(world.state_hash(), reference.state_hash())
                << name << ' ' << to_string(method) << ' ' << to_string(isa) << ' ' << threads << " threads";
          }
      }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
