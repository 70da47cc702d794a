#pragma once

#include <cstddef>

#include "plumb/vec3.hpp"

/// This file holds 3x3 matrices for the linear-time methods: plain values, all inlined.
namespace plumb::detail {

inline Vec3 load3(const double* p) {
  return {p[0], p[1], p[2]};
}
inline void store3(double* p, Vec3 v) {
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}

/// This is a symmetric 3x3 matrix.
struct Sym3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  static constexpr Sym3 diagonal(double d) { return {d, 0, 0, d, 0, d}; }
  Sym3& operator+=(const Sym3& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    return *this;
  }
  friend Sym3 operator+(Sym3 a, const Sym3& b) { return a += b; }
  friend Sym3 operator*(double s, const Sym3& a) {
    return {s * a.xx, s * a.xy, s * a.xz, s * a.yy, s * a.yz, s * a.zz};
  }
  friend Sym3 operator-(const Sym3& a, const Sym3& b) {
    return {a.xx - b.xx, a.xy - b.xy, a.xz - b.xz, a.yy - b.yy, a.yz - b.yz, a.zz - b.zz};
  }
  friend Vec3 operator*(const Sym3& m, Vec3 v) {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
  }
};

inline double trace(const Sym3& m) {
  return m.xx + m.yy + m.zz;
}
/// Returns s a aᵀ.
inline Sym3 outer(double s, Vec3 a) {
  const Vec3 b = s * a;
  return {a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.y, a.y * b.z, a.z * b.z};
}
/// Returns a bᵀ + b aᵀ.
inline Sym3 outer_both(Vec3 a, Vec3 b) {
  return {2 * a.x * b.x, a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x,
          2 * a.y * b.y, a.y * b.z + a.z * b.y, 2 * a.z * b.z};
}
/// Inverts by cofactors. The inverse of a singular matrix is not finite.
inline Sym3 inverse(const Sym3& m) {
  const double cxx = m.yy * m.zz - m.yz * m.yz, cxy = m.xz * m.yz - m.xy * m.zz,
               cxz = m.xy * m.yz - m.xz * m.yy;
  const double over = 1 / (m.xx * cxx + m.xy * cxy + m.xz * cxz);
  return {over * cxx,
          over * cxy,
          over * cxz,
          over * (m.xx * m.zz - m.xz * m.xz),
          over * (m.xy * m.xz - m.xx * m.yz),
          over * (m.xx * m.yy - m.xy * m.xy)};
}

/// Returns how a rigid thing with this inertia turns with an angular momentum. A straight line does not turn
/// about itself. What keeps its inertia from being singular, and what rounding makes of the inverse then,
/// goes out with the second solution.
inline Vec3 spin_of(const Sym3& inertia, Vec3 momentum) {
  const Sym3 back = inverse(inertia + Sym3::diagonal(1e-8 * trace(inertia) + 1e-300));
  Vec3 out = back * momentum;
  out += back * (momentum - inertia * out);
  return out;
}

/// This is a 3x3 matrix by its columns.
struct Mat3 {
  Vec3 x{}, y{}, z{};

  friend Vec3 operator*(const Mat3& m, Vec3 v) { return v.x * m.x + v.y * m.y + v.z * m.z; }
  friend Mat3 operator*(const Mat3& a, const Mat3& b) { return {a * b.x, a * b.y, a * b.z}; }
  friend Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Mat3 operator-(const Mat3& a, const Mat3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Mat3 operator*(double s, const Mat3& m) { return {s * m.x, s * m.y, s * m.z}; }
};

inline Mat3 full(const Sym3& m) {
  return {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
}
/// Returns the half above the diagonal of a matrix that is known to be symmetric.
inline Sym3 symmetric(const Mat3& m) {
  return {m.x.x, m.y.x, m.z.x, m.y.y, m.z.y, m.z.z};
}
inline Mat3 transposed(const Mat3& m) {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}
/// Returns Mᵀ v.
inline Vec3 transposed_times(const Mat3& m, Vec3 v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
/// Returns a bᵀ.
inline Mat3 outer(Vec3 a, Vec3 b) {
  return {b.x * a, b.y * a, b.z * a};
}
/// Returns [a]x, the matrix that takes x to a × x.
inline Mat3 cross_matrix(Vec3 a) {
  return {{0, a.z, -a.y}, {-a.z, 0, a.x}, {a.y, -a.x, 0}};
}

}  // namespace plumb::detail
