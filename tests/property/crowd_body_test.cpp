// The vector body of loops over rows of a crowd, compiled for what every machine has, does what its scalar
// body does, on numbers that a reader can check.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "simd/relax/crowd_lanes.hpp"
#include "simd/relax/crowd_loops.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

// Of two rows, in which the k-th particle is at k on all axes and goes by k along y, the box holds 2 to 5,
// and those are fast that go by more than 3.
template <class T>
void expect_fast_and_far() {
  constexpr std::uint32_t width = logical_width<T>, n = 6 * width;
  layouts::AlignedBuffer<T> x(n), p(n);
  std::vector<double> mass(n, 2);
  double sum = 0;
  for (std::uint32_t row = 0; row < 2; ++row)
    for (std::uint32_t k = 0; k < width; ++k) {
      for (std::uint32_t c = 0; c < 3; ++c) x[(3 * row + c) * width + k] = static_cast<T>(k);
      p[(3 * row + 1) * width + k] = static_cast<T>(k);
      sum += 2.0 * k * k;
    }
  const FastRules<T> rules{{T(2), T(2), T(2)}, {T(5), T(5), T(5)}, T(9)};
  for (const CrowdKernels<T>& kernels : {row_crowd_kernels<T>, crowd_kernels<width, T>}) {
    std::vector<std::uint32_t> found(n);
    found.resize(kernels.list_fast(x.data(), p.data(), rules, n, found.data()));
    EXPECT_EQ(found, (std::vector<std::uint32_t>{4, 5, 3 * width + 4, 3 * width + 5}));
    EXPECT_EQ(kernels.farthest(p.data(), n), T(width - 1) * T(width - 1));
    EXPECT_EQ(kernels.weigh_squares(mass.data(), p.data(), n), sum);
  }
}

TEST(CrowdBody, ListsWhatIsFastAndFindsTheFarthest) {
  expect_fast_and_far<float>();
  expect_fast_and_far<double>();
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
