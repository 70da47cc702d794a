// Rods that break in islands with joints, springs or shapes: where and when direct solves break them, without
// a change of momentum, and not by steps that are taken back.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/breaking.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 120;
constexpr double never = 1e30;  // N

void add_shape(Scene& scene, std::uint32_t particle) {
  scene.capsules.push_back({.a = point_at(particle), .b = point_at(particle), .radius = 0.05});
}

/// A chain without anchors that spins about its middle, in space. Its middle rods are the weakest.
Scene spinning(const RodLaw& law, double strength) {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i <= 8; ++i) {
    const double x = 0.2 * (i - 4.0);
    scene.particles.push_back(test::movable({x, 0, 0}, 0.5 + 0.1 * i, {0.3, 10 * x, 1}));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .law = law});
    scene.rods.back().law.strength = strength * (1 + std::abs(x - 0.1));
  }
  return scene;
}

Settings settings(std::uint32_t substeps = 8) {
  return {.method = Method::direct,
          .gradient = Gradient::old,
          .substeps = substeps,
          .tensions = true,
          .threads = 1};
}

/// A bridge of planks above the ground, and a ball that falls on it.
Scene bridge(const RodLaw& law, bool has_ball) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 10; ++i) {
    const Vec3 at{0.3 * i, -0.02 * i * (10.0 - i), 0};
    scene.particles.push_back(i % 10 == 0 ? test::fixed(at) : test::movable(at, 0.5));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .law = law});
    scene.rods.back().law.strength = 120 + 10 * i;
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.04});
  }
  scene.planes.push_back({.offset = -3});
  scene.drag = 1;
  if (has_ball) test::add_ball(scene, {1.5, 3, 0}, 0.2, 20);
  return scene;
}

/// Pulls at the end of a chain by 36 N more in every second, until it breaks. Returns the frame.
int frame_of_break(World& world, StepReport& total) {
  for (int i = 0; i < 300; ++i) {
    world.set_force(6, {0, -0.3 * i, 0});
    total += world.step(frame);
    if (test::broken_rods(world) > 0) return i;
  }
  return -1;
}

// What hangs from the third rod weighs 28.4 N, so that rigid rods bear 105 frames. Elastic ones swing and
// break before. Both solvers have the same equations for rigid rods, and others of second order.
TEST(BreakingLinkages, BreakWhereAndWhenDirectSolvesBreakThem) {
  for (const RodLaw& law : test::breaking_laws) {
    Scene scene = test::hanging_chain(law);
    StepReport of_direct, total;
    World direct(scene, {.method = Method::direct, .gradient = Gradient::old, .substeps = 8, .threads = 1});
    const int expected = frame_of_break(direct, of_direct);
    add_shape(scene, 6);
    World world(scene, settings());
    const int found = frame_of_break(world, total);
    EXPECT_TRUE(law.is_elastic() || expected == 106) << expected;
    EXPECT_NEAR(found, expected, law.is_elastic() ? 1 : 0);
    EXPECT_TRUE(world.is_broken(2));
    EXPECT_EQ(total.broken_rods, 1u);
    // Below the break it falls freely, by gravity and the force of now.
    const double force = 0.3 * found, mass = 2.9;
    const auto mean_velocity = [&] {
      const double light = world.velocity(3).y + world.velocity(4).y + world.velocity(5).y;
      return (0.3 * light + 2 * world.velocity(6).y) / mass;
    };
    const double before = mean_velocity();
    const StepReport next = world.step(frame);
    EXPECT_EQ(next.broken_rods, 0u);
    EXPECT_NEAR(mean_velocity() - before, -(9.81 + force / mass) * frame, 1e-9);
    EXPECT_EQ(world.tension(2), 0);
    EXPECT_TRUE(world.problems().empty());
  }
}

// Until it breaks, a world moves as one whose rods never do, to the bit. What both have is a strength, since
// rods without one are constraints.
TEST(BreakingLinkages, MoveAsUnbreakableOnesUntilTheyBreak) {
  for (const RodLaw& law : test::breaking_laws) {
    Scene scene = spinning(law, never), weak = spinning(law, 250);
    for (Scene* const each : {&scene, &weak}) add_shape(*each, 0);
    World twin(scene, settings(1)), world(weak, settings(1));
    int same = 0;
    StepReport report;
    for (double push = 0; test::broken_rods(world) == 0 && same < 300; push += 2, ++same) {
      for (World* const each : {&twin, &world}) {
        each->set_force(0, {-push, 0, 0});
        each->set_force(8, {push, 0, 0});
      }
      EXPECT_EQ(twin.state_hash(), world.state_hash());
      for (std::uint32_t i = 0; same > 0 && i < 8; ++i) EXPECT_EQ(twin.tension(i), world.tension(i));
      twin.step(frame / 8);
      report = world.step(frame / 8);
    }
    EXPECT_GT(same, 5);
    EXPECT_LT(same, 300) << "it breaks";
    EXPECT_EQ(report.direct_substeps, 1u);
    EXPECT_EQ(twin.state_hash(), world.state_hash()) << "a rod breaks at the end of a substep";
  }
}

// Pulls come in pairs. Energy swings by the square of the substep where rods are elastic, and a break takes
// that of the rod.
TEST(BreakingLinkages, KeepMomentumAndGainNoEnergy) {
  for (const RodLaw& law : test::breaking_laws) {
    Scene scene = spinning(law, 30);
    add_shape(scene, 2);
    World world(scene, settings(32));
    const auto energy = [&] {
      double sum = measure_energy(scene, test::positions_of(world), test::velocities_of(world)).kinetic;
      for (std::uint32_t i = 0; law.is_elastic() && i < world.rod_count(); ++i) {
        const double off = norm(world.position(i + 1) - world.position(i)) - 0.2;
        if (!world.is_broken(i) && (off > 0 || !law.one_sided)) sum += 0.5 * law.stiffness * off * off;
      }
      return sum;
    };
    const Momentum first = test::momentum_of(scene, world);
    const double start = energy();
    StepReport total;
    for (int i = 0; i < 120; ++i) {
      total += world.step(frame);
      const Momentum now = test::momentum_of(scene, world);
      EXPECT_LT(norm(now.linear - first.linear), 1e-12 * norm(first.linear));
      EXPECT_LT(norm(now.angular - first.angular), 1e-11 * norm(first.angular));
      EXPECT_LT(energy() - start, (law.is_elastic() ? 1e-4 : 1e-7) * start);
    }
    EXPECT_GT(total.broken_rods, 0u);
    EXPECT_EQ(total.broken_rods, test::broken_rods(world));
    EXPECT_EQ(total.unsolved, 0u);
  }
}

// An accuracy takes steps back in which rods broke. They break in those that stand alone, and once.
TEST(BreakingLinkages, BreakInStepsThatStand) {
  std::uint64_t repeated = 0;
  for (const RodLaw& law : test::breaking_laws)
    for (const std::uint32_t order : {2u, 4u}) {
      Scene scene = test::hanging_chain(law);
      add_shape(scene, 6);
      for (Rod& rod : scene.rods) rod.law.strength = 75;
      scene.rods[0].law.strength = 60;
      Settings accurate = settings(1);
      accurate.accuracy = 1e-4;
      accurate.time_order = law.damping > 0 ? 2 : order;
      World world(scene, accurate);
      StepReport total;
      for (int i = 0; i < 240; ++i) {
        world.set_force(6, {0, -0.3 * std::min(i, 150), 0});
        total += world.step(frame);
        EXPECT_EQ(total.broken_rods, test::broken_rods(world));
        EXPECT_LE(total.broken_rods, 1u) << "what falls pulls less";
      }
      EXPECT_TRUE(world.is_broken(0)) << "it bears most";
      repeated += total.repeated_steps;
    }
  EXPECT_GT(repeated, 0u);
}

// Steps of order 4 in the air break rods as those of order 2 do.
TEST(BreakingLinkages, BreakInFlightOfHigherOrder) {
  for (const double strength : {never, 22.0}) {
    Scene scene = spinning({.stiffness = 2000}, strength);
    scene.joint_drag = 1e-9;
    Settings order4 = settings(16), order2 = settings(16);
    order4.time_order = 4;
    World world(scene, order4), other(scene, order2);
    StepReport total, of_other;
    for (int i = 0; i < 60; ++i) {
      total += world.step(frame);
      of_other += other.step(frame);
    }
    EXPECT_EQ(total.broken_rods, test::broken_rods(world));
    EXPECT_EQ(total.broken_rods, of_other.broken_rods);
    EXPECT_EQ(total.broken_rods > 0, strength != never);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      EXPECT_LT(norm(world.position(i) - other.position(i)), 1e-2) << i;
  }
}

// A ball falls through a bridge of planks, which would hang still without it.
TEST(BreakingLinkages, LetABallThroughABridge) {
  for (const RodLaw& law : test::breaking_laws) {
    World still(bridge(law, false), test::body_settings(4, true));
    StepReport report;
    for (int i = 0; i < 1200; ++i) report = still.step(frame);
    EXPECT_EQ(report.awake_islands, 0u) << "it hangs still";
    EXPECT_EQ(test::broken_rods(still), 0u);
    World world(bridge(law, true), test::body_settings(4, true));
    StepReport total;
    for (int i = 0; i < 2400; ++i) total += report = world.step(frame);
    EXPECT_GT(total.broken_rods, 0u);
    EXPECT_EQ(total.broken_rods, test::broken_rods(world));
    EXPECT_NEAR(world.position(11).y, -2.8, 0.15) << "it lies on the ground, or on a plank";
    EXPECT_EQ(total.unsolved, 0u);
    EXPECT_EQ(total.frozen_islands, 0u);
  }
}

// Rods that do not fit together break, the weakest first: no pull holds a straight line whose ends part.
TEST(BreakingLinkages, BreakWhereRodsDoNotFit) {
  for (const double speed : {0.1, 1.0}) {
    Scene scene;
    scene.gravity = {};
    for (std::uint32_t i = 0; i <= 4; ++i) {
      const Vec3 at{0.25 * i, 0, 0};
      scene.particles.push_back(i % 4 == 0 ? test::fixed(at) : test::movable(at, 1));
      if (i == 0) continue;
      scene.rods.push_back({.a = i - 1, .b = i});
      scene.rods.back().law.strength = i == 3 ? 1e5 : 2e5;
    }
    add_shape(scene, 1);
    World world(scene, settings());
    StepReport total;
    for (int i = 0; i < 60; ++i) {
      world.move_anchor(4, {1 + speed * frame * (i + 1), 0, 0});
      total += world.step(frame);
    }
    EXPECT_EQ(total.broken_rods, 1u) << speed;
    EXPECT_TRUE(world.is_broken(2)) << speed;
    EXPECT_EQ(total.unsolved, 0u) << speed;
    EXPECT_NEAR(world.velocity(3).x, speed, 1e-9) << "it follows its anchor";
    EXPECT_NEAR(norm(world.velocity(2)), 0, 1e-9);
  }
}

// What rests while a rod breaks is about to fall, however soon things sleep.
TEST(BreakingLinkages, DoNotSleepAsTheyBreak) {
  for (const Method method : {Method::direct, Method::relax})
    for (const bool has_shape : {false, true}) {
      if (method == Method::relax && has_shape) continue;
      Scene scene = test::hanging_chain({});
      scene.rods[2].law.strength = 1;
      if (has_shape) add_shape(scene, 6);
      Settings settings{.method = method, .gradient = Gradient::old, .stop = {.sweeps = 400}, .threads = 1};
      settings.sleep = true;
      settings.sleep_time = 1e-3;
      if (method == Method::direct) settings.stop = {};
      World world(scene, settings);
      EXPECT_EQ(world.step(frame).broken_rods, 1u);
      for (int i = 0; i < 60; ++i) world.step(frame);
      EXPECT_NEAR(world.velocity(6).y, -9.81 * 0.5, 0.1) << to_string(method) << has_shape;
      EXPECT_NEAR(world.position(2).y, -0.4, 1e-6);
    }
}

// A body hangs from a rope and sleeps. A force wakes it and breaks the rope, and it falls freely.
TEST(BreakingLinkages, WakeAndFall) {
  for (const RodLaw& law : test::breaking_laws) {
    Scene scene;
    scene.particles.push_back(test::fixed({0, 0, 0}));
    add_body(scene, solid_box(3, {0.1, 0.3, 0.5}));
    for (const std::uint32_t i : scene.bodies[0].particles) scene.particles[i].position.y -= 1;
    scene.bodies[0].center.y -= 1;
    scene.drag = 1;
    scene.rods.push_back({.a = 0, .b = scene.bodies[0].particles[0], .law = law});
    scene.rods.back().law.strength = 100;
    World world(scene, test::body_settings(4, true));
    StepReport report;
    for (int i = 0; i < 1200; ++i) report = world.step(frame);
    EXPECT_EQ(report.awake_islands, 0u);
    EXPECT_EQ(test::broken_rods(world), 0u);
    world.set_force(scene.bodies[0].particles[0], {0, -200, 0});
    EXPECT_EQ(world.step(frame).broken_rods, 1u);
    world.set_force(scene.bodies[0].particles[0], {});
    const double before = world.velocity(scene.bodies[0].particles[0]).y;
    for (int i = 0; i < 1200; ++i) world.step(frame);
    // Drag of 1/s brings what falls to a speed of g s.
    EXPECT_NEAR(world.velocity(scene.bodies[0].particles[0]).y, -9.81,
                0.01 + std::abs(before) * std::exp(-9));
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
