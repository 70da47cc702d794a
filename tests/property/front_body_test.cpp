// The body of the loops on fronts, as the scalar oracle has it: each of its steps against its definition.

#include <gtest/gtest.h>

// The body is made of what stands before it.
// clang-format off
#include "simd/double_scalar.hpp"
#include "simd/front/front_lanes.hpp"
// clang-format on

#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

TEST(DoubleScalar, IsOneNumber) {
  const double from[2] = {3, 5};
  double to = 0;
  store(load<double>(from + 1), &to);
  EXPECT_EQ(to, 5);
  EXPECT_EQ(broadcast<double>(7), 7);
}

TEST(FrontBody, SubtractsMultiplesOfRows) {
  double to[8], from[8];
  for (int i = 0; i < 8; ++i) to[i] = 10 * i, from[i] = i;
  subtract_row<double>(to, 4, from, 2, 7);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(to[i], i >= 2 && i < 7 ? 6 * i : 10 * i);
}

TEST(FrontBody, WholeVectorsBeginAtTheColumnOrBefore) {
  for (std::uint32_t column = 0; column < 40; ++column) {
    EXPECT_EQ(whole_vector(column) % logical_width<double>, 0u);
    EXPECT_LE(whole_vector(column), column);
    EXPECT_LT(column - whole_vector(column), logical_width<double>);
  }
}

// [4 2; 2 5] = [1 0; 1/2 1] [4 2; 0 4]; of the right hand side [8, 12] the solution is [1, 2].
TEST(FrontBody, SolvesByHand) {
  layouts::AlignedBuffer<double> block(16), upper(16), lower(16), inverse(8), x(8);
  block[0] = 4, block[1] = 2, block[8] = 2, block[9] = 5;
  x[0] = 8, x[1] = 12;
  const FrontView front{2, 2, 8, upper.data(), lower.data(), inverse.data()};
  const double smallest[] = {0, 0};
  EXPECT_EQ(eliminate<double>(front, block.data(), smallest), 0u);
  EXPECT_EQ(lower[1], 0.5);
  EXPECT_EQ(upper[9], 4);
  EXPECT_EQ(inverse[1], 0.25);
  forward<double>(front, x.data());
  EXPECT_EQ(x[1], 8);
  backward<double>(front, x.data());
  EXPECT_EQ(x[0], 1);
  EXPECT_EQ(x[1], 2);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
