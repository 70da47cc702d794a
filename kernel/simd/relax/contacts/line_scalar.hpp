// Finds where lines touch each other, one pair at a time, written for reading: the oracle of line_lanes.hpp.
// contact/shapes/touch.hpp has the same, for all other shapes. Everything has internal linkage.

#pragma once

#include <cmath>

#include "simd/relax/contacts/line_kernels.hpp"
#include "simd/relax/contacts/line_limits.hpp"
#include "simd/relax/scalar_access.hpp"

namespace plumb::simd {
namespace {

using Point3 = Triple<double>;

inline Point3 minus(const Point3& a, const Point3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Point3 plus(const Point3& a, double by, const Point3& b) {
  return {a.x + by * b.x, a.y + by * b.y, a.z + by * b.z};
}
inline double length_of(const Point3& a) {
  return std::sqrt(dot(a, a));
}
inline double to_share(double t) {
  return t < 0 ? 0 : (1 < t ? 1 : t);
}

/// One line, in m.
struct OneLine {
  Point3 p, q, along, p_by, q_by;
  double radius, moves;

  explicit OneLine(const double* from)
      : p(at(from + line_fields::p)),
        q(at(from + line_fields::q)),
        along(minus(q, p)),
        p_by(at(from + line_fields::p_by)),
        q_by(at(from + line_fields::q_by)),
        radius(from[line_fields::radius]),
        moves(from[line_fields::moves]) {}
  static Point3 at(const double* from) { return {from[0], from[1], from[2]}; }
};

/// Returns whether a plane across an axis, or across the line between middles, parts two lines' surfaces by
/// more than `reach` (m).
inline bool are_lines_apart(const OneLine& a, const OneLine& b, double reach) {
  const Point3 twice{(a.p.x + a.q.x) - (b.p.x + b.q.x), (a.p.y + a.q.y) - (b.p.y + b.q.y),
                     (a.p.z + a.q.z) - (b.p.z + b.q.z)};
  const double most = reach + a.radius + b.radius;
  const auto parts = [&](double apart, double one, double other) {
    return std::fabs(apart) - std::fabs(one) - std::fabs(other) > 2 * most;
  };
  return parts(twice.x, a.along.x, b.along.x) || parts(twice.y, a.along.y, b.along.y) ||
         parts(twice.z, a.along.z, b.along.z) ||
         dot(twice, twice) - std::fabs(dot(twice, a.along)) - std::fabs(dot(twice, b.along)) >
             2 * most * length_of(twice);
}

/// Returns whether two lines move so far against each other that one may pass the other.
inline bool are_lines_fast(const OneLine& a, const OneLine& b, const LineRules& rules) {
  const double most = rules.margin + rules.passes * (a.radius + b.radius);
  if (!(a.moves + b.moves > most)) return false;
  return length_of(minus(a.p_by, b.p_by)) > most || length_of(minus(a.p_by, b.q_by)) > most ||
         length_of(minus(a.q_by, b.p_by)) > most || length_of(minus(a.q_by, b.q_by)) > most;
}

/// Adds where two lines touch if they come that near. `a` and `b` are places on them.
inline bool add_line_touch(const OneLine& one, const OneLine& other, double a, double b,
                           const LineRules& rules, LineTouch& out) {
  const Point3 apart = minus(plus(one.p, a, one.along), plus(other.p, b, other.along));
  const double distance = length_of(apart), over = 1 / distance;
  const bool is_near = !(distance > line_limits::least_distance);
  const Point3 n = is_near ? Point3{0, 1, 0} : Point3{over * apart.x, over * apart.y, over * apart.z};
  const double gap = distance - one.radius - other.radius;
  Point3 shift{};
  shift = plus(shift, 1 - a, one.p_by);
  shift = plus(shift, a, one.q_by);
  shift = plus(shift, -(1 - b), other.p_by);
  shift = plus(shift, -b, other.q_by);
  const double closing = dot(n, shift);
  out = {gap, n.x, n.y, n.z, a, b, closing, 0, 0};
  return gap <= rules.margin + line_limits::reach * (one.moves + other.moves) &&
         gap + closing <= rules.margin + line_limits::spread * length_of(shift);
}

/// Finds the touches of a pair. Returns how many.
inline std::uint32_t find_pair_touches(const OneLine& a, const OneLine& b, const LineRules& rules,
                                       LineTouch* out) {
  using namespace line_limits;
  const double reach_of_pair = rules.margin + reach * (a.moves + b.moves);
  if (are_lines_apart(a, b, reach_of_pair)) return 0;
  if (are_lines_fast(a, b, rules)) {
    out->which = LineTouch::fast;
    return 1;
  }
  const Point3 &u = a.along, &v = b.along, r = minus(a.p, b.p);
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  const double area = uu * vv - uv * uv;
  double s = 0, t = 0;
  if (uu > least_square && vv > least_square)
    s = area > least_area * uu * vv ? to_share((uv * vr - vv * ur) / area) : 0.5;
  if (vv > least_square) t = to_share((uv * s + vr) / vv);
  if (uu > least_square) s = to_share((uv * t - ur) / uu);
  std::uint32_t count = 0;
  if (add_line_touch(a, b, s, t, rules, out[count])) out[count++].which = 0;
  const Point3 apart = minus(plus(a.p, s, u), plus(b.p, t, v));
  if (length_of(apart) - a.radius - b.radius > reach_of_pair) return count;
  if (uu == 0 || vv == 0 || uv * uv < along * uu * vv) return count;
  const double first = to_share(dot(minus(b.p, a.p), u) / uu);
  const double second = to_share(dot(minus(b.q, a.p), u) / uu);
  if (!(std::fabs(first - second) > least_part)) return count;
  std::uint32_t which = 1;
  for (const double end : {first, second}) {
    if (!(std::fabs(end - s) > least_part)) continue;
    const double place = vv > least_square ? to_share(dot(v, minus(plus(a.p, end, u), b.p)) / vv) : 0;
    if (add_line_touch(a, b, end, place, rules, out[count])) out[count++].which = which;
    ++which;
  }
  return count;
}

inline std::uint32_t find_line_touches(const double* lines, const LinePair* pairs, std::uint32_t count,
                                       const LineRules& rules, LineTouch* out) {
  std::uint32_t found = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const OneLine a(lines + std::size_t{pairs[i].one} * line_fields::count),
        b(lines + std::size_t{pairs[i].other} * line_fields::count);
    const std::uint32_t more = find_pair_touches(a, b, rules, out + found);
    for (std::uint32_t k = 0; k < more; ++k) out[found + k].pair = i;
    found += more;
  }
  return found;
}

constexpr LineKernels line_kernels = {find_line_touches};

}  // namespace
}  // namespace plumb::simd
