#include "direct/twists/twist_law.hpp"

#include <algorithm>
#include <cstddef>

#include "scene/bends/curvature.hpp"

namespace plumb::detail {
namespace {

/// Two rods have these lengths (m), and the product of them with 1 + p . q (m²).
struct Sizes {
  double first, second, sum;
  bool is_folded;
};
Sizes sizes_of(const RodPair& rods) {
  const double first = norm(rods.first), second = norm(rods.second);
  const double sum = first * second + dot(rods.first, rods.second), least = least_twist_sum * first * second;
  return {first, second, std::max(sum, least), sum < least};
}

/// Adds scale [v]x - u w^T, where [v]x times any x is v x x.
void add(std::array<double, 9>& to, double scale, Vec3 v, Vec3 u, Vec3 w) {
  const double turn[9] = {0, -v.z, v.y, v.z, 0, -v.x, -v.y, v.x, 0};
  const double a[3] = {u.x, u.y, u.z}, b[3] = {w.x, w.y, w.z};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) to[3 * i + j] += scale * turn[3 * i + j] - a[i] * b[j];
}

}  // namespace

RodPair twist_direction(const RodPair& rods) {
  const Sizes s = sizes_of(rods);
  const Vec3 across = 1 / s.sum * cross(rods.first, rods.second);
  return {1 / s.first * across, 1 / s.second * across};
}

TwistSlopes twist_slopes(const RodPair& rods) {
  const Sizes s = sizes_of(rods);
  const RodPair direction = twist_direction(rods);
  // The logarithm of the sum has these derivatives.
  RodPair growth{s.second / s.first * rods.first, s.first / s.second * rods.second};
  growth = s.is_folded ? RodPair{least_twist_sum * growth.first, least_twist_sum * growth.second}
                       : RodPair{growth.first + rods.second, growth.second + rods.first};
  growth = {1 / s.sum * growth.first, 1 / s.sum * growth.second};
  const Vec3 first_growth = 1 / (s.first * s.first) * rods.first;
  const Vec3 second_growth = 1 / (s.second * s.second) * rods.second;
  TwistSlopes out;
  add(out.of[0][0], -1 / (s.sum * s.first), rods.second, direction.first, growth.first + first_growth);
  add(out.of[0][1], 1 / (s.sum * s.first), rods.first, direction.first, growth.second);
  add(out.of[1][0], -1 / (s.sum * s.second), rods.second, direction.second, growth.first);
  add(out.of[1][1], 1 / (s.sum * s.second), rods.first, direction.second, growth.second + second_growth);
  return out;
}

}  // namespace plumb::detail
