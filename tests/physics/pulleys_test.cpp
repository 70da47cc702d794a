// Pulleys with friction: Atwood's machine, hoists, what friction takes, and the order in time.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/reactions.hpp"
#include "support/swinging_machine.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using std::numbers::pi;
using test::atwood;
using test::direct_with_tensions;
using test::fixed;
using test::movable;

constexpr double g = 9.81;

TEST(Pulleys, AtwoodsMachineSlidesAtItsRate) {
  const double ratio = std::exp(0.2 * pi);
  for (const Gradient gradient : {Gradient::mid, Gradient::new_})
    for (const bool goes_on : {false, true}) {
      World world(goes_on ? atwood({1, 3}, 0.2) : atwood({3, 1}, 0.2), direct_with_tensions(gradient, 4));
      const StepReport report = test::run(world, 0.01, 30);
      const double rate = g * (3 - ratio) / (3 + ratio), t = 0.3;
      const double light = world.position(goes_on ? 0 : 2).y, start = goes_on ? -2 : -1;
      EXPECT_NEAR(light, start + rate / 2 * t * t, 1e-12);
      const double before = world.tackle_tension(0, 0), behind = world.tackle_tension(0, 1);
      EXPECT_NEAR(goes_on ? behind / before : before / behind, ratio, 1e-12);
      EXPECT_EQ(before, world.tackle_tension(0));
      EXPECT_NEAR(behind, (goes_on ? 3 * (g - rate) : g + rate), 1e-9);
      EXPECT_NEAR(world.reaction(1).y, before + behind, 1e-9);
      EXPECT_EQ(report.fallbacks + report.unsolved + report.halvings + report.elastic_substeps, 0u);
    }
}

TEST(Pulleys, AtwoodsMachineStandsStillWhileFrictionHoldsIt) {
  const double ratio = std::exp(0.2 * pi);
  for (const Gradient gradient : {Gradient::mid, Gradient::new_})
    for (const double share : {0.999, 1.001}) {
      World world(atwood({2, 2 * share * ratio}, 0.2), direct_with_tensions(gradient));
      test::run(world, 1.0 / 60, 600);
      if (share > 1) {
        EXPECT_LT(world.position(2).y, -1.1);
        continue;
      }
      // What sticks creeps by 1e-10 of the way that a load falls in a substep: 1.4e-13 m, 600 times.
      EXPECT_NEAR(world.position(2).y, -1, 1e-10);
      EXPECT_LT(norm(world.velocity(2)), 1e-10);
      EXPECT_NEAR(world.tackle_tension(0, 0), 2 * g, 1e-8);
      EXPECT_NEAR(world.tackle_tension(0, 1), 2 * share * ratio * g, 1e-8);
    }
}

TEST(Pulleys, AMachineInALiftThatAcceleratesWeighsMore) {
  const double ratio = std::exp(0.2 * pi), rate = 6, dt = 0.01;
  for (const double share : {0.95, 1.05}) {
    World world(atwood({2, 2 * share * ratio}, 0.2), direct_with_tensions(Gradient::mid));
    world.step(dt);  // a blow in the very first step would find no friction yet
    for (int i = 1; i <= 50; ++i) {
      world.move_anchor(1, {0, rate / 2 * i * dt * i * dt, 0});
      world.step(dt);
    }
    // Either it holds as it would at rest, or it slides as if gravity were larger.
    const double slid = share > 1 ? (share - 1) / (share + 1) : 0, slides = (g + rate) * slid, t = 50 * dt;
    const double way = slid * g * dt * (dt / 2 + t) + slides / 2 * t * t;
    EXPECT_NEAR(world.position(0).y - world.position(1).y, -2 + way, 1e-9);
    EXPECT_NEAR(world.tackle_tension(0), 2 * (g + rate + slides), 1e-6);
  }
}

TEST(Pulleys, AMachineThatComesToRestStaysWhereItStops) {
  // It is pushed at 1 m/s, loses speed at a known rate, and then friction holds it.
  const double ratio = std::exp(0.2 * pi), rate = g * (2.5 * ratio - 3) / (2.5 * ratio + 3);
  const double way = 1 / (2 * rate);
  double last = 0;
  for (const int steps : {100, 400, 1600}) {
    Scene scene = atwood({2.5, 3}, 0.2);
    scene.particles[0].velocity = {0, 1, 0};
    scene.particles[2].velocity = {0, -1, 0};
    World world(scene, direct_with_tensions(Gradient::mid));
    const StepReport report = test::run(world, 1.0 / steps, steps);
    // Within the substep in which it stops it goes too far by less than that substep's way.
    const double error = std::abs(world.position(0).y + 2 - way);
    EXPECT_LT(error, rate / steps / steps);
    EXPECT_LT(norm(world.velocity(0)), 1e-9) << "gradient mid does not let it swing about its place";
    EXPECT_NEAR(world.tackle_tension(0, 1), 3 * g, 1e-6);
    EXPECT_EQ(report.fallbacks + report.unsolved + report.elastic_substeps, 0u);
    last = error;
  }
  EXPECT_LT(last, 2e-6);
}

TEST(Pulleys, SwingingMachinesConvergeToTheTruthWithTheirOrder) {
  // It falls until 0.4 s, well before the cord is twice as long and phi passes zero.
  const Vec3 truth = test::swung(0.3, 1, 0.2, 1, 0.35);
  for (const auto& [gradient, order] : {std::pair{Gradient::mid, 2}, std::pair{Gradient::new_, 1}}) {
    const auto error = [&, gradient = gradient](int steps) {
      World world(atwood({0.3, 1}, 0.2, 1), direct_with_tensions(gradient));
      test::run(world, 0.35 / steps, steps);
      return norm(world.position(2) - truth);
    };
    const double coarse = error(100), fine = error(200);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.05);
    EXPECT_LT(fine, order == 2 ? 2e-5 : 1e-2);
  }
}

/// A load of 100 kg on `falls` falls of a cord, which is wound at the first particle.
Scene hoist(std::uint32_t falls, double friction) {
  Scene scene;
  scene.particles = {fixed({-0.1, 0, 0}), fixed({0.1, 0, 0}), movable({0, -3, 0}, 100)};
  Tackle& tackle = scene.tackles.emplace_back();
  tackle.particles = {0};
  for (std::uint32_t fall = 0; fall < falls; fall += 2) {
    tackle.particles.push_back(2);
    tackle.particles.push_back(1);
  }
  tackle.friction = friction;
  return scene;
}

/// Returns by which of its forces each fall of a hoist holds the load: its direction's upward part.
double lean(const World& world, std::uint32_t segment) {
  const Vec3 way = world.position(segment == 0 ? 0 : 1) - world.position(2);
  return way.y / norm(way);
}

TEST(Pulleys, HoistsLiftAndLowerWithTheirRatio) {
  for (const std::uint32_t falls : {2u, 4u, 6u})
    for (const double way : {1.0, -1.0}) {
      const Scene scene = hoist(falls, 0.1);
      World world(scene, direct_with_tensions(Gradient::mid, 4));
      StepReport report;
      const double start = tackle_length(scene, 0), dt = 0.01;
      for (int i = 1; i <= 200; ++i) {
        const double s = i / 200.0;
        world.set_tackle_length(0, start - way * falls * 0.5 * s * s);  // from rest, without a jolt
        report += world.step(dt);
      }
      // Hauled in, every segment pulls less than the one before, by the angle that the cord turns there.
      const Vec3 to_first = world.position(0) - world.position(2),
                 to_second = world.position(1) - world.position(2);
      const double corner = std::acos(dot(to_first, to_second) / (norm(to_first) * norm(to_second)));
      double share = 1, sum = 0;
      for (std::uint32_t s = 0; s < falls; ++s) {
        if (s > 0) share *= std::exp(-way * 0.1 * (s == 1 ? pi - corner : pi));
        EXPECT_NEAR(world.tackle_tension(0, s) / world.tackle_tension(0), share, 1e-3 * share) << falls << s;
        sum += share * lean(world, s);
      }
      // The load rises at 0.25 m/s^2, a constant rate.
      EXPECT_NEAR(world.tackle_tension(0) * sum / (100 * (g + way * 0.25)), 1, 1e-3) << falls << way;
      EXPECT_EQ(report.fallbacks + report.unsolved + report.elastic_substeps, 0u);
    }
}

/// A cord over two anchors and through two loads and a free end, one of which swings on a rod. There is no
/// gravity unless it is asked for.
Scene rig(const RodLaw& law, double friction) {
  Scene scene;
  scene.particles = {movable({-1.5, -1, 0}, 1, {0, 0.3, 0.2}),  fixed({-1, 0, 0}),
                     movable({0, -1.2, 0.1}, 3, {0.5, 0, 0.1}), fixed({1, 0.2, 0}),
                     movable({1.4, -1, 0}, 1.5, {0, 0, -0.3}),  movable({0.1, -1.8, 0}, 0.5)};
  scene.rods = {{.a = 2, .b = 5}};
  scene.tackles = {{.particles = {0, 1, 2, 3, 4}, .law = law, .friction = friction}};
  return scene;
}

/// Says how long the segments of a scene's first tackle are.
std::vector<double> segments_of(const Scene& scene, const World& world) {
  std::vector<double> out;
  const auto& particles = scene.tackles[0].particles;
  for (std::size_t s = 1; s < particles.size(); ++s)
    out.push_back(norm(world.position(particles[s]) - world.position(particles[s - 1])));
  return out;
}

TEST(Pulleys, FrictionTakesEnergyAtEveryPulleyAndNothingElseDoes) {
  for (const double stiffness : {std::numeric_limits<double>::infinity(), 2000.0})
    for (const double friction : {0.02, 0.15, 0.5}) {
      const Scene scene = rig({.stiffness = stiffness}, friction);
      World world(scene, direct_with_tensions(Gradient::mid));
      const auto energy = [&] { return test::energy_of(scene, world).total(); };
      const double range = energy_range(scene);
      double last = energy();
      std::vector<double> before = segments_of(scene, world);
      std::array<bool, 4> stuck{};
      int kept = 0;
      StepReport report;
      for (int i = 0; i < 2000; ++i) {
        report += world.step(1.0 / 500);
        const std::vector<double> now = segments_of(scene, world);
        double taken = 0, behind = 0;
        bool stops = false;
        for (std::uint32_t s = 4; s-- > 1;) {
          behind += now[s] - before[s];
          const double more = world.tackle_tension(0, s) - world.tackle_tension(0, s - 1);
          // Lengths are known to rounding.
          EXPECT_GT(more * behind, -1e-12 * range) << i << " " << s;
          taken += more * behind;
          const bool sticks = std::abs(behind) < 1e-9;
          stops = stops || (sticks && !stuck[s]);
          stuck[s] = sticks;
        }
        const double next = energy();
        // Where a cord comes to rest, what is left of its motion goes, too.
        EXPECT_GT(last - next, taken - 1e-9 * range) << i;
        if (!stops) {
          ++kept;
          EXPECT_LT(last - next, taken + 1e-9 * range) << i;
        }
        last = next;
        before = now;
      }
      EXPECT_GT(kept, 1500) << stiffness << " " << friction;
      EXPECT_EQ(report.fallbacks + report.unsolved + report.elastic_substeps, 0u) << stiffness << friction;
    }
}

// A drum that turns round turns the slide over the pulley round within a blow. Friction takes energy in it,
// since it acts against the mean of the slides before and after. Against the slide before, it gave 0.06 J.
TEST(Pulleys, BlowsOfADrumThatTurnsRoundGainNothing) {
  for (const bool one_sided : {false, true})
    for (const double stiffness : {std::numeric_limits<double>::infinity(), 1e4})
      for (const std::uint32_t substeps : {1u, 4u}) {
        Scene scene;
        scene.particles = {{.position = {0, 0, 0}, .fixed = true},
                           {.position = {1, 0, 0}, .fixed = true},
                           {.position = {1, -1, 0}, .mass = 2}};
        scene.tackles = {{.particles = {0, 1, 2},
                          .length = std::isfinite(stiffness) ? 2 - 2 * g / stiffness : 0,
                          .law = {.stiffness = stiffness, .one_sided = one_sided},
                          .friction = 0.3}};
        World world(scene, {.method = Method::direct, .substeps = substeps, .tensions = true});
        scene.tackles[0].length = tackle_length(scene, 0);
        double last = test::energy_of(scene, world).total();
        for (int i = 0; i < 16; ++i) {
          constexpr double dt = 1.0 / 60;
          scene.tackles[0].length += (i / 4 % 2 == 1 ? -0.4 : 0.1) * dt;
          world.set_tackle_length(0, scene.tackles[0].length);
          world.step(dt);
          const double now = test::energy_of(scene, world).total();
          EXPECT_LE(now - last, world.tackle_power(0) * dt + 1e-9) << one_sided << stiffness << " " << i;
          last = now;
        }
      }
}

TEST(Pulleys, ReactionsMakeTheChangeOfMomentum) {
  for (const bool one_sided : {false, true}) {
    const Scene scene = rig({.one_sided = one_sided}, 0.2);
    World world(scene, direct_with_tensions(Gradient::mid));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
    };
    Vec3 last = momentum();
    const double dt = 1.0 / 200;
    for (int i = 0; i < 400; ++i) {
      world.step(dt);
      const Vec3 now = momentum();
      EXPECT_LT(norm(1 / dt * (now - last) - (test::sum_of_reactions(world) - Vec3{0, 6 * g, 0})), 1e-7) << i;
      last = now;
    }
  }
}

TEST(Pulleys, AStraightWayHasNoFrictionAndASlackCordNeither) {
  Scene straight;
  straight.gravity = {};
  straight.particles = {movable({0, 0, 0}, 1, {1, 0, 0}), fixed({1, 0, 0}), movable({2, 0, 0}, 2, {1, 0, 0})};
  straight.tackles = {{.particles = {0, 1, 2}, .friction = 2}};
  World world(straight, direct_with_tensions(Gradient::mid));
  test::run(world, 0.01, 50);
  EXPECT_NEAR(world.velocity(2).x, 1, 1e-12);

  Scene slack = atwood({1, 1}, 0.5);
  slack.tackles[0].length = 5;
  slack.tackles[0].law.one_sided = true;
  World falls(slack, direct_with_tensions(Gradient::mid));
  test::run(falls, 0.01, 20);
  EXPECT_NEAR(falls.position(0).y, -2 - g / 2 * 0.04, 1e-12);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
