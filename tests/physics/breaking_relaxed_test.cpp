// Rods that break under relaxation: where and when direct solves break them, without a change of momentum,
// and not by steps that are taken back.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/breaking.hpp"
#include "support/laws.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 120;
constexpr Gradient gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

/// A net in space, whose middle flies out of it.
Scene torn(RodLaw law, double strength) {
  Scene scene = scenes::make_net(9, 9);
  scene.gravity = {};
  for (Particle& particle : scene.particles) {
    particle.fixed = false;
    particle.mass = 0.5;
    const Vec3 from_middle = particle.position - 0.5 * scene.particles.back().position;
    if (norm(from_middle) < 0.15) particle.velocity = {0.1, 0.2, -10};
  }
  law.strength = strength;
  return test::with_law(scene, law);
}

Settings relaxed(Gradient gradient, SweepOrder order = SweepOrder::gauss_seidel) {
  Settings settings{.method = Method::relax, .gradient = gradient, .substeps = 8, .threads = 1};
  settings.order = order;
  settings.stop = {.sweeps = 20000, .tolerance = 1e-13};
  settings.tensions = true;
  return settings;
}

/// Pulls at the end of a chain by 36 N more in every second, until it breaks. Returns the frame.
int frame_of_break(World& world) {
  StepReport total;
  for (int i = 60; i < 300; ++i) {
    world.set_force(6, {0, -0.3 * i, 0});
    total += world.step(frame);
    EXPECT_EQ(total.broken_rods, test::broken_rods(world));
    if (test::broken_rods(world) > 0) return i;
  }
  return -1;
}

// What hangs from the third rod weighs 28.4 N, so that rigid rods bear 105 frames. Elastic ones swing and
// break before, but for those that gradient new damps. A break that comes two
// substeps later leaves 4 mm after ten frames of falling at 21 m/s².
TEST(BreakingRelaxed, BreakWhereAndWhenDirectSolvesBreakThem) {
  for (const RodLaw& law : test::breaking_laws)
    for (const Gradient gradient : gradients)
      for (const SweepOrder order : {SweepOrder::gauss_seidel, SweepOrder::jacobi}) {
        const Scene scene = test::hanging_chain(law);
        World direct(scene, {.method = Method::direct, .gradient = gradient, .substeps = 8, .threads = 1});
        World world(scene, relaxed(gradient, order));
        const int found = frame_of_break(world);
        EXPECT_EQ(found, frame_of_break(direct)) << to_string(gradient);
        EXPECT_TRUE(law.is_elastic() || found == 106) << found;
        EXPECT_TRUE(world.is_broken(2));
        for (int i = 0; i < 10; ++i) {
          EXPECT_EQ(world.step(frame).broken_rods, 0u);
          direct.step(frame);
        }
        EXPECT_EQ(world.tension(2), 0);
        EXPECT_TRUE(world.problems().empty());
        for (std::uint32_t i = 0; i < 7; ++i)
          EXPECT_LT(norm(world.position(i) - direct.position(i)), 4e-3) << to_string(gradient);
      }
}

// With few sweeps the pull comes late at the far end of a chain. More of them bring the break nearer to that
// of the direct solution.
TEST(BreakingRelaxed, ComeNearerWithMoreSweeps) {
  int last = 1000;
  for (const std::uint32_t sweeps : {4u, 16u, 64u}) {
    Settings settings = relaxed(Gradient::old);
    settings.stop = {.sweeps = sweeps};
    World world(test::hanging_chain({}), settings);
    const int off = std::abs(frame_of_break(world) - 106);
    EXPECT_LE(off, last) << sweeps;
    last = off;
  }
  EXPECT_LE(last, 1);
}

// Until it breaks, a world moves as one whose rods never do, to the bit.
TEST(BreakingRelaxed, MoveAsUnbreakableOnesUntilTheyBreak) {
  for (const RodLaw& law : test::breaking_laws)
    for (const Gradient gradient : gradients) {
      Settings settings = relaxed(gradient);
      settings.stop = {.sweeps = 30};
      settings.substeps = 1;
      World twin(torn(law, 1e30), settings), world(torn(law, law.is_elastic() ? 300 : 900), settings);
      int same = 0;
      for (; test::broken_rods(world) == 0 && same < 300; ++same) {
        EXPECT_EQ(twin.state_hash(), world.state_hash());
        for (std::uint32_t i = 0; same > 0 && i < twin.rod_count(); ++i)
          EXPECT_EQ(twin.tension(i), world.tension(i));
        twin.step(frame / 8);
        world.step(frame / 8);
      }
      EXPECT_GT(same, 0);
      EXPECT_LT(same, 300) << to_string(gradient) << law.stiffness;
      EXPECT_EQ(twin.state_hash(), world.state_hash()) << "a rod breaks at the end of a substep";
    }
}

double kinetic_energy(const Scene& scene, const World& world) {
  return measure_energy(scene, test::positions_of(world), test::velocities_of(world)).kinetic;
}

// Visits move both ends against each other, however few they are.
TEST(BreakingRelaxed, KeepMomentum) {
  for (const RodLaw& law : test::breaking_laws)
    for (const Gradient gradient : gradients)
      for (const SweepOrder order : {SweepOrder::gauss_seidel, SweepOrder::jacobi}) {
        const Scene scene = torn(law, 300);
        Settings settings = relaxed(gradient, order);
        settings.stop = {.sweeps = 30};
        World world(scene, settings);
        const auto momentum = [&] {
          return measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
        };
        const Vec3 first = momentum();
        StepReport total;
        for (int i = 0; i < 60; ++i) {
          total += world.step(frame);
          EXPECT_LT(norm(momentum() - first), 1e-12 * norm(first));
        }
        EXPECT_GT(total.broken_rods, 0u);
        EXPECT_LT(total.broken_rods, scene.rods.size());
        EXPECT_EQ(total.broken_rods, test::broken_rods(world));
      }
}

// A break takes what the rod holds and gives nothing. With gradient old energy is off by the square of the
// substep, as it is without a break.
TEST(BreakingRelaxed, GainNoEnergy) {
  for (const RodLaw& law : test::breaking_laws)
    for (const Gradient gradient : gradients) {
      const Scene scene = torn(law, 300);
      double gain[2] = {};
      for (const int finer : {0, 1}) {
        Settings settings = relaxed(gradient);
        settings.stop = {.sweeps = 2000, .tolerance = 1e-12};
        settings.substeps = finer != 0 ? 32 : 8;
        World world(scene, settings);
        const double start = kinetic_energy(scene, world);
        for (int i = 0; i < 15; ++i) {
          world.step(frame);
          gain[finer] = std::max(gain[finer], kinetic_energy(scene, world) / start - 1);
        }
        EXPECT_GT(test::broken_rods(world), 0u);
      }
      EXPECT_LT(gain[0], gradient == Gradient::old ? 0.02 : 1e-9) << to_string(gradient) << law.stiffness;
      EXPECT_LT(gain[1], gradient == Gradient::old ? gain[0] / 14 + 1e-9 : 1e-9);
    }
}

// An accuracy takes steps back in which rods broke. They break in those that stand alone, and once. Other
// weights do not mend them.
TEST(BreakingRelaxed, BreakInStepsThatStand) {
  std::uint64_t repeated = 0;
  for (const RodLaw& law : test::breaking_laws)
    for (const Gradient gradient : gradients) {
      Scene scene = test::hanging_chain(law);
      for (Rod& rod : scene.rods) rod.law.strength = 75;
      scene.rods[0].law.strength = 60;
      Settings accurate = relaxed(gradient);
      accurate.substeps = 1;
      accurate.accuracy = 1e-3;
      World world(scene, accurate);
      StepReport total;
      for (int i = 0; i < 150; ++i) {
        world.set_force(6, {0, -0.3 * i, 0});
        total += world.step(frame);
        EXPECT_EQ(total.broken_rods, test::broken_rods(world));
        EXPECT_LE(total.broken_rods, 1u) << "what falls pulls less";
      }
      EXPECT_TRUE(world.is_broken(0)) << "it bears most";
      repeated += total.repeated_steps;
      world.set_weights(Weights::equal);
      world.step(frame);
      EXPECT_TRUE(world.is_broken(0));
      EXPECT_LT(world.velocity(1).y, -1) << "it still falls";
    }
  EXPECT_GT(repeated, 0u);
}

// Equal islands lie side by side in lanes, the last of them more than once. Every rod is counted once.
TEST(BreakingRelaxed, AreCountedOnceInLanes) {
  for (const Precision precision : {Precision::single, Precision::double_})
    for (const std::uint32_t count : {1u, 3u, 19u}) {
      Scene scene = scenes::make_ensemble({.chains = count, .links = 6});
      for (std::size_t i = 0; i < scene.rods.size(); ++i)
        scene.rods[i].law.strength = i % 6 == 2 ? 1e-3 : 1e9;
      Settings settings = relaxed(Gradient::new_);
      settings.precision = precision;
      settings.stop = {.sweeps = 40};
      World world(scene, settings);
      const StepReport total = test::run(world, frame, 30);
      EXPECT_EQ(total.broken_rods, count);
      for (std::uint32_t i = 0; i < world.rod_count(); ++i) EXPECT_EQ(world.is_broken(i), i % 6 == 2) << i;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
