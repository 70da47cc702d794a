// Vectors of 128 bits that NEON and WebAssembly run: lane by lane the numbers of plain C++, with the zeros
// and the numbers that are none of max and min on x86.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include "simd/vector128.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "simd/batch.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

template <class T>
std::vector<T> odd_numbers() {
  std::vector<T> out = {
      T(0), T(-0.0), T(1), T(-1), std::numeric_limits<T>::infinity(), std::numeric_limits<T>::quiet_NaN()};
  std::minstd_rand random(7);
  for (int i = 0; i < 40; ++i) out.push_back(T(random() % 20001) / T(997) - T(10));
  return out;
}

template <class T>
T lane_of(const BatchOf<T>& batch) {
  alignas(16) T values[BatchOf<T>::size];
  batch.store_aligned(values);
  for (const T value : values) EXPECT_TRUE(value == values[0] || std::isnan(value));
  return values[BatchOf<T>::size - 1];
}

template <class T>
void expect_same(T got, T wanted) {
  if (std::isnan(wanted)) {
    EXPECT_TRUE(std::isnan(got));
  } else {
    EXPECT_EQ(got, wanted);
    EXPECT_EQ(std::signbit(got), std::signbit(wanted)) << wanted;
  }
}

template <class T>
void expect_numbers_of_lanes() {
  for (const T a : odd_numbers<T>()) {
    expect_same(lane_of<T>(lanes::abs(BatchOf<T>(a))), std::fabs(a));
    if (a >= 0) expect_same(lane_of<T>(lanes::sqrt(BatchOf<T>(a))), std::sqrt(a));
    for (const T b : odd_numbers<T>()) {
      const BatchOf<T> left(a), right(b);
      expect_same(lane_of<T>(left + right), a + b);
      expect_same(lane_of<T>(left - right), a - b);
      expect_same(lane_of<T>(left * right), a * b);
      expect_same(lane_of<T>(left / right), a / b);
      expect_same(lane_of<T>(lanes::max(left, right)), a > b ? a : b);
      expect_same(lane_of<T>(lanes::min(left, right)), a < b ? a : b);
      expect_same(lane_of<T>(lanes::select(left >= right, left, right)), a >= b ? a : b);
      EXPECT_EQ(lanes::any(left < right), a < b);
      EXPECT_EQ(lanes::any((left <= right) && (left != right)), a <= b && a != b);
      EXPECT_EQ(lanes::any((left > right) || (left == right)), a > b || a == b);
    }
  }
}

TEST(Vector128, HasTheNumbersOfLanes) {
  expect_numbers_of_lanes<float>();
  expect_numbers_of_lanes<double>();
}

// Each lane is its own: loads at any place, a mask that holds in one lane, sums across.
TEST(Vector128, KeepsLanesApart) {
  alignas(16) const float numbers[8] = {1, -2, 3, -4, 5, -6, 7, -8};
  alignas(16) float out[8] = {};
  const auto from_two = BatchOf<float>::load_unaligned(numbers + 1);
  lanes::select(from_two > BatchOf<float>(4.5f), from_two, BatchOf<float>(0.0f)).store_unaligned(out + 3);
  const float wanted[8] = {0, 0, 0, 0, 0, 0, 5, 0};
  for (int i = 0; i < 8; ++i) EXPECT_EQ(out[i], wanted[i]) << i;
  EXPECT_TRUE(lanes::any(from_two > BatchOf<float>(4.5f)));
  EXPECT_FALSE(lanes::any(from_two > BatchOf<float>(5)));

  alignas(16) const double pairs[4] = {1, 2, 10, 20};
  const BatchOf<double> rows[] = {BatchOf<double>::load_aligned(pairs),
                                  BatchOf<double>::load_aligned(pairs + 2)};
  alignas(16) double sums[2];
  lanes::haddp(rows).store_aligned(sums);
  EXPECT_EQ(sums[0], 3);
  EXPECT_EQ(sums[1], 30);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
