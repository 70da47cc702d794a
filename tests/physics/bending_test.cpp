// Bends: beams against Euler and Bernoulli, what gradient mid keeps, and what the order in time is.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/beams.hpp"
#include "support/graphs.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using std::numbers::pi;
using test::cantilever;
using test::fixed;
using test::free_beam;
using test::give_velocities;
using test::movable;

Settings direct(Gradient gradient, std::uint32_t substeps = 1) {
  return {.method = Method::direct, .gradient = gradient, .substeps = substeps, .threads = 1};
}

double angle_at(const std::vector<Vec3>& x, const Bend& bend) {
  const Vec3 u = x[bend.b] - x[bend.a], v = x[bend.c] - x[bend.b];
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

/// Where the tip of a cantilever comes to rest under a force (N). In long steps gradient new finds the
/// equilibrium.
Vec3 tip_under(const Scene& scene, Vec3 force) {
  World world(scene, direct(Gradient::new_));
  const auto tip = static_cast<std::uint32_t>(scene.particles.size() - 1);
  world.set_force(tip, force);
  Vec3 last = world.position(tip);
  for (int i = 0; i < 200; ++i) {
    const StepReport report = world.step(10);
    EXPECT_EQ(report.unsolved, 0u);
    const Vec3 now = world.position(tip);
    if (i > 10 && norm(now - last) < 1e-12) return now;
    last = now;
  }
  ADD_FAILURE() << "the beam does not come to rest";
  return last;
}

/// Where the tip of a cantilever lies under a dead load P across it, in units of its length. With theta the
/// angle of its tangent, EI theta'' = -P cos theta, theta(0) = 0, theta'(L) = 0. It is solved by shooting
/// with Runge and Kutta's method; load is P L^2/EI. Bisshopp and Drucker (1945) have 0.8106 and 1 - 0.5550
/// for 10.
std::array<double, 2> elastica_tip(double load) {
  struct State {
    double theta, rate, x, y;
  };
  const auto shoot = [&](double rate) {
    constexpr int steps = 2000;
    constexpr double h = 1.0 / steps;
    const auto slope = [&](const State& s) {
      return State{s.rate, -load * std::cos(s.theta), std::cos(s.theta), std::sin(s.theta)};
    };
    const auto moved = [](const State& s, double t, const State& by) {
      return State{s.theta + t * by.theta, s.rate + t * by.rate, s.x + t * by.x, s.y + t * by.y};
    };
    State s{0, rate, 0, 0};
    for (int i = 0; i < steps; ++i) {
      const State a = slope(s), b = slope(moved(s, h / 2, a)), c = slope(moved(s, h / 2, b)),
                  d = slope(moved(s, h, c));
      s = moved(moved(moved(moved(s, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
    }
    return s;
  };
  double low = 0, high = std::sqrt(2 * load);  // theta'(0)^2 = 2 load sin(theta at the tip)
  for (int i = 0; i < 60; ++i) (shoot((low + high) / 2).rate < 0 ? low : high) = (low + high) / 2;
  const State end = shoot(low);
  return {end.x, end.y};
}

TEST(Bending, ACantileversTipSinksAsEulerAndBernoulliSay) {
  const double force = 0.01;
  const Vec3 tip = tip_under(cantilever(40), {0, -force, 0});
  EXPECT_NEAR(tip.y, -force / 3, 0.01 * force / 3);  // P L^3/(3 EI)
}

// The trapezoidal rule along the beam errs by a quarter as much with rods of half the length.
TEST(Bending, ConvergesToTheElasticaWithOrderTwo) {
  for (const double load : {1.0, 10.0}) {
    const auto [x, y] = elastica_tip(load);
    const auto error = [&](std::uint32_t rods) {
      const Vec3 tip = tip_under(cantilever(rods), {0, -load, 0});
      return norm(tip - Vec3{x, -y, 0});
    };
    const double coarse = error(40), fine = error(80);
    EXPECT_LE(coarse, 1e-3 * std::hypot(1 - x, y)) << load;
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << load;
  }
  const auto [x, y] = elastica_tip(10);
  EXPECT_NEAR(y, 0.8106, 1e-4);
  EXPECT_NEAR(1 - x, 0.5550, 1e-4);
}

// A column that is clamped at its foot buckles under pi^2 EI/(4 L^2). A blow from the side dies out below
// that, and becomes a bow above. Steps are short enough that they do not damp what grows.
TEST(Bending, AColumnBucklesUnderEulersLoad) {
  for (const double share : {0.99, 1.01}) {
    Scene scene = cantilever(40, {0, 1, 0});
    const auto tip = static_cast<std::uint32_t>(scene.particles.size() - 1);
    for (std::uint32_t i = 2; i <= tip; ++i)
      scene.particles[i].velocity = {1e-3 * scene.particles[i].position.y, 0, 0};
    World world(scene, direct(Gradient::new_));
    world.set_force(tip, {0, -share * pi * pi / 4, 0});
    test::run(world, 0.5, 800);
    if (share < 1)
      EXPECT_LE(std::abs(world.position(tip).x), 1e-6);
    else
      EXPECT_GE(std::abs(world.position(tip).x), 0.1);
  }
}

// What is asked for is 1e-9 of the range. A beam that falls from its clamp, one with masses on its rods, one
// at whose rest it is bent, and one whose rods give.
TEST(Bending, GradientMidKeepsEnergy) {
  for (int kind = 0; kind < 4; ++kind) {
    Scene scene = cantilever(20);
    scene.gravity = {0, -9.81, 0};
    for (Bend& bend : scene.bends) bend.angle = kind == 2 ? 0.1 : 0;
    for (Rod& rod : scene.rods) {
      if (kind == 1) rod.mass = 0.05;
      if (kind == 3) rod.law.stiffness = 1e4;
    }
    give_velocities(scene, 5);
    World world(scene, direct(Gradient::mid));
    const auto energy = [&] {
      return measure_energy(scene, test::positions_of(world), test::velocities_of(world),
                            MassModel::consistent)
          .total();
    };
    const double start = energy();
    double largest = 0;
    StepReport total;
    for (int i = 0; i < 1000; ++i) {
      total += world.step(1.0 / 60);
      largest = std::max(largest, std::abs(energy() - start));
    }
    EXPECT_LE(largest, 1e-9 * energy_range(scene)) << kind;
    EXPECT_EQ(total.fallbacks + total.elastic_substeps, 0u) << kind;
  }
}

TEST(Bending, KeepsMomentumAndAngularMomentumInTheAir) {
  for (const double rest : {0.0, 0.3}) {
    Scene scene = free_beam(20, 2);
    for (Bend& bend : scene.bends) {
      bend.angle = rest;
      bend.damping = 1e-3;
    }
    give_velocities(scene, 7);
    World world(scene, direct(Gradient::mid));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world));
    };
    const Momentum start = momentum();
    test::run(world, 1.0 / 60, 300);
    EXPECT_LE(norm(momentum().linear - start.linear), 1e-10);
    EXPECT_LE(norm(momentum().angular - start.angular), 1e-10);
  }
}

// Against a run with a sixteenth of the finer step, which adds 1/256 of its error.
TEST(Bending, OrderInTime) {
  Scene scene = cantilever(8);
  scene.gravity = {0, -9.81, 0};
  const auto end = [&](Gradient gradient, std::uint32_t substeps) {
    World world(scene, direct(gradient, substeps));
    const StepReport report = test::run(world, 1.0 / 60, 20);
    EXPECT_EQ(report.halvings, 0u);
    return test::positions_of(world);
  };
  const std::vector<Vec3> truth = end(Gradient::mid, 1024);
  const auto order = [&](Gradient gradient) {
    return std::log2(rms_distance(end(gradient, 32), truth) / rms_distance(end(gradient, 64), truth));
  };
  EXPECT_NEAR(order(Gradient::mid), 2, 0.15);
  EXPECT_NEAR(order(Gradient::new_), 1, 0.15);
}

// One rod on a clamp is a damped oscillator, m l^2 phi'' = -k phi - c phi', which passes the straight line.
// The curvature 2 tan(phi/2) adds a share of phi^2/6.
TEST(Bending, DampsAsAnOscillator) {
  const double k = 4, c = 0.4, m = 0.25, l = 0.5, phi = 1e-3;
  Scene scene;
  scene.gravity = {};
  scene.particles = {fixed({-l, 0, 0}), fixed({}), movable({l * std::cos(phi), l * std::sin(phi), 0}, m)};
  scene.rods = {{.a = 1, .b = 2, .length = l}};
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = k, .damping = c}};
  const double decay = c / (2 * m * l * l), omega = std::sqrt(k / (m * l * l) - decay * decay);
  const auto truth = [&](double t) {
    return phi * std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
  };
  const auto error = [&](std::uint32_t substeps) {
    World world(scene, direct(Gradient::mid, substeps));
    double sum = 0;
    for (int i = 1; i <= 20; ++i) {
      world.step(0.1);
      const double off = world.position(2).y - l * truth(0.1 * i);
      sum += off * off;
    }
    return std::sqrt(sum / 20);
  };
  const double coarse = error(25), fine = error(100);
  EXPECT_LE(fine, 1e-5 * l * phi);
  EXPECT_NEAR(std::log2(coarse / fine) / 2, 2, 0.3);
}

// Bent wire stays as it is where it is drawn at rest, and comes back where it is not.
TEST(Bending, ARestAngleHoldsAShape) {
  Scene scene = free_beam(12, 3);
  for (Bend& bend : scene.bends) bend.angle = 0.25;
  for (const Gradient gradient : {Gradient::mid, Gradient::new_}) {
    World world(scene, direct(gradient));
    test::run(world, 1.0 / 60, 300);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      EXPECT_LE(norm(world.position(i) - scene.particles[i].position), 1e-12);
  }
  for (Bend& bend : scene.bends) bend.angle = 0.4;
  World world(scene, direct(Gradient::new_));
  test::run(world, 0.5, 400);
  for (const Bend& bend : scene.bends) EXPECT_NEAR(angle_at(test::positions_of(world), bend), 0.4, 1e-6);
}

/// A chain of 4 to 12 rods in any directions, from an anchor or in the air, whose bends are of any stiffness
/// (0.1 to 1,000 N m) and rest at any angle that a bend may have.
Scene random_chain(unsigned seed) {
  test::Random random(seed);
  const auto unit = [&] { return (test::signed_unit(random) + 1) / 2; };
  const auto vector = [&] {
    const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
    return Vec3{x, y, z};
  };
  const std::uint32_t rods = 4 + test::below(random, 9);
  Scene scene;
  scene.particles = {test::below(random, 2) == 0 ? fixed({}) : movable({}, 0.1 + unit())};
  for (std::uint32_t i = 1; i <= rods; ++i) {
    const Vec3 direction = vector();
    const Vec3 from = scene.particles.back().position;
    scene.particles.push_back(
        movable(from + (0.1 + unit()) / norm(direction) * direction, 0.1 + unit(), vector()));
    scene.rods.push_back({.a = i - 1, .b = i});
    if (i == 1) continue;
    Bend& bend = scene.bends.emplace_back();
    bend.a = i - 2;
    bend.b = i - 1;
    bend.c = i;
    bend.stiffness = std::pow(10, 4 * unit() - 1);
    if (test::below(random, 3) > 0) bend.angle = 2.89 * unit();
    if (test::below(random, 3) == 0) bend.damping = unit();
  }
  return scene;
}

// Such bends start far from rest and let go with up to 10^5 J. Substeps are halved, but all are solved.
TEST(Bending, EveryRandomChainIsSolved) {
  for (const Gradient gradient : {Gradient::mid, Gradient::new_}) {
    StepReport total;
    for (unsigned seed = 1; seed <= 40; ++seed) {
      World world(random_chain(seed), direct(gradient));
      total += test::run(world, 1.0 / 60, 20);
    }
    EXPECT_EQ(total.unsolved, 0u);
    EXPECT_EQ(total.elastic_substeps, 0u);
    EXPECT_EQ(total.fallbacks, 0u);
  }
}

// A beam that lies still takes one iteration, however hard its bends pull.
TEST(Bending, APrestressedRingRestsInWholeSubsteps) {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < 40; ++i) {
    const double phi = 2 * pi * i / 40;
    scene.particles.push_back(movable(1 / (2 * pi) * Vec3{std::cos(phi), std::sin(phi), 0}, 0.025));
    scene.particles.back().velocity = {0, 0, 1e-6 * std::cos(2 * phi)};
    scene.rods.push_back({.a = i, .b = (i + 1) % 40});
    scene.bends.push_back({.a = i, .b = (i + 1) % 40, .c = (i + 2) % 40, .stiffness = 40});
  }
  World world(scene, direct(Gradient::mid));
  const StepReport report = test::run(world, 1e-3, 100);
  EXPECT_EQ(report.halvings, 0u);
  EXPECT_LE(report.newton, 200u);
}

// A bend joins what hangs from both sides of an anchor into one island: a beam on a knife edge is one beam.
// Each half sinks as a cantilever of n = 4 rods does, by P L^3/(3 EI) (1 + 1/(2 n^2)).
TEST(Bending, ActsAcrossAnAnchor) {
  Scene scene = free_beam(8, 0);
  scene.particles[4].fixed = true;
  const auto last = static_cast<std::uint32_t>(scene.particles.size() - 1);
  World world(scene, direct(Gradient::new_));
  EXPECT_EQ(world.info().islands, 1u);
  world.set_force(0, {0, -0.1, 0});
  world.set_force(last, {0, -0.1, 0});
  test::run(world, 10, 60);
  EXPECT_NEAR(world.position(0).y, world.position(last).y, 1e-9);
  const double sag = 0.1 * 0.125 / 3 * (1 + 1.0 / 32);
  EXPECT_NEAR(world.position(last).y, -sag, 1e-3 * sag);
}

// The error after a second is that of a second's growth; a third of it and less is seen.
TEST(Bending, KeepsAnAccuracy) {
  Scene scene = cantilever(10);
  scene.gravity = {0, -9.81, 0};
  World fine(scene, direct(Gradient::mid, 1024));
  test::run(fine, 1.0 / 60, 60);
  const std::vector<Vec3> truth = test::positions_of(fine);
  for (const double accuracy : {1e-2, 1e-3, 1e-4}) {
    World world(scene, {.accuracy = accuracy, .threads = 1});
    const StepReport report = test::run(world, 1.0 / 60, 60);
    EXPECT_EQ(report.inaccurate_steps, 0u);
    EXPECT_LE(test::relative_error(scene, world, truth), accuracy);
  }
}

// A program turns a clamp by moving the first of its two particles. The beam follows.
TEST(Bending, FollowsAClampThatTurns) {
  const Scene scene = cantilever(10);
  World world(scene, direct(Gradient::new_));
  for (int i = 1; i <= 60; ++i) {
    const double angle = pi / 2 * i / 60;
    world.move_anchor(0, {-0.1 * std::cos(angle), -0.1 * std::sin(angle), 0});
    world.step(1.0 / 60);
  }
  test::run(world, 10, 60);
  EXPECT_LE(norm(world.position(11) - Vec3{0, 1, 0}), 1e-9);
}

// A beam between anchors that are too far apart is straight, and its rods share what they lack.
TEST(Bending, RodsThatDoNotFitShareWhatTheyLack) {
  Scene scene = cantilever(10);
  scene.gravity = {0, -9.81, 0};
  scene.particles.back() = fixed({1.1, 0, 0});
  World world(scene, direct(Gradient::mid));
  const StepReport report = test::run(world, 1.0 / 60, 60);
  EXPECT_GT(report.elastic_substeps, 0u);
  EXPECT_EQ(report.unsolved, 0u);
  for (std::uint32_t i = 1; i <= 11; ++i)
    EXPECT_LE(norm(world.position(i) - Vec3{0.11 * (i - 1), 0, 0}), 1e-3) << i;
}

// A rod that was broken off turns at the rate it had, because no bend holds it any more.
TEST(Bending, EndsWhereARodBreaks) {
  Scene scene = cantilever(4);
  scene.gravity = {0, -9.81, 0};
  scene.rods[2].law.strength = 1;
  World world(scene, direct(Gradient::mid));
  world.set_force(5, {100, 0, 0});
  world.step(1.0 / 60);
  ASSERT_TRUE(world.is_broken(2));
  world.set_force(5, {});
  const Vec3 before = world.velocity(4) - world.velocity(5);
  test::run(world, 1.0 / 60, 3);
  const Vec3 after = world.velocity(4) - world.velocity(5);
  EXPECT_NEAR(norm(before), norm(after), 1e-9);
}

// A winch in a straight beam keeps it straight, and bends push nothing.
TEST(Bending, RodsThatChangeTheirLengthStayStraight) {
  const Scene scene = cantilever(10);
  World world(scene, direct(Gradient::new_));
  for (int i = 1; i <= 30; ++i) {
    world.set_length(4, 0.1 + 0.002 * i);
    world.step(1.0 / 60);
  }
  test::run(world, 10, 3);
  for (std::uint32_t i = 6; i <= 11; ++i)
    EXPECT_LE(norm(world.position(i) - Vec3{0.1 * (i - 1) + 0.06, 0, 0}), 1e-9) << i;
}

// Two beams with the same rods and other bends, on one thread and two.
TEST(Bending, HasTheSameBitsEverywhere) {
  Scene scene = cantilever(12);
  const Scene one = scene;
  const auto shifted = [](std::uint32_t i) { return i + 14; };
  for (Particle particle : one.particles) {
    particle.position.z = 1;
    scene.particles.push_back(particle);
  }
  for (Rod rod : one.rods) {
    rod.a = shifted(rod.a);
    rod.b = shifted(rod.b);
    scene.rods.push_back(rod);
  }
  for (std::size_t i = 1; i < one.bends.size(); i += 2) {
    Bend bend = one.bends[i];
    bend.a = shifted(bend.a);
    bend.b = shifted(bend.b);
    bend.c = shifted(bend.c);
    scene.bends.push_back(bend);
  }
  scene.gravity = {0, -9.81, 0};
  const auto hash = [&](Isa isa, unsigned threads) {
    World world(scene, {.isa = isa, .threads = threads});
    test::run(world, 1.0 / 60, 30);
    EXPECT_EQ(world.info().islands, 2u);
    return world.state_hash();
  };
  const auto scalar = hash(Isa::scalar, 1);
  EXPECT_EQ(hash(best_isa(), 1), scalar);
  EXPECT_EQ(hash(best_isa(), 2), scalar);
}

TEST(Bending, WhatDoesNotKnowBendsRefusesThem) {
  const Scene scene = cantilever(4);
  const auto refusal = [&](const Scene& of, const Settings& settings) {
    return test::refusal([&] { const World world(of, settings); });
  };
  for (const Method method : {Method::relax, Method::springs, Method::multipliers, Method::featherstone})
    EXPECT_EQ(refusal(scene, {.method = method, .threads = 1}),
              "bend 0: method " + std::string(to_string(method)) + " moves no bends; direct and auto do");
  for (const Method method : {Method::direct, Method::automatic})
    EXPECT_EQ(
        refusal(scene, {.method = method, .gradient = Gradient::old, .threads = 1}),
        "bend 0: gradient old moves no bends: a straight chain has no direction at the old position; mid and "
        "new do");
  EXPECT_EQ(refusal(scene, {.accuracy = 1e-4, .threads = 1}), "");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
