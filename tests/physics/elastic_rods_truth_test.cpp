// Method direct against truth where rods are elastic: the order of every gradient point on chains, trees,
// loops, and rods with mass, damped or mixed with rigid ones, and the way to the rigid limit.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"
#include "support/laws.hpp"
#include "support/truths.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::with_law;

struct Elastic {
  std::string name;
  Scene scene;
  std::uint32_t substeps = 4;  ///< of 1/60 s, from which on the error falls as its order says
  MassModel mass = MassModel::consistent;
  Frame truth{};  ///< at half a second, accurate to 1e-9 of the diagonal or better
};

/// Every second rod is elastic, and the others are rigid.
Scene mixed(Scene scene, const RodLaw& law) {
  for (std::size_t r = 1; r < scene.rods.size(); r += 2) scene.rods[r].law = law;
  return scene;
}

/// Twigs of the exact tree are light: their waves, some 300 rad/s, need twice the substeps of the others.
std::vector<Elastic> elastic_scenes() {
  const RodLaw soft{.stiffness = 2e3}, damped{.stiffness = 2e3, .damping = 20}, firm{.stiffness = 2e4};
  const MassModel lumped = MassModel::lumped;
  std::vector<Elastic> out{{"chain", with_law(scenes::make_chain(5, 0.1, 2), soft)},
                           {"damped chain", with_law(scenes::make_chain(5, 0.1, 2), damped)},
                           {"mixed chain", mixed(scenes::make_chain(5, 0.1, 2), soft)},
                           {"tree", with_law(scenes::make_tree(), firm), 8},
                           {"lumped tree", with_law(scenes::make_tree(), firm), 4, lumped},
                           {"rods", with_law(scenes::make_rods5(), firm)},
                           {"lumped rods", with_law(scenes::make_rods5(), firm), 4, lumped},
                           {"ring", with_law(scenes::make_ring({.links = 8}), soft)},
                           {"damped ring", with_law(scenes::make_ring({.links = 8}), damped)},
                           {"hung ring", with_law(test::hung_ring(1), soft)},
                           {"mixed ring", mixed(test::hung_ring(1), soft)}};
  for (Elastic& each : out)
    each.truth = truth::solve(each.scene, {.save_at = {0.5}, .mass = each.mass}).frames.front();
  return out;
}

/// Position and velocity errors after half a second, RMS.
std::pair<double, double> errors(const Elastic& each, Gradient gradient, std::uint32_t substeps) {
  World world(each.scene, test::direct(gradient, substeps, each.mass));
  const StepReport report = test::run(world, 1.0 / 60, 30);
  EXPECT_EQ(report.unsolved, 0u) << each.name;
  return {rms_distance(test::positions_of(world), each.truth.positions),
          rms_distance(test::velocities_of(world), each.truth.velocities)};
}

/// By what the errors fall as the step is halved three times.
void expect_falls(const Elastic& each, Gradient gradient, std::uint32_t substeps, double least, double most) {
  auto coarse = errors(each, gradient, substeps);
  for (int halving = 1; halving <= 3; ++halving) {
    const auto fine = errors(each, gradient, substeps << halving);
    const std::string what = each.name + ", halving " + std::to_string(halving);
    EXPECT_GE(coarse.first / fine.first, least) << what;
    EXPECT_LE(coarse.first / fine.first, most) << what;
    EXPECT_GE(coarse.second / fine.second, least) << what << ", velocities";
    EXPECT_LE(coarse.second / fine.second, most) << what << ", velocities";
    coarse = fine;
  }
}

// 4 is second order; 3.7 to 4.3 leaves room for the next order's part at the coarsest step.
TEST(ElasticRodsTruth, GradientOldIsOfOrderTwo) {
  for (const Elastic& each : elastic_scenes()) expect_falls(each, Gradient::old, each.substeps, 3.7, 4.3);
}
TEST(ElasticRodsTruth, GradientMidIsOfOrderTwo) {
  for (const Elastic& each : elastic_scenes()) expect_falls(each, Gradient::mid, each.substeps, 3.7, 4.3);
}
TEST(ElasticRodsTruth, GradientNewIsOfOrderOne) {
  for (const Elastic& each : elastic_scenes())
    expect_falls(each, Gradient::new_, 8 * each.substeps, 1.8, 2.2);
}

/// Largest distance of a particle after half a second in 64 substeps a frame, in m.
double largest_distance(const Scene& a, const Scene& b, Gradient gradient) {
  World one(a, test::direct(gradient, 64)), two(b, test::direct(gradient, 64));
  test::run(one, 1.0 / 60, 30);
  EXPECT_EQ(test::run(two, 1.0 / 60, 30).unsolved, 0u);
  double largest = 0;
  for (std::uint32_t i = 0; i < a.particles.size(); ++i)
    largest = std::max(largest, norm(one.position(i) - two.position(i)));
  return largest;
}

// Rods of 1e12 N/m are those of a rigid chain. What is left is what a pull T stretches, T/k, and what becomes
// of it: tenfold stiffness leaves a tenth, to 2 %, as the next term is far below rounding's part of 1e-12 m.
TEST(ElasticRodsTruth, RodsSoStiffAreRigid) {
  const Scene rigid = scenes::make_chain(5, 0.1, 0.2, 0.1);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double last = 0;
    for (const double stiffness : {1e10, 1e11, 1e12}) {
      const double apart = largest_distance(rigid, with_law(rigid, {.stiffness = stiffness}), gradient);
      if (last > 0) {
        EXPECT_NEAR(last / apart, 10, 0.2) << to_string(gradient) << ", " << stiffness;
      }
      last = apart;
    }
    EXPECT_LE(last, 1e-9) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
