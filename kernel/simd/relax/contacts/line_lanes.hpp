// Finds where lines touch each other, in vectors of pairs. line_scalar.hpp says what is computed; the
// operations and their order are the same here. relax_lanes.hpp includes it, and it has internal linkage as
// that has.

#pragma once

#include "simd/relax/contacts/line_kernels.hpp"
#include "simd/relax/contacts/line_limits.hpp"
#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

using Doubles = Batch<double>;
using Points = Triple<double>;
constexpr std::uint32_t line_lanes = width<double>;

PLUMB_INLINE Doubles length_of(const Points& a) {
  return lanes::sqrt(dot(a, a));
}
PLUMB_INLINE Doubles to_share(const Doubles& t) {
  const Doubles zero(0.0), one(1.0);
  return lanes::select(t < zero, zero, lanes::select(one < t, one, t));
}

/// Records of as many lines as there are lanes, as columns.
struct LineColumns {
  Points xyz;
  Doubles last;

  PLUMB_INLINE LineColumns(const double* const* lines, std::uint32_t field)
      : LineColumns(read(lines, field)) {}

 private:
  PLUMB_INLINE explicit LineColumns(const FourColumns<double, line_lanes>& of)
      : xyz{Doubles(of.x), Doubles(of.y), Doubles(of.z)}, last(of.w) {}
  static PLUMB_INLINE FourColumns<double, line_lanes> read(const double* const* lines, std::uint32_t field) {
    Record<double> records[line_lanes];
    for (std::uint32_t lane = 0; lane < line_lanes; ++lane) records[lane] = load_record(lines[lane] + field);
    FourColumns<double, line_lanes> columns;
    to_four_columns(records, columns);
    return columns;
  }
};

/// Lines of one machine vector of pairs.
struct Lines {
  Points p, q, along, p_by, q_by;
  Doubles radius, moves;

  PLUMB_INLINE Lines(const double* const* from)
      : Lines(LineColumns(from, line_fields::p), LineColumns(from, line_fields::q),
              LineColumns(from, line_fields::p_by), LineColumns(from, line_fields::q_by)) {}

 private:
  PLUMB_INLINE Lines(const LineColumns& of_p, const LineColumns& of_q, const LineColumns& p_goes,
                     const LineColumns& q_goes)
      : p(of_p.xyz),
        q(of_q.xyz),
        along(q - p),
        p_by(p_goes.xyz),
        q_by(q_goes.xyz),
        radius(of_p.last),
        moves(of_q.last) {}
};

/// Writes which lanes are set, one bit each.
template <class Mask>
PLUMB_INLINE std::uint32_t bits_of(const Mask& mask) {
  alignas(64) double out[line_lanes];
  lanes::select(mask, Doubles(1.0), Doubles(0.0)).store_aligned(out);
  std::uint32_t bits = 0;
  for (std::uint32_t lane = 0; lane < line_lanes; ++lane) bits |= (out[lane] != 0 ? 1u : 0u) << lane;
  return bits;
}

/// Returns what is left of a distance between two lines that reach so far.
PLUMB_INLINE Doubles left_between(const Doubles& apart, const Doubles& one, const Doubles& other) {
  return lanes::abs(apart) - lanes::abs(one) - lanes::abs(other);
}
PLUMB_INLINE auto are_lines_apart(const Lines& a, const Lines& b, const Doubles& reach) {
  const Points twice = (a.p + a.q) - (b.p + b.q);
  const Doubles most = Doubles(2.0) * (reach + a.radius + b.radius);
  return (left_between(twice.x, a.along.x, b.along.x) > most) ||
         (left_between(twice.y, a.along.y, b.along.y) > most) ||
         (left_between(twice.z, a.along.z, b.along.z) > most) ||
         (left_between(dot(twice, twice), dot(twice, a.along), dot(twice, b.along)) >
          most * length_of(twice));
}

/// Finds the lanes of lines that are fast, one bit each.
PLUMB_INLINE std::uint32_t find_fast_lines(const Lines& a, const Lines& b, const LineRules& rules) {
  const Doubles most = Doubles(rules.margin) + Doubles(rules.passes) * (a.radius + b.radius);
  const auto may_be = a.moves + b.moves > most;
  if (!lanes::any(may_be)) return 0;  // without roots
  return bits_of(may_be && ((length_of(a.p_by - b.p_by) > most) || (length_of(a.p_by - b.q_by) > most) ||
                            (length_of(a.q_by - b.p_by) > most) || (length_of(a.q_by - b.q_by) > most)));
}

/// Places where the pairs of a vector may touch. Lanes that are `set` do. Those that `count` have such a
/// place.
struct TouchColumns {
  alignas(64) double gap[line_lanes], x[line_lanes], y[line_lanes], z[line_lanes];
  alignas(64) double a[line_lanes], b[line_lanes], closing[line_lanes];
  std::uint32_t set = 0, count = 0;

  PLUMB_INLINE LineTouch of(std::uint32_t lane, std::uint32_t pair, std::uint32_t which) const {
    return {gap[lane], x[lane], y[lane], z[lane], a[lane], b[lane], closing[lane], pair, which};
  }
};

/// Places on the lines of pairs, from 0 to 1.
struct Shares {
  Doubles a, b;
};

/// Finds whether lines come to touch at places on them. Returns how far they are apart.
template <class Mask>
PLUMB_INLINE Doubles find_touches_at(const Lines& one, const Lines& other, const Shares& at,
                                     const LineRules& rules, const Mask& among, TouchColumns& out) {
  const auto& [a, b] = at;
  const Doubles zero(0.0), unit(1.0), margin(rules.margin);
  const Points apart = (one.p + a * one.along) - (other.p + b * other.along);
  const Doubles distance = length_of(apart), over = unit / distance;
  const auto is_far = distance > Doubles(line_limits::least_distance);
  const Points n{lanes::select(is_far, over * apart.x, zero), lanes::select(is_far, over * apart.y, unit),
                 lanes::select(is_far, over * apart.z, zero)};
  const Doubles gap = distance - one.radius - other.radius;
  Points shift{zero, zero, zero};
  shift = shift + (unit - a) * one.p_by;
  shift = shift + a * one.q_by;
  shift = shift + (zero - (unit - b)) * other.p_by;
  shift = shift + (zero - b) * other.q_by;
  const Doubles closing = dot(n, shift);
  const auto touch = among && (gap <= margin + Doubles(line_limits::reach) * (one.moves + other.moves)) &&
                     (gap + closing <= margin + Doubles(line_limits::spread) * length_of(shift));
  gap.store_aligned(out.gap);
  n.x.store_aligned(out.x);
  n.y.store_aligned(out.y);
  n.z.store_aligned(out.z);
  a.store_aligned(out.a);
  b.store_aligned(out.b);
  closing.store_aligned(out.closing);
  out.set = bits_of(touch);
  out.count = bits_of(among);
  return gap;
}

/// Finds the touches of the pairs of a vector. Returns the lanes that have any.
PLUMB_INLINE std::uint32_t find_vector_of_touches(const Lines& one, const Lines& other,
                                                  const LineRules& rules, TouchColumns* out) {
  using namespace line_limits;
  const Doubles zero(0.0), half(0.5), least(least_square);
  const Points &u = one.along, &v = other.along, r = one.p - other.p;
  const Doubles uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  const Doubles area = uu * vv - uv * uv;
  const auto both = (uu > least) && (vv > least);
  const auto crosses = area > Doubles(least_area) * uu * vv;
  Doubles s = lanes::select(crosses, to_share((uv * vr - vv * ur) / area), half);
  s = lanes::select(both, s, zero);
  const Doubles t = lanes::select(vv > least, to_share((uv * s + vr) / vv), zero);
  s = lanes::select(uu > least, to_share((uv * t - ur) / uu), s);
  const auto all = zero == zero;
  const Doubles gap = find_touches_at(one, other, {s, t}, rules, all, out[0]);
  out[1].set = out[2].set = out[1].count = out[2].count = 0;
  const Doubles reach_of_pair = Doubles(rules.margin) + Doubles(reach) * (one.moves + other.moves);
  const auto lie_along =
      (gap <= reach_of_pair) && (uu != zero) && (vv != zero) && (uv * uv >= Doubles(along) * uu * vv);
  if (!lanes::any(lie_along)) return out[0].set;
  const Doubles ends[2] = {to_share(dot(other.p - one.p, u) / uu), to_share(dot(other.q - one.p, u) / uu)};
  const auto parts = lie_along && (lanes::abs(ends[0] - ends[1]) > Doubles(least_part));
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Doubles& end = ends[k];
    const auto counts = parts && (lanes::abs(end - s) > Doubles(least_part));
    const Points at = one.p + end * u;
    const Doubles place = lanes::select(vv > least, to_share(dot(v, at - other.p) / vv), zero);
    find_touches_at(one, other, {end, place}, rules, counts, out[1 + k]);
  }
  return out[0].set | out[1].set | out[2].set;
}

/// Pairs that are not far apart, of those that are looked at at once.
struct NearLines {
  const double *one[most_line_pairs + line_lanes], *other[most_line_pairs + line_lanes];
  std::uint32_t pair[most_line_pairs], count = 0;
  bool is_fast[most_line_pairs];

  PLUMB_INLINE void add(const double* a, const double* b, std::uint32_t number, bool fast) {
    one[count] = a;
    other[count] = b;
    pair[count] = number;
    is_fast[count++] = fast;
  }
  /// Fills the last vector.
  PLUMB_INLINE void pad() {
    for (std::uint32_t k = 0; k < line_lanes && count > 0; ++k) {
      one[count + k] = one[count - 1];
      other[count + k] = other[count - 1];
    }
  }
};

PLUMB_INLINE void find_near_lines(const double* lines, const LinePair* pairs, std::uint32_t count,
                                  const LineRules& rules, NearLines& near) {
  for (std::uint32_t first = 0; first < count; first += line_lanes) {
    const double *one[line_lanes], *other[line_lanes];
    for (std::uint32_t lane = 0; lane < line_lanes; ++lane) {
      const LinePair& pair = pairs[first + lane < count ? first + lane : count - 1];
      one[lane] = lines + std::size_t{pair.one} * line_fields::count;
      other[lane] = lines + std::size_t{pair.other} * line_fields::count;
    }
    const Lines a(one), b(other);
    const Doubles reach = Doubles(rules.margin) + Doubles(line_limits::reach) * (a.moves + b.moves);
    const std::uint32_t apart = bits_of(are_lines_apart(a, b, reach)), fast = find_fast_lines(a, b, rules);
    for (std::uint32_t lane = 0; lane < line_lanes && first + lane < count; ++lane)
      if ((apart >> lane & 1) == 0) near.add(one[lane], other[lane], first + lane, (fast >> lane & 1) != 0);
  }
  near.pad();
}

inline std::uint32_t find_line_touches(const double* lines, const LinePair* pairs, std::uint32_t count,
                                       const LineRules& rules, LineTouch* out) {
  NearLines near;
  find_near_lines(lines, pairs, count, rules, near);
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < near.count; first += line_lanes) {
    TouchColumns at[most_line_touches];
    const std::uint32_t any =
        find_vector_of_touches(Lines(near.one + first), Lines(near.other + first), rules, at);
    for (std::uint32_t lane = 0; lane < line_lanes && first + lane < near.count; ++lane) {
      const std::uint32_t pair = near.pair[first + lane];
      if (near.is_fast[first + lane]) {
        out[found].pair = pair;
        out[found++].which = LineTouch::fast;
        continue;
      }
      if ((any >> lane & 1) == 0) continue;
      std::uint32_t which = 0;
      for (const TouchColumns& each : at) {
        if ((each.set >> lane & 1) != 0) out[found++] = each.of(lane, pair, which);
        which += each.count >> lane & 1;
      }
    }
  }
  return found;
}

constexpr LineKernels line_kernels = {find_line_touches};

}  // namespace
}  // namespace plumb::simd
