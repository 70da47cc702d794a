// What a truth refuses, and what it says then.
#include "truth/truth.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "plumb/error.hpp"
#include "scenes/generators/generators.hpp"
#include "support/truths.hpp"

namespace plumb::truth::PLUMB_TEST_FILE {
namespace {

template <class Error>
std::string message_of(const Scene& scene, const Plan& plan) {
  try {
    solve(scene, plan);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

void expect_says(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Truth, SavesTheStartAndWhatIsAskedFor) {
  const Scene scene = scenes::make_chain(3);
  const Truth truth = solve(scene, {.save_at = {0, 0.05, 0.1}});
  ASSERT_EQ(truth.frames.size(), 3u);
  EXPECT_EQ(truth.frames[1].t, 0.05);
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    const Vec3 moved = truth.frames[0].positions[i] - scene.particles[i].position;
    EXPECT_LT(norm(moved), 1e-16) << "particle " << i;  // 0.1 and 0.2 - 0.1 are not the same double
    EXPECT_EQ(truth.frames[0].velocities[i], (Vec3{}));
  }
  EXPECT_EQ(truth.accuracy.size(), 3u);
  EXPECT_LT(truth.reached.worst(), 1e-16);
  EXPECT_DOUBLE_EQ(truth.diagonal, bounding_diagonal(scene));
}

TEST(Truth, RefusesPlansThatMakeNoSense) {
  const Scene scene = scenes::make_chain(2);
  expect_says(message_of<InputError>(scene, {.save_at = {}}), "no times");
  expect_says(message_of<InputError>(scene, {.save_at = {-1}}), "negative");
  expect_says(message_of<InputError>(scene, {.save_at = {1, 0.5}}), "rise");
  expect_says(message_of<InputError>(scene, {.save_at = {std::numeric_limits<double>::infinity()}}),
              "finite");
  for (const double tolerance : {0.0, 1e-16, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_says(message_of<InputError>(scene, {.save_at = {1}, .tolerance = tolerance}), "tolerance");
  }
}

TEST(Truth, RefusesRodsOffTheirLengthAndNamesTheWorst) {
  Scene scene = scenes::make_chain(3);
  scene.rods[0].length = 0.1 * (1 + 1e-9);
  scene.rods[1].length = 0.1 * (1 + 1e-6);
  expect_says(message_of<InputError>(scene, {.save_at = {1}}), "rod 1 starts off its length, by 1e-06");
}

// A series in time needs pulls that are smooth; a message names the rod and says what is not.
TEST(Truth, RefusesLawsThatAreNotSmooth) {
  Scene scene = scenes::make_chain(3);
  scene.rods[1].law = {.stiffness = 1e3, .one_sided = true};
  expect_says(message_of<InputError>(scene, {.save_at = {1}}), "rod 1 is one-sided");
  scene.rods[1].law = {.one_sided = true};
  expect_says(message_of<InputError>(scene, {.save_at = {1}}), "rod 1 is one-sided");
  scene.rods[1].law = {};
  scene.rods[2].law = {.strength = 50};
  expect_says(message_of<InputError>(scene, {.save_at = {1}}), "rod 2 has a finite strength");
}

TEST(Truth, TakesElasticRodsOffTheirLengthButNotOfNone) {
  Scene scene = scenes::make_chain(3);
  scene.rods[1].length = 0.15;
  scene.rods[1].law = {.stiffness = 1e3, .damping = 1};
  EXPECT_EQ(message_of<InputError>(scene, {.save_at = {0.1}}), "no error");
  scene.particles[2].position = scene.particles[1].position;
  scene.rods[2].length = 0.2;
  expect_says(message_of<InputError>(scene, {.save_at = {0.1}}), "rod 1 is elastic and its ends start");
}

// Velocities are relative to what a stretched rod's energy, k x²/2, can make of all mass: x sqrt(k/m).
TEST(Truth, KnowsTheSpeedOfElasticRods) {
  Scene scene;
  scene.particles = {test::anchor({0, 0, 0}), test::loose({0.7, 0, 0}, 4)};
  scene.rods = {{.a = 0, .b = 1, .length = 0.5, .law = {.stiffness = 1e6}}};
  EXPECT_DOUBLE_EQ(solve(scene, {.save_at = {0}}).speed, 0.2 * 500);
}

TEST(Truth, RefusesBadScenes) {
  Scene scene = scenes::make_chain(3);
  scene.particles[2].mass = -1;
  expect_says(message_of<InputError>(scene, {.save_at = {1}}), "particle 2");
}

TEST(Truth, SaysUntilWhenAChaoticMotionIsKnown) {
  const std::string message = message_of<Unreachable>(scenes::make_thesis5(), {.save_at = {1, 10}});
  expect_says(message, "no solution to 1e-09");
  // Five links double a rounding error about every tenth of a second.
  const std::size_t at = message.find("beyond t = ");
  ASSERT_NE(at, std::string::npos) << message;
  const double until = std::stod(message.substr(at + 11));
  EXPECT_GT(until, 2) << message;
  EXPECT_LT(until, 8) << message;
}

// A row of rods drawn straight between two anchors cannot give way to first order: no finite pull holds it.
TEST(Truth, RefusesRodsDrawnStraight) {
  const std::string message = message_of<Unreachable>(scenes::make_net(4, 3), {.save_at = {0.1}});
  expect_says(message, "cannot be kept at its length");
}

TEST(Truth, ProjectsVelocitiesThatPull) {
  Scene scene;
  scene.particles = {test::loose({0, 0, 0}, 1), test::loose({1, 0, 0}, 3)};
  scene.particles[1].velocity = {4, 0, 2};
  scene.rods = {{.a = 0, .b = 1}};
  const Truth truth = solve(scene, {.save_at = {0}});
  // Along the rod both take the velocity of the centre of mass, 3 m/s: the lighter one changes by all of it.
  EXPECT_DOUBLE_EQ(truth.velocity_change, 3);
  EXPECT_EQ(truth.frames[0].velocities[0], (Vec3{3, 0, 0}));
  EXPECT_EQ(truth.frames[0].velocities[1], (Vec3{3, 0, 2}));
}

TEST(Truth, OfNothingIsNothing) {
  EXPECT_TRUE(solve({}, {.save_at = {1}}).frames.front().positions.empty());
}

// What is more than particles and rods is not left out without a word.
TEST(Truth, RefusesWhatItDoesNotKnow) {
  Scene scene = scenes::make_rods5();
  scene.rods[2].orthogonal_drag = 0.1;
  EXPECT_THROW(make_model(scene, MassModel::consistent), InputError);
  scene = scenes::make_rods5();
  scene.planes.push_back({.offset = -3});
  EXPECT_THROW(make_model(scene, MassModel::consistent), InputError);
}

}  // namespace
}  // namespace plumb::truth::PLUMB_TEST_FILE
