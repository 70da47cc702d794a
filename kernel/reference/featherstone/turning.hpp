#pragma once

#include <cmath>

#include "plumb/inertia.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {

/// Stands for a turn as a quaternion, which need not have length one.
struct Quaternion {
  double w;
  Vec3 v;
};
inline Quaternion load_quaternion(const double* q) {
  return {q[0], {q[1], q[2], q[3]}};
}
inline double norm2(const Quaternion& q) {
  return q.w * q.w + dot(q.v, q.v);
}
/// Returns the matrix of a quaternion of any length, so that the stages of an integrator need not keep it at
/// one.
inline Mat3 rotation(const Quaternion& q) {
  const double s = 2 / norm2(q);
  const Vec3 v = q.v;
  return {{1 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y + q.w * v.z), s * (v.x * v.z - q.w * v.y)},
          {s * (v.x * v.y - q.w * v.z), 1 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z + q.w * v.x)},
          {s * (v.x * v.z + q.w * v.y), s * (v.y * v.z - q.w * v.x), 1 - s * (v.x * v.x + v.y * v.y)}};
}
/// Returns where a quaternion takes x; `s` is 2 / norm2(q).
inline Vec3 first_axis(const Quaternion& q, double s) {
  const Vec3 v = q.v;
  return {1 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y + q.w * v.z), s * (v.x * v.z - q.w * v.y)};
}
/// Returns the matrix of a turn about a unit axis by an angle (rad), by Rodrigues' formula.
inline Mat3 rotation(Vec3 axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Mat3 one{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return c * one + s * cross_matrix(axis) + (1 - c) * outer(axis, axis);
}

inline Sym3 tensor(const Inertia& i) {
  return {i.xx, i.xy, i.xz, i.yy, i.yz, i.zz};
}
/// Returns m (|c|² - c cᵀ), the inertia of a point of mass m at c.
inline Sym3 point_inertia(double mass, Vec3 c) {
  return Sym3::diagonal(mass * dot(c, c)) - outer(mass, c);
}

}  // namespace plumb::detail
