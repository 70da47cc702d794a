// Method direct against truth: the order of every gradient point, with rods solved exactly, so that nothing
// but the step is left to blame.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scenes/generators.hpp"
#include "scenes/trajectory.hpp"
#include "support/direct.hpp"
#include "support/truths.hpp"

namespace plumb {
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
  return {{"rods5", test::five_rods(), at_half_a_second("rods5.csv"), 4},
          {"tree", test::rod_tree(), at_half_a_second("tree.csv"), 4},
          {"double", test::double_pendulum(), at_half_a_second("double.csv"), 4},
          {"chain", scenes::make_chain(20, 0.1, 10), at_half_a_second("chain_N20_r10.csv"), 8}};
}

/// Position and velocity errors after half a second, RMS.
std::pair<double, double> errors(const Known& k, Gradient gradient, std::uint32_t substeps) {
  World world(k.scene, test::direct(gradient, substeps));
  const StepReport report = test::run(world, 1.0 / 60, 30);
  EXPECT_EQ(report.unsolved, 0u);
  return {rms_distance(test::positions_of(world), k.truth.positions),
          rms_distance(test::velocities_of(world), k.truth.velocities)};
}

/// By what the errors fall as the step is halved three times.
void expect_falls(const Known& k, Gradient gradient, std::uint32_t substeps, double least, double most) {
  auto coarse = errors(k, gradient, substeps);
  for (int halving = 1; halving <= 3; ++halving) {
    const auto fine = errors(k, gradient, substeps << halving);
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

}  // namespace
}  // namespace plumb
