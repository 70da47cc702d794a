// How bad input is refused: one message, made of parts, that says what and why.

#include "scene/refuse.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "plumb/error.hpp"
#include "scene/require_points.hpp"
#include "scene/validate_bodies.hpp"
#include "support/bodies.hpp"
#include "support/refusals.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::refusal;

TEST(Refuse, WritesItsPartsOneAfterTheOther) {
  EXPECT_EQ(refusal([] { refuse("rod ", 7u, ':', ' ', std::string("length "), 0.25, " m"); }),
            "rod 7: length 0.25 m");
  EXPECT_EQ(MessagePart(std::uint64_t{1} << 40).text(), "1099511627776");
  EXPECT_EQ(MessagePart(1e-300).text(), "1e-300");
}

// Gravity of 9.81 m/s² is not the world's if that is the next number.
TEST(Refuse, WritesNumbersThatDifferDifferently) {
  EXPECT_EQ(MessagePart(9.81).text(), "9.81");
  EXPECT_EQ(MessagePart(std::nextafter(9.81, 10)).text(), "9.810000000000002");
  EXPECT_EQ(MessagePart(Vec3{0, -9.8100001, 1e7}).text(), "(0, -9.8100001, 1e+07)");
}

TEST(RequirePoints, NamesTheFirstThatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([] { require_points({}); }), "a bounding volume needs a point at least");
  EXPECT_EQ(refusal([] { require_points(std::array{Vec3{1, 2, 3}}); }), "");
  EXPECT_EQ(refusal([&] {
              require_points(std::array{Vec3{1, 2, 3}, Vec3{0, nan, 0}, Vec3{nan, 0, 0}});
            }),
            "point 1: position is not finite");
}

TEST(ValidateBodies, AskForFourPlacesWithAVolume) {
  Scene scene;
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 1, 0}})
    scene.particles.push_back(test::movable(at));
  EXPECT_EQ(positions_of(scene, {4, 0, 1, 2})[0], (Vec3{1, 1, 0}));
  EXPECT_EQ(refusal([&] { require_particles(scene, 3, {0, 1, 2, 3}); }), "");
  EXPECT_EQ(refusal([&] {
              require_particles(scene, 3, {0, 1, 2, 5});
            }),
            "body 3: particle 5 does not exist (the scene has 5 particles)");
  EXPECT_EQ(refusal([&] { require_particles(scene, 3, {0, 1, 2, 1}); }), "body 3: particle 1 is there twice");
  EXPECT_EQ(refusal([&] { require_volume(3, positions_of(scene, {0, 1, 2, 3})); }), "");
  EXPECT_EQ(refusal([&] {
              require_volume(3, positions_of(scene, {0, 1, 2, 4}));
            }),
            "body 3: its particles lie in one plane");
}

// A solid's inertia passes, and that of a disc without thickness. That of a line spins without inertia, and
// nothing has a moment above the sum of the others.
TEST(ValidateBodies, AskForTheInertiaOfASolid) {
  EXPECT_EQ(refusal([] { require_solid(0, solid_box(2, {0.1, 0.2, 0.3})); }), "");
  MassProperties disc = solid_box(2, {0.1, 0.2, 0.3});
  disc.inertia = {.xx = 1, .yy = 1, .zz = 2};
  EXPECT_EQ(refusal([&] { require_solid(0, disc); }), "");
  disc.inertia = {.xx = 1, .yy = 1, .zz = 0};
  EXPECT_NE(refusal([&] { require_solid(0, disc); }).find("that of a line"), std::string::npos);
  disc.inertia = {.xx = 1, .yy = 1, .zz = 2.1};
  EXPECT_NE(refusal([&] { require_solid(0, disc); }).find("not that of a solid"), std::string::npos);
}

// A sphere has both of its ends at one place, which sphere_at() does not leave out.
TEST(ValidateBodies, SayHowASphereIsMade) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0})};
  scene.capsules = {{.a = point_at(0), .radius = 1}};
  EXPECT_EQ(refusal([&] { validate_shapes(scene); }),
            "capsule 0, point b: has no weights; those of a sphere are those of point a, as sphere_at() has "
            "them");
  scene.capsules = {sphere_at(point_at(0), 1)};
  EXPECT_EQ(refusal([&] { validate_shapes(scene); }), "");
  EXPECT_EQ(scene.capsules[0].radius, 1);
}

TEST(Refuse, NamesTheSettingThatNothingReads) {
  try {
    refuse_unread("omega", "all is ", 1u, " tree");
    FAIL();
  } catch (const UnreadSetting& error) {
    EXPECT_EQ(error.setting(), "omega");
    EXPECT_STREQ(error.what(), "nothing reads omega: all is 1 tree");
  }
}

// Joints and shapes have their own checks, and an empty scene passes all of them.
TEST(ValidateBodies, LookAtTheirOwnLists) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}), test::movable({1, 0, 0})};
  scene.pins = {{point_at(0), point_at(0)}};
  scene.planes = {{.normal = {0, 2, 0}}};
  EXPECT_EQ(refusal([&] { validate_bodies(scene); }), "");
  EXPECT_EQ(refusal([&] { validate_joints(scene); }), "pin 0: both points are the same");
  EXPECT_EQ(refusal([&] { validate_shapes(scene); }), "plane 0: normal must be of length 1, not 2");
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
