// The vector bodies of fronts against the scalar one, and that against the definition.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "scenes/basics/seeded.hpp"
#include "simd/front/front_kernels.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

/// A front's arrays.
struct Front {
  Front(std::uint32_t count, std::uint32_t eliminated)
      : rows(count),
        pivots(eliminated),
        stride(layouts::round_up(count, logical_width<double>)),
        block(std::size_t{rows} * stride),
        upper(std::size_t{pivots} * stride),
        lower(std::size_t{pivots} * stride),
        inverse(pivots),
        x(stride) {}

  FrontView view() { return {rows, pivots, stride, upper.data(), lower.data(), inverse.data()}; }

  std::uint32_t rows, pivots, stride;
  layouts::AlignedBuffer<double> block, upper, lower, inverse, x;
};

Front random_front(std::uint32_t rows, std::uint32_t pivots, unsigned seed) {
  std::mt19937_64 random(seed);
  Front front(rows, pivots);
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j < rows; ++j)
      front.block[std::size_t{i} * front.stride + j] =
          2 * scenes::unit_double(random) - 1 + (i == j ? rows : 0);
    front.x[i] = 2 * scenes::unit_double(random) - 1;
  }
  return front;
}

struct Size {
  std::uint32_t rows, pivots;
};
// Around the widths of a vector and of a panel, with and without a rest.
const Size sizes[] = {{1, 1},   {2, 1},   {5, 3},   {8, 8},   {9, 2},  {16, 5},
                      {17, 17}, {31, 12}, {40, 33}, {71, 64}, {70, 66}};

TEST(Fronts, AreFactorsOfTheirBlock) {
  for (const Size size : sizes) {
    Front front = random_front(size.rows, size.pivots, 7 * size.rows);
    const Front before = random_front(size.rows, size.pivots, 7 * size.rows);
    const std::vector<double> smallest(size.pivots, 0);
    EXPECT_EQ(front_scalar.eliminate(front.view(), front.block.data(), smallest.data()), 0u);
    for (std::uint32_t i = 0; i < size.rows; ++i)
      for (std::uint32_t j = 0; j < size.rows; ++j) {
        double sum =
            i >= size.pivots && j >= size.pivots ? front.block[std::size_t{i} * front.stride + j] : 0;
        for (std::uint32_t k = 0; k < size.pivots; ++k) {
          const double l = i < k ? 0 : i == k ? 1 : front.lower[std::size_t{k} * front.stride + i];
          if (k <= j) sum += l * front.upper[std::size_t{k} * front.stride + j];
        }
        // Rounding: the diagonal is as large as the front has rows, and so many products are added.
        EXPECT_NEAR(sum, before.block[std::size_t{i} * front.stride + j], 1e-14 * size.rows)
            << size.rows << " rows, " << size.pivots << " pivots, at " << i << ", " << j;
      }
  }
}

TEST(Fronts, AreTheSameBitsWithEveryInstructionSet) {
  for (const Isa isa : all_isas()) {
    if (!is_supported(isa)) continue;
    for (const Size size : sizes) {
      Front scalar = random_front(size.rows, size.pivots, size.rows);
      Front vector = random_front(size.rows, size.pivots, size.rows);
      std::vector<double> smallest(size.pivots, 0);
      smallest[size.pivots / 2] = 1e9;  // one is left out
      for (auto [front, kernels] :
           {std::pair{&scalar, &front_scalar}, std::pair{&vector, &front_kernels(isa)}}) {
        EXPECT_EQ(kernels->eliminate(front->view(), front->block.data(), smallest.data()), 1u);
        kernels->forward(front->view(), front->x.data());
        kernels->backward(front->view(), front->x.data());
      }
      EXPECT_EQ(vector.inverse[size.pivots / 2], 0);
      for (std::uint32_t i = 0; i < size.rows; ++i) {
        ASSERT_EQ(scalar.x[i], vector.x[i]) << to_string(isa) << ", " << size.rows << " rows";
        for (std::uint32_t j = size.pivots; i >= size.pivots && j < size.rows; ++j)
          ASSERT_EQ(scalar.block[std::size_t{i} * scalar.stride + j],
                    vector.block[std::size_t{i} * vector.stride + j])
              << to_string(isa) << ", " << size.rows << " rows";
      }
    }
  }
}

// With every row a pivot.
TEST(Fronts, SolveForTheirPivots) {
  for (const Size size : sizes) {
    Front front = random_front(size.rows, size.rows, 3 * size.rows);
    const Front before = random_front(size.rows, size.rows, 3 * size.rows);
    const std::vector<double> smallest(size.rows, 0);
    front_scalar.eliminate(front.view(), front.block.data(), smallest.data());
    front_scalar.forward(front.view(), front.x.data());
    front_scalar.backward(front.view(), front.x.data());
    for (std::uint32_t i = 0; i < size.rows; ++i) {
      double sum = 0;
      for (std::uint32_t j = 0; j < size.rows; ++j)
        sum += before.block[std::size_t{i} * front.stride + j] * front.x[j];
      EXPECT_NEAR(sum, before.x[i], 1e-14 * size.rows) << size.rows << " rows";
    }
  }
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
