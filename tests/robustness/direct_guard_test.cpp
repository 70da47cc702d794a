// Where Newton fails or has nothing to hold on to: steps are cut, what cannot be solved stands still and is
// counted, and nothing becomes infinite or not a number.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/graphs.hpp"
#include "support/sanitizers.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::Kept;
using test::movable;

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};
constexpr Precision all_precisions[] = {Precision::single, Precision::double_};

template <class F>
void for_each_kind(F&& f) {
  for (const Precision precision : all_precisions)
    for (const Gradient gradient : all_gradients)
      for (const MassModel mass : {MassModel::lumped, MassModel::consistent}) {
        SCOPED_TRACE(testing::Message() << to_string(precision) << ", gradient " << to_string(gradient)
                                        << ", " << to_string(mass));
        Settings settings = test::direct(gradient, 2, mass);
        settings.precision = precision;
        f(settings);
      }
}

// A tenth of a second is far too long for links of 10 cm that swing: the step is cut as often as it takes,
// and gradient mid keeps energy through all of it.
TEST(DirectGuard, CutsStepsThatAreTooLong) {
  for (const double dt : {0.05, 0.1, 0.2}) {
    const Scene scene = scenes::make_chain(10, 0.1, 100);
    World world(scene, test::direct(Gradient::mid));
    const Kept kept = test::run_and_watch(scene, world, 60, dt);
    EXPECT_GT(kept.report.halvings, 0u) << dt;
    EXPECT_GT(kept.report.direct_substeps, 60u) << dt;
    EXPECT_EQ(kept.report.unsolved, 0u) << dt;
    EXPECT_EQ(kept.report.fallbacks, 0u) << dt;
    EXPECT_LE(kept.drift, 1e-9) << dt;
    EXPECT_LE(kept.strain, 1e-9) << dt;
  }
}

// Rods between two fixed points that are too far apart have no solution: they give way alike, what they lack
// is shared, and their neighbour moves on.
TEST(DirectGuard, RodsThatHaveNoSolutionGiveWay) {
  for_each_kind([](const Settings& settings) {
    Scene scene;
    scene.particles = {fixed({0, 0, 0}), movable({0.5, 0, 0}), fixed({1, 0, 0}), fixed({0, 0, 1}),
                       movable({0.5, 0, 1})};
    scene.rods = {{.a = 0, .b = 1, .length = 0.3}, {.a = 1, .b = 2, .length = 0.3}, {.a = 3, .b = 4}};
    World world(scene, settings);
    const StepReport report = test::run(world, 1.0 / 60, 10);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_EQ(report.elastic_substeps, 20u);
    EXPECT_LT(norm(world.position(1) - Vec3{0.5, 0, 0}), 1e-6);
    EXPECT_LT(norm(world.velocity(1)), 1e-6);
    EXPECT_LT(world.position(4).y, -0.05) << "the other falls";
  });
}

// An infinite force breaks its own tree only, in lanes too.
TEST(DirectGuard, AnInfiniteForceBreaksOneTree) {
  for_each_kind([](const Settings& settings) {
    const Scene scene = scenes::make_ensemble({.chains = 8, .links = 3});
    World world(scene, settings), other(scene, settings);
    test::run(world, 1.0 / 60, 5);
    test::run(other, 1.0 / 60, 5);
    const Vec3 before = world.position(7);
    world.set_force(7, {1e308, 1e308, 0});
    const StepReport report = test::run(world, 1.0 / 60, 2);
    test::run(other, 1.0 / 60, 2);
    EXPECT_TRUE(test::all_finite(world));
    if (settings.precision == Precision::single) {
      EXPECT_EQ(report.unsolved, 4u);
      EXPECT_EQ(world.position(7), before);
    }
    for (std::uint32_t i = 0; i < 32; ++i)
      ASSERT_TRUE(i / 4 == 1 || world.position(i) == other.position(i)) << i;
  });
}

// Heavy and light in turn, over twelve orders: never infinite; what is not unsolved has rods at their length.
TEST(DirectGuard, MassRatiosOfAMillionMillion) {
  for_each_kind([](const Settings& settings) {
    Scene scene = scenes::make_chain(12);
    for (std::size_t i = 1; i < scene.particles.size(); ++i)
      scene.particles[i].mass = i % 2 == 0 ? 1e6 : 1e-6;
    World world(scene, settings);
    double strain = 0;
    StepReport report;
    for (int i = 0; i < test::scaled(60); ++i) {
      report += world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world)) << "step " << i;
      strain = std::max(strain, test::stretch_of(scene, world).max);
    }
    EXPECT_LE(strain, settings.precision == Precision::double_ ? 1e-9 : 3e-3);
  });
}
TEST(DirectGuard, MassRatiosOfAMillion) {
  for_each_kind([](const Settings& settings) {
    Scene scene = scenes::make_chain(20);
    for (std::size_t i = 1; i < scene.particles.size(); ++i)
      scene.particles[i].mass = i % 2 == 0 ? 1e3 : 1e-3;
    World world(scene, settings);
    double strain = 0;
    for (int i = 0; i < test::scaled(10); ++i) {
      world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world)) << "step " << i;
      strain = std::max(strain, test::stretch_of(scene, world).max);
    }
    EXPECT_LE(strain, settings.precision == Precision::double_ ? 1e-9 : 3e-3);
  });
}

// Straight between two fixed points, one rod more than holds the line: no finite pull carries it, and the
// equations are singular. Whatever happens is finite, and rods are at their length as far as a solve is
// checked.
TEST(DirectGuard, AStraightLineBetweenTwoFixedPoints) {
  for_each_kind([](const Settings& settings) {
    for (const std::uint32_t n : {2u, 3u, 8u}) {
      Scene scene = scenes::make_chain(n);
      scene.particles.back().fixed = true;
      World world(scene, settings);
      for (int i = 0; i < 30; ++i) {
        world.step(1.0 / 60);
        ASSERT_TRUE(test::all_finite(world)) << n;
        ASSERT_LE(test::stretch_of(scene, world).max, settings.precision == Precision::double_ ? 3e-6 : 3e-3)
            << n;
      }
    }
  });
}

/// A chain of four particles; `ends` says how many rods to fixed points hold its first and its last: three
/// for good, two for good in a plane. The rods of the last come before those of the chain if `last_first`.
Scene held_chain(const std::array<int, 2>& ends, bool last_first, bool flat) {
  Scene scene;
  const double depth = flat ? 0 : 1;
  for (const Vec3 at :
       {Vec3{0, 0, 0}, Vec3{0.3, -0.5, 0.1 * depth}, Vec3{0.7, -0.4, -0.1 * depth}, Vec3{1, 0, 0}})
    scene.particles.push_back(movable(at));
  const auto hold = [&](std::uint32_t particle, int rods) {
    const Vec3 feet[] = {{0.5, 1, 0}, {-0.5, 1, 0.4 * depth}, {0, 1, -0.5 * depth}};
    for (int i = 0; i < rods; ++i) {
      scene.particles.push_back(fixed(scene.particles[particle].position + feet[i]));
      scene.rods.push_back({.a = particle, .b = static_cast<std::uint32_t>(scene.particles.size() - 1)});
    }
  };
  if (last_first) hold(3, ends[1]);
  hold(0, ends[0]);
  for (std::uint32_t i = 1; i < 4; ++i) scene.rods.push_back({.a = i - 1, .b = i});
  if (!last_first) hold(3, ends[1]);
  return scene;
}

// What hangs on particles that are held for good, wherever elimination begins.
TEST(DirectGuard, ChainsOnWhatIsHeldForGood) {
  const std::array<int, 2> solid[] = {{3, 0}, {3, 1}, {1, 3}, {2, 3}, {3, 3}};
  const std::array<int, 2> planar[] = {{2, 0}, {1, 2}, {2, 1}, {2, 2}};
  for (const bool flat : {false, true}) {
    for (const auto& ends : flat ? std::span<const std::array<int, 2>>(planar) : solid) {
      for (const bool last_first : {false, true}) {
        const Scene scene = held_chain(ends, last_first, flat);
        for_each_kind([&](Settings settings) {
          for (const bool accurate : {false, true}) {
            if (accurate) settings.accuracy = 0.01;
            settings.substeps = 4;
            World world(scene, settings);
            const Kept kept = test::run_and_watch(scene, world, 30);
            EXPECT_TRUE(test::all_finite(world));
            EXPECT_EQ(kept.report.unsolved, 0u) << ends[0] << " " << ends[1] << " " << last_first;
            EXPECT_LE(kept.strain, settings.precision == Precision::double_ ? 1e-9 : 1e-6);
          }
        });
      }
    }
  }
}

// Steps near the limit of gradient old do not gain energy: with heavy ends and rods of mass, whose matrix
// lets waves be faster than its diagonal says, and around a light hub, which all its spokes pull at once.
// (Tens to thousands of ranges where the bound of their frequency is too low, or steps go up to it.)
TEST(DirectGuard, OldStaysStableWhereverItsBoundIsTight) {
  const auto watch = [](const Scene& scene, std::uint32_t substeps, int steps) {
    World world(scene, test::direct(Gradient::old, substeps));
    return test::run_and_watch(scene, world, steps);
  };
  for (const double end_mass : {1.0, 100.0}) {
    for (const double rod_mass : {0.0, 1.0}) {
      Scene scene = scenes::make_chain(20, 0.1, end_mass);
      for (Rod& rod : scene.rods) rod.mass = rod_mass;
      const Kept kept = watch(scene, 4, test::scaled(600));
      EXPECT_LE(kept.drift, 1) << end_mass << ", rods of " << rod_mass;
      EXPECT_EQ(kept.report.unsolved, 0u);
    }
  }
  Scene wheel;
  wheel.gravity = {};
  wheel.particles.push_back(movable({0, 0, 0}, 4e-4));
  for (int i = 0; i < 12; ++i) {
    const double angle = 2 * std::numbers::pi * i / 12;
    const Vec3 at{std::cos(angle), std::sin(angle), 0};
    wheel.particles.push_back(movable(at));
    wheel.particles.back().velocity = cross({0, 0, 1}, at);
    wheel.rods.push_back({.a = 0, .b = static_cast<std::uint32_t>(wheel.particles.size() - 1)});
  }
  EXPECT_LE(watch(wheel, 1, test::scaled(1200)).drift, 1e-9);
}

// Without gravity and at rest, everything stays to the bit.
TEST(DirectGuard, NothingMovesWithoutGravity) {
  for_each_kind([](const Settings& settings) {
    Scene scene = scenes::make_chain(7);
    scene.gravity = {};
    World world(scene, settings);
    const StepReport report = test::run(world, 1.0 / 60, 20);
    EXPECT_EQ(report.halvings + report.unsolved, 0u);
    for (std::uint32_t i = 0; i <= 7; ++i)
      EXPECT_LE(norm(world.position(i) - scene.particles[i].position), 1e-12);
  });
}

// A rod whose ends have met has no direction; it is solved or counted, its tree finite, its neighbour whole.
TEST(DirectGuard, EndsOfARodAtOnePlace) {
  for_each_kind([](const Settings& settings) {
    Scene scene;
    scene.particles = {movable({0, 0, 0}), movable({0, 0, 0}), movable({5, 0, 0}), movable({5.5, 0, 0})};
    scene.rods = {{.a = 0, .b = 1, .length = 1, .mass = 1}, {.a = 2, .b = 3}};
    World world(scene, settings);
    for (int i = 0; i < 30; ++i) {
      world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world));
    }
    EXPECT_LE(std::abs(norm(world.position(3) - world.position(2)) - 0.5), 1e-5);
  });
}

TEST(DirectGuard, NoParticlesOrOnlyFixedOnes) {
  for_each_kind([](const Settings& settings) {
    World empty(Scene{}, settings);
    test::run(empty, 1.0 / 60, 3);
    EXPECT_EQ(empty.info().islands, 0u);
    Scene scene;
    scene.particles = {fixed({1, 2, 3}), fixed({-4, 5, 6})};
    World still(scene, settings);
    still.move_anchor(1, {7, 8, 9});
    test::run(still, 1.0 / 60, 3);
    EXPECT_EQ(still.position(0), (Vec3{1, 2, 3}));
    EXPECT_EQ(still.position(1), (Vec3{7, 8, 9}));
  });
}

// A particle alone is exact, and no accuracy asked for makes it slow: there is no length to be relative to.
TEST(DirectGuard, OneFreeParticle) {
  for_each_kind([](Settings settings) {
    Scene scene;
    scene.particles = {movable({1, 2, 3}, 1e-30)};
    for (const bool controlled : {false, true}) {
      if (controlled) settings.accuracy = 1e-3;
      World world(scene, settings);
      const StepReport report = test::run(world, 1.0 / 60, 60);
      EXPECT_NEAR(world.position(0).y, 2 - 9.81 / 2, 1e-4);
      EXPECT_LE(report.direct_substeps, 100000u);
    }
  });
}

// All the mass of a rod at its middle: nothing resists its turning, so that a free one has no equations of
// motion across. Solved or counted; finite.
TEST(DirectGuard, ARodThatNothingKeepsFromTurning) {
  for_each_kind([](const Settings& settings) {
    Scene scene;
    scene.particles = {movable({0, 0, 0}, 0, {0, 1, 0}), movable({1, 0, 0}, 0, {0, -1, 0})};
    scene.rods = {{.a = 0, .b = 1, .mass = 1, .inertia = 0}};
    World world(scene, settings);
    test::run(world, 1.0 / 60, 10);
    EXPECT_TRUE(test::all_finite(world));
  });
}

TEST(DirectGuard, StepsOfAnyLength) {
  for_each_kind([](const Settings& settings) {
    for (const double dt : {1e-10, 1e-3, 1.0, 1e4}) {
      World world(scenes::make_chain(5), settings);
      for (int i = 0; i < 5; ++i) {
        world.step(dt);
        ASSERT_TRUE(test::all_finite(world)) << "dt " << dt;
      }
    }
  });
}

// Loops are refused, with a particle of theirs.
}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
