// Fixed particles that are moved, and what hangs from them.

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <string>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/sanitizers.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

struct Variant {
  Gradient gradient;
  Precision precision;
  std::uint32_t substeps;
};

void PrintTo(const Variant& v, std::ostream* out) {
  *out << "gradient " << to_string(v.gradient) << ", " << to_string(v.precision) << ", " << v.substeps
       << " substeps";
}

class Anchors : public testing::TestWithParam<Variant> {
 protected:
  Settings settings() const {
    return {.method = Method::relax,
            .precision = GetParam().precision,
            .gradient = GetParam().gradient,
            .substeps = GetParam().substeps,
            .stop = {.sweeps = 40},
            .threads = 1};
  }
  /// As the world stores it.
  Vec3 rounded(Vec3 v) const {
    if (GetParam().precision == Precision::double_) return v;
    // volatile: g++ 12 takes a pair of conversions to float and back for nothing when it vectorises them.
    const volatile float x = static_cast<float>(v.x), y = static_cast<float>(v.y),
                         z = static_cast<float>(v.z);
    return {x, y, z};
  }
};

// However a path's steps round, the anchor stands at the end of each where it was told to.
TEST_P(Anchors, AreExactlyWhereTheyWereSent) {
  World world(scenes::make_chain(5), settings());
  for (int i = 1; i <= 120; ++i) {
    const Vec3 target = rounded({0.3 * std::sin(0.1 * i), 0.01 * i, 0.7 * std::cos(0.13 * i)});
    world.move_anchor(0, target);
    world.step(1.0 / 60);
    ASSERT_EQ(world.position(0), target) << "step " << i;
  }
}

// A move lasts one step; then the anchor rests, and what hangs from it comes to rest below it.
TEST_P(Anchors, CarryTheirChainAndThenRest) {
  Scene scene = scenes::make_chain(3);
  scene.drag = 8;
  World world(scene, settings());
  for (int i = 1; i <= 120; ++i) {
    world.move_anchor(0, {i / 60.0, 0, 0});  // 1 m/s for 2 s
    world.step(1.0 / 60);
  }
  const Vec3 reached = world.position(0);
  EXPECT_NEAR(reached.x, 2, 1e-5);
  EXPECT_GT(world.position(3).x, 1.6) << "left behind";
  EXPECT_LT(world.position(3).x, 2) << "trails";
  test::run(world, 1.0 / 60, 600);
  EXPECT_EQ(world.position(0), reached);
  for (std::uint32_t i = 1; i <= 3; ++i) {
    EXPECT_NEAR(world.position(i).x, 2, 1e-4);
    EXPECT_NEAR(world.position(i).y, -0.1 * i, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Anchors,
                         testing::Values(Variant{Gradient::new_, Precision::double_, 1},
                                         Variant{Gradient::new_, Precision::single, 8},
                                         Variant{Gradient::old, Precision::double_, 8},
                                         Variant{Gradient::old, Precision::single, 3},
                                         Variant{Gradient::mid, Precision::double_, 8},
                                         Variant{Gradient::mid, Precision::single, 8}),
                         [](const auto& test) {
                           return std::string(to_string(test.param.gradient)) +
                                  std::string(to_string(test.param.precision)) +
                                  std::to_string(test.param.substeps);
                         });

// Galileo: a chain whose anchor moves at constant speed swings as one that moves with it, seen from the
// anchor.
TEST(MovingAnchor, IsAnInertialFrame) {
  const double speed = 1.5, dt = 1.0 / 60;
  Scene still = scenes::make_chain(3);
  Scene moving = still;
  for (Particle& particle : moving.particles)
    if (!particle.fixed) particle.velocity.z = speed;
  // Across the rods, so that initial velocities pull on none but the first, whose anchor moves along.
  const Settings settings{.method = Method::relax,
                          .gradient = Gradient::old,
                          .substeps = 16,
                          .stop = {.sweeps = 2000, .tolerance = 1e-12},
                          .threads = 1};
  World a(still, settings), b(moving, settings);
  for (int i = 1; i <= 60; ++i) {
    b.move_anchor(0, {0, 0, i * dt * speed});
    a.step(dt);
    b.step(dt);
  }
  // Sweeps that stop at 1e-12 in 960 substeps.
  for (std::uint32_t i = 0; i <= 3; ++i)
    EXPECT_LE(norm(b.position(i) - a.position(i) - Vec3{0, 0, speed}), 1e-9) << "particle " << i;
}

// An anchor that holds several chains, in several blocks, is one anchor.
TEST(MovingAnchor, MovesEverythingThatHangsFromIt) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0})};
  for (std::uint32_t k = 1; k <= 3; ++k) {  // chains of 1, 2 and 3 links: islands of different shapes
    std::uint32_t last = 0;
    for (std::uint32_t i = 1; i <= k; ++i) {
      scene.particles.push_back(test::movable({0.1 * k, -1.0 * i, 0}));
      const auto id = static_cast<std::uint32_t>(scene.particles.size() - 1);
      scene.rods.push_back({.a = last, .b = id});
      last = id;
    }
  }
  scene.drag = 5;
  World world(scene, {.method = Method::relax, .substeps = 4, .stop = {.sweeps = 100}, .threads = 1});
  for (int i = 1; i <= 60; ++i) {
    world.move_anchor(0, {0, 0, i / 60.0});
    world.step(1.0 / 60);
  }
  test::run(world, 1.0 / 60, 1200);
  for (std::uint32_t i = 1; i < scene.particles.size(); ++i) EXPECT_NEAR(world.position(i).z, 1, 1e-3) << i;
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-3);
}

// Moved again and again before a step, each anchor goes where it was sent last. Looking through all of them
// for each would take some 10^10 steps.
TEST(MovingAnchor, MayBeOneOfVeryMany) {
  const std::uint32_t pairs = test::sanitized ? 2000 : 100000;
  Scene scene;
  for (std::uint32_t i = 0; i < pairs; ++i) {
    scene.particles.push_back(test::fixed({0, 0, 0.1 * i}));
    scene.particles.push_back(test::movable({0, -1, 0.1 * i}));
    scene.rods.push_back({.a = 2 * i, .b = 2 * i + 1});
  }
  World world(scene, {.method = Method::relax, .substeps = 2, .stop = {.sweeps = 5}, .threads = 1});
  const auto target = [&](std::uint32_t i) {
    return scene.particles[2 * i].position + Vec3{0.01 + i % 3, 0, 0};
  };
  for (int step = 0; step < 2; ++step) {
    for (const double wrong : {5.0, 0.0})
      for (std::uint32_t i = 0; i < pairs; ++i) world.move_anchor(2 * i, target(i) + Vec3{0, wrong, 0});
    world.step(1.0 / 60);
    for (std::uint32_t i = 0; i < pairs; ++i) ASSERT_EQ(world.position(2 * i), target(i)) << i;
  }
  // In the second step they stood still. Resting anchors leave nothing behind: equal pairs stay equal.
  world.step(1.0 / 60);
  for (std::uint32_t i = 0; i < pairs; ++i) {
    ASSERT_EQ(world.position(2 * i), target(i)) << i;
    ASSERT_NEAR(world.velocity(2 * i + 1).x, world.velocity(2 * (i % 3) + 1).x, 1e-9) << i;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
