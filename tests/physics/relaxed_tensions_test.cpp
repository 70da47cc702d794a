// How rods pull that relaxation moves: at rest as solved directly, in motion to second order.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// `count` lines of six rods between two anchors each, that sag; masses differ.
Scene hammocks(RodLaw law, std::uint32_t count, double drag) {
  Scene scene;
  scene.drag = drag;
  for (std::uint32_t k = 0; k < count; ++k)
    for (std::uint32_t i = 0; i <= 6; ++i) {
      const double s = i / 6.0;
      const Vec3 at{1.5 * s, -2 * s * (1 - s), 0};
      scene.particles.push_back(i % 6 == 0 ? test::fixed(at) : test::movable(at, 0.1 + 0.05 * i));
      if (i > 0) scene.rods.push_back({.a = 7 * k + i - 1, .b = 7 * k + i, .law = law});
    }
  return scene;
}

Settings relaxed(Gradient gradient) {
  Settings settings{.method = Method::relax, .gradient = gradient, .threads = 1};
  settings.tensions = true;
  settings.stop.sweeps = 3000;
  settings.stop.tolerance = 1e-13;
  return settings;
}

/// The largest difference of tensions, over the largest of them.
double difference(const World& a, const World& b) {
  double worst = 0, most = 0;
  for (std::uint32_t i = 0; i < a.rod_count(); ++i) {
    worst = std::max(worst, std::abs(a.tension(i) - b.tension(i)));
    most = std::max(most, std::abs(b.tension(i)));
  }
  return worst / most;
}

constexpr RodLaw laws[] = {{}, {.stiffness = 1e4}, {.one_sided = true}, {.stiffness = 1e3, .damping = 2}};

// Rigid rods under gradients new and mid rest elsewhere, see the next test.
TEST(RelaxedTensions, OfACatenaryAreThoseOfMethodDirect) {
  for (const RodLaw& law : laws)
    for (const std::uint32_t count : {1u, 20u}) {
      const Scene scene = hammocks(law, count, 10);
      World direct(scene, {.method = Method::direct, .tensions = true});
      test::run(direct, frame, 900);
      for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_})
        for (const SweepOrder order : {SweepOrder::gauss_seidel, SweepOrder::jacobi}) {
          if (law.is_rigid() && gradient != Gradient::old) continue;
          Settings settings = relaxed(gradient);
          settings.order = order;
          if (order == SweepOrder::gauss_seidel) settings.omega = 1.3;
          World world(scene, settings);
          test::run(world, frame, 900);
          EXPECT_LT(difference(world, direct), 1e-9) << to_string(gradient) << law.stiffness << count;
          double weight = 0;
          for (std::uint32_t i = 1; i < 6; ++i) weight += scene.particles[i].mass * 9.81;
          EXPECT_LT(norm(world.reaction(0) + world.reaction(6) - Vec3{0, weight, 0}), 1e-9 * weight);
        }
    }
}

// A visit's direction turns while sweeps converge, by what a substep turns a rod.
TEST(RelaxedTensions, OfRigidRodsComeNearerWithTheSquareOfTheSubstep) {
  const Scene scene = hammocks({}, 1, 10);
  World direct(scene, {.method = Method::direct, .tensions = true});
  test::run(direct, frame, 900);
  for (const Gradient gradient : {Gradient::mid, Gradient::new_}) {
    double off[2];
    for (const std::uint32_t substeps : {1u, 2u}) {
      Settings settings = relaxed(gradient);
      settings.substeps = substeps;
      World world(scene, settings);
      test::run(world, frame, 900);
      off[substeps - 1] = difference(world, direct);
    }
    EXPECT_LT(off[0], 5e-3);
    EXPECT_NEAR(std::log2(off[0] / off[1]), 2, 0.2) << to_string(gradient);
  }
}

// Gradients old and new have the pull of another place in the substep than its middle.
TEST(RelaxedTensions, InMotionAreOfSecondOrderWithGradientMid) {
  const Scene scene = hammocks({.one_sided = true}, 1, 0);
  World truth(scene,
              {.method = Method::direct, .gradient = Gradient::mid, .substeps = 256, .tensions = true});
  test::run(truth, frame, 15);
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    double off[2];
    for (const std::uint32_t k : {0u, 1u}) {
      Settings settings = relaxed(gradient);
      settings.substeps = 16u << k;
      World world(scene, settings);
      test::run(world, frame, 15);
      off[k] = difference(world, truth);
    }
    EXPECT_LT(off[1], 1e-3);
    EXPECT_NEAR(std::log2(off[0] / off[1]), gradient == Gradient::mid ? 2 : 1, 0.1) << to_string(gradient);
  }
}

// Counting changes no motion, in every layout and precision, with an accuracy and on two threads.
TEST(RelaxedTensions, DoNotChangeTheMotion) {
  for (const LayoutChoice layout : {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa})
    for (const Precision precision : {Precision::single, Precision::double_})
      for (const bool controlled : {false, true}) {
        const Scene scene = hammocks({}, 17, 0.1);
        std::vector<double> tensions[2];
        std::uint64_t hashes[3];
        for (const unsigned run : {0u, 1u, 2u}) {
          Settings settings{.method = Method::relax, .precision = precision};
          settings.layout = layout;
          settings.threads = run == 2 ? 2 : 1;
          settings.tensions = run > 0;
          if (controlled) settings.accuracy = 1e-2;
          World world(scene, settings);
          test::run(world, frame, 20);
          hashes[run] = world.state_hash();
          for (std::uint32_t i = 0; run > 0 && i < world.rod_count(); ++i)
            tensions[run - 1].push_back(world.tension(i));
        }
        EXPECT_EQ(hashes[0], hashes[1]);
        EXPECT_EQ(hashes[0], hashes[2]);
        EXPECT_EQ(tensions[0], tensions[1]);
        EXPECT_TRUE(std::isfinite(tensions[0][0]) && tensions[0][0] != 0);
      }
}

// Blocks that the whole team shares, and those that sleep.
TEST(RelaxedTensions, OfALongRopeAndOfOneThatSleeps) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 3; ++i) {
    const Vec3 at{0, -0.1 * i, 0};
    scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, 1));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  World world(scene, relaxed(Gradient::old));
  EXPECT_TRUE(std::isnan(world.tension(0)));
  StepReport report;
  for (int i = 0; i < 100; ++i) report = world.step(frame);
  EXPECT_EQ(report.awake_islands, 0u);
  EXPECT_NEAR(world.tension(0), 3 * 9.81, 1e-9);
}

/// Three rods that hang straight, of 1 kg each.
Scene plumb_line(RodLaw law) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 3; ++i) {
    const Vec3 at{0, -0.1 * i, 0};
    scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, 1));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = 0.1, .law = law});
  }
  return scene;
}

// What a winch or an anchor pulls with while it changes its speed is what momentum gains, although gradient
// mid is guarded then: such a velocity has a move once, and others twice. Then nothing is guarded any more.
TEST(RelaxedTensions, OfWhatIsHauledAreWhatMomentumGains) {
  for (const RodLaw& law : laws)
    for (const bool by_anchor : {false, true})
      for (const std::uint32_t substeps : {1u, 3u}) {
        Settings settings = relaxed(Gradient::mid);
        settings.substeps = substeps;
        World world(plumb_line(law), settings);
        const auto momentum = [&] { return world.velocity(1).y + world.velocity(2).y + world.velocity(3).y; };
        std::uint64_t guarded = 0;
        double before = momentum(), hauled = 0;
        for (int i = 0; i < 30; ++i) {
          hauled += 1e-4 * std::min(i, 10);
          if (by_anchor)
            world.move_anchor(0, {0, hauled, 0});
          else
            world.set_length(0, 0.1 - hauled);
          guarded += world.step(frame).mid_guarded;
          const double after = momentum();
          ASSERT_NEAR(world.tension(0), 3 * 9.81 + (after - before) / frame, 1e-7)
              << law.stiffness << by_anchor << substeps << " at " << i;
          before = after;
        }
        EXPECT_EQ(guarded, (by_anchor ? 30 : 10) * substeps);
      }
}

// Double pulls would break such a rod.
TEST(RelaxedTensions, BreakNoRodAtHalfItsStrength) {
  for (const double strength : {1.5 * 3 * 9.81, 1.3 * 3 * 9.81}) {
    World world(plumb_line({.strength = strength}), relaxed(Gradient::mid));
    for (int i = 1; i <= 20; ++i) {
      world.move_anchor(0, {0, 1e-3 * i * i / 2, 0});  // by 3.6 m/s²
      world.step(frame);
    }
    EXPECT_EQ(world.is_broken(0), strength < 3 * (9.81 + 3.6));
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
