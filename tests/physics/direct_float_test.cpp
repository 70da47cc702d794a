// Method direct in float: positions are kept in double and rods are measured there, so that digits are lost
// to displacements only.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/generators/generators.hpp"
#include "support/direct.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

double stretch_after_a_second(Gradient gradient, double distance) {
  Scene scene = scenes::make_chain(1000);
  for (Particle& particle : scene.particles) particle.position += {distance, distance, distance};
  Settings settings = test::direct(gradient);
  settings.precision = Precision::single;
  World world(scene, settings);
  const StepReport report = test::run(world, 1.0 / 60, 60);
  EXPECT_EQ(report.unsolved, 0u);
  return test::stretch_of(scene, world).max;
}

// A displacement of s metres in a substep is rounded to 6e-8 s; here chains of 100 m move by up to 0.3 m, and
// rods are 0.1 m: some 1e-7 of their length a substep, taken back by the next. Measured 4e-8, 3e-7 and 5e-8.
TEST(DirectFloat, AThousandLinksAKilometreFromTheOrigin) {
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
    EXPECT_LE(stretch_after_a_second(gradient, 1000), 1e-6) << to_string(gradient);
}

// How far away makes no difference beyond double's own 1e-13 m.
TEST(DirectFloat, IsAsGoodFarAwayAsAtTheOrigin) {
  EXPECT_LE(stretch_after_a_second(Gradient::mid, 1000), 2 * stretch_after_a_second(Gradient::mid, 0));
}

// A line whose segments are not all of the same length: none of its substeps is halved, and it moves as in
// double, to the rounding of 480 displacements of up to 5 mm.
TEST(DirectFloat, ElasticLinesAreSolvedInSegments) {
  Scene scene = scenes::make_chain(200, 0.1, 10);
  for (Rod& rod : scene.rods) rod.law.stiffness = 1e5;
  Settings settings = test::direct(Gradient::old, 16);
  World exact(scene, settings);
  settings.precision = Precision::single;
  World world(scene, settings);
  EXPECT_EQ(test::run(world, 1.0 / 60, 30).halvings, 0u);
  test::run(exact, 1.0 / 60, 30);
  EXPECT_LT(rms_distance(test::positions_of(world), test::positions_of(exact)), 1e-4);
}

// Float would round the pull on a rod by 6 % of a link's weight: with an accuracy such a chain swung its
// end up by two metres. It is solved in double, to the last bit, from the start and after an edit.
TEST(DirectFloat, LightLinksOfAHeavyEndAreSolvedInDouble) {
  const auto run = [](double start, double end, Precision precision) {
    Settings settings = test::direct(Gradient::old);
    settings.accuracy = 1e-2;
    settings.precision = precision;
    World world(scenes::make_chain(20, 0.1, start), settings);
    if (end != start) world.set_mass(20, end);
    test::run(world, 1.0 / 60, 120);
    return test::positions_of(world);
  };
  EXPECT_EQ(run(1e6, 1e6, Precision::single), run(1e6, 1e6, Precision::double_));
  EXPECT_EQ(run(10, 1e6, Precision::single), run(1e6, 1e6, Precision::double_));
  EXPECT_NE(run(10, 10, Precision::single), run(10, 10, Precision::double_));
}

// Method automatic then chooses as it does in double, a time order among the rest.
TEST(DirectFloat, AutomaticChoosesForLightLinksAsInDouble) {
  const auto run = [](Precision precision) {
    World world(scenes::make_chain(5, 0.1, 1e5), {.precision = precision, .accuracy = 1e-4, .threads = 1});
    EXPECT_EQ(world.info().direct_time_order, 4u);
    test::run(world, 1.0 / 60, 60);
    return test::positions_of(world);
  };
  EXPECT_EQ(run(Precision::single), run(Precision::double_));
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
