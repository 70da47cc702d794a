#pragma once

#include <cmath>

namespace plumb {

/// Holds three Cartesian components. Positions are in metres, velocities in m/s, forces in N.
struct Vec3 {
  double x = 0;  ///< First component.
  double y = 0;  ///< Second component; up, where gravity has its default.
  double z = 0;  ///< Third component.

  /// @{
  /// These add, subtract and multiply component by component.
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  /// @}
  /// Adds `b` in place.
  constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  /// Subtracts `b` in place.
  constexpr Vec3& operator-=(Vec3 b) { return *this = *this - b; }
  /// Returns whether all components are equal.
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// Returns the dot product of two vectors.
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// Returns the cross product of two vectors.
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Returns the length of a vector.
inline double norm(Vec3 a) {
  return std::sqrt(dot(a, a));
}
/// Returns whether no component is infinite or not a number.
inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace plumb
