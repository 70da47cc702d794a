// Reels: the equations of ropes whose length changes, orders in time, what drums hold, and that nothing jumps
// where particles come out or go in.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/reeled_chain.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using std::numbers::pi;
using test::make_reeled;
using test::ReeledChain;

constexpr double g = 9.81;

Settings direct(Gradient gradient, std::uint32_t substeps = 1) {
  return {.method = Method::direct, .gradient = gradient, .substeps = substeps, .tensions = true};
}

Vec3 slanted(double angle) {
  return {std::sin(angle), -std::cos(angle), 0};
}

/// Reels at a rate (m/s) through `steps` steps of dt (s).
StepReport reel_at(World& world, double rate, double dt, int steps) {
  StepReport total;
  for (int i = 0; i < steps; ++i) {
    world.set_reel(0, world.reel_out(0) + rate * dt);
    total += world.step(dt);
  }
  return total;
}

/// Where a pendulum on a drum is, by r phi'' = -2 r' phi' - g sin phi and Runge and Kutta's method. It starts
/// at rest but for its rope.
double swung(double length, double rate, double angle, double t) {
  using State = std::array<double, 2>;
  const auto slope = [&](const State& s, double time) {
    const double r = length + rate * time;
    return State{s[1], (-2 * rate * s[1] - g * std::sin(s[0])) / r};
  };
  State s{angle, 0};
  constexpr int steps = 4000;
  const double h = t / steps;
  const auto moved = [](const State& from, double by, const State& way) {
    return State{from[0] + by * way[0], from[1] + by * way[1]};
  };
  for (int i = 0; i < steps; ++i) {
    const double now = i * h;
    const State a = slope(s, now), b = slope(moved(s, h / 2, a), now + h / 2),
                c = slope(moved(s, h / 2, b), now + h / 2), d = slope(moved(s, h, c), now + h);
    for (std::size_t k = 0; k < 2; ++k) s[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return s[0];
}

TEST(Reels, APendulumOnADrumFollowsItsEquation) {
  for (const double rate : {0.5, -0.5}) {
    const double truth = swung(0.9, rate, 1, 1);
    for (const auto& [gradient, order] : {std::pair{Gradient::mid, 2}, std::pair{Gradient::new_, 1}}) {
      const auto error = [&, gradient = gradient](int steps) {
        World world(make_reeled({.rods = 1, .length = 1.5, .mass = 2, .direction = slanted(1), .out = 0.9}),
                    direct(gradient));
        reel_at(world, rate, 1.0 / steps, steps);
        const Vec3 at = world.position(1);
        EXPECT_NEAR(norm(at), 0.9 + rate, 1e-12);
        return std::abs(std::atan2(at.x, -at.y) - truth);
      };
      const double coarse = error(800), fine = error(1600);
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.06);
      EXPECT_LT(fine, order == 2 ? 1e-5 : 3e-2);
    }
  }
}

TEST(Reels, AStraightRopePullsWithItsWeightAndRisesAsTheDrumTurns) {
  const ReeledChain chain{.rods = 10, .length = 0.1, .mass = 0.2};
  const Scene scene = make_reeled(chain);
  World world(scene, direct(Gradient::mid, 4));
  double energy = test::energy_of(scene, world).potential;
  for (const double rate : {-0.5, 0.5}) {
    reel_at(world, rate, 0.01, 1);  // begins with a blow
    for (int i = 1; i < 160; ++i) {
      reel_at(world, rate, 0.01, 1);
      const double out = world.reel_out(0), drawn = out - std::floor(out / 0.1 + 1e-9) * 0.1;
      for (std::uint32_t k = 1; k <= 10; ++k) {
        const double place = std::min(0.0, -(out - (10 - k) * 0.1));
        ASSERT_NEAR(world.position(k).y, place, 1e-12) << k << " at " << out;
        if (place < -1e-9) {
          ASSERT_NEAR(world.velocity(k).y, -rate, 1e-9) << k << " at " << out;
        }
      }
      // Particles that start or stop at the drum within this step take their momentum from it.
      if (drawn > 0.006 && drawn < 0.094) {
        ASSERT_NEAR(world.reaction(0).y, 10 * 0.2 * g, 1e-7) << out;
      }
      ASSERT_TRUE(world.problems(1e-9).empty());
    }
    if (rate > 0) break;
    double risen = 0;  // by the way of every particle to the drum, or with the end
    for (std::uint32_t k = 1; k <= 10; ++k) risen += std::min(0.1 * k, 0.8);
    const double now = test::energy_of(scene, world).potential;
    EXPECT_NEAR(now - energy, 0.2 * g * risen, 1e-12);
  }
  EXPECT_NEAR(test::energy_of(scene, world).potential, energy, 1e-12) << "out again";
}

/// How far positions are from those of twice as many substeps, and from those of four times as many.
std::array<double, 2> refined(const Scene& scene, double rate, Gradient gradient, std::uint32_t substeps) {
  std::vector<std::vector<Vec3>> ends;
  for (const std::uint32_t times : {1u, 2u, 4u}) {
    World world(scene, direct(gradient, times * substeps));
    const StepReport report = reel_at(world, rate, 0.02, 50);
    EXPECT_EQ(report.fallbacks + report.unsolved + report.elastic_substeps, 0u);
    ends.push_back(test::positions_of(world));
  }
  return {rms_distance(ends[0], ends[1]), rms_distance(ends[1], ends[2])};
}

TEST(Reels, SwingingRopesKeepTheOrderThroughAllThatComesOutOrGoesIn) {
  const RodLaw elastic{.stiffness = 500}, soft{.stiffness = 50};
  for (const RodLaw& law : {RodLaw{}, elastic, soft})
    for (const double rate : {0.6, -0.6}) {
      const Scene scene = make_reeled(
          {.rods = 6, .length = 0.2, .direction = slanted(0.5), .out = rate > 0 ? 0.5 : 1.2, .law = law});
      const auto [mid, finer_mid] = refined(scene, rate, Gradient::mid, law == soft ? 256 : 16);
      EXPECT_NEAR(std::log2(mid / finer_mid), 2, 0.3) << rate << law.is_elastic();
      EXPECT_LT(finer_mid, 1e-4);
      const auto [late, finer_late] = refined(scene, rate, Gradient::new_, 64);
      EXPECT_NEAR(std::log2(late / finer_late), 1, 0.3) << rate << law.is_elastic();
    }
}

/// Reels a swinging rope of 1.2 m and 1.2 kg at a rate (m/s) for a second, and returns by how much its energy
/// grows more than by the drum's work, in J. `parts` rods make 0.2 m.
double energy_from_nowhere(double rate, std::uint32_t parts, int steps) {
  const double length = 0.2 / parts, mass = 0.2 / parts;
  const Scene scene = make_reeled({.rods = 6 * parts,
                                   .length = length,
                                   .mass = mass,
                                   .direction = slanted(0.5),
                                   .out = rate > 0 ? 0.45 : 1.15});
  World world(scene, direct(Gradient::mid));
  const double dt = 1.0 / steps;
  reel_at(world, rate, dt, 1);  // begins with a blow
  const double start = test::energy_of(scene, world).total();
  double work = 0;
  const auto end = [&] {  // of the line from the drum: the first particle that is not on it
    for (std::uint32_t k = 1;; ++k)
      if (world.position(k) != Vec3{}) return world.position(k);
  };
  for (int i = 1; i < steps; ++i) {
    const Vec3 before = end();
    reel_at(world, rate, dt, 1);
    const Vec3 way = before + end();
    const double wound = std::floor((1.2 - world.reel_out(0) + rate * dt / 2) / length);
    const Vec3 pull = world.reaction(0) - Vec3{0, wound * mass * g, 0};
    work += rate * dt / norm(way) * dot(pull, way);
  }
  // A particle that comes out gets the rope's speed at once: half of that work is lost. One that goes in
  // gives the drum half of what its momentum would do. As many do either as 0.6 m have.
  const double lost = (rate > 0 ? 1 : -1) * 3 * 0.2 / 2 * rate * rate;
  return test::energy_of(scene, world).total() - start - (work - lost);
}

TEST(Reels, TheDrumsWorkIsTheEnergyThatTheRopeGains) {
  // Out of the drum it is, to the order of what a mean force over a step leaves: the second, and the first
  // where a particle gets its speed within one.
  const double coarse = energy_from_nowhere(0.6, 1, 200), fine = energy_from_nowhere(0.6, 1, 800);
  EXPECT_LT(std::abs(fine), 0.3 * std::abs(coarse));
  EXPECT_LT(std::abs(fine), 1e-5);
  // What comes in round a corner loses its motion across the line: of 5 J less than a thousandth, and of
  // shorter rods less.
  EXPECT_LT(std::abs(energy_from_nowhere(-0.6, 1, 800)), 5e-3);
  EXPECT_LT(std::abs(energy_from_nowhere(-0.6, 4, 800)), 5e-4);
}

TEST(Reels, NothingThatIsOutJumps) {
  for (const double rate : {0.6, -0.6}) {
    // The largest change of a velocity within a short step, of particles that stay out.
    const auto largest = [&](double dt) {
      const Scene scene =
          make_reeled({.rods = 6, .length = 0.2, .direction = slanted(0.5), .out = rate > 0 ? 0.48 : 1.12});
      World world(scene, direct(Gradient::mid, 16));
      reel_at(world, rate, 0.005, 30);
      double most = 0;
      std::vector<Vec3> before = test::velocities_of(world);
      for (int i = 0; i < static_cast<int>(0.5 / dt); ++i) {
        reel_at(world, rate, dt, 1);
        const std::vector<Vec3> now = test::velocities_of(world);
        for (std::uint32_t k = 5; k < 7; ++k) most = std::max(most, norm(now[k] - before[k]));
        before = now;
      }
      return most;
    };
    const double coarse = largest(2e-3), fine = largest(5e-4);
    EXPECT_LT(fine, 0.4 * coarse) << rate << ": accelerations stay finite";
    EXPECT_LT(fine / 5e-4, 40 * g) << rate;
  }
}

TEST(Reels, DrumsHoldWhatChangesTheMomentum) {
  for (const bool moves : {false, true}) {
    const Scene scene = make_reeled({.rods = 8, .length = 0.15, .direction = slanted(0.7), .out = 0.6});
    World world(scene, direct(Gradient::mid, 2));
    Vec3 impulse{};
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
    };
    const Vec3 start = momentum();
    for (int i = 0; i < 300; ++i) {
      world.set_reel(0, 0.6 + 0.5 * std::sin(0.05 * i));
      if (moves) world.move_anchor(0, {0.1 * std::sin(0.03 * i), 0, 0.002 * i});
      world.step(0.01);
      impulse += 0.01 * world.reaction(0);
    }
    // Of the order of rounding over a step's length, 300 times.
    EXPECT_LT(norm(momentum() - start - impulse - 3 * 8 * 0.2 * scene.gravity), 1e-9) << moves;
  }
}

TEST(Reels, WhatHangsFollowsADrumThatTurnsSmoothly) {
  for (const std::uint32_t substeps : {1u, 2u, 3u}) {
    World world(make_reeled({.rods = 1, .length = 2, .mass = 3, .out = 1}), direct(Gradient::mid, substeps));
    double out = 1, rate = 0;
    for (int i = 1; i <= 100; ++i) {
      const double next = 1 + 0.5 * std::sin(0.05 * i), last = rate;
      rate = (next - out) / 0.01;
      out = next;
      world.set_reel(0, out);
      world.step(0.01);
      ASSERT_NEAR(world.velocity(1).y, -rate, 1e-11) << substeps << " at " << i;
      ASSERT_NEAR(world.reaction(0).y, 3 * (g - (rate - last) / 0.01), 1e-8) << substeps << " at " << i;
    }
  }
}

TEST(Reels, ARopeThatGoesInAndOutAHundredTimesIsWhereItWas) {
  // A rope from the drum to an anchor, which hangs in a bow.
  Scene scene = make_reeled({.rods = 8, .length = 0.25, .direction = slanted(1.2)});
  scene.drag = 6;
  scene.particles.push_back(test::fixed({1.3, -0.2, 0.1}));
  scene.rods.push_back({.a = 8, .b = 9, .length = 0.3});
  World world(scene, direct(Gradient::mid, 2));
  test::run(world, 0.02, 400);
  const std::vector<Vec3> start = test::positions_of(world);
  StepReport report;
  for (int i = 1; i <= 100 * 60; ++i) {  // three rods in and out
    world.set_reel(0, 2 - 0.35 * (1 - std::cos(2 * pi * i / 60)));
    report += world.step(0.04);
  }
  EXPECT_EQ(world.reel_out(0), 2);
  report += test::run(world, 0.02, 400);
  EXPECT_EQ(report.unsolved + report.elastic_substeps + report.fallbacks, 0u);
  EXPECT_LT(rms_distance(test::positions_of(world), start), 1e-9);
}

TEST(Reels, AnElasticRopeHangsAsItsPiecesStretch) {
  constexpr double stiffness = 400, mass = 0.2, length = 0.1;  // of a rod
  Scene scene = make_reeled({.rods = 6, .length = length, .mass = mass, .law = {.stiffness = stiffness}});
  scene.drag = 8;
  World world(scene, direct(Gradient::mid, 2));
  for (const double out : {0.58, 0.5, 0.43, 0.26, 0.3, 0.47}) {
    reel_at(world, (out - world.reel_out(0)) / 0.5, 0.01, 50);
    world.set_reel(0, out);
    test::run(world, 0.02, 400);
    // Every piece carries what hangs below, and a piece of a rod is the stiffer, the shorter it is.
    const double below = std::ceil(out / length - 1e-9), piece = out - (below - 1) * length;
    double place = piece + piece / length * below * mass * g / stiffness;
    for (double k = below - 1; k > 0; --k) place += length + k * mass * g / stiffness;
    EXPECT_NEAR(world.position(6).y, -place, 1e-9) << out;
  }
}

TEST(Reels, TwoWinchesShareALoadAndAWellSleepsUntilOneTurns) {
  Scene scene = make_reeled({.rods = 4, .length = 0.5, .mass = 0.1, .direction = slanted(pi / 4)});
  scene.particles.back().mass = 10;
  const double across = 4 * std::sqrt(0.5);
  scene.particles.push_back(test::fixed({across, 0, 0}));
  Reel other{.particles = {5}};
  for (std::uint32_t i = 1; i < 4; ++i) {
    scene.particles.push_back(test::movable({across - i * std::sqrt(0.125), -i * std::sqrt(0.125), 0}, 0.1));
    scene.rods.push_back({.a = i == 1 ? 5 : 4 + i, .b = 5 + i, .length = 0.5});
    other.particles.push_back(5 + i);
  }
  scene.rods.push_back({.a = 8, .b = 4, .length = 0.5});
  other.particles.push_back(4);
  scene.reels.push_back(other);
  scene.drag = 10;
  World world(scene, direct(Gradient::mid));
  const StepReport report = test::run(world, 0.02, 1500);
  EXPECT_EQ(report.fell_asleep, 1u);
  EXPECT_EQ(world.step(0.02).awake_islands, 0u);
  StepReport turning;
  for (int i = 1; i <= 100; ++i) {
    world.set_reel(0, 2 - 0.004 * i);
    world.set_reel(1, 2 - 0.004 * i);
    turning += world.step(0.02);
  }
  EXPECT_EQ(turning.unsolved + turning.elastic_substeps, 0u);
  turning += test::run(world, 0.02, 500);
  EXPECT_NEAR(world.position(4).x, across / 2, 1e-9) << "both took in as much";
  EXPECT_NEAR(world.reaction(0).y + world.reaction(5).y, (10 + 6 * 0.1) * g, 1e-7);
  EXPECT_TRUE(world.problems(1e-9).empty());
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
