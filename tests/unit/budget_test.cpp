// How many substeps a running world takes: as many as a program says, or as fit into a time.

#include "time/budget.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <thread>

#include "plumb/plumb.hpp"
#include "scenes/generators/falling.hpp"
#include "scenes/generators/generators.hpp"
#include "support/edited_worlds.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;

constexpr double frame = 1.0 / 60;
constexpr double for_ever = 1e12, nothing = 1e-6;  // us

/// Returns ropes whose ends are ten times as heavy, drawn aside.
Scene ropes(std::uint32_t count, std::uint32_t rods) {
  Scene scene;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back(test::fixed({double{1} * k, 0, 0}));
    for (std::uint32_t i = 1; i <= rods; ++i) {
      scene.particles.push_back(test::movable({k + 0.1 * i, 0, 0}));
      scene.rods.push_back({.a = first + i - 1, .b = first + i});
    }
    scene.particles.back().mass = 10;
  }
  return scene;
}

/// Returns one that falls on ground.
Scene falling_ropes() {
  Scene scene = ropes(3, 8);
  for (Particle& particle : scene.particles) {
    if (particle.fixed) particle.mass = 1;
    particle.fixed = false;
  }
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i)
    scene.capsules.push_back(
        {.a = point_at(scene.rods[i].a), .b = point_at(scene.rods[i].b), .radius = 0.02});
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = -0.3});
  return scene;
}

template <class F>
void for_methods(F&& f) {
  for (const Method method : {Method::automatic, Method::relax, Method::direct})
    for (const Precision precision : {Precision::single, Precision::double_}) {
      SCOPED_TRACE(to_string(method));
      f(Settings{.method = method, .precision = precision, .threads = 1});
    }
}

TEST(Substeps, AreThoseOfAWorldThatHadThemFromTheStart) {
  for (const Scene& scene : {ropes(5, 12), falling_ropes()})
    for_methods([&](Settings settings) {
      World changed(scene, settings);
      changed.set_substeps(6);
      settings.substeps = 6;
      World own(scene, settings);
      for (int k = 0; k < 30; ++k) {
        EXPECT_EQ(changed.step(frame).substeps, 6u);
        own.step(frame);
      }
      EXPECT_EQ(changed.state_hash(), own.state_hash());
    });
}

// Of second order before and after, the motion stays near that of the finer world.
TEST(Substeps, MayChangeInMotion) {
  const Scene scene = ropes(2, 5);
  for (const Gradient gradient : {Gradient::old, Gradient::mid})
    for_methods([&](Settings settings) {
      settings.gradient = gradient;
      if (settings.method == Method::relax) settings.stop.sweeps = 100;
      settings.substeps = 64;
      World finer(scene, settings), changing(scene, settings);
      for (int k = 0; k < 20; ++k) {
        changing.set_substeps(k % 2 == 0 ? 32 : 64);
        changing.step(frame);
        finer.step(frame);
      }
      for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
        EXPECT_LE(norm(changing.position(i) - finer.position(i)), 2e-3) << i;
    });
}

TEST(Substeps, GoWithSnapshots) {
  const Scene scene = ropes(2, 6);
  World world(scene), other(scene);
  world.set_substeps(3);
  world.step(frame);
  std::vector<std::byte> bytes(world.snapshot_size());
  world.save(bytes);
  other.restore(bytes);
  EXPECT_EQ(other.step(frame).substeps, 3u);
  world.step(frame);
  EXPECT_EQ(other.state_hash(), world.state_hash());
}

TEST(Accuracies, AreThoseOfAWorldThatHadThemFromTheStart) {
  for_methods([&](Settings settings) {
    if (settings.method == Method::relax || settings.precision == Precision::single) return;
    settings.accuracy = 1e-2;
    World changed(ropes(3, 8), settings), coarse(ropes(3, 8), settings);
    changed.set_accuracy(1e-3);
    settings.accuracy = 1e-3;
    World own(ropes(3, 8), settings);
    std::uint64_t substeps = 0, coarser = 0;
    for (int k = 0; k < 30; ++k) {
      substeps += changed.step(frame).direct_substeps;
      coarser += coarse.step(frame).direct_substeps;
      own.step(frame);
    }
    EXPECT_EQ(changed.state_hash(), own.state_hash());
    EXPECT_GT(substeps, coarser);
  });
}

TEST(Accuracies, GoWithSnapshots) {
  World world(ropes(2, 6), {.accuracy = 1e-2}), other(ropes(2, 6), {.accuracy = 1e-2});
  world.set_accuracy(1e-4);
  world.step(frame);
  std::vector<std::byte> bytes(world.snapshot_size());
  world.save(bytes);
  other.restore(bytes);
  world.step(frame);
  other.step(frame);
  EXPECT_EQ(other.state_hash(), world.state_hash());
}

TEST(Accuracies, AreRefusedWithAReason) {
  World world(ropes(1, 2), {.accuracy = 1e-2}), without(ropes(1, 2));
  expect_refusal("accuracy must be positive and finite", [&] { world.set_accuracy(0); });
  expect_refusal("accuracy must be positive and finite", [&] { world.set_accuracy(std::nan("")); });
  expect_refusal("began without an accuracy", [&] { without.set_accuracy(1e-2); });
}

TEST(Substeps, AreRefusedWithAReason) {
  World world(ropes(1, 2));
  expect_refusal("substeps must be from 1 to 1000000, got 0", [&] { world.set_substeps(0); });
  expect_refusal("substeps must be from 1 to 1000000, got 1000001", [&] { world.set_substeps(1'000'001); });
  expect_refusal("budget must be positive", [&] { world.set_budget(0); });
  expect_refusal("budget must be positive", [&] { world.set_budget(std::nan("")); });
  expect_refusal("budget must be positive",
                 [&] { world.set_budget(std::numeric_limits<double>::infinity()); });
}

TEST(Budgets, LeaveSubstepsToOthersUntilTheyAreSet) {
  detail::Budget budget;
  StepReport report;
  EXPECT_EQ(budget.begin_step(7, 1), 7u);
  EXPECT_FALSE(budget.deadline(true));
  budget.end_step(7, true, report);
  EXPECT_EQ(report.step_us, 0);
  budget.set(for_ever);
  EXPECT_EQ(budget.begin_step(7, 1), 7u);
  // What is tried under an accuracy leaves time for substeps by number.
  EXPECT_LT(*budget.deadline(true), *budget.deadline(false));
  budget.end_step(7, true, report);
  budget.set(std::numeric_limits<double>::max());
  EXPECT_EQ(budget.begin_step(7, 1), 7u);
  EXPECT_GT(*budget.deadline(false), detail::Budget::Clock::now());
  budget.end_step(7, true, report);
  EXPECT_GT(report.step_us, 0);
  EXPECT_EQ(report.asked_us, report.step_us);
}

// A step may be late without having been cut short. Only the latter makes it less accurate than it was asked
// to be.
TEST(Budgets, CapOnlyWhatTheyCutShort) {
  World calm(ropes(2, 5)), watched(ropes(2, 5), {.accuracy = 1e-6});
  for (World* const world : {&calm, &watched}) world->set_budget(nothing);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(calm.step(frame).capped_steps, 0u);
    EXPECT_GT(watched.step(frame).capped_steps, 0u);
  }
}

TEST(Budgets, ThatSufficeChangeNoBits) {
  for (const Scene& scene : {ropes(5, 12), falling_ropes()})
    for (const bool is_controlled : {false, true})
      for_methods([&](Settings settings) {
        settings.substeps = 4;
        if (is_controlled) settings.accuracy = 1e-2;
        World world(scene, settings), free(scene, settings);
        world.set_budget(for_ever);
        for (int k = 0; k < 20; ++k) {
          const StepReport report = world.step(frame);
          EXPECT_GT(report.step_us, 0);
          EXPECT_EQ(report.capped_steps, free.step(frame).capped_steps);
        }
        EXPECT_EQ(world.state_hash(), free.state_hash());
      });
}

// The first step takes a guess, the second what the first one took, and others the second largest of the last
// costs, so that one slow frame says nothing.
TEST(Budgets, FollowWhatTheLastStepsTook) {
  detail::Budget budget;
  budget.set(2e3);
  StepReport report;
  EXPECT_EQ(budget.begin_step(10, 700), 2u);
  EXPECT_EQ(budget.begin_step(10, 1e9), 1u);
  EXPECT_EQ(budget.begin_step(10, 0), 10u);
  const auto begin = detail::Budget::Clock::now();
  while (detail::Budget::Clock::now() - begin < std::chrono::microseconds(1500)) {
  }
  budget.end_step(1, false, report);  // at least 1500 us, of which one fits
  EXPECT_EQ(budget.begin_step(10, 0), 1u);
  budget.end_step(1, false, report);  // next to nothing
  EXPECT_EQ(budget.begin_step(10, 1e9), 10u);
}

TEST(Budgets, ThatDoNotSufficeTakeFewerSubsteps) {
  for (const Scene& scene : {ropes(5, 12), falling_ropes()})
    for_methods([&](Settings settings) {
      settings.substeps = 8;
      World world(scene, settings);
      world.set_budget(nothing);
      for (int k = 0; k < 12; ++k) {
        const StepReport report = world.step(frame);
        EXPECT_EQ(report.substeps, 1u);
        EXPECT_GE(report.asked_us, report.step_us);
        if (k > 0) continue;
        EXPECT_DOUBLE_EQ(report.asked_us, 8 * report.step_us) << "nothing else is known yet";
      }
      world.set_budget({});
      const StepReport report = world.step(frame);
      EXPECT_EQ(report.substeps, 8u);
      EXPECT_EQ(report.step_us, 0);
      for (std::uint32_t i = 0; i < scene.particles.size(); ++i) EXPECT_TRUE(is_finite(world.position(i)));
    });
}

// A step that was to fit and is late all the same takes what is left of an island as one substep, in the air
// and where something touches. One such step says nothing of the next.
TEST(Budgets, TakeWhatIsLeftOfALateStepAtOnce) {
  constexpr double budget = 2e5;  // us
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const int late : {3, 40}) {  // frames in the air, and on the ground
      SCOPED_TRACE(std::string(to_string(method)) + ", " + std::to_string(late));
      World world(falling_ropes(), {.method = method, .substeps = 8, .sleep = false, .threads = 1});
      bool is_held_up = false;
      world.set_zones([&](std::string_view stage, bool begins) {
        if (is_held_up && begins && stage == "solve")
          std::this_thread::sleep_for(std::chrono::duration<double, std::micro>(budget));
      });
      world.set_budget(budget);
      for (int k = 0; k < late; ++k) EXPECT_EQ(world.step(frame).capped_steps, 0u);
      is_held_up = true;
      const StepReport report = world.step(frame);
      const bool is_swept =
          method == Method::relax && late < 10;  // by a solver that sweeps what it has equally
      EXPECT_EQ(report.capped_steps > 0, !is_swept);
      EXPECT_TRUE(method != Method::direct || report.direct_substeps < 8u * 3);
      is_held_up = false;
      EXPECT_EQ(world.step(frame).capped_steps, 0u);
      for (std::uint32_t i = 0; i < world.particle_count(); ++i) EXPECT_TRUE(is_finite(world.position(i)));
    }
}

// Nothing is cheaper there than what is done without a budget: what is not cut as it should be is tried in
// vain, and rods that give take a large net longer than its halves. Late as they are, they have the same
// bits.
TEST(Budgets, ChangeNothingWhereNothingIsCheaper) {
  const Scene net = scenes::make_net({.width = 20, .height = 20, .level = 1, .slack = 0.3, .end_mass = 100});
  for (const Scene& scene : {scenes::make_boxes({.boxes = 8}), scenes::make_ring({}), net}) {
    World late(scene, {.threads = 1}), free(scene, {.threads = 1});
    late.set_budget(nothing);
    StepReport sum;
    for (int k = 0; k < 60; ++k) {
      const StepReport report = late.step(frame);
      EXPECT_GT(report.step_us, nothing);
      sum += report;
      free.step(frame);
    }
    EXPECT_GT(sum.halvings, 0u) << "something is hard";
    EXPECT_EQ(sum.unsolved + sum.capped_steps, 0u);
    EXPECT_EQ(late.state_hash(), free.state_hash());
  }
}

// Ropes that fall on each other are relaxed in so many substeps that nothing passes another, late or not.
// Those that are slow enough take fewer. They fall otherwise then, so that halvings differ by chance.
TEST(Budgets, HurryCrowdsOnlyAsFarAsTheyAreSlow) {
  World late(scenes::make_heap({}), {.threads = 1}), free(scenes::make_heap({}), {.threads = 1});
  late.set_budget(nothing);
  StepReport hurried, whole;
  for (int k = 0; k < 60; ++k) {
    hurried += late.step(frame);
    whole += free.step(frame);
  }
  EXPECT_EQ(whole.missed_contacts, 0u);
  EXPECT_EQ(hurried.missed_contacts, 0u);
  EXPECT_LE(hurried.halvings, whole.halvings + whole.halvings / 5);
  EXPECT_LT(hurried.block_sweeps, whole.block_sweeps);
  EXPECT_GT(hurried.capped_steps, 0u);
}

TEST(Budgets, EndTriesForAnAccuracy) {
  const Scene scene = ropes(5, 12);
  for_methods([&](Settings settings) {
    settings.accuracy = 1e-3;
    settings.substeps = 2;
    World world(scene, settings);
    world.set_budget(nothing);
    for (int k = 0; k < 10; ++k) {
      const StepReport report = world.step(frame);
      EXPECT_GT(report.capped_steps, 0u);
      EXPECT_FALSE(world.problems().empty());
    }
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i) EXPECT_TRUE(is_finite(world.position(i)));
    world.set_budget({});
    for (int k = 0; k < 5; ++k) world.step(frame);
    EXPECT_EQ(world.step(frame).capped_steps, 0u);
  });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
