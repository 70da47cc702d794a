// Truths of elastic rods against solutions in closed form, and what their motion keeps.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scenes/generators/generators.hpp"
#include "support/laws.hpp"
#include "support/series_order.hpp"
#include "support/truths.hpp"
#include "truth/integrators/integrator.hpp"
#include "truth/truth.hpp"

namespace plumb::truth::PLUMB_TEST_FILE {
namespace {

using test::with_law;

/// Rounding of the double numbers in frames, in m and m/s at sizes of about one.
constexpr double rounding = 2e-15;

/// A place and its velocity along a line, in m and m/s.
struct Along {
  Real x = 0, v = 0;
};

/// A damped swing x'' + 2 decay x' + square x = 0 from `start`, after t seconds.
Along swing(Along start, Real decay, Real square, Real t) {
  const Real fast = square - decay * decay, w = std::sqrt(std::abs(fast)), left = std::exp(-decay * t);
  const Real c = fast > 0 ? std::cos(w * t) : std::cosh(w * t);
  const Real s = fast > 0 ? std::sin(w * t) : std::sinh(w * t);
  const Real other = (start.v + decay * start.x) / w, turned = fast > 0 ? -w : w;
  const Along out{left * (start.x * c + other * s), 0};
  return {out.x, left * (start.x * turned * s + other * w * c) - decay * out.x};
}

/// A particle of 2 kg below an anchor, on an elastic rod of 0.5 m that starts at 0.6 m and 0.3 m/s downwards.
Scene hung(const RodLaw& law) {
  Scene scene;
  scene.particles = {test::anchor({0, 0, 0}), test::loose({0, -0.6, 0}, 2)};
  scene.particles[1].velocity = {0, -0.3, 0};
  scene.rods = {{.a = 0, .b = 1, .length = 0.5, .law = law}};
  return scene;
}

/// Compares with the closed form at the time t. Positions and velocities count as in Accuracy.
void expect_swings(const RodLaw& law, double t, double tolerance) {
  const Scene scene = hung(law);
  const Truth truth = solve(scene, {.save_at = {t}, .tolerance = tolerance});
  const Real middle = 0.5L + 2 * Real{9.81} / law.stiffness;
  const Along x = swing({Real{0.6} - middle, Real{0.3}}, law.damping / Real{4}, law.stiffness / Real{2}, t);
  const std::string what = std::to_string(law.stiffness) + " N/m, " + std::to_string(law.damping);
  EXPECT_NEAR(-truth.frames[0].positions[1].y, static_cast<double>(middle + x.x), tolerance) << what;
  EXPECT_NEAR(-truth.frames[0].velocities[1].y, static_cast<double>(x.v), tolerance * truth.speed) << what;
}

// The rod is soft, stiff, and so stiff that a second holds 11 000 swings.
TEST(TruthLaws, ParticleSwingsAsASpring) {
  expect_swings({.stiffness = 200}, 2, 1e-14);
  expect_swings({.stiffness = 2e5}, 2, 1e-13);
  // A phase of 7e4 rad carries the rounding of every step, 1e-19 times some 1e4 steps.
  expect_swings({.stiffness = 1e10}, 1, 1e-11);
}

// The damping is weak, strong, and so strong that the particle creeps.
TEST(TruthLaws, ParticleSwingsAsADampedSpring) {
  expect_swings({.stiffness = 200, .damping = 3}, 2, 1e-14);
  expect_swings({.stiffness = 2e5, .damping = 100}, 2, 1e-14);
  expect_swings({.stiffness = 200, .damping = 400}, 2, 1e-14);
  expect_swings({.stiffness = 2e5, .damping = 4e4}, 0.3, 1e-13);
}

// A damper without a spring slows what pulls on it: v' = -(r/m) v.
TEST(TruthLaws, DamperAloneSlows) {
  Scene scene = hung({.stiffness = 0, .damping = 3});
  scene.gravity = {};
  const Frame frame = solve(scene, {.save_at = {1}}).frames[0];
  EXPECT_NEAR(frame.velocities[1].y, -0.3 * std::exp(-1.5), rounding);
  EXPECT_NEAR(frame.positions[1].y, -0.6 - 0.3 / 1.5 * (1 - std::exp(-1.5)), rounding);
}

// The centre of mass falls freely, and the two swing about it with the reduced mass 1/(1/2 + 1/3) kg.
TEST(TruthLaws, TwoParticlesSwingAboutTheirCentre) {
  const Vec3 along{0.36, 0.48, 0.8}, drift{1, 2, -0.5};
  Scene scene;
  scene.particles = {test::loose({}, 2), test::loose(0.7 * along, 3)};
  for (Particle& particle : scene.particles) particle.velocity = drift;
  scene.rods = {{.a = 0, .b = 1, .length = 0.5, .law = {.stiffness = 900, .damping = 2}}};
  const double t = 0.8;
  const Frame frame = solve(scene, {.save_at = {t}, .tolerance = 1e-14}).frames[0];
  const Real give = 1 / 2.0L + 1 / 3.0L;
  const Along x = swing({Real{0.7} - 0.5L, 0}, give, 900 * give, t);
  const Vec3 center = 0.6 * (0.7 * along) + t * drift + (t * t / 2) * scene.gravity;
  const double length = static_cast<double>(0.5L + x.x), rate = static_cast<double>(x.v);
  const Vec3 falling = drift + t * scene.gravity;
  EXPECT_LT(norm(frame.positions[0] - (center - 0.6 * length * along)), 4 * rounding);
  EXPECT_LT(norm(frame.positions[1] - (center + 0.4 * length * along)), 4 * rounding);
  EXPECT_LT(norm(frame.velocities[0] - (falling - 0.6 * rate * along)), 20 * rounding);
  EXPECT_LT(norm(frame.velocities[1] - (falling + 0.4 * rate * along)), 20 * rounding);
}

// Two particles circle at the length where the rod's pull turns them: k (l - L) = m w² l/2. Damping does
// nothing.
TEST(TruthLaws, TwoParticlesCircle) {
  const double length = 0.8, w = std::sqrt(2 * 500 * (length - 0.5) / (length * 1.5));
  Scene scene;
  scene.particles = {test::loose({-length / 2, 0, 0}, 1.5), test::loose({length / 2, 0, 0}, 1.5)};
  scene.particles[0].velocity = {0, 0, -w * length / 2};
  scene.particles[1].velocity = {0, 0, w * length / 2};
  scene.rods = {{.a = 0, .b = 1, .length = 0.5, .law = {.stiffness = 500, .damping = 3}}};
  scene.gravity = {};
  const double t = 1.1;
  const Frame frame = solve(scene, {.save_at = {t}, .tolerance = 1e-14}).frames[0];
  const Vec3 at{length / 2 * std::cos(w * t), 0, length / 2 * std::sin(w * t)};
  // The speed w is rounded, and a phase of 18 rad multiplies that.
  EXPECT_LT(norm(frame.positions[1] - at), 20 * rounding);
  EXPECT_LT(norm(frame.positions[0] + at), 20 * rounding);
}

// A rod with mass: its ends part with the inertia of aa - ab of its mass matrix each.
TEST(TruthLaws, MassAlongARodSwingsWithIt) {
  Scene scene;
  scene.particles = {test::loose({0, 0, 0}, 1), test::loose({0.6, 0, 0}, 1)};
  scene.rods = {{.a = 0, .b = 1, .length = 0.5, .mass = 3, .law = {.stiffness = 700}}};
  scene.gravity = {};
  const double t = 0.9;
  for (const MassModel model : {MassModel::lumped, MassModel::consistent}) {
    const Frame frame = solve(scene, {.save_at = {t}, .mass = model, .tolerance = 1e-14}).frames[0];
    // A uniform rod has aa - ab = m/3 - m/6, and m/2 if lumped.
    const Real each = 1 + (model == MassModel::lumped ? 1.5L : 0.5L);
    const Along x = swing({Real{0.6} - 0.5L, 0}, 0, 2 * 700 / each, t);
    EXPECT_NEAR(frame.positions[1].x - frame.positions[0].x, static_cast<double>(0.5L + x.x), rounding);
    EXPECT_NEAR(frame.velocities[1].x - frame.velocities[0].x, static_cast<double>(x.v), 4 * rounding);
  }
}

/// The braced box of rods with mass, of which every third is elastic.
Scene mixed_box() {
  Scene scene = test::braced_box(2);
  for (std::size_t r = 0; r < scene.rods.size(); r += 3) scene.rods[r].law = {.stiffness = 3e3};
  return scene;
}

TEST(TruthLaws, KeepEnergy) {
  const RodLaw law{.stiffness = 5e3};
  for (const Scene& scene : {with_law(test::double_pendulum(), law), with_law(scenes::make_rods5(), law),
                             with_law(scenes::make_tree(), law), with_law(test::hung_ring(1), law),
                             with_law(scenes::make_net(4, 3), law), mixed_box()}) {
    EXPECT_LT(solve(scene, {.save_at = {0.2, 0.6}}).energy_drift, 1e-14) << scene.rods.size() << " rods";
  }
}

// A floating mixture of rigid, elastic and damped rods with mass: inner forces change neither momentum.
TEST(TruthLaws, KeepMomenta) {
  Scene scene = with_law(test::hung_ring(1), {.stiffness = 800, .damping = 4});
  scene.rods[2].law = scene.rods[3].law = {};
  for (Particle& particle : scene.particles) {
    particle.fixed = false;
    particle.mass += 0.5;
  }
  scene.particles[3].velocity = {1, 2, 3};
  scene.gravity = {};
  const Truth truth = solve(scene, {.save_at = {0, 0.7}});
  const auto momentum = [&](const Frame& f) {
    return measure_momentum(scene, f.positions, f.velocities, MassModel::consistent);
  };
  const Momentum first = momentum(truth.frames[0]), last = momentum(truth.frames[1]);
  EXPECT_LT(norm(last.linear - first.linear), 20 * rounding);
  EXPECT_LT(norm(last.angular - first.angular), 20 * rounding);
}

// Half the step, 2^order of the error: no coefficient of the rods' lengths and pulls is wrong.
TEST(TruthLaws, ConvergeWithTheOrderOfTheSeries) {
  Scene scene = with_law(scenes::make_tree(), {.stiffness = 2e3, .damping = 5});
  scene.rods[1].law = {};
  const Model model = make_model(scene, MassModel::consistent);
  const State start = start_of(scene, model);
  for (const std::uint32_t order : {2u, 3u, 4u, 6u, 8u}) {
    EXPECT_NEAR(test::measured_order(model, start, order, 24), order, 0.2);
  }
}

// Falling upwards through its anchor, a particle turns its rod's pull round within no time.
TEST(TruthLaws, RefuseEndsThatMeet) {
  Scene scene = hung({.stiffness = 100});
  scene.particles[1].velocity = {0, 12, 0};
  try {
    solve(scene, {.save_at = {1}});
    FAIL() << "not refused";
  } catch (const Unreachable& error) {
    EXPECT_NE(std::string(error.what()).find("ends of elastic rod 0 meet"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace plumb::truth::PLUMB_TEST_FILE
