// The upper row of a net that hangs by two corners is straight and taut, so that its nodes are locked. They
// stay so whatever else is done to the net.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;
constexpr std::uint32_t n = 12;

/// A net of n x n that hangs down along `down` from two corners, and a rod in its midst.
Scene net(Vec3 down) {
  Scene scene;
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec3 at = 0.1 * j * down + Vec3{0.1 * i, 0, 0};
      const std::uint32_t here = j * n + i;
      scene.particles.push_back(j == 0 && (i == 0 || i + 1 == n) ? test::fixed(at) : test::movable(at, 0.01));
      if (i > 0) scene.rods.push_back({.a = here - 1, .b = here, .length = 0.1});
      if (j > 0) scene.rods.push_back({.a = here - n, .b = here, .length = 0.1});
    }
  return scene;
}

/// The largest strain of rods that are as long as they were made.
double strain_of(const World& world) {
  double out = 0;
  for (const Rod& rod : world.scene().rods)
    out = std::max(out, std::abs(norm(world.position(rod.b) - world.position(rod.a)) / rod.length - 1));
  return out;
}

// Before, rods gave from the step on in which a particle was pinned that moved, at thirty times the cost.
TEST(LockedRows, StayWhenAParticleIsPinned) {
  for (const int frames : {20, 40, 90}) {
    const Scene scene = net({0, 0, 1});
    World world(scene, {.threads = 1});
    StepReport total = test::run(world, frame, frames);
    constexpr std::uint32_t pinned = n * 5 + 5;
    world.fix(pinned);
    const Vec3 place = world.position(pinned);
    total += test::run(world, frame, 60);
    EXPECT_EQ(total.elastic_substeps + total.unsolved, 0u) << frames;
    EXPECT_EQ(world.position(pinned), place);
    EXPECT_LT(strain_of(world), 1e-8) << frames;
  }
}

// Before, a net that hung still had rods that gave, by 6e-6, for ever after one of them was made shorter.
TEST(LockedRows, StayWhenARodChangesItsLength) {
  const Scene scene = net({0, -1, 0});
  for (const Settings& settings :
       {Settings{.threads = 1}, test::direct(Gradient::old), test::direct(Gradient::new_)})
    for (const double share : {0.99, 0.8})
      for (const std::uint32_t rod : {12u, 132u, 263u}) {
        World world(scene, settings);
        test::run(world, frame, 5);
        world.set_length(rod, share * 0.1);
        const StepReport total = test::run(world, frame, 60);
        EXPECT_EQ(total.elastic_substeps + total.unsolved, 0u) << share << ' ' << rod;
        EXPECT_LT(strain_of(world), 1e-9) << share << ' ' << rod;
      }
}

// A line with a longer rod is locked no more, and sags: 1.11 m between anchors 1.1 m apart by 74 mm at most,
// drawn to a corner. It swings about less.
TEST(LockedRows, SagWithALongerRod) {
  World world(net({0, -1, 0}), {.threads = 1});
  test::run(world, frame, 5);
  constexpr std::uint32_t rod = 5, middle = 6;
  world.set_length(rod, 0.11);
  const StepReport total = test::run(world, frame, 60);
  EXPECT_EQ(total.unsolved, 0u);
  EXPECT_LT(world.position(middle).y, -0.03);
  EXPECT_GT(world.position(middle).y, -0.075);
  EXPECT_LT(strain_of(world), 1e-8);
}

// The row is free in the very step in which its rod becomes longer. Where it becomes shorter, rods give in
// that step, and say so.
TEST(LockedRows, AreFreeInTheStepInWhichARodChanges) {
  for (const double length : {0.11, 0.099}) {
    World world(net({0, -1, 0}), {.threads = 1});
    test::run(world, frame, 5);
    world.set_length(5, length);
    const StepReport report = world.step(frame);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_EQ(report.elastic_substeps > 0, length < 0.1);
    if (length > 0.1) {
      EXPECT_LT(strain_of(world), 1e-8);
    }
  }
}

// A rod between two locked rows cannot become shorter. Rods give from then on, as in any such place.
TEST(LockedRows, GiveWhereARodBetweenThemIsToBeShorter) {
  Scene scene;
  for (std::uint32_t i = 0; i < n; ++i)
    for (const double y : {0.0, -0.1}) {
      const Vec3 at{0.1 * i, y, 0};
      scene.particles.push_back(i == 0 || i + 1 == n ? test::fixed(at) : test::movable(at, 0.01));
      const std::uint32_t here = 2 * i + (y < 0 ? 1 : 0);
      if (i > 0) scene.rods.push_back({.a = here - 2, .b = here, .length = 0.1});
      if (y < 0 && i > 0 && i + 1 < n) scene.rods.push_back({.a = here - 1, .b = here, .length = 0.1});
    }
  World world(scene, {.threads = 1});
  test::run(world, frame, 5);
  const auto is_rung = [](const Rod& rod) { return rod.a + 1 == rod.b && rod.a == n; };
  const auto rung = std::find_if(scene.rods.begin(), scene.rods.end(), is_rung);
  ASSERT_NE(rung, scene.rods.end());
  const auto number = static_cast<std::uint32_t>(rung - scene.rods.begin());
  world.set_length(number, 0.09);
  const StepReport total = test::run(world, frame, 60);
  EXPECT_EQ(total.unsolved, 0u);
  EXPECT_EQ(total.elastic_substeps, 60u);
  EXPECT_LT(norm(world.position(rung->b) - world.position(rung->a)), 0.0999);
  world.set_length(number, 0.1);
  test::run(world, frame, 10);
  EXPECT_EQ(test::run(world, frame, 60).elastic_substeps, 0u);
  EXPECT_LT(strain_of(world), 1e-9);
}

// A row is drawn straight, so that rods give, and held. It goes on alike in a world that is restored then,
// and a net does whose rod changes its length by lines.
TEST(LockedRows, GoOnAlikeWhereTheyAreRestored) {
  const auto go_on_alike = [](const Scene& scene, const Settings& settings, auto&& drive, int frames) {
    World world(scene, settings);
    std::vector<std::byte> saved;
    std::unique_ptr<World> other;
    for (int i = 0; i < frames; ++i) {
      for (World* const each : {&world, other.get()})
        if (each != nullptr) {
          drive(*each, i);
          each->step(frame);
        }
      if (other) {
        ASSERT_EQ(world.state_hash(), other->state_hash()) << i;
      }
      if (i % 7 != 3) continue;
      saved.resize(world.snapshot_size());
      world.save(saved);
      other = std::make_unique<World>(scene, settings);
      test::run(*other, frame, i % 3);
      other->restore(saved);
    }
  };
  const Scene small = net({0, -1, 0});
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    go_on_alike(
        small, test::direct(gradient),
        [&](World& world, int i) {
          const double share = i < 20 ? i / 20.0 : std::max(0.0, 2 - i / 20.0);
          world.move_anchor(n - 1, small.particles[n - 1].position + share * Vec3{-0.2, 0, 0});
        },
        50);
    go_on_alike(
        scenes::make_net({.width = 32, .height = 32}), test::direct(gradient),
        [](World& world, int i) { world.set_length(900, 0.1 - 0.001 * i); }, 25);
  }
}

// A row that sagged is drawn straight again, or too far and back. Rods then give for a moment, since none
// comes to lie in a straight line by itself. Before, they gave from then on.
TEST(LockedRows, AreLockedAgainWhenTheyAreDrawnStraight) {
  const Scene scene = net({0, -1, 0});
  for (const Vec3 way : {Vec3{-0.3, 0, 0}, Vec3{0, 0.3, 0}, Vec3{0, 0, -0.2}}) {
    World world(scene, {.threads = 1});
    for (int i = 1; i <= 120; ++i) {
      const double share = i <= 60 ? i / 60.0 : 2 - i / 60.0;
      world.move_anchor(n - 1, scene.particles[n - 1].position + share * way);
      world.step(frame);
    }
    StepReport total = test::run(world, frame, 10);
    EXPECT_EQ(total.unsolved, 0u);
    total = test::run(world, frame, 60);
    EXPECT_EQ(total.elastic_substeps + total.unsolved, 0u) << way.x << ' ' << way.y;
    EXPECT_LT(strain_of(world), 1e-9) << way.x << ' ' << way.y;
    for (std::uint32_t i = 1; i + 1 < n; ++i) EXPECT_EQ(world.velocity(i), Vec3{}) << i;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
