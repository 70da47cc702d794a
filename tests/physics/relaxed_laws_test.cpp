// Relaxation of rods that give (plumb::RodLaw). Once converged, a substep is that of method direct, whatever
// the number and the order of sweeps. Momentum is kept, stiff rods are rigid ones, and a slack cable pulls
// nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double dt = 1.0 / 60;

Scene chain(const RodLaw& law) {
  Scene scene = scenes::make_chain(6, 0.1, 3);
  for (Rod& rod : scene.rods) rod.law = law;
  return scene;
}

/// A net between two corners whose rods are drawn slack. It falls into them.
Scene loose_net(const RodLaw& law) {
  Scene scene = scenes::make_net(4, 3);
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    scene.rods[i].length = rod_length(scene, i) * (1.05 + 0.02 * static_cast<double>(i % 5));
    scene.rods[i].law = law;
  }
  return scene;
}

struct Case {
  const char* name;
  Scene scene;
};
std::vector<Case> cases() {
  std::vector<Case> out{
      {"elastic chain", chain({.stiffness = 2000})},
      {"soft chain", chain({.stiffness = 60})},
      {"damped chain", chain({.stiffness = 500, .damping = 5})},
      {"chain of elastic cables", chain({.stiffness = 500, .damping = 1, .one_sided = true})},
      {"chain of cables", chain({.one_sided = true})},
      {"net of elastic cables", loose_net({.stiffness = 3000, .damping = 2, .one_sided = true})},
      {"chain in drag", chain({.stiffness = 500, .damping = 1})},
      {"chain of several laws", chain({.stiffness = 500})}};
  out[6].scene.drag = 0.7;
  out[7].scene.rods[0].law = {};
  out[7].scene.rods[2].law = {.one_sided = true};
  out[7].scene.rods[3].law = {};
  out[7].scene.rods[5].law = {.stiffness = 0, .damping = 8};
  return out;
}

constexpr Gradient gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

Settings relaxed(Gradient gradient) {
  return {.method = Method::relax,
          .gradient = gradient,
          .substeps = 4,
          .stop = {.sweeps = 20000, .tolerance = 1e-14},
          .threads = 1};
}
Settings direct(Gradient gradient) {
  return {.method = Method::direct, .gradient = gradient, .substeps = 4, .threads = 1};
}

using test::apart;
/// Returns how far apart two worlds are after 20 steps, in m.
double apart(const Scene& first, const Settings& a, const Scene& second, const Settings& b) {
  World one(first, a), other(second, b);
  test::run(one, dt, 20);
  test::run(other, dt, 20);
  return apart(one, other);
}

// Substeps of both methods solve the same equation. What is apart are the tolerances of 80 substeps, which
// motion carries on. With drag the first displacement is apart, too: relaxation takes the exact one.
TEST(RelaxedLaws, ConvergeToTheDirectSolution) {
  for (const auto& [name, scene] : cases())
    for (const Gradient gradient : gradients)
      EXPECT_LT(apart(scene, relaxed(gradient), scene, direct(gradient)), scene.drag > 0 ? 1e-5 : 1e-10)
          << name << ", gradient " << to_string(gradient);
}

// Rigid cables catch a net: which of them are taut is part of the solution. Method direct cuts a substep in
// two where Newton does not find it. Until then both are the same, and any order of sweeps is afterwards,
// too.
TEST(RelaxedLaws, CatchANetInCables) {
  const Scene scene = loose_net({.one_sided = true});
  World one(scene, relaxed(Gradient::new_)), other(scene, direct(Gradient::new_));
  int taut = 0;
  for (int i = 0; i < 20; ++i) {
    const StepReport report = other.step(dt);
    if (report.halvings > 0) break;
    if (one.step(dt).block_sweeps > 0) ++taut;
    EXPECT_LT(apart(one, other), 1e-12);
  }
  EXPECT_GT(taut, 2);
  Settings omega = relaxed(Gradient::new_), jacobi = omega;
  omega.omega = 1.5;
  jacobi.order = SweepOrder::jacobi;
  for (const Settings& settings : {omega, jacobi})
    EXPECT_LT(apart(scene, relaxed(Gradient::new_), scene, settings), 1e-12);
  EXPECT_LT(test::stretch_of(scene, one).max, 1e-12) << "no cable is too long";
}

// A substep that follows one of another length takes pulls over the right time.
TEST(RelaxedLaws, FollowStepsThatChange) {
  for (const auto& [name, scene] : cases())
    for (const Gradient gradient : gradients) {
      World one(scene, relaxed(gradient)), other(scene, direct(gradient));
      for (int i = 0; i < 20; ++i)
        for (World* world : {&one, &other}) world->step(i % 3 == 0 ? dt : 0.7 * dt);
      EXPECT_LT(apart(one, other), scene.drag > 0 ? 1e-5 : 1e-10)
          << name << ", gradient " << to_string(gradient);
    }
}

// The stiffness does not depend on how many sweeps there are, in which order, and how far they go.
TEST(RelaxedLaws, DoNotDependOnSweepsOrderOrOmega) {
  for (const auto& [name, scene] : cases())
    for (const Gradient gradient : gradients) {
      Settings other = relaxed(gradient);
      other.stop = {.sweeps = 1500};
      EXPECT_LT(apart(scene, relaxed(gradient), scene, other), 1e-10) << name;
      other.stop = {.sweeps = 20};
      other.layout = LayoutChoice::aosoa;
      Settings aos = other;
      aos.layout = LayoutChoice::aos;
      EXPECT_EQ(apart(scene, aos, scene, other), 0) << name << ", layout";
      other = relaxed(gradient);
      other.omega = 1.4;
      EXPECT_LT(apart(scene, relaxed(gradient), scene, other), 1e-10) << name << ", omega";
      other = relaxed(gradient);
      other.order = SweepOrder::jacobi;
      EXPECT_LT(apart(scene, relaxed(gradient), scene, other), 1e-10) << name << ", jacobi";
    }
}

// The strain of stiffness k is a pull over k and the length: 10^-9 for 10^12 N/m. Relaxation of rigid rods
// keeps what visits did along directions that turn since, so gradients new and mid are apart by the turn of a
// substep squared. With gradient old, whose directions do not turn, it is the same.
TEST(RelaxedLaws, StiffRodsAreRigid) {
  for (const Gradient gradient : gradients) {
    const Scene stiff = chain({.stiffness = 1e12}), rigid = chain({});
    EXPECT_LT(apart(stiff, relaxed(gradient), rigid, direct(gradient)), 1e-8) << to_string(gradient);
    EXPECT_LT(apart(stiff, relaxed(gradient), rigid, relaxed(gradient)),
              gradient == Gradient::old ? 1e-8 : 1e-3)
        << to_string(gradient);
  }
}

// Forces between two particles are equal and opposite, whatever is left to converge.
TEST(RelaxedLaws, KeepMomentumInFreeFlight) {
  for (auto& [name, scene] : cases())
    for (const SweepOrder order : {SweepOrder::gauss_seidel, SweepOrder::jacobi})
      for (const Gradient gradient : gradients) {
        scene.gravity = {};
        scene.drag = 0;
        Vec3 before{};
        for (std::size_t p = 0; p < scene.particles.size(); ++p) {
          Particle& particle = scene.particles[p];
          if (particle.fixed) particle.fixed = false, particle.mass = 1.5;
          particle.velocity = {0.1 * static_cast<double>(p), p % 2 == 0 ? 1.0 : -0.5, 0.3};
          before = before + particle.mass * particle.velocity;
        }
        Settings settings = relaxed(gradient);
        settings.order = order;
        settings.stop = {.sweeps = 3};
        World world(scene, settings);
        Vec3 center{};
        double mass = 0;
        for (std::size_t p = 0; p < scene.particles.size(); ++p) {
          center = center - scene.particles[p].mass * scene.particles[p].position;
          mass += scene.particles[p].mass;
        }
        test::run(world, dt, 60);
        for (std::uint32_t p = 0; p < world.particle_count(); ++p)
          center = center + scene.particles[p].mass * world.position(p);
        // The centre of mass has gone on for a second, with the velocity that projection leaves as it was.
        EXPECT_LT(norm(center - before), 1e-12 * mass) << name << ", gradient " << to_string(gradient);
      }
}

// It falls as if nothing held it.
TEST(RelaxedLaws, ASlackCablePullsNothing) {
  for (const double stiffness : {100.0, std::numeric_limits<double>::infinity()})
    for (const Gradient gradient : gradients) {
      Scene scene;
      scene.particles = {test::fixed({}), test::movable({0.1, 0, 0}, 2, {0.3, 0, 0})};
      scene.rods = {{.a = 0, .b = 1, .length = 2, .law = {.stiffness = stiffness, .one_sided = true}}};
      World world(scene, relaxed(gradient));
      const StepReport report = test::run(world, dt, 30);
      EXPECT_LT(norm(world.position(1) - Vec3{0.1 + 0.15, -9.81 / 8, 0}), 1e-13);
      EXPECT_EQ(report.block_sweeps, 0) << "there is nothing to sweep for";
    }
}

// An island that hangs still is where Hooke's law says: each rod longer by the weight below it over its
// stiffness.
TEST(RelaxedLaws, HangAsHookeSays) {
  Scene scene;
  scene.particles = {test::fixed({}), test::movable({0, -1, 0}, 2), test::movable({0, -2, 0}, 3)};
  scene.rods = {{.a = 0, .b = 1, .length = 1, .law = {.stiffness = 400, .damping = 60}},
                {.a = 1, .b = 2, .length = 1, .law = {.stiffness = 700, .damping = 60}}};
  for (const Gradient gradient : gradients)
    for (const Precision precision : {Precision::single, Precision::double_}) {
      Settings settings = relaxed(gradient);
      settings.precision = precision;
      settings.stop = {.sweeps = 60};
      World world(scene, settings);
      test::run(world, dt, 900);
      const double first = 5 * 9.81 / 400, second = 3 * 9.81 / 700;
      const double bound = precision == Precision::single ? 1e-5 : 1e-10;
      EXPECT_NEAR(world.position(1).y, -1 - first, bound) << to_string(gradient);
      EXPECT_NEAR(world.position(2).y, -2 - first - second, bound) << to_string(gradient);
    }
}

// Gradient mid takes energy for what it is: a sum of kinetic, potential and elastic energy stays, to the
// sweeps' tolerance, with cables that go slack and tighten, too.
TEST(RelaxedLaws, GradientMidKeepsEnergy) {
  for (const bool one_sided : {false, true}) {
    const Scene scene = chain({.stiffness = 800, .one_sided = one_sided});
    World world(scene, relaxed(Gradient::mid));
    const double start = test::energy_of(scene, world).total();
    test::run(world, dt, 120);
    EXPECT_NEAR(test::energy_of(scene, world).total(), start, 1e-10 * energy_range(scene)) << one_sided;
  }
}

// A world that looks for its own substeps takes them back, and half kicks with them.
TEST(RelaxedLaws, TakeAnAccuracy) {
  const Scene scene = chain({.stiffness = 500, .damping = 1});
  World truth(scene, {.method = Method::direct, .gradient = Gradient::old, .substeps = 2000, .threads = 1});
  test::run(truth, dt, 30);
  for (const Gradient gradient : gradients) {
    Settings settings = relaxed(gradient);
    settings.accuracy = 1e-3;
    settings.stop = {.sweeps = 200, .tolerance = 1e-8};
    World world(scene, settings);
    test::run(world, dt, 30);
    EXPECT_LT(apart(world, truth), 3e-3 * bounding_diagonal(scene)) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
