// Files of forces and tensions, and how tensions are compared.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumb/joints.hpp"
#include "scenes/files/forces.hpp"
#include "scenes/files/trajectory.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(ForcesFile, HasARowForAllThatIsHeld) {
  Scene scene;
  scene.particles = {test::movable({}, 1), test::fixed({})};
  const Forces forces{.reactions = {{}, {1, 2, 3}},
                      .pins = {{unknown, unknown, unknown}},
                      .springs = {{0, -0.5, 0}},
                      .contacts = {{0, 9, 0}},
                      .angles = {4},
                      .torsions = {unknown}};
  std::string csv(forces_header);
  append_forces(csv, 0.5, scene, forces);
  EXPECT_EQ(csv,
            "t,kind,number,x,y,z\n0.5,anchor,1,1,2,3\n0.5,pin,0,,,\n0.5,spring,0,0,-0.5,0\n"
            "0.5,capsule,0,0,9,0\n0.5,angle,0,4,,\n0.5,torsion,0,,,\n");
}

TEST(ForcesFile, HasWhatTheWorldKnows) {
  Scene scene;
  scene.particles = {test::fixed({}), test::movable({0, -1, 0}, 2)};
  scene.springs = {{.a = point_at(0), .b = point_at(1), .length = 0.5, .stiffness = 10}};
  World world(scene, {.tensions = true});
  world.step(0.01);
  Forces forces = make_forces(scene);
  EXPECT_FALSE(forces.is_empty());
  copy_forces(world, forces);
  EXPECT_EQ(forces.springs[0], world.spring_force(0));
  EXPECT_EQ(forces.reactions[0], world.reaction(0));
}

// A rod that breaks leaves a sphere at each end, and the world one shape more than the scene.
TEST(ForcesFile, KnowsTheShapesOfTheScene) {
  Scene scene;
  scene.planes.push_back({});
  scene.particles = {test::movable({0, 1, 0}, 1), test::movable({1, 1, 0}, 1)};
  scene.particles[1].velocity = {0, 2, 0};
  scene.rods = {{.a = 0, .b = 1, .law = {.strength = 0.1}}};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  World world(scene, {.tensions = true});
  for (int i = 0; i < 240; ++i) world.step(1.0 / 120);
  EXPECT_EQ(world.shape_count(), 2u);
  Forces forces = make_forces(scene);
  copy_forces(world, forces);
  ASSERT_EQ(forces.contacts.size(), 1u);
  EXPECT_NEAR(forces.contacts[0].y, 9.81, 1e-6);
}

TEST(TensionsFile, IsReadIntoFrames) {
  std::vector<Frame> frames{{.t = 0.5, .positions = {}, .velocities = {}},
                            {.t = 1, .positions = {}, .velocities = {}}};
  parse_tensions("t,rod,tension\n0.5,0,2\n0.5,1,\n1,0,-3\n", "file", frames);
  ASSERT_EQ(frames[0].tensions.size(), 2u);
  EXPECT_EQ(frames[0].tensions[0], 2);
  EXPECT_TRUE(std::isnan(frames[0].tensions[1]));
  EXPECT_EQ(frames[1].tensions, std::vector<double>{-3});
  const auto refusal = [&](const char* text) {
    std::vector<Frame> none{{.t = 0.5, .positions = {}, .velocities = {}}};
    return test::refusal([&] { parse_tensions(text, "file", none); });
  };
  EXPECT_EQ(refusal("t,rod\n"), "file:1: the first line must be t,rod,tension");
  EXPECT_EQ(refusal("t,rod,tension\n0.7,0,1\n"), "file:2: no positions are known at this time");
  EXPECT_EQ(refusal("t,rod,tension\n0.5,1,1\n"), "file:2: expected rod 0, found 1");
  EXPECT_EQ(refusal("t,rod,tension\n0.5,0,x\n"), "file:2: 'x' is not a finite number");
  EXPECT_EQ(refusal("t,rod,tension\n0.5,0\n"), "file:2: expected 3 values, found 2");
}

TEST(TensionError, IsTheRmsDifferenceAndItsShareOfTheTruth) {
  const Frame truth{.t = 2, .positions = {}, .velocities = {}, .tensions = {3, 4, unknown}};
  Frame frame = truth;
  frame.tensions = {3.5, 4, 1};
  const TensionError error = tension_error(frame, truth);
  EXPECT_EQ(error.t, 2);
  EXPECT_NEAR(error.rms_n, 0.5 / std::sqrt(2), 1e-15);
  EXPECT_NEAR(error.relative, 0.1, 1e-15);
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
