#include "math/elementary.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace plumb::detail {
namespace {

/// These two parts add up to ln 2. The first has 33 bits, so that its product with an exponent is exact.
constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;
constexpr double over_ln2 = 0x1.71547652b82fep+0;
/// These two parts add up to π/2.
constexpr double half_pi_high = 0x1.921fb54442d18p+0, half_pi_low = 0x1.1a62633145c07p-54;

/// Returns 2^k for −1022 <= k <= 1023.
double power_of_2(int k) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
}

/// Returns x 2^k for |k| <= 1200. Two factors reach subnormal results and infinity with a single rounding.
double scaled(double x, int k) {
  const int half = k / 2;
  return x * power_of_2(half) * power_of_2(k - half);
}

/// These are the coefficients of (eʳ − 1 − r)/r² for |r| <= ln 2/2, the highest power first. The series ends
/// at 1/13!; what follows is less than 2^-57 of eʳ.
constexpr double exp_series[] = {1.0 / 6227020800, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800,
                                 1.0 / 362880,     1.0 / 40320,     1.0 / 5040,     1.0 / 720,
                                 1.0 / 120,        1.0 / 24,        1.0 / 6,        1.0 / 2};

/// These are the coefficients of (asin(s)/s − 1)/s² in z = s² <= 1/4, the highest power first. They
/// interpolate at 14 Chebyshev points, and make asin(s) wrong by less than 2^-58 of it.
constexpr double arc_series[] = {0x1.e529c6fce9bb4p-6, -0x1.3b416bb7d9257p-6, 0x1.406192d124629p-6,
                                 0x1.8f193743418ffp-9, 0x1.31622469ce5adp-7,  0x1.3b49de7121487p-7,
                                 0x1.7b027ee1dd585p-7, 0x1.c990ad3d8fdcap-7,  0x1.1c4efce23019fp-6,
                                 0x1.6e8ba123e494cp-6, 0x1.f1c71c7a52ba3p-6,  0x1.6db6db6dac1e0p-5,
                                 0x1.3333333333388p-4, 0x1.5555555555555p-3};

/// Evaluates a polynomial by Horner's rule in x². Even and odd powers go side by side, which takes half as
/// long as one after the other.
template <std::size_t count>
double polynomial(const double (&coefficients)[count], double x) {
  static_assert(count % 2 == 0);
  const double square = x * x;
  double odd = 0, even = 0;
  for (std::size_t i = 0; i < count; i += 2) {
    odd = odd * square + coefficients[i];
    even = even * square + coefficients[i + 1];
  }
  return odd * x + even;
}

/// Holds the parts of x = k ln 2 + r with |r| <= ln 2/2 (Cody and Waite 1980), and of eʳ = 1 + high + rest.
///
/// `high` is r without the low part of k ln 2, which goes to the rest. The rest is at most 0.07 and carries
/// all errors but that of the last sum.
struct Reduced {
  int k;
  double high, rest;
};
Reduced reduce(double x) {
  const int k = static_cast<int>(x * over_ln2 + (x < 0 ? -0.5 : 0.5));
  const double high = x - k * ln2_high, low = k * ln2_low, r = high - low;
  return {k, high, r * r * polynomial(exp_series, r) - low};
}

/// Returns one + high + rest. |one| is either 0 or at least |high|, so what rounding takes from one + high is
/// known exactly (Dekker 1971). It is added with the rest.
double sum_of(double one, const Reduced& reduced) {
  const double sum = one + reduced.high;
  return sum + (((one - sum) + reduced.high) + reduced.rest);
}

/// Returns (asin(s) − s)/s for z = s² <= 1/4.
double arc_excess(double z) {
  return z * polynomial(arc_series, z);
}

}  // namespace

double exp(double x) {
  if (x != x) return x;
  if (x > 750) return std::numeric_limits<double>::infinity();
  if (x < -750) return 0;
  const Reduced reduced = reduce(x);
  return scaled(sum_of(1, reduced), reduced.k);
}

double expm1(double x) {
  if (x != x || std::abs(x) < 0x1p-54) return x;
  if (x > 750) return std::numeric_limits<double>::infinity();
  if (x < -40) return -1;  // e^x is below 2^-57, half a unit in the last place of 1
  const Reduced reduced = reduce(x);
  const double one = reduced.k > 60 ? 1 : 1 - power_of_2(-reduced.k);
  return scaled(sum_of(one, reduced), reduced.k);
}

double acos(double x) {
  const double size = std::abs(x);
  if (!(size <= 1)) return std::numeric_limits<double>::quiet_NaN();
  if (size <= 0.5) return half_pi_high - (x - (half_pi_low - x * arc_excess(x * x)));
  if (x == 1) return 0;
  // The identity is acos(x) = 2 asin(s) with s² = (1 − x)/2; for −x the result is what is left of π. 1 − |x|
  // is exact.
  const double z = 0.5 * (1 - size), s = std::sqrt(z), excess = arc_excess(z);
  if (x < 0) return 2 * (half_pi_high - (s + (s * excess - half_pi_low)));
  // Rounding of the square root is put right here: the upper half of s has an exact square, which tells what
  // s lacks.
  const double upper =
      std::bit_cast<double>(std::bit_cast<std::uint64_t>(s) & std::uint64_t{0xffffffff00000000});
  return 2 * (upper + (s * excess + (z - upper * upper) / (s + upper)));
}

double cbrt(double x) {
  const double size = std::abs(x);
  if (!(size > 0) || size > std::numeric_limits<double>::max()) return x;
  if (size < std::numeric_limits<double>::min()) return 0x1p-18 * cbrt(0x1p54 * x);
  // Dividing the bits by three divides the exponent by three. With the offset the result is within 4 %, and
  // four steps of Newton bring it to 1e-22.
  double y = std::bit_cast<double>(std::bit_cast<std::uint64_t>(size) / 3 + 0x2a9f7893782da1ce);
  for (int i = 0; i < 4; ++i) y -= (y * y * y - size) / (3 * (y * y));
  return x < 0 ? -y : y;
}

double root(double x, std::uint32_t order) {
  if (order == 1) return x;
  const double square = std::sqrt(x);
  return order == 2 ? square : order == 4 ? std::sqrt(square) : cbrt(square);
}

}  // namespace plumb::detail
