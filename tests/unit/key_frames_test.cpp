// Poses by time, and drives that seek them.

#include "plumb/key_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "contact/elastics/elastic.hpp"
#include "contact/linkage/combination.hpp"
#include "plumb/joints.hpp"
#include "scene/springs/springs.hpp"
#include "scene/springs/turn.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

const KeyFrames frames({{0, {1, 0}}, {1, {2, 1}}, {3, {0, 3}}});

std::vector<double> pose_at(const KeyFrames& of, double time) {
  std::vector<double> out(of.pose_size());
  of.pose_at(time, out);
  return out;
}

TEST(KeyFrames, GoThroughTheirPoses) {
  EXPECT_EQ(pose_at(frames, -1), (std::vector<double>{1, 0}));
  EXPECT_EQ(pose_at(frames, 0), (std::vector<double>{1, 0}));
  EXPECT_EQ(pose_at(frames, 1), (std::vector<double>{2, 1}));
  EXPECT_EQ(pose_at(frames, 3), (std::vector<double>{0, 3}));
  EXPECT_EQ(pose_at(frames, 9), (std::vector<double>{0, 3}));
  EXPECT_EQ(frames.first_time(), 0);
  EXPECT_EQ(frames.last_time(), 3);
}

// Differences over 1e-6 s on either side tell rates to 1e-5. At a pose both are that between its neighbours.
TEST(KeyFrames, DoNotJumpInRate) {
  const double by = 1e-6;
  for (const double time : {0.0, 1.0, 3.0}) {
    const double before = (pose_at(frames, time)[1] - pose_at(frames, time - by)[1]) / by;
    const double after = (pose_at(frames, time + by)[1] - pose_at(frames, time)[1]) / by;
    EXPECT_NEAR(before, after, 1e-5);
    EXPECT_NEAR(after, time == 1 ? 1 : 0, 1e-5);
  }
}

TEST(KeyFrames, Blend) {
  const std::vector<double> first{1, 2}, second{3, -2};
  std::vector<double> out(2);
  blend_poses(first, second, 0.5, out);
  EXPECT_EQ(out, (std::vector<double>{2, 0}));
  blend_poses(first, second, -1, out);
  EXPECT_EQ(out, first);
  blend_poses(first, second, 0.25, out);
  EXPECT_DOUBLE_EQ(out[0], 1 + 2 * (3.0 / 16 - 2.0 / 64));
  blend_poses(first, second, 7, out);
  EXPECT_EQ(out, second);
}

TEST(KeyFrames, RefuseWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> one(1), two(2);
  EXPECT_NE(test::refusal([] { const KeyFrames none({}); }), "");
  EXPECT_NE(test::refusal([] { const KeyFrames back({{1, {0}}, {1, {0}}}); }), "");
  EXPECT_NE(test::refusal([] { const KeyFrames uneven({{1, {0}}, {2, {0, 1}}}); }), "");
  EXPECT_NE(test::refusal([&] { const KeyFrames bad({KeyFrame{1, {nan}}}); }), "");
  EXPECT_NE(test::refusal([&] { const KeyFrames bad({KeyFrame{nan, {0}}}); }), "");
  EXPECT_NE(test::refusal([&] { frames.pose_at(0, one); }), "");
  EXPECT_NE(test::refusal([&] { frames.pose_at(nan, two); }), "");
  EXPECT_NE(test::refusal([&] { blend_poses(one, two, 0, two); }), "");
  EXPECT_NE(test::refusal([&] { blend_poses(two, two, nan, two); }), "");
}

// A rod of 1 kg follows a pose that swings by 1 rad in 2 s. A drive of natural frequency 45/s that is damped
// critically lags by 2/45 s at most, 0.04 rad at the fastest.
TEST(KeyFrames, AreSoughtByDrives) {
  const double inertia = 1.0 / 3, omega = 45;
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::fixed({0, 1, 0}), test::movable({1, 0, 0}, 0)};
  scene.rods = {{.a = 0, .b = 2, .mass = 1}};
  AngleControl drive{.u = {point_at(0), point_at(1)},
                     .v = {point_at(0), point_at(2)},
                     .stiffness = inertia * omega * omega,
                     .damping = 2 * inertia * omega};
  scene.angles = {drive};
  scene.gravity = {};
  World world(scene, {.method = Method::direct, .substeps = 4});
  const KeyFrames swing({{0, {drive.target}}, {1, {drive.target + 0.5}}, {2, {drive.target + 1}}});
  double worst = 0;
  for (int i = 0; i < 180; ++i) {
    swing.pose_at(world.time(), {&drive.target, 1});
    world.set_angle(0, drive);
    world.step(1.0 / 60);
    const Vec3 tip = world.position(2);
    worst = std::max(worst, std::abs(std::atan2(tip.x, tip.y) - pose_at(swing, world.time())[0]));
  }
  EXPECT_LE(worst, 0.05);
  EXPECT_NEAR(std::atan2(world.position(2).x, world.position(2).y), swing.last_time() / 2 + 1.5708, 1e-4);
}

// The row of an elastic: a resolved one takes the mean of both ends, and a stiff one its end alone.
TEST(ElasticStep, TakesTheMeanOfWhatItResolves) {
  detail::ElasticStep step{.start = 1.5};
  step.begin({.rest = 1, .stiffness = 8}, 1, 0.1, false);  // swings by 0.28 rad
  EXPECT_EQ(step.resolved, 1);
  EXPECT_DOUBLE_EQ(step.soft, 4 / (8 * 0.1 * 0.1));
  EXPECT_DOUBLE_EQ(step.before, 0.5);
  step.acts = true;
  EXPECT_LT(step.soft_at_end(), 0) << "nothing holds velocities";
  step.begin({.rest = 1, .stiffness = 8e8}, 1, 0.1, false);
  EXPECT_NEAR(step.soft, 2 / (8e8 * 0.1 * 0.1), 1e-12);
  EXPECT_NEAR(step.before, 0, 1e-6);
  EXPECT_NEAR(step.soft_at_end(), 0, 1e-6) << "velocities are held as by a rod";
}

// With gradient new it takes its end alone, as backward Euler does, and its whole impulse acts there.
TEST(ElasticStep, TakesTheEndAloneWithGradientNew) {
  detail::ElasticStep step{.start = 1.5};
  step.begin({.rest = 1, .stiffness = 8, .damping = 0.4}, 1, 0.1, true);
  EXPECT_DOUBLE_EQ(step.kick, 0.1 * 0.1);
  EXPECT_DOUBLE_EQ(step.soft, 1 / ((8 + 0.4 / 0.1) * 0.1 * 0.1));
  EXPECT_DOUBLE_EQ(step.before, -0.5 * (0.4 / 0.1) / (8 + 0.4 / 0.1));
  step.acts = true;
  EXPECT_LT(step.soft_at_end(), 0) << "nothing holds velocities";
}

TEST(Turn, KnowsAllFourQuadrants) {
  for (double angle = -3.1; angle < 3.14; angle += 0.01)
    EXPECT_NEAR(detail::angle_of(2 * std::cos(angle), 2 * std::sin(angle)), angle, 1e-15);
  EXPECT_EQ(detail::angle_of(0, 0), 0);
  const detail::Across across({0, 0, 5}, {1, 0, 3}, {0, 2, -1});
  EXPECT_NEAR(across.turn(), std::acos(0.0), 1e-15);
  EXPECT_EQ(across.u_along, 3);
}

// Half of k (l - length)² of what is not slack.
TEST(SpringEnergy, IsThatOfWhatIsTaut) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({3, 0, 0})};
  scene.springs = {{.a = point_at(0), .b = point_at(1), .length = 1, .stiffness = 2},
                   {.a = point_at(0), .b = point_at(1), .length = 5, .stiffness = 2, .one_sided = true}};
  const std::vector<Vec3> at{{0, 0, 0}, {3, 0, 0}};
  EXPECT_DOUBLE_EQ(detail::spring_energy(scene, at), 4);
  EXPECT_EQ(detail::difference(point_at(1), point_at(0)).of(at).x, 3);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
