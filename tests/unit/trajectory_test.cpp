#include "scenes/files/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumb/error.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

std::string message_of(const std::string& rows) {
  try {
    parse_trajectory("t,particle,x,y,z,vx,vy,vz\n" + rows, "t.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<Frame> two_frames() {
  return {
      {.t = 0.1, .positions = {{0, 0, 0}, {1.0 / 3, -2e-17, 5}}, .velocities = {{0, 0, 0}, {-1, 1e300, 0.1}}},
      {.t = 1, .positions = {{0, 0, 0}, {3, 4, 0}}, .velocities = {{0, 0, 0}, {6, 7, 8}}}};
}

TEST(Trajectory, RoundTripKeepsEveryBit) {
  const std::vector<Frame> frames = two_frames();
  const std::vector<Frame> back = parse_trajectory(format_trajectory(frames), "t.csv");
  ASSERT_EQ(back.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(back[i].t, frames[i].t);
    EXPECT_EQ(back[i].positions, frames[i].positions);
    EXPECT_EQ(back[i].velocities, frames[i].velocities);
  }
}

TEST(Trajectory, RowsHaveSeventeenDigitsInTheScenesOrder) {
  EXPECT_EQ(format_trajectory(two_frames()),
            "t,particle,x,y,z,vx,vy,vz\n"
            "0.10000000000000001,0,0,0,0,0,0,0\n"
            "0.10000000000000001,1,0.33333333333333331,-2.0000000000000001e-17,5,-1,1.0000000000000001e+300,"
            "0.10000000000000001\n"
            "1,0,0,0,0,0,0,0\n"
            "1,1,3,4,0,6,7,8\n");
}

TEST(Trajectory, WindowsLineEndsAndAMissingLastOneAreRead) {
  const auto frames =
      parse_trajectory("t,particle,x,y,z,vx,vy,vz\r\n0,0,1,2,3,4,5,6\r\n1,0,1,2,3,4,5,7", "t.csv");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].velocities[0], (Vec3{4, 5, 7}));
}

TEST(Trajectory, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_THROW(parse_trajectory("", "t.csv"), InputError);
  try {
    parse_trajectory("time,x\n", "t.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "t.csv:1: the first line must be t,particle,x,y,z,vx,vy,vz");
  }
  EXPECT_EQ(message_of(""), "t.csv:1: no rows follow the header");
  EXPECT_EQ(message_of("0,0,1,2,3,4,5\n"), "t.csv:2: expected 8 values, found 7");
  EXPECT_EQ(message_of("0,0,1,2,3,4,5,6,\n"), "t.csv:2: expected 8 values, found 9");
  EXPECT_EQ(message_of("\n"), "t.csv:2: expected 8 values, found 1");
  EXPECT_EQ(message_of("0,0,1,2,3,4,5,6\n1,0,1,x,3,4,5,6\n"), "t.csv:3: 'x' is not a finite number");
  EXPECT_EQ(message_of("0,0,1,nan,3,4,5,6\n"), "t.csv:2: 'nan' is not a finite number");
  EXPECT_EQ(message_of("0,a,1,2,3,4,5,6\n"), "t.csv:2: 'a' is not the number of a particle");
  EXPECT_EQ(message_of("0,1,1,2,3,4,5,6\n"), "t.csv:2: expected particle 0, found 1");
  EXPECT_EQ(message_of("0,0,1,2,3,4,5,6\n0,0,1,2,3,4,5,6\n"), "t.csv:3: expected particle 1, found 0");
  EXPECT_EQ(message_of("1,0,1,2,3,4,5,6\n0,0,1,2,3,4,5,6\n"), "t.csv:3: times must rise");
  EXPECT_EQ(message_of("0,0,1,2,3,4,5,6\n0,1,1,2,3,4,5,6\n1,0,1,2,3,4,5,6\n"),
            "t.csv:4: time 1 has 1 particles, the first time has 2");
}

TEST(Trajectory, PositionErrorIsRmsDistanceAndItsShareOfTheDiagonal) {
  Frame truth = two_frames()[1];
  Frame frame = truth;
  frame.positions[1] += Vec3{0.3, 0, 0.4};  // 0.5 m off; the other particle is right
  const PositionError error = position_error(frame, truth, 5);
  EXPECT_EQ(error.t, 1);
  EXPECT_NEAR(error.rms_m, 0.5 / std::sqrt(2), 1e-15);
  EXPECT_NEAR(error.relative, 0.1 / std::sqrt(2), 1e-15);
}

// What is not known, as before the first step, is left empty.
TEST(Tensions, AreWrittenByRod) {
  std::string csv(tensions_header);
  append_tensions(csv, {.t = 0.5,
                        .positions = {},
                        .velocities = {},
                        .tensions = {2, std::numeric_limits<double>::quiet_NaN(), -0.25}});
  EXPECT_EQ(csv, "t,rod,tension\n0.5,0,2\n0.5,1,\n0.5,2,-0.25\n");
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
