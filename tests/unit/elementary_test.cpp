// plumb's own elementary functions against those of the C library in long double, and against numbers that
// every compiler and machine must come to.

#include "math/elementary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "scenes/basics/seeded.hpp"
#include "support/sanitizers.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double smallest = std::numeric_limits<double>::denorm_min();
constexpr double largest = std::numeric_limits<double>::max();

/// The distance from `wanted` in units in the last place of the double nearest to it.
double ulps(double got, long double wanted) {
  if (std::isinf(static_cast<double>(wanted)) || wanted == 0)
    return got == static_cast<double>(wanted) ? 0 : infinity;
  int exponent = 0;
  std::frexp(wanted, &exponent);
  return static_cast<double>(std::abs((got - wanted) / std::ldexp(1.0L, std::max(exponent - 53, -1074))));
}

struct Range {
  double from, to;
  bool logarithmic = false;  ///< bounds are powers of two, and arguments are even in the logarithm
};

/// The largest error over a range, at evenly spaced and at random arguments.
template <class F, class Exact>
double worst_ulps(Range range, F f, Exact exact) {
  std::mt19937_64 random(1);
  const int count = test::scaled(200000);
  double worst = 0;
  for (int i = 0; i <= 2 * count; ++i) {
    const double share = i <= count ? static_cast<double>(i) / count : scenes::unit_double(random);
    const double at = range.from + share * (range.to - range.from);
    const double x = range.logarithmic ? std::exp2(at) : at;
    worst = std::max(worst, ulps(f(x), exact(static_cast<long double>(x))));
  }
  return worst;
}

// Largest errors measured over 4 million random arguments a range: 0.79 ulp where results are subnormal, else
// 0.74.
TEST(Exp, IsWithinOneUlp) {
  const auto exact = [](long double x) { return std::exp(x); };
  for (const Range range :
       {Range{-1, 1}, Range{-50, 50}, Range{-745.2, -700}, Range{-700, 709.8}, Range{-60, 0, true}})
    EXPECT_LE(worst_ulps(range, exp, exact), 1) << range.from;
}

TEST(Exp, OfSpecialValues) {
  EXPECT_EQ(exp(0), 1);
  EXPECT_EQ(exp(-0.0), 1);
  EXPECT_EQ(exp(smallest), 1);
  EXPECT_EQ(exp(-infinity), 0);
  EXPECT_EQ(exp(-746), 0);
  EXPECT_EQ(exp(-largest), 0);
  EXPECT_EQ(exp(-745.1), smallest);
  EXPECT_EQ(exp(infinity), infinity);
  EXPECT_EQ(exp(largest), infinity);
  EXPECT_EQ(exp(709.79), infinity);
  EXPECT_LT(exp(709.78), infinity);
  EXPECT_TRUE(std::isnan(exp(nan)));
}

// 1.29 ulp measured, near ln 2/2.
TEST(Expm1, IsWithinTwoUlp) {
  const auto exact = [](long double x) { return std::expm1(x); };
  for (const Range range :
       {Range{-1, 1}, Range{-0.4, 0.4}, Range{-50, 50}, Range{50, 709.8}, Range{-1074, 9, true}})
    EXPECT_LE(worst_ulps(range, expm1, exact), 2) << range.from;
  const auto negative = [](double x) { return expm1(-x); };
  EXPECT_LE(worst_ulps({-1074, 9, true}, negative, [](long double x) { return std::expm1(-x); }), 2);
}

TEST(Expm1, OfSpecialValues) {
  EXPECT_EQ(expm1(0), 0);
  EXPECT_TRUE(std::signbit(expm1(-0.0)));
  EXPECT_EQ(expm1(smallest), smallest);
  EXPECT_EQ(expm1(-infinity), -1);
  EXPECT_EQ(expm1(-38), -1);
  EXPECT_EQ(expm1(infinity), infinity);
  EXPECT_EQ(expm1(709.79), infinity);
  EXPECT_TRUE(std::isnan(expm1(nan)));
}

// 0.90 ulp measured, just below −1/2.
TEST(Acos, IsWithinOneUlp) {
  const auto exact = [](long double x) { return std::acos(x); };
  for (const Range range :
       {Range{-1, 1}, Range{-0.5, 0.5}, Range{0.5, 1}, Range{-1, -0.5}, Range{-60, -1, true}})
    EXPECT_LE(worst_ulps(range, acos, exact), 1) << range.from;
  for (double below = 0.5; below > 1e-16; below /= 2) {  // down to the last number before 1 and −1
    EXPECT_LE(ulps(acos(1 - below), exact(1 - below)), 1) << below;
    EXPECT_LE(ulps(acos(below - 1), exact(below - 1)), 1) << below;
  }
}

TEST(Acos, OfSpecialValues) {
  EXPECT_EQ(acos(1), 0);
  EXPECT_EQ(acos(-1), static_cast<double>(std::acos(-1.0L)));
  EXPECT_EQ(acos(0), static_cast<double>(std::acos(0.0L)));
  EXPECT_EQ(acos(-0.0), acos(0));
  for (const double x : {std::nextafter(1.0, 2.0), -1.5, infinity, -infinity, nan})
    EXPECT_TRUE(std::isnan(acos(x)));
}

// 0.97 ulp measured.
TEST(Cbrt, IsWithinOneUlp) {
  const auto exact = [](long double x) { return std::cbrt(x); };
  EXPECT_LE(worst_ulps({1, 8}, cbrt, exact), 1);
  EXPECT_LE(worst_ulps({-1074, 1023, true}, cbrt, exact), 1);
}

TEST(Cbrt, OfSpecialValues) {
  for (const double x : {0.0, infinity, -infinity}) EXPECT_EQ(cbrt(x), x);
  EXPECT_TRUE(std::signbit(cbrt(-0.0)));
  EXPECT_EQ(cbrt(-27), -3);
  EXPECT_EQ(cbrt(0x1p-1074), 0x1p-358);
  EXPECT_TRUE(std::isnan(cbrt(nan)));
}

// 1.19 ulp measured for order 6, 0.85 for order 4.
TEST(Root, IsWithinTwoUlp) {
  for (const std::uint32_t order : {1u, 2u, 4u, 6u}) {
    const auto f = [order](double x) { return root(x, order); };
    const auto exact = [order](long double x) { return std::pow(x, 1.0L / order); };
    for (const Range range : {Range{0.1, 10}, Range{-1074, 1023, true}})
      EXPECT_LE(worst_ulps(range, f, exact), 2) << order;
    EXPECT_EQ(root(0, order), 0) << order;
    EXPECT_EQ(root(infinity, order), infinity) << order;
    EXPECT_TRUE(std::isnan(root(nan, order))) << order;
  }
}

/// FNV-1a over the bits of f at 65537 arguments with short binary fractions.
template <class F>
std::uint64_t hash_over(double from, double to, F f) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (int i = 0; i <= 65536; ++i) {
    const auto bits = std::bit_cast<std::uint64_t>(f(from + (to - from) * (i * 0x1p-16)));
    for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 0xff)) * 0x100000001b3;
  }
  return hash;
}

// Golden: a compiler, a flag or a machine that comes to other bits breaks what plumb promises.
TEST(Elementary, HasTheSameBitsEverywhere) {
  EXPECT_EQ(hash_over(-744, 712, exp), 0x5f5fd47ebd84f701u);
  EXPECT_EQ(hash_over(-2, 2, exp), 0xecde57584a0581e9u);
  EXPECT_EQ(hash_over(-48, 720, expm1), 0x7fbc7244003acab6u);
  EXPECT_EQ(hash_over(-2, 2, expm1), 0xe702bbea1f37ae7bu);
  EXPECT_EQ(hash_over(-1, 1, acos), 0xb6587dacbb811579u);
  EXPECT_EQ(hash_over(-8, 8, cbrt), 0x37c4574270f02d19u);
  EXPECT_EQ(hash_over(0, 64, [](double x) { return root(x, 4); }), 0x00190f6e39c8ed18u);
  EXPECT_EQ(hash_over(0, 64, [](double x) { return root(x, 6); }), 0xc28892a6245275beu);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
