// Rods whose length changes at a constant rate: the truth of such scenes, and how worlds converge to it.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/world.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/runs/run.hpp"
#include "scenes/spec.hpp"
#include "support/direct.hpp"
#include "support/truths.hpp"
#include "support/worlds.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using scenes::LengthRate;

constexpr double frame = 1.0 / 60;

// Without gravity a ball on a rod that is reeled in keeps its angular momentum, so that it turns by
// spin L0 t / L. The start's velocity gets the rate along the rod.
TEST(WinchTruth, KeepsAngularMomentumOfAnOrbit) {
  constexpr double length = 1, spin = 2, rate = -0.4, t = 1.5;
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::anchor({0, 0, 0}), test::loose({length, 0, 0}, 3)};
  scene.particles[1].velocity = {0, spin * length, 0};
  scene.rods = {{.a = 0, .b = 1}};
  const truth::Truth truth = truth::solve(scene, {.save_at = {t}, .rates = {{.rod = 0, .rate = rate}}});
  const double now = length + rate * t, angle = spin * length * t / now;
  const Vec3 out{std::cos(angle), std::sin(angle), 0};
  EXPECT_LE(norm(truth.frames[0].positions[1] - now * out), 1e-14);
  const Vec3 velocity = rate * out + (spin * length * length / now) * Vec3{-out.y, out.x, 0};
  EXPECT_LE(norm(truth.frames[0].velocities[1] - velocity), 1e-14);
  EXPECT_DOUBLE_EQ(truth.velocity_change, std::abs(rate));
}

// Without gravity the ball on an elastic damped rod that is paid out at a rate follows its length. The excess
// c obeys m c'' = -k c - d (c' + rate), with c' = -rate at the start, since the ball rests then.
TEST(WinchTruth, SwingsAboutTheLengthOfAnElasticRod) {
  constexpr double mass = 2, stiffness = 50, damping = 3, rate = 0.3, t = 0.8;
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::anchor({0, 0, 0}), test::loose({1, 0, 0}, mass)};
  scene.rods = {{.a = 0, .b = 1, .law = {.stiffness = stiffness, .damping = damping}}};
  const truth::Truth truth = truth::solve(scene, {.save_at = {t}, .rates = {{.rod = 0, .rate = rate}}});
  const double decay = damping / (2 * mass), swing = std::sqrt(stiffness / mass - decay * decay);
  const double at_last = -damping * rate / stiffness, sine = -(rate + decay * at_last) / swing;
  const double excess =
      at_last + std::exp(-decay * t) * (sine * std::sin(swing * t) - at_last * std::cos(swing * t));
  EXPECT_NEAR(truth.frames[0].positions[1].x, 1 + rate * t + excess, 1e-14);
}

TEST(WinchTruth, RefusesWhatItCannotReel) {
  const Scene scene = scenes::make_winch({.rods = 2});
  const auto solve = [&](const Scene& of, LengthRate rate) {
    truth::solve(of, {.save_at = {1}, .rates = {rate}});
  };
  EXPECT_THROW(solve(scene, {.rod = 3, .rate = 0.1}), InputError);
  EXPECT_THROW(solve(scene, {.rod = 0, .rate = NAN}), InputError);
  EXPECT_THROW(solve(scene, {.rod = 0, .rate = -1}), InputError) << "to nothing";
  Scene bent = scene;
  bent.bends.push_back({.a = 0, .b = 1, .c = 2, .stiffness = 1});
  EXPECT_THROW(solve(bent, {.rod = 0, .rate = 0.1}), InputError);
}

/// The error of a winch after its run, of the diagonal.
double error_of(const Scene& scene, const truth::Truth& truth, Gradient gradient, std::uint32_t order,
                std::uint32_t substeps) {
  Settings settings{.method = Method::direct, .gradient = gradient, .substeps = substeps, .threads = 1};
  settings.time_order = order;
  const scenes::RunPlan plan{
      .settings = settings, .duration = 0.5, .dt = 1.0 / 60, .rates = {{.rod = 0, .rate = -0.5}}};
  return scenes::run_scene(scene, plan, truth.frames).position_error.back().relative;
}

/// The order of the last halving.
double order_of(const Scene& scene, Gradient gradient, std::uint32_t order, std::uint32_t substeps) {
  const truth::Truth truth = truth::solve(scene, {.save_at = {0.5}, .rates = {{.rod = 0, .rate = -0.5}}});
  return std::log2(error_of(scene, truth, gradient, order, substeps) /
                   error_of(scene, truth, gradient, order, 2 * substeps));
}

// A rigid rope with a load, hauled at half a metre a second from rest. The jerk of the start is exact, so
// that orders are those of rods that keep their lengths.
TEST(Winch, ConvergesAtTheOrderOfItsMethod) {
  const Scene scene = scenes::make_winch({.rods = 5});
  EXPECT_NEAR(order_of(scene, Gradient::old, 2, 32), 2, 0.1);
  EXPECT_NEAR(order_of(scene, Gradient::old, 4, 16), 4, 0.3);
  EXPECT_NEAR(order_of(scene, Gradient::mid, 2, 256), 2, 0.2);
  EXPECT_NEAR(order_of(scene, Gradient::new_, 2, 64), 1, 0.1);
}

// The same of elastic damped rods.
TEST(Winch, OfElasticRodsConvergesToo) {
  Scene scene = scenes::make_winch({.rods = 5});
  for (Rod& rod : scene.rods) rod.law = {.stiffness = 2e4, .damping = 10};
  EXPECT_NEAR(order_of(scene, Gradient::old, 2, 64), 2, 0.1);
  EXPECT_NEAR(order_of(scene, Gradient::mid, 2, 64), 2, 0.2);
}

// A winch: every rod of a rope shortens smoothly, and a load of 100 kg rises by 10 m in 10 s. What a winch
// does is what energy gains, to rounding while gradient mid is not interrupted.
TEST(Winch, DoesTheWorkThatEnergyGains) {
  constexpr std::uint32_t rods = 200;
  constexpr double rod = 0.1;
  for (const double stiffness : {std::numeric_limits<double>::infinity(), 1e6}) {
    for (const std::uint32_t substeps : {1u, 2u}) {
      Scene scene;
      for (std::uint32_t i = 0; i <= rods; ++i) {
        scene.particles.push_back(
            {.position = {0, -rod * i, 0}, .mass = i == rods ? 100 : 0.01, .fixed = i == 0});
        if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = rod, .law = {.stiffness = stiffness}});
      }
      Settings settings = test::direct(Gradient::mid, substeps);
      settings.tensions = true;
      World world(scene, settings);
      Scene now = scene;
      std::vector<Vec3> x(rods + 1), v(rods + 1);
      const auto energy = [&] {
        world.copy_positions(x);
        world.copy_velocities(v);
        return measure_energy(now, x, v).total();
      };
      const double first = energy();
      double work = 0;
      for (int i = 1; i <= 600; ++i) {
        const double s = i / 600.0, length = rod * (1 - 0.5 * s * s * (3 - 2 * s));
        for (std::uint32_t k = 0; k < rods; ++k) {
          now.rods[k].length = length;
          world.set_length(k, length);
        }
        EXPECT_EQ(world.step(frame).unsolved, 0u);
        for (std::uint32_t k = 0; k < rods; ++k) work += world.power(k) * frame;
      }
      EXPECT_NEAR(work / (energy() - first), 1, stiffness < 1e9 ? 1e-5 : 1e-10) << stiffness;
      EXPECT_NEAR(world.position(rods).y, -10, stiffness < 1e9 ? 0.3 : 1e-9);
      for (int i = 0; i < 60; ++i) world.step(frame);
      EXPECT_EQ(world.power(0), 0);
      EXPECT_TRUE(world.problems().empty());
    }
  }
}

// A load that is hauled from rest at a rate that grows has that rate, and pulls as Newton says, whatever the
// number of substeps. A tree, a diamond that hangs by two rods and hauls with both, and a cord over a pulley.
TEST(Winch, ALoadFollowsARateThatChanges) {
  enum class Kind { tree, loop, tackle };
  for (const Kind kind : {Kind::tree, Kind::loop, Kind::tackle}) {
    for (const std::uint32_t substeps : {1u, 2u, 3u, 4u}) {
      constexpr double mass = 3, g = 9.81;
      Scene scene;
      scene.particles = {test::anchor({0, 0, 0}), test::loose({0, -2, 0}, mass)};
      if (kind == Kind::tree) scene.rods = {{.a = 0, .b = 1}};
      if (kind == Kind::loop) {
        scene.particles.push_back(test::loose({0.5, -3, 0}, 1e-3));
        scene.particles.push_back(test::loose({-0.5, -3, 0}, 1e-3));
        scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}, {.a = 2, .b = 3}, {.a = 3, .b = 1}};
      }
      if (kind == Kind::tackle) scene.tackles = {{.particles = {0, 1}}};
      Settings settings = test::direct(Gradient::mid, substeps);
      settings.tensions = true;
      World world(scene, settings);
      double length = 2, rate = 0, work = 0;
      const double weight = kind == Kind::loop ? mass + 2e-3 : mass;
      for (int i = 1; i <= 40; ++i) {
        // It grows, stands for a while, and falls to nothing.
        const double next = i < 15 ? 0.05 * i : i < 25 ? 0.7 : std::max(0.7 - 0.07 * (i - 25), 0.0);
        length -= next * frame;
        kind == Kind::tackle ? world.set_tackle_length(0, length) : world.set_length(0, length);
        ASSERT_EQ(world.step(frame).unsolved, 0u);
        const double pull = kind == Kind::tackle ? world.tackle_tension(0) : world.tension(0);
        ASSERT_NEAR(pull, weight * (g + (next - rate) / frame), 1e-7) << substeps << " at " << i;
        ASSERT_NEAR(world.velocity(1).y, next, 1e-9) << substeps << " at " << i;
        work += frame * (kind == Kind::tackle ? world.tackle_power(0) : world.power(0));
        const double gained = weight * (g * (2 - length) + next * next / 2);
        ASSERT_NEAR(work, gained, 1e-8) << substeps << " at " << i;
        rate = next;
      }
    }
  }
}

TEST(Winch, InAndOutComesBack) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old}) {
    Scene scene = scenes::load_scene("chain:links=10,end_mass=5");
    for (std::size_t i = 0; i < scene.particles.size(); ++i)
      scene.particles[i].position = {0, -0.1 * static_cast<double>(i), 0};
    World world(scene, test::direct(gradient));
    for (int turn = 0; turn < 100; ++turn)
      for (int i = 0; i < 20; ++i) {
        world.set_length(0, 0.1 - 0.004 * (i < 10 ? i + 1 : 19 - i));
        EXPECT_EQ(world.step(frame).unsolved, 0u);
      }
    EXPECT_NEAR(world.position(10).y, -1, 1e-9) << to_string(gradient);
    EXPECT_NEAR(world.position(10).x, 0, 1e-9) << to_string(gradient);
  }
}

// What gradient mid leaves along rods is in its energy. A winch or an anchor that trembles by nanometres
// takes none of it, on a tree and on an island with a loop.
TEST(Winch, TremblingTakesNoEnergy) {
  enum class Trembles { rod, anchor };
  for (const bool has_loop : {false, true})
    for (const Trembles what : {Trembles::rod, Trembles::anchor})
      for (const std::uint32_t substeps : {1u, 2u}) {
        Scene scene = scenes::make_chain(5, 0.2);
        if (has_loop) {
          scene.particles.push_back(test::loose({0.5, 0.1, 0}, 0.5));
          for (const std::uint32_t end : {2u, 3u}) scene.rods.push_back({.a = end, .b = 6});
        }
        World world(scene, test::direct(Gradient::mid, substeps));
        const double start = test::energy_of(scene, world).total();
        for (int i = 0; i < 300; ++i) {
          const double off = i % 2 == 0 ? 1e-9 : -1e-9;
          if (what == Trembles::rod) world.set_length(0, 0.2 + off);
          if (what == Trembles::anchor) world.move_anchor(0, {off, 0, 0});
          ASSERT_EQ(world.step(frame).unsolved, 0u);
        }
        // Speeds of 1e-7 m/s do work on the pulls of some 100 N in 300 steps of 1/60 s.
        EXPECT_NEAR(test::energy_of(scene, world).total(), start, 1e-4) << has_loop << " " << substeps;
      }
}

// Beside joints, a rod that was made a millimetre long is paid out to 100 m and hauled in again. Rounding of
// its length grows with it, and so must what counts as solved.
TEST(Winch, PaysOutFarBesideJoints) {
  constexpr double made = 1e-3, far = 100;
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    Scene scene;
    scene.drag = 0.5;
    scene.particles = {test::anchor({0, 0, 0}), test::loose({0, -made, 0}, 1),
                       test::loose({0, -made - 0.5, 0}, 1)};
    scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
    scene.angles.push_back({.u = {point_at(0), point_at(1)}, .v = {point_at(1), point_at(2)}});
    Settings settings = test::direct(gradient);
    settings.tensions = true;
    World world(scene, settings);
    std::uint64_t unsolved = 0;
    const auto wind = [&](double from, double to) {
      for (int i = 1; i <= 600; ++i) {
        const double s = i / 600.0;
        world.set_length(0, from + (to - from) * s * s * (3 - 2 * s));
        unsolved += world.step(frame).unsolved;
      }
      for (int i = 0; i < 60; ++i) unsolved += world.step(frame).unsolved;
      EXPECT_NEAR(-world.position(1).y / to, 1, 1e-8) << to_string(gradient);
      EXPECT_NEAR(world.tension(0), 2 * 9.81, 1e-6) << to_string(gradient);
    };
    wind(made, far);
    wind(far, 1);
    EXPECT_EQ(unsolved, 0u) << to_string(gradient);
  }
}

// Rods that give but that a substep does not resolve follow the winch, with gradient old as well: the load is
// as fast as it is hauled, and weighs what it weighs. A force that trembles makes each step a new one.
TEST(Winch, HaulsOnStiffRodsAtItsRateWithGradientOld) {
  constexpr double length = 3, rate = -0.3;
  for (const double stiffness : {1e4, 1e6, 1e9})
    for (const double tremble : {0.0, 1e-9}) {
      Scene scene;
      scene.particles = {test::anchor({}), test::loose({0, -length, 0}, 1)};
      scene.rods = {{.a = 0, .b = 1, .length = length, .law = {.stiffness = stiffness, .damping = 50}}};
      World world(scene, {.method = Method::direct, .gradient = Gradient::old, .tensions = true});
      for (int i = 1; i <= 60; ++i) {
        world.set_length(0, length + rate * frame * i);
        world.set_force(1, {0, i % 2 * tremble, 0});
        world.step(frame);
      }
      // Both are exact but for rounding, of which a stiffness of 1e9 N/m makes 1e-6 N, and the tremble.
      EXPECT_NEAR(world.velocity(1).y, -rate, 1e-9) << stiffness << ", " << tremble;
      EXPECT_NEAR(world.tension(0), 9.81, 1e-5) << stiffness << ", " << tremble;
    }
}

// An elastic cable, which is slack for a part of the time, is hauled in at a constant rate. Its pull is the
// change of its energy over that of its stretch, so that a winch does what energy gains: without that 11 % of
// the energy came from nowhere in two seconds. As a rod of a tree, in an island with a loop, and as a cord.
TEST(Winch, AnElasticCableGainsWhatIsDone) {
  enum class Kind { tree, loop, tackle };
  for (const Kind kind : {Kind::tree, Kind::loop, Kind::tackle}) {
    constexpr double mass = 2, stiffness = 2e3;
    const RodLaw law{.stiffness = stiffness, .one_sided = true};
    Scene scene;
    scene.particles = {test::anchor({0, 0, 0}), test::loose({0.3, -0.9, 0}, mass)};
    if (kind != Kind::tackle) scene.rods = {{.a = 0, .b = 1, .length = 1, .law = law}};
    if (kind == Kind::tackle) scene.tackles = {{.particles = {0, 1}, .length = 1, .law = law}};
    if (kind == Kind::loop) {
      scene.particles.push_back(test::loose({0.3, -1.2, 0}, 0.1));
      scene.particles.push_back(test::loose({0.5, -1.1, 0}, 0.1));
      for (const auto& [a, b] : {std::pair{1u, 2u}, {2u, 3u}, {3u, 1u}})
        scene.rods.push_back({.a = a, .b = b});
    }
    Settings settings = test::direct(Gradient::mid);
    settings.tensions = true;
    World world(scene, settings);
    double length = 1, work = 0, slack = 0;
    const auto energy = [&] {
      (kind == Kind::tackle ? scene.tackles[0].length : scene.rods[0].length) = length;
      slack += norm(world.position(1)) < length ? 1 : 0;
      return test::energy_of(scene, world).total();
    };
    const double start = energy();
    for (int i = 1; i <= 120; ++i) {
      length -= 0.3 * frame;
      kind == Kind::tackle ? world.set_tackle_length(0, length) : world.set_length(0, length);
      ASSERT_EQ(world.step(frame).unsolved, 0u);
      work += frame * (kind == Kind::tackle ? world.tackle_power(0) : world.power(0));
      ASSERT_NEAR(energy() - start, work, 1e-8) << static_cast<int>(kind) << " at " << i;
    }
    EXPECT_GT(slack, 10) << "it must have been slack, or this shows nothing";
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
