#pragma once

// The law of twists (plumb::Twist) for the loops of trees, with the numbers of one lane or of all. It is that
// of direct/twists/twist_law.hpp, and is compared with it by a test. tree_lanes.hpp includes this file after
// lane_math.hpp.

#include "scene/bends/curvature.hpp"

namespace plumb::simd {
namespace {

/// Holds a vector for each of two rods that meet, seen from the root on.
template <class V>
struct RodPair {
  Vec<V> first, second;
};
template <class V>
PLUMB_INLINE V dot(const RodPair<V>& a, const RodPair<V>& b) {
  return dot(a.first, b.first) + dot(a.second, b.second);
}
/// Returns a + s b.
template <class V>
PLUMB_INLINE RodPair<V> sum_of(const RodPair<V>& a, const V& s, const RodPair<V>& b) {
  return {a.first + s * b.first, a.second + s * b.second};
}

/// Two rods that meet have these inverse lengths, and the inverse of the product of lengths with 1 + p . q.
template <class V>
struct TwistSizes {
  V first, second, over_first, over_second, over_sum;
  V folded;  ///< It is above 0 where the rods are folded, see least_twist_sum.
};
template <class V>
PLUMB_INLINE TwistSizes<V> twist_sizes(const RodPair<V>& rods) {
  const V one(1), first = root(dot(rods.first, rods.first)), second = root(dot(rods.second, rods.second));
  const V product = first * second, sum = product + dot(rods.first, rods.second);
  const V least = V(detail::least_twist_sum) * product;
  return {first, second, one / first, one / second, one / larger(sum, least), least - sum};
}
template <class V>
PLUMB_INLINE RodPair<V> twist_direction(const RodPair<V>& rods, const TwistSizes<V>& sizes) {
  const Vec<V> across = sizes.over_sum * cross(rods.first, rods.second);
  return {sizes.over_first * across, sizes.over_second * across};
}

/// A direction has these derivatives: the first name is that of its vector, the second of the rod. Matrices
/// are given by columns.
template <class V>
struct TwistSlopes {
  Mat<V> first_first, first_second, second_first, second_second;
};
/// Returns scale [v]x - u w^T by columns, where [v]x times any x is v x x.
template <class V>
PLUMB_INLINE Mat<V> turn_matrix(const V& scale, const Vec<V>& v, const Vec<V>& u, const Vec<V>& w) {
  const Vec<V> a = scale * v;
  const V none(0);
  return {Vec<V>{none, a.z, none - a.y} - w.x * u, Vec<V>{none - a.z, none, a.x} - w.y * u,
          Vec<V>{a.y, none - a.x, none} - w.z * u};
}
template <class V>
PLUMB_INLINE TwistSlopes<V> twist_slopes(const RodPair<V>& rods, const TwistSizes<V>& s,
                                         const RodPair<V>& direction) {
  const V none(0), least(detail::least_twist_sum);
  // The logarithm of the sum has these derivatives.
  RodPair<V> growth{(s.second * s.over_first) * rods.first, (s.first * s.over_second) * rods.second};
  const auto kept = [&](const Vec<V>& along, const Vec<V>& other) {
    const Vec<V> open = along + other, closed = least * along;
    return Vec<V>{select_positive(s.folded, closed.x, open.x), select_positive(s.folded, closed.y, open.y),
                  select_positive(s.folded, closed.z, open.z)};
  };
  growth = {s.over_sum * kept(growth.first, rods.second), s.over_sum * kept(growth.second, rods.first)};
  const Vec<V> first_growth = (s.over_first * s.over_first) * rods.first;
  const Vec<V> second_growth = (s.over_second * s.over_second) * rods.second;
  const V by_first = s.over_sum * s.over_first, by_second = s.over_sum * s.over_second;
  return {turn_matrix(none - by_first, rods.second, direction.first, growth.first + first_growth),
          turn_matrix(by_first, rods.first, direction.first, growth.second),
          turn_matrix(none - by_second, rods.second, direction.second, growth.first),
          turn_matrix(by_second, rods.first, direction.second, growth.second + second_growth)};
}

/// A joint of a chain pulls its rods along `pull` by a unit torque, whose derivatives are `slopes`. It has
/// turned by `turn` in a substep, with the derivative `gradient` by the change of rods.
template <class V>
struct TwistOfJoint {
  RodPair<V> pull, gradient;
  TwistSlopes<V> slopes;
  V turn;
};

/// Returns what turn_of() and its derivative are in direct/twists/loop_twists.cpp, of gradient mid or new.
template <bool is_mid, class V>
PLUMB_INLINE TwistOfJoint<V> twist_of_joint(const RodPair<V>& start, const RodPair<V>& change) {
  const V half(0.5);
  const RodPair<V> middle = sum_of(start, half, change);
  const TwistSizes<V> sizes = twist_sizes(middle);
  const RodPair<V> direction = twist_direction(middle, sizes);
  const TwistSlopes<V> slopes = twist_slopes(middle, sizes, direction);
  const RodPair<V> turned{multiply_transposed(slopes.first_first, change.first) +
                              multiply_transposed(slopes.second_first, change.second),
                          multiply_transposed(slopes.first_second, change.first) +
                              multiply_transposed(slopes.second_second, change.second)};
  const RodPair<V> gradient = sum_of(direction, half, turned);
  const V turn = dot(direction, change);
  if constexpr (is_mid) return {direction, gradient, slopes, turn};
  const RodPair<V> end = sum_of(start, V(1), change);
  const TwistSizes<V> end_sizes = twist_sizes(end);
  const RodPair<V> pull = twist_direction(end, end_sizes);
  return {pull, gradient, twist_slopes(end, end_sizes, pull), turn};
}

}  // namespace
}  // namespace plumb::simd
