// Scenes at the edge of what makes sense: nothing becomes infinite or not a number, and what is known stays
// known.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/sanitizers.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};
constexpr Precision all_precisions[] = {Precision::single, Precision::double_};

template <class F>
void for_each_kind(F&& f) {
  for (const Precision precision : all_precisions)
    for (const Gradient gradient : all_gradients)
      for (const SweepOrder order : {SweepOrder::gauss_seidel, SweepOrder::jacobi}) {
        SCOPED_TRACE(testing::Message() << to_string(precision) << ", gradient " << to_string(gradient)
                                        << ", " << to_string(order));
        f(Settings{.method = Method::relax,
                   .precision = precision,
                   .gradient = gradient,
                   .order = order,
                   .substeps = 2,
                   .stop = {.sweeps = 20},
                   .threads = 1});
      }
}

TEST(Extremes, EmptyScene) {
  for_each_kind([](const Settings& settings) {
    World world(Scene{}, settings);
    const StepReport report = test::run(world, 1.0 / 60, 10);
    EXPECT_EQ(report.stopped_by, StoppedBy::nothing);
    EXPECT_EQ(report.frozen_islands, 0u);
    EXPECT_EQ(world.particle_count(), 0u);
    EXPECT_EQ(world.info().islands, 0u);
    EXPECT_NEAR(world.time(), 1.0 / 6, 1e-15);
  });
}

TEST(Extremes, OnlyFixedParticles) {
  Scene scene;
  scene.particles = {fixed({1, 2, 3}), fixed({1, 2, 3}), fixed({-4, 5, 6})};
  for_each_kind([&](const Settings& settings) {
    World world(scene, settings);
    world.move_anchor(2, {7, 8, 9});
    EXPECT_EQ(test::run(world, 1.0 / 60, 10).frozen_islands, 0u);
    EXPECT_EQ(world.position(0), (Vec3{1, 2, 3}));
    EXPECT_EQ(world.position(1), (Vec3{1, 2, 3}));
    EXPECT_LE(norm(world.position(2) - Vec3{7, 8, 9}), 1e-5);
    EXPECT_EQ(world.velocity(2), Vec3{});
    EXPECT_EQ(world.info().islands, 0u);
  });
}

TEST(Extremes, OneFreeParticle) {
  Scene scene;
  scene.particles = {movable({1, 2, 3}, 1e-30)};
  for_each_kind([&](const Settings& settings) {
    World world(scene, settings);
    test::run(world, 1.0 / 60, 60);
    EXPECT_NEAR(world.position(0).y, 2 - 9.81 / 2, 1e-4);
  });
}

// Both ends keep their distance while the middle falls freely.
TEST(Extremes, OneRod) {
  Scene scene;
  scene.particles = {movable({0, 0, 0}, 1, {0, 0, 1}), movable({1, 0, 0}, 1, {0, 0, -1})};
  scene.rods = {{.a = 0, .b = 1}};
  for_each_kind([&](const Settings& settings) {
    World world(scene, settings);
    test::run(world, 1.0 / 60, 60);
    EXPECT_NEAR(0.5 * (world.position(0).y + world.position(1).y), -9.81 / 2, 1e-4);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-4);
  });
}

// One rod more than fills the vectors, and one less: chains and ensembles around the widths of 8 and 16
// lanes.
TEST(Extremes, LeftOversOfALane) {
  for_each_kind([](const Settings& settings) {
    for (const std::uint32_t n : {7u, 8u, 9u, 15u, 16u, 17u, 31u, 32u, 33u}) {
      const Scene chain = scenes::make_chain(n);
      World swinging(chain, settings);
      Settings enough = settings;
      enough.stop = {.sweeps = 4000, .tolerance = 1e-4};
      World held(chain, enough);
      test::run(swinging, 1.0 / 60, 10);
      EXPECT_EQ(test::run(held, 1.0 / 60, 10).stopped_by, StoppedBy::tolerance) << n;
      EXPECT_TRUE(test::all_finite(swinging)) << n;
      EXPECT_LE(test::stretch_of(chain, held).max, 1.1e-4) << n;

      // Equal chains stay equal, whichever lane they are in; they lie side by side in z.
      const Scene ensemble = scenes::make_ensemble({.chains = n, .links = 3});
      World together(ensemble, settings);
      test::run(together, 1.0 / 60, 10);
      for (std::uint32_t i = 0; i < 4 * n; ++i) {
        ASSERT_EQ(together.position(i).x, together.position(i % 4).x) << n << " chains, particle " << i;
        ASSERT_EQ(together.position(i).y, together.position(i % 4).y) << n << " chains, particle " << i;
      }
    }
  });
}

// A million metres a second, across the rods (they throw each other around) and along them (projected).
TEST(Extremes, AMillionMetresASecond) {
  for_each_kind([](const Settings& settings) {
    Scene scene = scenes::make_chain(10);
    for (std::size_t i = 1; i < scene.particles.size(); ++i)
      scene.particles[i].velocity = {1e6, i % 2 == 0 ? 1e6 : -1e6, 1e6};
    World world(scene, settings);
    for (int i = 0; i < test::scaled(300); ++i) {
      world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world)) << "step " << i;
    }
  });
}

TEST(Extremes, MassRatiosOfAMillionMillion) {
  for_each_kind([](const Settings& settings) {
    Scene scene = scenes::make_chain(12);
    for (std::size_t i = 1; i < scene.particles.size(); ++i)
      scene.particles[i].mass = i % 2 == 0 ? 1e6 : 1e-6;
    World world(scene, settings);
    for (int i = 0; i < test::scaled(300); ++i) {
      world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world)) << "step " << i;
    }
  });
}

// A rod whose ends have met has no direction. It stays as it is, neither infinite nor in anybody's way, until
// something else pulls its ends apart.
TEST(Extremes, EndsOfARodAtOnePlace) {
  for_each_kind([](const Settings& settings) {
    Scene scene;
    scene.particles = {movable({0, 0, 0}), movable({0, 0, 0}), movable({5, 0, 0}), movable({5.5, 0, 0})};
    scene.rods = {{.a = 0, .b = 1, .length = 1}, {.a = 2, .b = 3}};
    World world(scene, settings);
    for (int i = 0; i < 60; ++i) {
      world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world));
    }
    EXPECT_EQ(world.position(0), world.position(1));
    EXPECT_NEAR(world.position(0).y, -9.81 / 2, 1e-4) << "falls on";
    EXPECT_LE(std::abs(norm(world.position(3) - world.position(2)) - 0.5), 1e-5) << "the other is not harmed";
    world.set_force(1, {10, 0, 0});
    test::run(world, 1.0 / 60, 30);
    EXPECT_NEAR(norm(world.position(1) - world.position(0)), 1, 0.05) << "it takes up its length again";
  });
}

// Two particles that meet in flight, head on, and the rod between them: 100 m/s over 1 m.
TEST(Extremes, EndsOfARodThatCross) {
  for_each_kind([](const Settings& settings) {
    Scene scene;
    scene.gravity = {};
    scene.particles = {movable({0, 0, 0}, 1, {100, 0, 0}), movable({1, 0, 0}, 1, {-100, 0, 0}),
                       movable({0.5, 1, 0}, 1, {0, -200, 0})};
    scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
    World world(scene, settings);
    for (int i = 0; i < 120; ++i) {
      world.step(1.0 / 60);
      ASSERT_TRUE(test::all_finite(world));
    }
  });
}

// Islands by the hundred thousand, each alone: pairs that turn, among them some of another kind.
TEST(Extremes, AHundredThousandTinyIslands) {
  const std::uint32_t islands = test::sanitized ? 5000 : 100000;
  Scene scene;
  for (std::uint32_t i = 0; i < islands; ++i) {
    const double z = 0.1 * i;
    scene.particles.push_back(movable({0, 0, z}, 1, {0, 1, 0}));
    scene.particles.push_back(movable({1, 0, z}, i % 7 == 0 ? 2 : 1, {0, -1, 0}));
    scene.rods.push_back({.a = 2 * i, .b = 2 * i + 1});
    if (i % 11 != 0) continue;
    scene.particles.pop_back();  // a loose particle instead of a pair
    scene.rods.pop_back();
    scene.particles.push_back(movable({1, 0, z}));
  }
  World world(scene, {.method = Method::relax, .stop = {.sweeps = 5}, .threads = 1});
  EXPECT_EQ(world.info().islands, islands + (islands + 10) / 11);
  test::run(world, 1.0 / 60, 5);
  EXPECT_TRUE(test::all_finite(world));
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-9);
  for (std::uint32_t i = 24; i < islands; ++i)  // i mod 77 is what islands differ by
    ASSERT_LE(norm(world.velocity(2 * i) - world.velocity(2 * (i % 77))), 1e-12) << i;
}

// Far from the origin a float is coarse: at 1,000 m a coordinate has 6e-5 m. Rods of 1 m stay within three of
// that.
TEST(Extremes, AKilometreFromTheOrigin) {
  Scene scene = scenes::make_chain(10, 1);
  for (Particle& particle : scene.particles) particle.position += {1000, 1000, 1000};
  World world(scene, {.method = Method::relax,
                      .precision = Precision::single,
                      .stop = {.sweeps = 2000, .tolerance = 1e-4},
                      .threads = 1});
  test::run(world, 1.0 / 60, 30);
  EXPECT_TRUE(test::all_finite(world));
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-4 + 3 * 6.2e-5);
}

// Time steps from a tenth of a nanosecond to a month.
TEST(Extremes, StepsOfAnyLength) {
  for_each_kind([](const Settings& settings) {
    for (const double dt : {1e-10, 1e-3, 10.0, 1e4, 2.6e6}) {
      World world(scenes::make_chain(10), settings);
      for (int i = 0; i < 20; ++i) {
        world.step(dt);
        ASSERT_TRUE(test::all_finite(world)) << "dt " << dt;
      }
    }
  });
}

// Gradient mid with sweeps far too few: velocities would take up what is left of the violation and grow
// without bound. The guard takes over, is counted, and energy does not rise.
TEST(MidGuard, CountsAndKeepsEnergyDown) {
  const Scene scene = scenes::make_chain(50, 0.1, 100);
  World world(scene,
              {.method = Method::relax, .gradient = Gradient::mid, .stop = {.sweeps = 1}, .threads = 1});
  std::uint64_t guarded = 0;
  for (int i = 0; i < test::scaled(600); ++i) {
    guarded += world.step(1.0 / 60).mid_guarded;
    ASSERT_LE(test::relative_energy(scene, world), 0.1) << "step " << i;
  }
  EXPECT_GT(guarded, static_cast<std::uint64_t>(test::scaled(300)));

  World enough(scenes::make_chain(3),
               {.method = Method::relax, .gradient = Gradient::mid, .stop = {.sweeps = 200}, .threads = 1});
  EXPECT_EQ(test::run(enough, 1.0 / 60, 60).mid_guarded, 0u);
  World other(scene,
              {.method = Method::relax, .gradient = Gradient::old, .stop = {.sweeps = 1}, .threads = 1});
  EXPECT_EQ(test::run(other, 1.0 / 60, 10).mid_guarded, 0u) << "only gradient mid is guarded";
}

// Two ropes fall beside each other, a millimetre apart. Each has 301 shapes near the other, which is more
// than are pushed by their responses, and nothing pushes.
TEST(Extremes, ManyPlacesThatAreNearButDoNotTouch) {
  constexpr std::uint32_t rods = 300;
  constexpr double radius = 0.02, gap = 1e-3;
  Scene scene;
  for (const double z : {0.0, 2 * radius + gap}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (std::uint32_t i = 0; i <= rods; ++i) scene.particles.push_back(movable({0.1 * i, 0, z}));
    for (std::uint32_t i = first; i < first + rods; ++i) {
      scene.rods.push_back({.a = i, .b = i + 1});
      scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = radius});
    }
  }
  World world(scene, {.method = Method::direct, .threads = 1});
  const StepReport total = test::run(world, 1.0 / 60, 10);
  EXPECT_EQ(total.unsolved, 0u);
  EXPECT_EQ(total.contact_points, 0u);
  const double fallen = 0.5 * 9.81 * (10.0 / 60) * (10.0 / 60);
  for (const Vec3 at : test::positions_of(world)) EXPECT_NEAR(at.y, -fallen, 1e-9);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
