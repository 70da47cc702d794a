// Settings::accuracy: substeps are chosen by an estimate of their error.

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

// The error after a second is within three times of what was asked for: the estimate is of each substep's own
// error, which the motion then carries on.
TEST(DirectAccuracy, IsWhatWasAskedFor) {
  for (const std::uint32_t links : {5u, 20u})
    for (const double end_mass : {1.0, 10.0}) {
      const Scene scene = scenes::make_chain(links, 0.1, end_mass);
      const Frame truth = truth::solve(scene, {.save_at = {1}}).frames.front();
      for (const Gradient gradient : {Gradient::old, Gradient::mid})
        for (const double accuracy : {1e-2, 1e-3, 1e-4}) {
          Settings settings = test::direct(gradient);
          settings.accuracy = accuracy;
          World world(scene, settings);
          test::run(world, 1.0 / 60, 60);
          EXPECT_LE(test::relative_error(scene, world, truth.positions), 3 * accuracy)
              << links << " links, end mass " << end_mass << ", gradient " << to_string(gradient)
              << ", asked " << accuracy;
        }
    }
}

// Gradient new is of first order, which its estimate knows. It damps velocities, which positions at the end
// of a step hardly show and the motion carries on: within ten times.
TEST(DirectAccuracy, IsWhatWasAskedForWithGradientNew) {
  for (const Scene& scene : {scenes::make_chain(5, 0.1, 10), scenes::make_ring({.links = 12})}) {
    Settings fine = test::direct(Gradient::mid, 256);
    World truth(scene, fine);
    test::run(truth, 1.0 / 60, 30);
    Settings settings = test::direct(Gradient::new_);
    settings.accuracy = 1e-3;
    World world(scene, settings);
    EXPECT_EQ(test::run(world, 1.0 / 60, 30).inaccurate_steps, 0u);
    EXPECT_LE(test::relative_error(scene, world, test::positions_of(truth)), 10 * 0.5 * *settings.accuracy);
  }
}

// Also with composed substeps, whose estimate is another; automatic takes them where much is asked for.
TEST(DirectAccuracy, IsWhatWasAskedForWithTimeOrders) {
  const std::pair<const char*, Scene> scenes_to_try[] = {{"chain", scenes::make_chain(20, 0.1, 10)},
                                                         {"rods5", scenes::make_rods5()},
                                                         {"tree", scenes::make_tree()}};
  for (const auto& [name, scene] : scenes_to_try) {
    const Frame truth = truth::solve(scene, {.save_at = {1}}).frames.front();
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      for (const std::uint32_t order : {4u, 6u}) {
        Settings settings = test::direct(Gradient::old);
        settings.time_order = order;
        settings.accuracy = accuracy;
        World world(scene, settings);
        test::run(world, 1.0 / 60, 60);
        EXPECT_LE(test::relative_error(scene, world, truth.positions), 3 * accuracy)
            << name << ", order " << order << ", asked " << accuracy;
      }
      World world(scene, {.method = Method::automatic, .accuracy = accuracy, .threads = 1});
      const bool is_short = scene.rods.size() < 10;  // order 4 pays from 1.7e-4 on for 9, 5e-5 for 20
      EXPECT_EQ(world.info().direct_time_order, accuracy < 1e-5 || is_short ? 4u : 2u);
      test::run(world, 1.0 / 60, 60);
      EXPECT_LE(test::relative_error(scene, world, truth.positions), 3 * accuracy)
          << name << ", automatic, asked " << accuracy;
    }
  }
}

// Each island takes the time order that pays for its size.
TEST(DirectAccuracy, TakesTheTimeOrderOfEveryIsland) {
  Scene both = scenes::make_chain(5, 0.1, 10);
  const Scene chain = scenes::make_chain(100);
  for (const Rod& rod : chain.rods) {
    Rod moved = rod;
    moved.a += 6;
    moved.b += 6;
    both.rods.push_back(moved);
  }
  for (Particle particle : chain.particles) {
    particle.position.z = 1;
    both.particles.push_back(particle);
  }
  const double accuracy = 5e-5;
  World world(both, {.method = Method::automatic, .accuracy = accuracy, .threads = 1});
  EXPECT_EQ(world.info().direct_time_order, 4u);
  const StepReport report = test::run(world, 1.0 / 60, 60);
  EXPECT_EQ(report.inaccurate_steps, 0u);
  // Both at order 4 would take the long chain ten parts a step at least, and as many again for each piece
  // that stability wants (5 or so), three times what order 2 does.
  Settings fourth = test::direct(Gradient::old);
  fourth.accuracy = accuracy;
  fourth.time_order = 4;
  World all_fourth(both, fourth);
  EXPECT_LT(report.direct_substeps, 0.8 * test::run(all_fourth, 1.0 / 60, 60).direct_substeps);
  World fine(both, test::direct(Gradient::mid, 256));
  test::run(fine, 1.0 / 60, 60);
  EXPECT_LE(test::relative_error(both, world, test::positions_of(fine)), 3 * accuracy);
}

// Rings and trusses by factors, a net by its lines; wide ones are direct with automatic, too, if an accuracy
// is asked for. Against order 4 with 128 substeps, with its distance from 64 on top.
TEST(DirectAccuracy, OfIslandsWithLoopsIsWhatWasAskedFor) {
  Scene net = scenes::make_net({.width = 14, .height = 14, .level = 1});
  net.gravity = {3, -9, 2};
  const std::pair<const char*, Scene> scenes_to_try[] = {
      {"ring", scenes::make_ring({.links = 12})},
      {"truss", scenes::make_truss({.bays = 6, .braces = 2, .fixed = 2})},
      {"net", net}};
  for (const auto& [name, scene] : scenes_to_try) {
    const auto run = [&scene = scene](const Settings& settings) {
      World world(scene, settings);
      const StepReport report = test::run(world, 1.0 / 60, 30);
      EXPECT_EQ(report.inaccurate_steps, 0u);
      EXPECT_EQ(world.info().relaxed_rods, 0u);
      return test::positions_of(world);
    };
    Settings fine = test::direct(Gradient::old, 128);
    fine.time_order = 4;
    const std::vector<Vec3> truth = run(fine);
    fine.substeps = 64;
    const double known = rms_distance(truth, run(fine));
    for (const double accuracy : {1e-3, 1e-5}) {
      Settings settings{.method = Method::automatic, .accuracy = accuracy, .threads = 1};
      EXPECT_LE(rms_distance(run(settings), truth), known + 3 * accuracy * bounding_diagonal(scene)) << name;
      settings.method = Method::direct;
      settings.gradient = Gradient::mid;
      EXPECT_LE(rms_distance(run(settings), truth), known + 3 * accuracy * bounding_diagonal(scene)) << name;
    }
  }
}

// A blow that no substep resolves, and rods that cannot be held: counted, without a search for ever finer
// steps, and forgotten in the next step.
TEST(DirectAccuracy, DoesNotChaseWhatCannotBeHad) {
  const Scene net = scenes::make_net({.width = 14, .height = 14, .level = 1});
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    Settings settings = test::direct(gradient);
    settings.accuracy = 1e-3;
    World world(net, settings);
    test::run(world, 1.0 / 60, 3);
    world.set_force(100, {0, 1e5, 0});
    const StepReport blow = world.step(1.0 / 60);
    EXPECT_LE(blow.repeated_steps, 7u);
    world.set_force(100, {});
    StepReport after = test::run(world, 1.0 / 60, 2);
    EXPECT_LE(after.direct_substeps, 4000u) << to_string(gradient);
    EXPECT_TRUE(test::all_finite(world));

    Scene too_short = scenes::make_net(8, 8);
    for (Rod& rod : too_short.rods) rod.length = 0.1;
    too_short.particles[7].position.x *= 1.001;
    World taut(too_short, settings);
    const StepReport sagging = test::run(taut, 1.0 / 60, 2);
    EXPECT_GT(sagging.elastic_substeps + sagging.fallbacks, 0u);
    EXPECT_GT(sagging.inaccurate_steps, 0u);
    EXPECT_LE(sagging.repeated_steps, 2 * 7u);
  }
}

// Its substeps go backwards too, past an anchor that moves, and through forces that change.
TEST(DirectAccuracy, HoldsWithMovingAnchorsAndForces) {
  const Scene scene = scenes::make_chain(8, 0.1, 5);
  const auto run = [&](const Settings& settings) {
    World world(scene, settings);
    for (int frame = 0; frame < 60; ++frame) {
      world.move_anchor(0, {0.2 * std::sin(0.1 * (frame + 1)), 0.05 * (frame + 1) / 60.0, 0});
      world.set_force(8, {frame < 30 ? 20.0 : 0.0, 0, 5});
      world.step(1.0 / 60);
    }
    return test::positions_of(world);
  };
  const std::vector<Vec3> fine = run(test::direct(Gradient::mid, 512));
  Settings settings = test::direct(Gradient::old);
  settings.time_order = 4;
  settings.accuracy = 1e-6;
  // mid's own error at 512 substeps: a quarter of what it differs by from 256.
  const double known = rms_distance(fine, run(test::direct(Gradient::mid, 256)));
  EXPECT_LE(rms_distance(run(settings), fine), known + 3e-6 * bounding_diagonal(scene));
}

// An anchor's change of velocity is a blow in one substep, which an estimate by accelerations would refine
// without end.
TEST(DirectAccuracy, IsHadWithAnchorsThatNeverGoStraight) {
  const Scene scenes_to_try[] = {scenes::make_chain(10), scenes::make_ring({.links = 12}),
                                 scenes::make_tree(), scenes::make_truss({.bays = 4, .fixed = 2}),
                                 scenes::make_net({.width = 14, .height = 14, .level = 1})};
  for (const Scene& scene : scenes_to_try) {
    StepReport report;
    const auto run = [&](const Settings& settings) {
      World world(scene, settings);
      report = {};
      for (int frame = 1; frame <= 30; ++frame) {
        const double angle = 0.2 * frame;
        for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
          if (scene.particles[i].fixed)
            world.move_anchor(
                i, scene.particles[i].position + 0.05 * Vec3{std::sin(angle), 0, 1 - std::cos(angle)});
        const StepReport step = world.step(1.0 / 60);
        report.direct_substeps += step.direct_substeps;
        report.inaccurate_steps += step.inaccurate_steps;
      }
      return test::positions_of(world);
    };
    Settings settings = test::direct(Gradient::old, 64);
    settings.time_order = 4;
    const std::vector<Vec3> truth = run(settings);
    for (const double accuracy : {1e-3, 1e-4}) {
      Settings controlled = test::direct(Gradient::old);
      controlled.accuracy = accuracy;
      EXPECT_LE(rms_distance(run(controlled), truth), 3 * accuracy * bounding_diagonal(scene));
      EXPECT_EQ(report.inaccurate_steps, 0u);
      EXPECT_LE(report.direct_substeps, 30u * 100u);  // 100 a step; without a way out it would be 10,000
    }
  }
}

// A step that turns out too coarse is done again, from where it began: a blow in the middle of quiet.
TEST(DirectAccuracy, RepeatsStepsThatWereTooCoarse) {
  Scene scene = scenes::make_chain(10);
  for (std::uint32_t i = 1; i <= 10; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  Settings settings = test::direct(Gradient::mid);
  settings.accuracy = 1e-4;
  World world(scene, settings);
  const StepReport quiet = test::run(world, 1.0 / 60, 60);
  world.set_force(10, {300, 0, 0});
  const StepReport blow = test::run(world, 1.0 / 60, 2);
  EXPECT_GT(blow.repeated_steps, 0u);
  EXPECT_GT(blow.direct_substeps / 2, quiet.direct_substeps / 60);
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-9);
}

// Light rods with a heavy end that whip: from one substep a step to thousands within a few steps, where
// substeps that are too long cannot be solved at all and show no error to go by.
TEST(DirectAccuracy, FindsSubstepsAThousandTimesShorter) {
  Scene scene = scenes::make_chain(3, 0.1, 4000);
  for (Rod& rod : scene.rods) rod = {.a = rod.a, .b = rod.b, .mass = 0.1};
  for (std::size_t i = 1; i < 3; ++i) scene.particles[i].mass = 0.1 * static_cast<double>(i);
  for (std::size_t i = 1; i < 4; ++i) scene.particles[i].position.y = i % 2 ? -0.003 : 0.001;
  scene.particles[3].position.z = 0.01;
  Settings settings = test::direct(Gradient::old);
  settings.accuracy = 0.05;
  World world(scene, settings);
  const StepReport report = test::run(world, 1.0 / 60, 60);
  EXPECT_GT(report.direct_substeps, 60'000u);
  EXPECT_EQ(report.unsolved, 0u);
  EXPECT_LE(report.inaccurate_steps, 3u);
}

// Second order: a hundred times the accuracy for ten times the substeps. Coarser than 1e-4, Newton's own
// limits and the first, cautious substeps decide.
TEST(DirectAccuracy, CostsTheRootOfWhatIsAsked) {
  const Scene scene = scenes::make_chain(20, 0.1, 10);
  const auto substeps = [&](double accuracy) {
    Settings settings = test::direct(Gradient::mid);
    settings.accuracy = accuracy;
    World world(scene, settings);
    return static_cast<double>(test::run(world, 1.0 / 60, 60).direct_substeps);
  };
  EXPECT_LE(substeps(1e-3), substeps(1e-4));
  EXPECT_NEAR(substeps(1e-7) / substeps(1e-5), 10, 3);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
