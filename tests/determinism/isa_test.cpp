// The same scene has the same bits after a thousand steps on every instruction set, on one thread and on two.

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "determinism/scenes.hpp"
#include "support/executors.hpp"
#include "support/sanitizers.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::SharedScene;

class InstructionSets : public testing::TestWithParam<std::tuple<SharedScene, Precision>> {
 protected:
  SharedScene shared() const { return std::get<0>(GetParam()); }
  Settings settings(Isa isa) const {
    return {.method = Method::relax,
            .precision = std::get<1>(GetParam()),
            .stop = {.sweeps = shared().sweeps},
            .isa = isa,
            .threads = 1};
  }
};

TEST_P(InstructionSets, AndThreadsGiveTheSameBits) {
  const Scene scene = shared().make();
  const int steps = test::scaled(1000);
  World reference(scene, settings(Isa::scalar));
  test::run(reference, 1.0 / 60, steps);
  ASSERT_TRUE(test::all_finite(reference));

  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, test::early);
  for (const Isa isa : test::supported_isas())
    for (const unsigned threads : {1u, 2u}) {
      if (isa == Isa::scalar && threads == 1) continue;
      Settings other = settings(isa);
      other.threads = threads;
      other.executor = threads == 2 ? &eager : nullptr;
      World world(scene, other);
      ASSERT_EQ(world.info().isa, isa);
      ASSERT_EQ(world.info().parallel, threads == 2) << "the scene is too small for what is tested";
      test::run(world, 1.0 / 60, steps);
      EXPECT_EQ(world.state_hash(), reference.state_hash())
          << to_string(isa) << ", " << threads << " threads";
    }
}

INSTANTIATE_TEST_SUITE_P(Every, InstructionSets,
                         testing::Combine(testing::ValuesIn(test::shared_scenes()),
                                          testing::Values(Precision::single, Precision::double_)),
                         [](const auto& test) {
                           return std::get<0>(test.param).name + std::string("_") +
                                  std::string(to_string(std::get<1>(test.param)));
                         });

// Every other way of stepping, for shorter: gradients, Jacobi sweeps, over-relaxation, drag, sweeps that stop
// at a tolerance and moving anchors.
class Variants : public testing::TestWithParam<SharedScene> {};

TEST_P(Variants, GiveTheSameBits) {
  Scene scene = GetParam().make();
  const StopRule fixed_sweeps{.sweeps = GetParam().sweeps};
  const StopRule by_tolerance{.sweeps = 3 * GetParam().sweeps, .tolerance = 1e-3};
  struct Variant {
    const char* name;
    Settings settings;
    double drag;
  };
  const Variant variants[] = {
      {"old", {.method = Method::relax, .gradient = Gradient::old, .stop = fixed_sweeps}, 0},
      {"mid", {.method = Method::relax, .gradient = Gradient::mid, .substeps = 4, .stop = fixed_sweeps}, 0},
      {"jacobi", {.method = Method::relax, .order = SweepOrder::jacobi, .stop = fixed_sweeps}, 0},
      {"relaxed", {.method = Method::relax, .omega = 1.7, .stop = fixed_sweeps}, 0.5},
      {"equal", {.method = Method::relax, .weights = Weights::equal, .substeps = 3, .stop = fixed_sweeps}, 0},
      {"tolerance", {.method = Method::relax, .substeps = 2, .stop = by_tolerance}, 0.1},
      {"tolerance, mid",
       {.method = Method::relax, .gradient = Gradient::mid, .substeps = 2, .stop = by_tolerance},
       0.1},
  };
  std::uint32_t anchor = 0;
  while (!scene.particles[anchor].fixed) ++anchor;
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, test::early);
  for (const Variant& variant : variants)
    for (const Precision precision : {Precision::single, Precision::double_}) {
      scene.drag = variant.drag;
      std::uint64_t wanted = 0;
      for (const Isa isa : test::supported_isas())
        for (const unsigned threads : {1u, 2u}) {
          Settings settings = variant.settings;
          settings.precision = precision;
          settings.isa = isa;
          settings.threads = threads;
          settings.executor = threads == 2 ? &eager : nullptr;
          World world(scene, settings);
          for (int i = 0; i < test::scaled(40); ++i) {
            world.move_anchor(anchor, scene.particles[anchor].position + Vec3{0.001 * i, 0.002 * i, 0});
            world.step(i < 30 ? 1.0 / 60 : 1.0 / 90);
          }
          if (wanted == 0) wanted = world.state_hash();
          EXPECT_EQ(world.state_hash(), wanted) << variant.name << ", " << to_string(precision) << ", "
                                                << to_string(isa) << ", " << threads << " threads";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Every, Variants, testing::ValuesIn(test::shared_scenes()),
                         [](const auto& test) { return std::string(test.param.name); });

// A hash that did not see every number would make all of the above empty.
TEST(StateHash, ChangesWithEveryParticle) {
  const Scene scene = scenes::make_chain(5);
  const std::uint64_t hash = World(scene, {.method = Method::relax, .threads = 1}).state_hash();
  EXPECT_EQ(World(scene, {.method = Method::relax, .threads = 1}).state_hash(), hash);
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    for (double Vec3::*component : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      Scene moved = scene;
      moved.particles[i].position.*component += 1e-15;
      EXPECT_NE(World(moved, {.method = Method::relax, .threads = 1}).state_hash(), hash) << "particle " << i;
    }
  World pushed(scene, {.method = Method::relax, .threads = 1}), left(scene, {.threads = 1});
  pushed.set_force(5, {1e-9, 0, 0});
  pushed.step(1.0 / 60);
  left.step(1.0 / 60);
  EXPECT_NE(pushed.state_hash(), left.state_hash());
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
