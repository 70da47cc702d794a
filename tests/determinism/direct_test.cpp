// Method direct: the same bits on every instruction set, on one thread and on two, and for a tree among
// others as for the same tree alone.

#include "support/direct.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "determinism/scenes.hpp"
#include "scenes/generators/generators.hpp"
#include "support/executors.hpp"
#include "support/sanitizers.hpp"
#include "support/truths.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};
constexpr Precision all_precisions[] = {Precision::single, Precision::double_};

struct Trees {
  const char* name;
  Scene scene;
};
std::vector<Trees> trees() {
  Scene forest;  // three of one shape beside an ensemble: groups of several kinds
  for (const Scene& more : {scenes::make_tree(), scenes::make_tree(), scenes::make_rods5(),
                            scenes::make_ensemble({.chains = 20, .links = 6, .vary = 0.3})}) {
    const auto first = static_cast<std::uint32_t>(forest.particles.size());
    forest.particles.insert(forest.particles.end(), more.particles.begin(), more.particles.end());
    for (Rod rod : more.rods) {
      rod.a += first;
      rod.b += first;
      forest.rods.push_back(rod);
    }
  }
  return {{"ensemble", scenes::make_ensemble({.chains = 40, .links = 8, .vary = 0.3})},
          {"chain", scenes::make_chain(50, 0.1, 10)},
          {"tree", scenes::make_tree()},
          {"forest", forest}};
}

TEST(DirectDeterminism, InstructionSetsAndThreadsGiveTheSameBits) {
  test::PoolExecutor pool(2);
  for (const Trees& t : trees())
    for (const Precision precision : all_precisions)
      for (const bool controlled : {false, true}) {
        std::uint64_t wanted = 0;
        for (const Isa isa : test::supported_isas())
          for (const unsigned threads : {1u, 2u}) {
            Settings settings = test::direct(Gradient::mid, controlled ? 1 : 2);
            settings.precision = precision;
            settings.isa = isa;
            settings.threads = threads;
            settings.executor = threads == 2 ? &pool : nullptr;
            if (controlled) {  // and trees change their gradient
              settings.accuracy = 1e-2;
              settings.method = Method::automatic;
              settings.gradient.reset();
            }
            World world(t.scene, settings);
            test::run(world, 1.0 / 60, test::scaled(controlled ? 60 : 300));
            ASSERT_TRUE(test::all_finite(world));
            if (wanted == 0) wanted = world.state_hash();
            EXPECT_EQ(world.state_hash(), wanted)
                << t.name << ", " << to_string(precision) << ", " << to_string(isa) << ", " << threads
                << " threads" << (controlled ? ", accuracy" : "");
          }
      }
}

TEST(DirectDeterminism, OtherGradientsToo) {
  test::PoolExecutor pool(2);
  Scene scene = scenes::make_ensemble({.chains = 40, .links = 8, .vary = 0.3});
  for (Rod& rod : scene.rods) rod.mass = 0.5;
  scene.drag = 0.1;
  for (const Gradient gradient : {Gradient::new_, Gradient::old})
    for (const Precision precision : all_precisions) {
      std::uint64_t wanted = 0;
      for (const Isa isa : test::supported_isas()) {
        Settings settings = test::direct(gradient, 2);
        settings.precision = precision;
        settings.isa = isa;
        settings.threads = isa == Isa::scalar ? 1 : 2;
        settings.executor = isa == Isa::scalar ? nullptr : &pool;
        World world(scene, settings);
        for (int i = 0; i < test::scaled(100); ++i) {
          if (i % 50 < 5) world.move_anchor(0, {0.002 * (i % 50), 0, 0});
          world.step(1.0 / 60);
        }
        if (wanted == 0) wanted = world.state_hash();
        EXPECT_EQ(world.state_hash(), wanted) << to_string(gradient) << to_string(isa);
      }
    }
}

// Every chain of an ensemble, in its lane, as a scene of its own, without lanes. Steps that are too long for
// some are among them: those leave their lane and come back. Not so with gradient old: trees side by side are
// cut into as many pieces as the tightest of them needs.
TEST(DirectDeterminism, ATreeAmongOthersMovesAsItDoesAlone) {
  const std::uint32_t chains = 19, links = 5;
  const Scene together =
      scenes::make_ensemble({.chains = chains, .links = links, .end_mass = 50, .vary = 0.9});
  for (const Precision precision : all_precisions)
    for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
      Settings settings = test::direct(gradient);
      settings.precision = precision;
      World world(together, settings);
      const StepReport report = test::run(world, 1.0 / 60, test::scaled(200));
      std::uint64_t halvings = 0;
      for (std::uint32_t c = 0; c < chains; ++c) {
        const std::uint32_t first = c * (links + 1);
        Scene scene;
        scene.particles.assign(together.particles.begin() + first,
                               together.particles.begin() + first + links + 1);
        for (std::uint32_t i = 0; i < links; ++i) {
          Rod rod = together.rods[c * links + i];
          rod.a -= first;
          rod.b -= first;
          scene.rods.push_back(rod);
        }
        World alone(scene, settings);
        halvings += test::run(alone, 1.0 / 60, test::scaled(200)).halvings;
        for (std::uint32_t i = 0; i <= links; ++i) {
          ASSERT_EQ(world.position(first + i), alone.position(i))
              << to_string(precision) << ", " << to_string(gradient) << ", chain " << c;
          ASSERT_EQ(world.velocity(first + i), alone.velocity(i)) << "chain " << c;
        }
      }
      EXPECT_EQ(report.halvings, halvings);
    }
}

// Looking does not change what is looked at.
TEST(DirectDeterminism, ReadingChangesNothing) {
  Scene scene = scenes::make_tree();
  for (const Gradient gradient : all_gradients) {
    World watched(scene, test::direct(gradient)), left(scene, test::direct(gradient));
    for (int i = 0; i < 30; ++i) {
      for (World* world : {&watched, &left}) {
        if (i % 5 < 2) world->move_anchor(0, {0.01 * i, 0, 0});
        world->step(1.0 / 60);
      }
      test::velocities_of(watched);
      watched.state_hash();
    }
    EXPECT_EQ(watched.state_hash(), left.state_hash()) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
