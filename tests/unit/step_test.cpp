// The parts of a step above the solvers: anchors, sleep, substeps, threads, and the step itself.

#include "step/step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "scenes/generators/generators.hpp"
#include "step/compile/compiled.hpp"
#include "step/inputs/anchors.hpp"
#include "step/sleep.hpp"
#include "step/state/standing.hpp"
#include "support/executors.hpp"
#include "support/worlds.hpp"
#include "threads/workers.hpp"
#include "time/advance.hpp"
#include "time/composition.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

const Settings direct{.method = Method::direct, .threads = 1};

std::shared_ptr<const Scene> shared(const Scene& scene) {
  return std::make_shared<const Scene>(scene);
}

TEST(Compile, FindsAPlaceForEveryParticle) {
  const Scene scene = scenes::make_net(4, 3);
  const Compiled compiled = compile(shared(scene), direct);
  EXPECT_EQ(compiled.contact, nullptr) << "nothing can touch";
  EXPECT_EQ(compiled.info.rods, scene.rods.size());
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
    for (const Place place : compiled.places.of(i))
      EXPECT_EQ(compiled.solvers[place.solver]->position(place.slot), scene.particles[i].position);
  Scene ball;
  ball.particles = {test::movable({0, 0, 0})};
  ball.capsules = {{.a = point_at(0), .b = point_at(0), .radius = 0.1}};
  EXPECT_NE(compile(shared(ball), direct).contact, nullptr);
}

// An anchor goes to its target in the next step, and is there exactly afterwards.
TEST(Anchors, ArriveExactly) {
  const Scene scene = scenes::make_chain(3);
  Compiled compiled = compile(shared(scene), direct);
  Anchors anchors(scene, compiled.solvers.size());
  ASSERT_TRUE(anchors.is_fixed(0));
  EXPECT_FALSE(anchors.any_paths());
  const Vec3 target{0.1, 0.7, -0.3};
  anchors.set_target(0, target);
  EXPECT_TRUE(anchors.any_paths());
  int places = 0;
  anchors.for_moving_places(compiled.places, [&](Place) { ++places; });
  EXPECT_EQ(places, 1);
  anchors.begin_step(1.0 / 3, compiled.places, compiled.solvers);
  anchors.end_step(compiled.places, compiled.solvers);
  EXPECT_EQ(anchors.position(0), target);
  const Place place = compiled.places.of(0).front();
  EXPECT_EQ(compiled.solvers[place.solver]->position(place.slot), target);
  EXPECT_TRUE(anchors.any_paths()) << "its solver has still to learn that it rests";
  anchors.begin_step(1.0 / 3, compiled.places, compiled.solvers);
  anchors.end_step(compiled.places, compiled.solvers);
  EXPECT_FALSE(anchors.any_paths());
}

// What stands still falls asleep once it has stood for long enough without a break, and wakes if asked.
TEST(Sleep, NeedsStillnessWithoutABreak) {
  const Scene scene = scenes::make_chain(3);
  Compiled compiled = compile(shared(scene), direct);
  Sleep sleep;
  Settings settings = direct;
  settings.sleep_time = 0.5;
  sleep.start(compiled.solvers, settings);
  ASSERT_EQ(sleep.tasks().size(), 1u);
  const auto stand = [&](bool is_still, int steps) {
    std::uint32_t fell = 0;
    for (int i = 0; i < steps; ++i) {
      sleep.tasks()[0].is_still = is_still;
      fell += sleep.settle(compiled.solvers, 0.0625);
    }
    return fell;
  };
  EXPECT_EQ(stand(true, 7), 0u);
  EXPECT_EQ(stand(false, 1), 0u);
  EXPECT_EQ(stand(true, 7), 0u) << "it starts anew";
  EXPECT_EQ(stand(true, 1), 1u) << "half a second";
  EXPECT_TRUE(sleep.all_asleep());
  const Place place = compiled.places.of(1).front();
  EXPECT_TRUE(sleep.is_asleep(compiled.solvers, place));
  sleep.wake(compiled.solvers, place);
  EXPECT_FALSE(sleep.all_asleep());
  EXPECT_EQ(stand(true, 7), 0u);
}

// A body on a line of 10 m turns round at 5 cm with 0.049 m/s², below the speed of sleep for 0.8 s. Without
// that, it sleeps once it is slow.
TEST(Sleep, LeavesAwakeWhatTurnsRound) {
  for (const double aside : {0.05, 0.0}) {
    Scene scene;
    scene.particles.push_back(test::fixed({0, 10, 0}));
    MassProperties box = solid_box(10, {0.3, 0.3, 0.3});
    box.center = {aside, 10 - std::sqrt(100 - aside * aside), 0};
    const std::uint32_t body = add_body(scene, box);
    add_spherical(scene, point_at(0), point_on_body(scene, body, {0, 10, 0}));
    World world(scene, direct);
    std::uint32_t fell = 0;
    for (int i = 0; i < 600; ++i) fell += world.step(1.0 / 60).fell_asleep;
    EXPECT_EQ(fell, aside > 0 ? 0u : 1u);
  }
}

// A step is a world's, without its checks.
TEST(Step, IsThatOfAWorld) {
  const Scene scene = scenes::make_chain(8);
  Step step(shared(scene), direct);
  World world(scene, direct);
  for (int i = 0; i < 10; ++i) {
    step.move_anchor(0, {0.01 * i, 0, 0});
    world.move_anchor(0, {0.01 * i, 0, 0});
    step.run(1.0 / 60);
    world.step(1.0 / 60);
  }
  EXPECT_EQ(step.state_hash(), world.state_hash());
  EXPECT_EQ(step.position(8), world.position(8));
  EXPECT_EQ(step.velocity(8), world.velocity(8));
}

// Two ropes that hang from one anchor are two islands, and the anchor is of neither.
TEST(Step, SaysWhichIslandAParticleIsOf) {
  Scene scene;
  scene.particles = {test::fixed({}), test::movable({1, 0, 0}), test::movable({2, 0, 0}),
                     test::movable({0, 0, 1})};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}, {.a = 0, .b = 3}};
  const Step step(shared(scene), direct);
  const Standing anchor = step.standing(0), first = step.standing(1), second = step.standing(3);
  EXPECT_EQ(anchor.island, Standing{}.island);
  EXPECT_EQ(first.island, step.standing(2).island);
  EXPECT_NE(first.island, second.island);
  EXPECT_NE(second.island, anchor.island);
  EXPECT_FALSE(first.is_asleep || second.is_asleep);
}

TEST(AdvancePiece, TakesEqualSubsteps) {
  const Scene scene = scenes::make_chain(8);
  Compiled one = compile(shared(scene), direct), other = compile(shared(scene), direct);
  Team team(1);
  StepReport by_rules;
  Tally by_hand;
  one.solvers[0]->begin_step(0.1, team);
  advance_piece(*one.solvers[0], 0, 0.1, {.substeps = 4, .most_work = 1000}, 0, by_rules);
  other.solvers[0]->begin_step(0.1, team);
  other.solvers[0]->advance(0, 0.025, 4, 0, by_hand);
  EXPECT_EQ(by_rules.direct_substeps, by_hand.direct_substeps);
  const Place place = one.places.of(8).front();
  EXPECT_EQ(one.solvers[0]->position(place.slot), other.solvers[0]->position(place.slot));
}

// The finer the error that may grow, the more substeps.
TEST(AdvancePiece, TakesMoreSubstepsForLessError) {
  const Scene scene = scenes::make_chain(8);
  std::uint64_t last = 0;
  for (const double growth : {1e-2, 1e-4, 1e-6}) {
    Settings settings = direct;
    settings.accuracy = 1e-3;  // so that solvers keep what errors are estimated from
    Compiled compiled = compile(shared(scene), settings);
    Team team(1);
    StepReport report;
    for (int i = 0; i < 5; ++i) {
      compiled.solvers[0]->begin_step(0.05, team);
      advance_piece(*compiled.solvers[0], 0, 0.05,
                    {.substeps = 1, .error_growth = growth, .most_work = 100000}, 0, report);
    }
    EXPECT_GT(report.direct_substeps, last) << growth;
    last = report.direct_substeps;
  }
}

// Conditions of order: shares add up to 1, so do none of their odd powers below the order (to rounding), and
// they read the same backwards.
TEST(Composition, MeetsTheConditionsOfItsOrder) {
  for (const std::uint32_t order : {2u, 4u, 6u}) {
    const std::span<const double> shares = composition(order);
    for (std::uint32_t power = 1; power < order; power += 2) {
      double sum = 0;
      for (const double share : shares) sum += std::pow(share, power);
      EXPECT_NEAR(sum, power == 1 ? 1 : 0, 1e-14) << order << ", power " << power;
    }
    for (std::size_t i = 0; i < shares.size(); ++i) {
      EXPECT_EQ(shares[i], shares[shares.size() - 1 - i]);
      EXPECT_LE(std::abs(shares[i]), largest_share(order));
    }
  }
  EXPECT_EQ(pieces_of(0.3), 1u);
  EXPECT_EQ(pieces_of(2.1), 3u);
  EXPECT_EQ(pieces_of(1e9), 64u);
}

TEST(Workers, AreAsManyAsAsked) {
  EXPECT_EQ(Workers(direct).size(), 1u);
  test::SerialExecutor three(3);
  Settings with = direct;
  with.executor = &three;
  EXPECT_EQ(Workers(with).size(), 1u) << "threads were set";
  with.threads = 0;
  Workers workers(with);
  EXPECT_EQ(workers.size(), 3u) << "as many as the executor offers";
  for (const bool together : {false, true}) {
    unsigned parts = 0;
    workers.lead(together, [&] { parts = workers.team().parts(); });
    EXPECT_EQ(parts, together ? 3u : 1u);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
