// Method direct against truth: the order of every gradient point, with rods solved exactly, so that nothing
// but the step is left to blame.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/truths.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

struct Known {
  const char* name;
  Scene scene;
  Frame truth;             ///< at half a second, from a file accurate to 1e-9
  std::uint32_t substeps;  ///< of 1/60 s, from which on the error falls as its order says
};

Frame at_half_a_second(const char* file) {
  for (const Frame& frame : scenes::read_trajectory(std::string(PLUMB_TEST_DATA) + "/" + file))
    if (frame.t == 0.5) return frame;
  ADD_FAILURE() << file << " has no half second";
  return {};
}

std::vector<Known> known() {
  return {{"rods5", scenes::make_rods5(), at_half_a_second("rods5.csv"), 4},
          {"tree", scenes::make_tree(), at_half_a_second("tree.csv"), 4},
          {"double", test::double_pendulum(), at_half_a_second("double.csv"), 4},
          {"chain", scenes::make_chain(20, 0.1, 10), at_half_a_second("chain_N20_r10.csv"), 8}};
}

/// Position and velocity errors after half a second, RMS.
std::pair<double, double> errors(const Known& k, Gradient gradient, std::uint32_t substeps,
                                 std::uint32_t time_order) {
  Settings settings = test::direct(gradient, substeps);
  settings.time_order = time_order;
  World world(k.scene, settings);
  const StepReport report = test::run(world, 1.0 / 60, 30);
  EXPECT_EQ(report.unsolved, 0u);
  return {rms_distance(test::positions_of(world), k.truth.positions),
          rms_distance(test::velocities_of(world), k.truth.velocities)};
}

/// By what the errors fall as the step is halved three times.
void expect_falls(const Known& k, Gradient gradient, std::uint32_t substeps, double least, double most,
                  std::uint32_t time_order = 2, int halvings = 3) {
  auto coarse = errors(k, gradient, substeps, time_order);
  for (int halving = 1; halving <= halvings; ++halving) {
    const auto fine = errors(k, gradient, substeps << halving, time_order);
    EXPECT_GE(coarse.first / fine.first, least) << k.name << ", halving " << halving;
    EXPECT_LE(coarse.first / fine.first, most) << k.name << ", halving " << halving;
    EXPECT_GE(coarse.second / fine.second, least) << k.name << ", velocities, halving " << halving;
    EXPECT_LE(coarse.second / fine.second, most) << k.name << ", velocities, halving " << halving;
    coarse = fine;
  }
}

// 4 is second order; 3.7 to 4.3 leaves room for the next order's part at the coarsest step.
TEST(DirectOrder, OfGradientOldIsTwo) {
  for (const Known& k : known()) expect_falls(k, Gradient::old, k.substeps, 3.7, 4.3);
}
TEST(DirectOrder, OfGradientMidIsTwo) {
  for (const Known& k : known()) expect_falls(k, Gradient::mid, k.substeps, 3.7, 4.3);
}
TEST(DirectOrder, OfGradientNewIsOne) {
  for (const Known& k : known()) expect_falls(k, Gradient::new_, 8 * k.substeps, 1.8, 2.2);
}

/// With truths that are good enough to see them: those in files are good to 1e-9.
std::vector<Known> known_well() {
  std::vector<Known> out = known();
  for (Known& k : out) k.truth = truth::solve(k.scene, {.save_at = {0.5}}).frames.front();
  return out;
}

// 16 and 64; a tenth, and a quarter, for the next order's part.
TEST(DirectOrder, OfCompositionsIsFourAndSix) {
  for (const Known& k : known_well()) {
    expect_falls(k, Gradient::old, 2 * k.substeps, 14.4, 17.6, 4, 2);
    expect_falls(k, Gradient::old, k.substeps, 48, 80, 6, 1);
  }
}

// A ring goes through the solver of loops.
TEST(DirectOrder, OfCompositionsWithLoopsIsFourAndSix) {
  Known ring{"ring", scenes::make_ring({.links = 8}), {}, 4};
  ring.truth = truth::solve(ring.scene, {.save_at = {0.5}}).frames.front();
  expect_falls(ring, Gradient::old, 4, 14.4, 17.6, 4, 2);
  expect_falls(ring, Gradient::old, 4, 48, 80, 6, 1);
}

// Rods that give pull by half of a kick where a substep ends, which drag must not spoil.
TEST(DirectOrder, OfCompositionsWithElasticRodsInDragIsFourAndSix) {
  for (Known k : {Known{"chain", scenes::make_chain(5, 0.1, 3), {}, 8},
                  Known{"ring", scenes::make_ring({.links = 8}), {}, 8}}) {
    k.scene.drag = 0.7;
    for (Rod& rod : k.scene.rods) rod.law.stiffness = 500;
    k.truth = truth::solve(k.scene, {.save_at = {0.5}}).frames.front();
    expect_falls(k, Gradient::old, k.substeps, 14.4, 17.6, 4, 2);
    expect_falls(k, Gradient::old, k.substeps / 2, 48, 80, 6, 1);
  }
}

// Nothing is lost by going backwards: symmetric compositions of RATTLE keep energy in the long run.
TEST(DirectOrder, CompositionsKeepEnergyFarBetter) {
  const Scene scene = scenes::make_chain(5, 0.1, 1);
  double drift[2];
  for (const std::uint32_t order : {2u, 6u}) {
    Settings settings = test::direct(Gradient::old, order == 2 ? 144 : 16);  // the same work
    settings.time_order = order;
    World world(scene, settings);
    drift[order == 6] = test::run_and_watch(scene, world, 300).drift;
  }
  EXPECT_LT(drift[1], drift[0] / 1000);
}

// Multipliers of gradient old are extrapolated. Where a motion is smooth they start so near that one Newton
// step does, in double, and without it two (1.17 and 2.0 seen).
TEST(DirectOrder, OneNewtonStepDoesWhereMotionIsSmooth) {
  World world(scenes::make_chain(1000, 0.1, 1000), test::direct(Gradient::old, 2));
  std::uint64_t newton = 0, substeps = 0;
  for (int i = 0; i < 60; ++i) {
    const StepReport report = world.step(1.0 / 60);
    newton += report.newton;
    substeps += report.direct_substeps;
  }
  EXPECT_LT(static_cast<double>(newton), 1.5 * static_cast<double>(substeps));
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
