#pragma once

#include <cmath>
#include <limits>

/// Truths are computed in the 80-bit floats of x86, which have 64 bits of digits (eps 1.1e-19).
namespace plumb::truth {

using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64, "truths need long double to be wider than double");

struct Point {
  Real x = 0, y = 0, z = 0;

  Point& operator+=(const Point& p) { return x += p.x, y += p.y, z += p.z, *this; }
  Point& operator-=(const Point& p) { return x -= p.x, y -= p.y, z -= p.z, *this; }
};

inline Point operator+(Point p, const Point& q) {
  return p += q;
}
inline Point operator-(Point p, const Point& q) {
  return p -= q;
}
inline Point operator*(Real s, const Point& p) {
  return {s * p.x, s * p.y, s * p.z};
}
inline Real dot(const Point& p, const Point& q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
inline Real norm(const Point& p) {
  return std::sqrt(dot(p, p));
}

/// A symmetric 3×3 matrix holds its lower triangle by rows.
struct Symmetric {
  Real xx = 0, yx = 0, yy = 0, zx = 0, zy = 0, zz = 0;

  void add_identity(Real s) { xx += s, yy += s, zz += s; }
  /// Adds s·p·pᵀ.
  void add_square(Real s, const Point& p) {
    xx += s * p.x * p.x, yx += s * p.y * p.x, yy += s * p.y * p.y;
    zx += s * p.z * p.x, zy += s * p.z * p.y, zz += s * p.z * p.z;
  }
};

/// Factors a positive definite 3×3 matrix as LDLᵀ. Unlike an inverse from cofactors it keeps its digits where
/// one direction is much stiffer than the others. The matrix of a rod with a heavy end is such.
class Factor3 {
 public:
  /// Returns false if the matrix is not positive definite to working precision.
  bool factor(const Symmetric& k) {
    constexpr Real least = 1e-17L;  // Least pivot, relative to its diagonal element.
    if (!(k.xx > 0)) return false;
    inverse_x_ = 1 / k.xx;
    yx_ = k.yx * inverse_x_, zx_ = k.zx * inverse_x_;
    const Real y = k.yy - yx_ * k.yx;
    if (!(y > least * k.yy)) return false;
    inverse_y_ = 1 / y;
    const Real below = k.zy - zx_ * k.yx;
    zy_ = below * inverse_y_;
    const Real z = k.zz - zx_ * k.zx - zy_ * below;
    if (!(z > least * k.zz)) return false;
    inverse_z_ = 1 / z;
    return true;
  }

  Point solve(Point p) const {
    p.y -= yx_ * p.x;
    p.z -= zx_ * p.x + zy_ * p.y;
    p.z *= inverse_z_;
    p.y = p.y * inverse_y_ - zy_ * p.z;
    p.x = p.x * inverse_x_ - yx_ * p.y - zx_ * p.z;
    return p;
  }

 private:
  Real inverse_x_ = 0, inverse_y_ = 0, inverse_z_ = 0, yx_ = 0, zx_ = 0, zy_ = 0;
};

}  // namespace plumb::truth
