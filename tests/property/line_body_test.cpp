// Where lines touch each other: every instruction set has the bits of the scalar body.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <algorithm>
#include <cstring>
#include <vector>

#include "simd/relax/contacts/line_kernels.hpp"
#include "simd/relax/contacts/line_lanes.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/near_lines.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using namespace test::near_lines;

TEST(LineBody, EveryInstructionSetFindsTheSameBits) {
  const std::vector<LineTouch> wanted = found(kernels<double>(Isa::scalar).lines);
  const auto is_fast = [](const LineTouch& each) { return each.which == LineTouch::fast; };
  EXPECT_GT(std::count_if(wanted.begin(), wanted.end(), is_fast), 10);
  EXPECT_GT(wanted.size(), 200u);
  const auto expect_same = [&](const LineKernels& kernels) {
    const std::vector<LineTouch> got = found(kernels);
    ASSERT_EQ(got.size(), wanted.size());
    EXPECT_EQ(std::memcmp(got.data(), wanted.data(), wanted.size() * sizeof(LineTouch)), 0);
  };
  expect_same(line_kernels);
  for (const Isa isa : all_isas())
    if (is_supported(isa)) expect_same(kernels<double>(isa).lines);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
