// Methods multipliers and featherstone solve the equations of motion as they are, so that only the integrator
// errs: against truths, each other, method direct, and what must be conserved.

#include "support/exact_methods.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/random_trees.hpp"
#include "support/truths.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

class ExactMethods : public testing::TestWithParam<Method> {
 protected:
  Settings settings(Integrator integrator = Integrator::rk4, std::uint32_t substeps = 1,
                    MassModel mass = MassModel::consistent) const {
    return test::exact(GetParam(), integrator, substeps, mass);
  }
};

INSTANTIATE_TEST_SUITE_P(Both, ExactMethods, testing::Values(Method::multipliers, Method::featherstone),
                         [](const auto& method) { return std::string(to_string(method.param)); });

// The stored truths are good to 1e-9; classical Runge-Kutta at this step errs by less than 1e-10 (its error
// falls sixteenfold with half the step, see ConvergesWithTheOrderOfTheIntegrator).
TEST_P(ExactMethods, AgreeWithStoredTruths) {
  const auto expect_agrees = [&](const Scene& scene, const std::string& name) {
    const std::vector<Frame> stored = scenes::read_trajectory(PLUMB_TEST_DATA "/" + name);
    const auto truth = std::find_if(stored.begin(), stored.end(), [](const Frame& f) { return f.t == 0.5; });
    ASSERT_NE(truth, stored.end()) << name;
    World world(scene, settings(Integrator::rk4, 100));
    test::run(world, 0.025, 20);
    const test::Apart off = test::apart(test::frame_of(world), *truth);
    EXPECT_LE(off.position, 1e-8 * bounding_diagonal(scene)) << name;
    EXPECT_LE(off.velocity, 1e-8 * std::sqrt(9.81 * bounding_diagonal(scene))) << name;
  };
  expect_agrees(scenes::make_rods5(), "rods5.csv");
  expect_agrees(scenes::make_tree(), "tree.csv");
  expect_agrees(test::double_pendulum(), "double.csv");
  expect_agrees(scenes::make_chain(5, 0.1, 10), "chain_N5_r10.csv");
  expect_agrees(scenes::make_chain(20, 0.1, 1), "chain_N20_r1.csv");
  expect_agrees(scenes::make_chain(20, 0.1, 10), "chain_N20_r10.csv");
}

// A massless rod whose far particle has its mass from the next rod alone.
TEST_P(ExactMethods, MoveMasslessLinksBeforeRodsWithMass) {
  Scene scene;
  scene.particles = {test::anchor({0, 0, 0}), test::loose({0.3, 0, 0}), test::loose({0.6, 0.1, 0.1})};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2, .mass = 1}};
  const Frame truth = truth::solve(scene, {.save_at = {0.5}}).frames.front();
  World world(scene, settings(Integrator::rk4, 100));
  test::run(world, 0.025, 20);
  EXPECT_LE(test::apart(test::frame_of(world), truth).position, 1e-8);
}

// Half the step: half, a quarter, a sixteenth of the error.
TEST_P(ExactMethods, ConvergeWithTheOrderOfTheIntegrator) {
  const Scene scene = scenes::make_tree();
  const Frame truth = truth::solve(scene, {.save_at = {0.3}}).frames.front();
  struct Case {
    Integrator integrator;
    double order;
    std::uint32_t substeps;
  };
  for (const Case c : {Case{Integrator::explicit_euler, 1, 64}, Case{Integrator::semi_implicit_euler, 1, 64},
                       Case{Integrator::rk2, 2, 16}, Case{Integrator::rk4, 4, 4}}) {
    double errors[2];
    for (const int k : {0, 1}) {
      World world(scene, settings(c.integrator, c.substeps << k));
      test::run(world, 0.05, 6);
      errors[k] = rms_distance(test::positions_of(world), truth.positions);
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), c.order, 0.15) << to_string(c.integrator);
    EXPECT_LE(errors[1], 1e-2) << to_string(c.integrator);
  }
}

// Where the mass of rods acts: both models have truths of their own, and they differ.
TEST_P(ExactMethods, MoveEitherModelOfMass) {
  Scene scene = scenes::make_tree();
  scene.rods[2].center = 0.3;
  scene.rods[2].inertia = 0.01;
  scene.rods[5] = {.a = 6, .b = 2, .mass = 4, .center = 0.8, .inertia = 0.05};
  Frame frames[2];
  for (const MassModel mass : {MassModel::consistent, MassModel::lumped}) {
    const Frame truth = truth::solve(scene, {.save_at = {0.5}, .mass = mass}).frames.front();
    World world(scene, settings(Integrator::rk4, 100, mass));
    test::run(world, 0.025, 20);
    frames[mass == MassModel::lumped] = test::frame_of(world);
    const test::Apart off = test::apart(test::frame_of(world), truth);
    EXPECT_LE(off.position, 1e-9) << to_string(mass);
    EXPECT_LE(off.velocity, 1e-8) << to_string(mass);
  }
  EXPECT_GT(test::apart(frames[0], frames[1]).position, 1e-2);
}

/// A branched body of 12 rods in free flight, every particle with a velocity of its own.
Scene flying_tree(double rod_mass, std::uint32_t seed = 5) {
  test::Random random(seed);
  Scene scene = test::random_tree(random, {.movable = 13, .anchors = 0, .masses = 3, .rod_mass = rod_mass});
  for (Particle& particle : scene.particles) particle.velocity = test::random_vector(random);
  return scene;
}

// What an explicit method of order 4 loses in a second at this step is below 1e-10; rounding 1e-13. Momenta
// follow gravity alone.
TEST_P(ExactMethods, ConserveEnergyAndMomenta) {
  for (const double rod_mass : {0.0, 2.0}) {
    const Scene scene = flying_tree(rod_mass);
    World world(scene, settings(Integrator::rk4, 400));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world),
                              MassModel::consistent);
    };
    const Momentum first = momentum();
    const double energy = test::energy_of(scene, world, MassModel::consistent);
    test::run(world, 0.1, 10);
    const Momentum last = momentum();
    const double mass = energy_range(scene) / 9.81 / bounding_diagonal(scene), t = 1;
    const Vec3 fall = mass * t * scene.gravity;
    EXPECT_LE(norm(last.linear - first.linear - fall), 1e-11 * norm(first.linear + fall));
    // The centre of mass flies a parabola, and gravity turns about the origin where it is.
    const Vec3 center = first.center_of_mass, drift = (1 / mass) * first.linear;
    EXPECT_LE(norm(last.center_of_mass - center - t * drift - 0.5 * t * t * scene.gravity), 1e-11);
    const Vec3 turn = cross(t * center + 0.5 * t * t * drift, mass * scene.gravity);
    EXPECT_LE(norm(last.angular - first.angular - turn), 1e-10 * (norm(first.angular) + norm(turn)));
    EXPECT_LE(std::abs(test::energy_of(scene, world, MassModel::consistent) - energy),
              1e-10 * energy_range(scene));
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-12);
  }
}

TEST_P(ExactMethods, ConserveTheEnergyOfHangingTrees) {
  for (const Scene& scene : {scenes::make_tree(), scenes::make_rods5(), test::double_pendulum()}) {
    World world(scene, settings(Integrator::rk4, 400));
    const double energy = test::energy_of(scene, world, MassModel::consistent);
    for (int i = 0; i < 20; ++i) {
      test::run(world, 0.05, 1);
      EXPECT_LE(std::abs(test::energy_of(scene, world, MassModel::consistent) - energy),
                1e-9 * energy_range(scene));
    }
  }
}

// A particle without rods falls as a stone does.
TEST_P(ExactMethods, MoveLooseParticles) {
  Scene scene;
  scene.particles = {test::movable({1, 2, 3}, 0.5, {0.3, -0.1, 2})};
  World world(scene, settings());
  world.set_force(0, {2, 0, 0});
  test::run(world, 0.1, 5);
  const Vec3 pull = scene.gravity + Vec3{4, 0, 0};  // constant: exact by Runge-Kutta
  EXPECT_LE(norm(world.position(0) - Vec3{1, 2, 3} - 0.5 * Vec3{0.3, -0.1, 2} - 0.125 * pull), 1e-14);
  EXPECT_LE(norm(world.velocity(0) - Vec3{0.3, -0.1, 2} - 0.5 * pull), 1e-14);
}

// Drag lets both momenta decay as exp(-ct), whatever the rods do.
TEST_P(ExactMethods, LetMomentaDecayUnderDrag) {
  Scene scene = flying_tree(2);
  scene.gravity = {};
  scene.drag = 0.7;
  World world(scene, settings(Integrator::rk4, 200));
  const auto momentum = [&] {
    return measure_momentum(scene, test::positions_of(world), test::velocities_of(world),
                            MassModel::consistent);
  };
  const Momentum first = momentum();
  test::run(world, 0.1, 10);
  const Momentum last = momentum();
  const double left = std::exp(-0.7);
  EXPECT_LE(norm(last.linear - left * first.linear), 1e-11 * norm(first.linear));
  EXPECT_LE(norm(last.angular - left * first.angular), 1e-10 * norm(first.angular));
}

TEST_P(ExactMethods, HangUnderDragAsTheTruthDoes) {
  Scene scene = scenes::make_tree();
  scene.drag = 2;
  const Frame truth = truth::solve(scene, {.save_at = {0.5}}).frames.front();
  World world(scene, settings(Integrator::rk4, 100));
  test::run(world, 0.025, 20);
  const test::Apart off = test::apart(test::frame_of(world), truth);
  EXPECT_LE(off.position, 1e-9);
  EXPECT_LE(off.velocity, 1e-8);
}

// Velocities that pull on rods are projected by mass: as the truth says, which does it by other means.
TEST_P(ExactMethods, ProjectInitialVelocities) {
  Scene scene = scenes::make_tree();
  test::Random random(11);
  for (Particle& particle : scene.particles) particle.velocity = test::random_vector(random);
  scene.particles[0].velocity = {};
  for (const MassModel mass : {MassModel::consistent, MassModel::lumped}) {
    const Frame truth = truth::solve(scene, {.save_at = {0}, .mass = mass}).frames.front();
    const World world(scene, settings(Integrator::rk4, 1, mass));
    EXPECT_LE(test::apart(test::frame_of(world), truth).velocity, 1e-13) << to_string(mass);
    EXPECT_GT(world.info().projected_velocity, 0.1);
  }
}

// A weight hung on the tip by a force, and one hung there as mass without inertia in the end: at rest the
// same pull. Here: a sideways force holds a pendulum at the angle where it balances gravity.
TEST_P(ExactMethods, BalanceForces) {
  Scene scene;
  const double angle = 0.6, weight = 3 * 9.81;
  scene.particles = {test::anchor({0, 0, 0}), test::loose({std::sin(angle), -std::cos(angle), 0}, 1)};
  scene.rods = {{.a = 0, .b = 1, .mass = 4}};  // half of the rod's weight acts at its end: 1 + 2 kg
  World world(scene, settings());
  world.set_force(1, {weight * std::tan(angle), 0, 0});
  test::run(world, 0.01, 100);
  EXPECT_LE(norm(world.position(1) - scene.particles[1].position), 1e-12);
  EXPECT_LE(norm(world.velocity(1)), 1e-11);
}

// A force on one particle of a body in free flight: it gains the momentum of force times time. In reduced
// coordinates but for what the integrator errs, here below 1e-11.
TEST_P(ExactMethods, TakeUpTheMomentumOfForces) {
  Scene scene = flying_tree(1);
  scene.gravity = {};
  for (std::uint32_t held = 0; held < scene.particles.size(); ++held) {
    World world(scene, settings(Integrator::rk4, 20));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world),
                              MassModel::consistent)
          .linear;
    };
    const Vec3 first = momentum(), force{3, -2, 1};
    world.set_force(held, force);
    test::run(world, 0.01, 10);
    EXPECT_LE(norm(momentum() - first - 0.1 * force), 2e-11 * norm(first)) << held;
  }
}

// Seen from an anchor that starts to move evenly, everything else starts to move the other way: as around an
// anchor at rest, with that velocity at first. Lumped: rods have no mass that starts with the anchor.
TEST_P(ExactMethods, FollowAnAnchorThatMovesEvenly) {
  const Vec3 speed{0.7, 0.3, -0.4};
  Scene rest = scenes::make_tree();
  World moving(rest, settings(Integrator::rk4, 50, MassModel::lumped));
  for (std::size_t i = 1; i < rest.particles.size(); ++i) rest.particles[i].velocity = -1 * speed;
  World still(rest, settings(Integrator::rk4, 50, MassModel::lumped));
  for (int i = 1; i <= 20; ++i) {
    moving.move_anchor(0, (i * 0.02) * speed);
    moving.step(0.02);
    still.step(0.02);
  }
  const Vec3 way = 0.4 * speed;
  for (std::uint32_t i = 0; i < rest.particles.size(); ++i) {
    EXPECT_LE(norm(moving.position(i) - way - still.position(i)), 1e-10) << i;
    if (i > 0) {
      EXPECT_LE(norm(moving.velocity(i) - speed - still.velocity(i)), 1e-9) << i;
    }
  }
}

// Drag acts as mass does, so a body towed evenly comes to hang straight, at the angle of c v to g.
TEST_P(ExactMethods, TrailBehindAnAnchorUnderDrag) {
  Scene scene = scenes::make_rods5();
  scene.drag = 5;
  World world(scene, settings(Integrator::rk4, 10));
  for (int i = 1; i <= 500; ++i) {
    world.move_anchor(0, {0.02 * i, 0, 0});
    world.step(0.02);
  }
  const Vec3 pull{-5, -9.81, 0}, way = (1 / norm(pull)) * pull;
  // What is left of the swing after 10 s is exp(-2.5 * 10) of it.
  for (std::uint32_t i = 1; i <= 5; ++i)
    EXPECT_LE(norm(world.position(i) - world.position(0) - (0.2 * i) * way), 1e-9) << i;
}

// The blow of an anchor that starts to move is an impulse on the body: for a uniform rod hit at its end
// across, the far end takes half the speed the other way (centre of percussion at two thirds).
TEST_P(ExactMethods, TakeTheBlowOfAnAnchor) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::anchor({0, 0, 0}), test::loose({1, 0, 0})};
  scene.rods = {{.a = 0, .b = 1, .mass = 4}};
  World world(scene, settings());
  const double dt = 1e-6;
  world.move_anchor(0, {0, 2 * dt, 0});
  world.step(dt);
  EXPECT_NEAR(world.velocity(1).y, -1, 1e-5);  // the rod turns by 3 dt meanwhile
  world.move_anchor(0, {0, 2 * dt, 0});
  world.step(dt);
  EXPECT_NEAR(world.velocity(1).y, 0, 2e-5) << "stopped again by the blow back";
}

/// `ties`: rods to fixed particles that the tree hangs from.
Scene random_scene(test::Random& random, std::uint32_t ties, double rod_mass, bool straggling,
                   std::uint32_t movable = 15) {
  const test::TreeShape shape{.movable = movable,
                              .anchors = ties,
                              .ties = 1,
                              .masses = 3,
                              .rod_mass = rod_mass,
                              .straggling = straggling};
  for (;;) {
    Scene scene = test::random_tree(random, shape);
    const auto held = std::count_if(scene.rods.begin(), scene.rods.end(), [&](const Rod& rod) {
      return scene.particles[rod.a].fixed || scene.particles[rod.b].fixed;
    });
    if (held != ties) continue;  // an anchor may hold a second particle
    for (Particle& particle : scene.particles) particle.velocity = test::random_vector(random);
    return scene;
  }
}

// Against method direct, gradient mid, which errs by its step squared.
TEST_P(ExactMethods, AgreeWithMethodDirectOnRandomTrees) {
  test::Random random(3);
  for (std::uint32_t round = 0; round < 6; ++round) {
    const std::uint32_t ties = GetParam() == Method::multipliers ? round % 3 : round % 2;
    const Scene scene = random_scene(random, ties, round % 3 == 0 ? 0.0 : 2.0, round < 3);
    World world(scene, settings(Integrator::rk4, 20));
    test::run(world, 0.02, 10);
    double errors[2];
    for (const int k : {0, 1}) {
      World direct(scene, test::direct(Gradient::mid, 64u << k));
      test::run(direct, 0.02, 10);
      errors[k] = rms_distance(test::positions_of(direct), test::positions_of(world));
    }
    EXPECT_LE(errors[1], 3e-5 * bounding_diagonal(scene)) << round;
    EXPECT_NEAR(errors[0] / errors[1], 4, 0.2) << round << ": all of the difference is direct's";
  }
}

// Against each other, where both step finely enough to be exact: bushes and deep trees, hung and afloat,
// either model of mass, with drag.
TEST(ExactMethodsAlike, MoveRandomTreesAlike) {
  test::Random random(31);
  for (std::uint32_t round = 0; round < 12; ++round) {
    Scene scene = random_scene(random, round % 2, round % 3 == 0 ? 0.0 : 2.0, round % 4 < 2, 30);
    if (round % 5 == 0) scene.drag = 1;
    const MassModel mass = round % 3 == 1 ? MassModel::lumped : MassModel::consistent;
    World one(scene, test::exact(Method::multipliers, Integrator::rk4, 100, mass)),
        other(scene, test::exact(Method::featherstone, Integrator::rk4, 100, mass));
    test::run(one, 0.02, 10);
    test::run(other, 0.02, 10);
    const test::Apart off = test::apart(test::frame_of(one), test::frame_of(other));
    EXPECT_LE(off.position, 1e-9) << round;
    EXPECT_LE(off.velocity, 1e-7) << round;
  }
}

// What breaks one island leaves the others to the bit.
TEST_P(ExactMethods, FreezeOnlyTheIslandThatBroke) {
  Scene scene = scenes::make_ensemble({.chains = 3, .links = 4});
  World world(scene, settings(Integrator::semi_implicit_euler, 4)),
      twin(scene, settings(Integrator::semi_implicit_euler, 4));
  test::run(world, 0.01, 5);
  test::run(twin, 0.01, 5);
  std::vector<Vec3> before = test::positions_of(world);
  world.set_force(7, {1e308, 1e308, 0});
  EXPECT_EQ(world.step(0.01).frozen_islands, 1u);
  twin.step(0.01);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(world.step(0.01).frozen_islands, 0u);
    twin.step(0.01);
  }
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    const bool broke = i >= 5 && i < 10;
    EXPECT_EQ(world.position(i), broke ? before[i] : twin.position(i)) << i;
    EXPECT_EQ(world.velocity(i), broke ? Vec3{} : twin.velocity(i)) << i;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
