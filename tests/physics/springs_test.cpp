// Method springs: what its motion converges to, how fast, what it keeps, and which steps it bears.

#include "reference/springs/springs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "plumb/reference/springs.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/refusals.hpp"
#include "support/sanitizers.hpp"
#include "support/truths.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double g = 9.81;
constexpr SpringModel both_models[] = {SpringModel::rigid_rods, SpringModel::particles};

Settings springs(SpringModel model, Integrator integrator, double stiffness, double damping_ratio,
                 std::uint32_t substeps = 1) {
  return {.method = Method::springs,
          .substeps = substeps,
          .integrator = integrator,
          .springs = {.model = model, .stiffness = stiffness, .damping_ratio = damping_ratio}};
}

std::string name_of(const Settings& s) {
  return std::string(to_string(s.springs.model)) + " " + std::string(to_string(integrator_of(s))) +
         " damped " + std::to_string(s.springs.damping_ratio);
}

/// Positions after one step of `duration`, in the settings' substeps.
std::vector<Vec3> positions_at(const Scene& scene, const Settings& settings, double duration) {
  World world(scene, settings);
  EXPECT_EQ(world.step(duration).frozen_islands, 0u);
  return test::positions_of(world);
}

std::vector<Vec3> truth_at(const std::string& file, double t) {
  const std::vector<Frame> frames = scenes::read_trajectory(PLUMB_TEST_DATA "/" + file);
  return std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return f.t == t; })->positions;
}

/// Distance to the truth at 0.5 s, relative to the scene's diagonal; rk4 at a third of its limit.
double error_of(const Scene& scene, const std::string& truth, SpringModel model, double stiffness) {
  constexpr double t = 0.5;
  Settings settings = springs(model, Integrator::rk4, stiffness, 0.1);
  settings.substeps =
      static_cast<std::uint32_t>(std::ceil(3 * t / spring_stability(scene, settings).largest_step));
  return rms_distance(positions_at(scene, settings, t), truth_at(truth, t)) / bounding_diagonal(scene);
}

// Springs give by force over stiffness, and so does the motion: ten times as stiff, a tenth of the error
// (to 20 %, the next power of 1/k). Point masses by both models, rods with mass by rigid rods.
TEST(SpringMotion, ApproachesTheRodsTruthAsOneOverStiffness) {
  struct Case {
    Scene scene;
    const char* truth;
    SpringModel model;
    double error;  ///< at 1e8 N/m, measured, with a tenth to spare
  };
  const Scene chain = scenes::make_chain(5, 0.1, 10);
  for (const Case& c : {Case{chain, "chain_N5_r10.csv", SpringModel::rigid_rods, 6.6e-5},
                        Case{chain, "chain_N5_r10.csv", SpringModel::particles, 6.5e-5},
                        Case{scenes::make_rods5(), "rods5.csv", SpringModel::rigid_rods, 4.6e-5},
                        Case{scenes::make_tree(), "tree.csv", SpringModel::rigid_rods, 3.5e-5},
                        Case{test::double_pendulum(), "double.csv", SpringModel::particles, 9e-5}}) {
    const double soft = error_of(c.scene, c.truth, c.model, 1e7);
    const double stiff = error_of(c.scene, c.truth, c.model, 1e8);
    EXPECT_NEAR(soft / stiff, 10, 2) << c.truth << " " << to_string(c.model);
    EXPECT_LT(stiff, c.error) << c.truth << " " << to_string(c.model);
  }
}

// Half of every rod's mass at either end is another body: no stiffness brings it to the truth.
TEST(SpringMotion, ParticlesDoNotMoveAsRodsWithMass) {
  EXPECT_GT(error_of(scenes::make_rods5(), "rods5.csv", SpringModel::particles, 1e8), 0.03);
}

/// Masses 1, 1, 2, 4, 1 (the first at the anchor) on links of a quarter metre.
Scene uneven_chain() {
  Scene scene = scenes::make_chain(4, 0.25);
  scene.particles[2].mass = 2;
  scene.particles[3].mass = 4;
  return scene;
}

// Errors at 0.5 s against rk4 in 20000 steps; its own error there is below 1e-14.
TEST(SpringMotion, EveryIntegratorHasItsOrder) {
  struct Case {
    Integrator integrator;
    double order;
  };
  const Scene scene = uneven_chain();
  for (const SpringModel model : both_models) {
    const auto exact = positions_at(scene, springs(model, Integrator::rk4, 2000, 0.1, 20000), 0.5);
    for (const Case c :
         {Case{Integrator::explicit_euler, 1}, Case{Integrator::semi_implicit_euler, 1},
          Case{Integrator::rk2, 2}, Case{Integrator::rk4, 4}, Case{Integrator::implicit_euler, 1}}) {
      const auto error = [&](std::uint32_t n) {
        return rms_distance(positions_at(scene, springs(model, c.integrator, 2000, 0.1, n), 0.5), exact);
      };
      EXPECT_NEAR(std::log2(error(400) / error(800)), c.order, 0.1)
          << to_string(model) << " " << to_string(c.integrator);
    }
  }
}

// A body in free flight that spins and vibrates. Internal forces come in pairs: linear momentum is kept to
// rounding by every integrator, angular momentum by rk4 to its order where no joint is damped.
TEST(SpringMotion, KeepsMomentumOfAFreeBody) {
  Scene scene = scenes::make_tree();
  scene.gravity = {};
  for (Particle& particle : scene.particles) {
    particle.fixed = false;
    particle.mass += 0.5;
    particle.velocity = cross({0.3, 1, -2}, particle.position) + Vec3{1, -2, 0.5};
  }
  detail::Drive drive;
  drive.forces.resize(scene.particles.size());
  drive.anchors.resize(scene.particles.size());
  drive.anchor_velocities.resize(scene.particles.size());
  for (const SpringModel model : both_models)
    for (const Integrator integrator : {Integrator::explicit_euler, Integrator::semi_implicit_euler,
                                        Integrator::rk2, Integrator::rk4, Integrator::implicit_euler}) {
      const auto system = detail::make_springs(scene, springs(model, integrator, 1e4, 0));
      detail::MechanicalState state = system->initial_state(drive);
      const Eigen::Index size = system->body_size(), coordinates = size == 3 ? 3 : 7;
      using Momenta = Eigen::Matrix<double, 6, 1>;
      const auto momenta = [&] {
        Momenta sum = Momenta::Zero();
        for (Eigen::Index i = 0; i < system->masses().size() / size; ++i) {
          const Eigen::Vector3d x = state.q.segment<3>(coordinates * i);
          const Eigen::Vector3d p = system->masses()[size * i] * state.v.segment<3>(size * i);
          sum.head<3>() += p;
          sum.tail<3>() += x.cross(p);
          if (size > 3) sum.tail<3>() += system->masses()[size * i + 3] * state.v.segment<3>(size * i + 3);
        }
        return sum;
      };
      const Momenta before = momenta();
      for (int i = 0; i < 5000; ++i) system->advance(state, drive, 2e-4);
      const Momenta change = momenta() - before;
      const std::string what = std::string(to_string(model)) + " " + std::string(to_string(integrator));
      EXPECT_LT(change.head<3>().norm(), 1e-11 * before.head<3>().norm()) << what;
      if (integrator == Integrator::rk4) {
        EXPECT_LT(change.tail<3>().norm(), 1e-9 * before.tail<3>().norm()) << what;
      }
    }
}

// rk4 loses energy of a vibration in proportion to (ωh)^5 each step: 500 rad/s at 1e-4 s over 1 s come to
// 1e4 * 0.05^6/72 = 2e-6 of what vibrates, which is a small part of the range.
TEST(SpringMotion, KeepsEnergyWithoutDamping) {
  const Scene scene = uneven_chain();
  detail::Drive drive;
  drive.forces.resize(scene.particles.size());
  drive.anchor_velocities.resize(scene.particles.size());
  for (const Particle& particle : scene.particles) drive.anchors.push_back(particle.position);
  for (const SpringModel model : both_models) {
    const auto drift = [&](double damping_ratio, double h) {
      const auto system = detail::make_springs(scene, springs(model, Integrator::rk4, 1e4, damping_ratio));
      detail::MechanicalState state = system->initial_state(drive);
      const double before = system->energy(state, drive);
      for (int i = 0; i < std::lround(1 / h); ++i) system->advance(state, drive, h);
      return (system->energy(state, drive) - before) / energy_range(scene);
    };
    EXPECT_LT(std::abs(drift(0, 1e-4)), 1e-8) << to_string(model);
    EXPECT_LT(std::abs(drift(0, 1e-4)), std::abs(drift(0, 2e-4)) / 10) << to_string(model);
    EXPECT_LT(drift(0.1, 1e-4), -1e-5) << to_string(model);  // and damping takes it away
  }
}

/// A straight spring or chain at rest, without weight.
Scene weightless(std::uint32_t links) {
  Scene scene = links == 1 ? scenes::make_chain(1, 0.5, 2) : scenes::make_chain(links, 0.5);
  for (std::uint32_t i = 2; i < links; ++i) scene.particles[i].mass = 1 + i % 3;
  scene.gravity = {};
  return scene;
}

/// Whether a tug at the anchor, 1e-9 m in every direction, grows a hundredfold in `steps` of h.
bool diverges(const Scene& scene, Settings settings, double h, std::uint32_t steps) {
  const auto fastest = [](const World& world) {
    double speed = 0;
    for (const Vec3 v : test::velocities_of(world)) speed = std::max(speed, norm(v));
    return speed;
  };
  settings.substeps = 20;
  World first(scene, settings);
  first.move_anchor(0, {1e-9, 1e-9, 1e-9});
  first.step(20 * h);
  const double start = fastest(first);
  settings.substeps = steps;
  World world(scene, settings);
  world.move_anchor(0, {1e-9, 1e-9, 1e-9});
  return world.step(steps * h).frozen_islands > 0 || fastest(world) > 100 * start;
}

// At 1 % below the predicted limit a tug does not grow, at 1 % above it does. Slowest with explicit Euler: a
// vibration of damping ratio z grows by 2 z^2 1 % a step at 1 % beyond its limit, and the slowest of the
// chain has a z of 0.05.
TEST(SpringStability, LimitsAreWithinAPercent) {
  if (test::sanitized) GTEST_SKIP() << "millions of steps, which others take as well";
  for (const std::uint32_t links : {1u, 5u})
    for (const SpringModel model : both_models)
      for (const Integrator integrator :
           {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk2, Integrator::rk4})
        for (const double damping_ratio : {0.0, 0.2, 1.5}) {
          const Scene scene = weightless(links);
          const Settings settings = springs(model, integrator, 1e4, damping_ratio);
          const double limit = spring_stability(scene, settings).largest_step;
          const bool none = damping_ratio == 0 &&
                            (integrator == Integrator::explicit_euler || integrator == Integrator::rk2);
          EXPECT_EQ(limit == 0, none) << name_of(settings);
          if (none) continue;
          const std::uint32_t steps = integrator == Integrator::explicit_euler ? 200000 : 20000;
          EXPECT_FALSE(diverges(scene, settings, 0.99 * limit, steps)) << links << " " << name_of(settings);
          EXPECT_TRUE(diverges(scene, settings, 1.01 * limit, steps)) << links << " " << name_of(settings);
        }
}

// More links than whose eigenvalues are all found: semi-implicit Euler's limit is still exact, that of the
// others comes from the fastest vibration.
TEST(SpringStability, LimitsOfLongChains) {
  if (test::sanitized) GTEST_SKIP() << "millions of steps, which others take as well";
  const Scene scene = weightless(60);
  for (const SpringModel model : both_models)
    for (const Integrator integrator :
         {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk4}) {
      const double margin = integrator == Integrator::semi_implicit_euler ? 0.01 : 0.2;
      const Settings settings = springs(model, integrator, 1e4, 0.1);
      const double limit = spring_stability(scene, settings).largest_step;
      EXPECT_FALSE(diverges(scene, settings, (1 - margin) * limit, 3000)) << name_of(settings);
      EXPECT_TRUE(diverges(scene, settings, (1 + margin) * limit, 3000)) << name_of(settings);
    }
}

// In closed form, to the bisection's 1e-10: one mass on a spring (ω² = k/m); a uniform rod on its end, which
// is a quarter of its mass to a push across; a chain of n equal masses, ω = 2 sqrt(k/m) cos(pi/(2n + 1)).
TEST(SpringStability, IsThatOfTheOscillator) {
  const double k = 1e4, m = 2, frequency = std::sqrt(k / m);
  const auto limit = [&](Integrator integrator, double ratio) {
    return spring_stability(weightless(1), springs(SpringModel::particles, integrator, k, ratio))
        .largest_step;
  };
  const auto expect = [](double is, double wanted) { EXPECT_NEAR(is, wanted, 1e-8 * wanted); };
  for (const double ratio : {0.1, 0.5, 0.9})
    expect(limit(Integrator::explicit_euler, ratio), 2 * ratio / frequency);
  // Overdamped, the faster of two decays sets it: h rate < 2, as in eq. 3.15.
  expect(limit(Integrator::explicit_euler, 3), 2 / (frequency * (3 + std::sqrt(8.0))));
  for (const double ratio : {0.0, 0.5, 3.0})
    expect(limit(Integrator::semi_implicit_euler, ratio),
           2 * (std::sqrt(1 + ratio * ratio) - ratio) / frequency);
  expect(limit(Integrator::rk4, 0), 2 * std::sqrt(2.0) / frequency);
  EXPECT_EQ(limit(Integrator::implicit_euler, 0.1), INFINITY);

  Scene rod;
  rod.particles = {test::anchor({0, 0, 0}), test::loose({0, 0.3, 0})};
  rod.rods = {{.a = 0, .b = 1, .mass = m}};
  expect(spring_stability(rod, springs(SpringModel::rigid_rods, Integrator::rk4, k, 0)).frequency,
         2 * frequency);
  for (const std::uint32_t n : {5u, 300u}) {
    const Scene chain = scenes::make_chain(n);
    expect(spring_stability(chain, springs(SpringModel::particles, Integrator::rk4, k, 0.1)).frequency,
           2 * std::sqrt(k) * std::cos(std::acos(-1.0) / (2 * n + 1)));
  }
  Scene loose;
  loose.particles = {test::movable({0, 0, 0})};
  EXPECT_EQ(spring_stability(loose, springs(SpringModel::particles, Integrator::rk4, k, 0)).largest_step,
            INFINITY);
}

// Steps of 1/60 s at h k = 1e6 and at h² k/m = 1e6: ten seconds of falling and swinging stay within reach and
// never gain energy, where semi-implicit Euler is gone. Gaps are of the second order of how far a rod turns
// in a step, some tenths of a radian: at most a sixth of a rod.
TEST(SpringStability, ImplicitStepsBearAnyStiffness) {
  for (const SpringModel model : both_models)
    for (const std::uint32_t links : {1u, 20u})
      for (const double stiffness : {60e6, 3600e6}) {
        const Scene scene = scenes::make_chain(links, 0.1, 10);
        const Settings settings = springs(model, Integrator::implicit_euler, stiffness, 0.1);
        World world(scene, settings);
        for (int i = 0; i < 600; ++i) {
          EXPECT_EQ(world.step(1.0 / 60).frozen_islands, 0u);
          ASSERT_LT(test::stretch_of(scene, world).max, 0.17) << name_of(settings) << " " << links;
          ASSERT_LT(test::relative_energy(scene, world), 1e-3) << name_of(settings) << " " << links;
        }
        Settings fails = settings;
        fails.integrator = Integrator::semi_implicit_euler;
        World broken(scene, fails);
        const StepReport report = test::run(broken, 1.0 / 60, 600);
        EXPECT_EQ(report.frozen_islands, 1u);
        EXPECT_TRUE(test::all_finite(broken));
      }
}

// Thesis §4.4.1 and figure 4.5: the joint that bears the most opens the most. Five rods of m hang at rest;
// the joint above the lowest i of them is open by i m g/k.
TEST(SpringGaps, AreTheWeightBelowOverStiffness) {
  const double m = 3;
  Scene scene;
  scene.particles.push_back(test::anchor({0, 0, 0}));
  for (std::uint32_t i = 1; i <= 5; ++i) {
    scene.particles.push_back(test::loose({0, -0.2 * i, 0}));
    scene.rods.push_back({.a = i - 1, .b = i, .mass = m});
  }
  for (const double k : {1e4, 1e6}) {
    World world(scene, springs(SpringModel::rigid_rods, Integrator::implicit_euler, k, 1));
    test::run(world, 0.1, 200);
    const StepReport report = world.step(0.1);
    const double unit = m * g / k;
    EXPECT_NEAR(report.largest_gap, 5 * unit, 1e-9 * 5 * unit);
    EXPECT_NEAR(report.rms_gap, std::sqrt((1 + 4 + 9 + 16 + 25) / 5.0) * unit, 1e-9 * 5 * unit);
    EXPECT_NEAR(world.position(5).y, -1 - (1 + 2 + 3 + 4 + 5) * unit, 1e-12);
    // The topmost: half the gap at particle 1 is above its mean position.
    EXPECT_NEAR(world.position(1).y, -0.2 - 5 * unit - 4 * unit / 2, 1e-12);
  }
}

// The error that is estimated grows by no more than the accuracy asked for; what it does to the motion after
// that is of the same size here. Against rk4 on the same springs.
TEST(SpringAccuracy, AdaptiveStepsKeepIt) {
  const Scene scene = scenes::make_chain(3, 0.1, 2);
  for (const SpringModel model : both_models) {
    const auto exact = positions_at(scene, springs(model, Integrator::rk4, 1e6, 0.1, 20000), 0.5);
    double before = INFINITY;
    for (const double accuracy : {1e-1, 1e-2, 1e-3}) {
      Settings settings = springs(model, Integrator::adaptive_implicit_euler, 1e6, 0.1);
      settings.accuracy = accuracy;
      World world(scene, settings);
      const StepReport report = test::run(world, 1.0 / 60, 30);
      const double error = rms_distance(test::positions_of(world), exact) / bounding_diagonal(scene);
      EXPECT_LT(error, accuracy * 0.5) << to_string(model);
      EXPECT_LT(error, before / 5) << to_string(model);
      EXPECT_EQ(report.inaccurate_steps, 0u);
      EXPECT_GT(report.repeated_steps, 0u);
      before = error;
    }
    // More than the shortest steps can do is said, and comes to an end.
    Settings settings = springs(model, Integrator::adaptive_implicit_euler, 1e6, 0.1);
    settings.accuracy = 1e-9;
    World world(scene, settings);
    EXPECT_GT(world.step(1.0 / 60).inaccurate_steps, 1000u);
  }
}

// A frame is longer than the fastest vibration bears forward in time, by which these chains would fly apart.
TEST(SpringDefaults, HangChainsByHeavyEndsAtFramesOfSixtieths) {
  for (const double end : {1.0, 10.0, 100.0}) {
    Scene scene = scenes::make_chain(20, 0.1, end);
    scene.drag = 2;
    const Settings settings{.method = Method::springs};
    Settings forward = settings;
    forward.integrator = Integrator::semi_implicit_euler;
    EXPECT_LT(spring_stability(scene, forward).largest_step, 1.0 / 60);
    World world(scene, settings);
    // Each spring gives by the weight below it, of 19 unit masses and the end for the first, and of the end
    // for the last. Where masses lie on rigid rods moves a unit of them from spring to spring.
    const double give = (190 + 20 * end) * g / settings.springs.stiffness, length = 2;
    double farthest = 0;
    for (int i = 0; i < 1200; ++i) {
      world.step(1.0 / 60);
      farthest = std::max(farthest, norm(world.position(20)));
    }
    EXPECT_LT(farthest, 2 * (length + give)) << end;
    EXPECT_NEAR(world.position(20).y, -(length + give), 0.02 * (length + give)) << end;
  }
}

// A pull of m g sideways holds a pendulum at 45 degrees, whichever way it is shared among ends; and lifting
// the anchor lifts it. 20 s of drag leave exp(-20) of the swing or less.
TEST(SpringForces, HoldAPendulumAside) {
  for (const SpringModel model : both_models)
    for (const Integrator integrator :
         {Integrator::semi_implicit_euler, Integrator::rk4, Integrator::implicit_euler}) {
      Scene scene = scenes::make_chain(2, 0.5, 3);
      scene.drag = 4;
      const double k = 1e5;
      World world(scene, springs(model, integrator, k, 0.2, 100));
      world.set_force(1, {g, 0, 0});
      world.set_force(2, {3 * g, 0, 0});
      world.move_anchor(0, {0, 0.1, 0});
      test::run(world, 0.1, 200);
      // Springs give by what they hold over k: in both directions 4 g and 3 g. Between rigid rods, the lower
      // joint also holds the half of the middle particle that belongs to the lower rod, and its force, and
      // the upper one as much for the upper rod's counterweight, which has no force of its own.
      const bool rods = model == SpringModel::rigid_rods;
      const double give_x = (rods ? 7.5 : 7) * g / k, give_y = (rods ? 8 : 7) * g / k;
      EXPECT_NEAR(world.position(2).x, std::sqrt(0.5) + give_x, 1e-9) << to_string(integrator);
      EXPECT_NEAR(world.position(2).y, 0.1 - std::sqrt(0.5) - give_y, 1e-9) << to_string(integrator);
    }
}

// x = v (1 - exp(-ct))/c, to rk4's order.
TEST(SpringForces, DragSlowsAsItSays) {
  Scene scene;
  scene.gravity = {};
  scene.drag = 2;
  scene.particles = {test::movable({0, 0, 0}, 1, {1, 0, 0}), test::movable({0, 1, 0}, 1, {1, 0, 0}),
                     test::movable({0, 2, 0}, 3, {1, 0, 0})};
  scene.rods = {{.a = 1, .b = 2}};
  for (const SpringModel model : both_models) {
    World world(scene, springs(model, Integrator::rk4, 1e4, 0.1, 1000));
    world.step(1);
    for (const std::uint32_t i : {0u, 1u, 2u}) {
      EXPECT_NEAR(world.position(i).x, (1 - std::exp(-2.0)) / 2, 1e-12);
      EXPECT_NEAR(world.velocity(i).x, std::exp(-2.0), 1e-12);
    }
  }
}

// A rigid rod has no place for a velocity along itself; a spring has.
TEST(SpringVelocities, ThatStretchAreLeftToParticlesOnly) {
  Scene scene = scenes::make_chain(1, 1, 1);
  scene.particles[1].velocity = {1, 2, 0};
  World rods(scene, springs(SpringModel::rigid_rods, Integrator::rk4, 1e4, 0));
  EXPECT_LT(norm(rods.velocity(1) - Vec3{0, 2, 0}), 1e-14);
  EXPECT_NEAR(rods.info().projected_velocity, 1, 1e-14);
  World particles(scene, springs(SpringModel::particles, Integrator::rk4, 1e4, 0));
  EXPECT_EQ(particles.velocity(1), (Vec3{1, 2, 0}));
  EXPECT_EQ(particles.info().projected_velocity, 0);
}

// An island too light for its springs breaks; the one beside it has the bits it has alone.
TEST(SpringFailures, FreezeTheirIslandAlone) {
  for (const SpringModel model : both_models)
    for (const Integrator integrator :
         {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk2, Integrator::rk4}) {
      const Settings settings = springs(model, integrator, 1e4, 0.1, 50);
      const Scene sound = scenes::make_chain(3);
      Scene scene = sound;
      scene.particles.push_back(test::anchor({5, 0, 0}));
      scene.particles.push_back(test::loose({5.1, 0, 0}, 1e-6));
      scene.rods.push_back({.a = 4, .b = 5});
      World alone(sound, settings), world(scene, settings);
      test::run(alone, 1.0 / 60, 60);
      const StepReport report = test::run(world, 1.0 / 60, 60);
      EXPECT_EQ(report.frozen_islands, 1u) << name_of(settings);
      EXPECT_TRUE(test::all_finite(world));
      EXPECT_EQ(world.velocity(5), Vec3{});
      for (const std::uint32_t i : {1u, 2u, 3u}) {
        EXPECT_EQ(world.position(i), alone.position(i)) << name_of(settings);
        EXPECT_EQ(world.velocity(i), alone.velocity(i)) << name_of(settings);
      }
    }
}

std::string refusal(const Scene& scene, const Settings& settings) {
  return test::refusal([&] { World(scene, settings); });
}

TEST(SpringFailures, BadSettingsAndBodiesAreRefused) {
  const Scene chain = scenes::make_chain(3);
  const auto with = [](double stiffness, double ratio) {
    return springs(SpringModel::rigid_rods, Integrator::rk4, stiffness, ratio);
  };
  EXPECT_EQ(refusal(chain, with(0, 0.1)), "stiffness must be positive and finite, got 0 N/m");
  EXPECT_EQ(refusal(chain, with(1e4, -1)), "damping ratio must be 0 or more and finite, got -1");
  EXPECT_EQ(refusal(chain, with(1e4, NAN)), "damping ratio must be 0 or more and finite, got nan");
  EXPECT_EQ(refusal(chain, springs(SpringModel::particles, Integrator::adaptive_implicit_euler, 1e4, 0)),
            "integrator adaptive-implicit-euler needs an accuracy");
  // Two rods with mass, a light one between them that has none.
  Scene bridge = scenes::make_rods5();
  bridge.rods[2].mass = 0;
  EXPECT_EQ(refusal(bridge, with(1e4, 0.1)),
            "rod 2: has no inertia to turn by as a rigid body, since neither it nor its particles have mass; "
            "springs between particles take it");
  bridge.rods[2].mass = 1;
  bridge.rods[2].inertia = 0;
  EXPECT_EQ(
      refusal(bridge, with(1e4, 0.1)),
      "rod 2: has no inertia to turn by as a rigid body, since all of its mass is in one point; springs "
      "between particles take it");
  EXPECT_EQ(refusal(bridge, springs(SpringModel::particles, Integrator::rk4, 1e4, 0.1)), "");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
