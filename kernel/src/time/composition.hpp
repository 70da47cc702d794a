#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace plumb::detail {

/// Returns the shares into which a substep is composed, as multiples of its length. They are taken one after
/// the other, some of them backwards. They raise a symmetric method of order 2 to order 4 (Suzuki 1990) or 6
/// (Kahan and Li 1997). See Hairer, Lubich and Wanner, Geometric Numerical Integration, section V.3.
inline std::span<const double> composition(std::uint32_t order) {
  static constexpr double second[] = {1};
  // a is 1/(4 - 4^(1/3)), and b is what is left of 1 after four of them.
  static constexpr double a = 0.41449077179437573714, b = 1 - 4 * a;
  static constexpr double fourth[] = {a, a, b, a, a};
  static constexpr double c = 0.39216144400731413928, d = 0.33259913678935943860, e = -0.70624617255763935981,
                          f = 0.08221359629355080023, g = 1 - 2 * (c + d + e + f);
  static constexpr double sixth[] = {c, d, e, f, g, f, e, d, c};
  if (order == 2) return second;
  return order == 4 ? std::span<const double>(fourth) : std::span<const double>(sixth);
}

inline double largest_share(std::uint32_t order) {
  double largest = 0;
  for (const double share : composition(order)) largest = std::max(largest, std::abs(share));
  return largest;
}

/// Returns into how many pieces a substep is cut that is `times_too_long` times its limit, at most `most`.
inline std::uint32_t pieces_of(double times_too_long, double most = 64) {
  return static_cast<std::uint32_t>(std::clamp(std::ceil(times_too_long), 1.0, most));
}

}  // namespace plumb::detail
