// The vectors and matrices of the loops of trees, for one lane: by hand, and a matrix against its inverse.

#include <gtest/gtest.h>

// What lanes compute with is made of what stands before it.
// clang-format off
#include "simd/tree/one_lane.hpp"
#include "simd/tree/lane_math.hpp"
// clang-format on

#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

TEST(OneLane, ChoosesByItsMask) {
  EXPECT_EQ(select_nonzero(1.0, 2.0, 3.0), 2);
  EXPECT_EQ(select_nonzero(0.0, 2.0, 3.0), 3);
  EXPECT_EQ(larger(2.0f, -3.0f), 2);
  EXPECT_EQ(reciprocal_or_zero(-4.0, 3.9), -0.25);
  EXPECT_EQ(reciprocal_or_zero(-4.0, 4.0), 0) << "not above the floor";
  double sum = 1;
  add_wide(0.5f, &sum);
  EXPECT_EQ(sum, 1.5);
  EXPECT_EQ(narrow<float>(load_wide<float>(&sum)), 1.5f);
}

Vec<double> random_vec(test::Random& random) {
  const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
  return {x, y, z};
}

// inverse() takes rows and gives columns; the diagonal of 3 keeps matrices from being singular.
TEST(LaneMath, InverseTimesMatrixIsOne) {
  test::Random random(71);
  for (int round = 0; round < 50; ++round) {
    Mat<double> rows{random_vec(random), random_vec(random), random_vec(random)};
    rows.v0.x += 3, rows.v1.y += 3, rows.v2.z += 3;
    const Mat<double> columns = inverse(rows);
    const Vec<double> v = random_vec(random);
    // Rows times (columns of the inverse times v): multiply_transposed() takes what it is given as rows.
    const Vec<double> back = multiply_transposed(rows, multiply(columns, v));
    EXPECT_NEAR(back.x, v.x, 1e-14);
    EXPECT_NEAR(back.y, v.y, 1e-14);
    EXPECT_NEAR(back.z, v.z, 1e-14);
    EXPECT_NEAR(dot(cross(rows.v0, rows.v1), rows.v0), 0, 1e-14);
    EXPECT_EQ(trace(rows), (rows.v0.x + rows.v1.y) + rows.v2.z);
  }
}

// Entry i of lane 2 of four is number 4 i + 2.
TEST(LaneMath, EntriesAreLanesApart) {
  double data[16];
  for (int i = 0; i < 16; ++i) data[i] = i;
  const At<double, double, 4> at{2};
  EXPECT_EQ(at.get(data, 3), 14);
  EXPECT_EQ(at.get3(data, 1).z, 14);
  at.put3(data, 0, {-1, -2, -3});
  EXPECT_EQ(data[2], -1);
  EXPECT_EQ(data[6], -2);
  EXPECT_EQ(data[10], -3);
  EXPECT_EQ(data[1], 1) << "its neighbour stays";
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
