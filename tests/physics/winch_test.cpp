// Rods whose length changes at a constant rate: the truth of such scenes, and how worlds converge to it.

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/generators/generators.hpp"
#include "scenes/runs/run.hpp"
#include "support/truths.hpp"
#include "support/worlds.hpp"
#include "truth/truth.hpp"

namespace plumb {
namespace {

using scenes::LengthRate;

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

}  // namespace
}  // namespace plumb
