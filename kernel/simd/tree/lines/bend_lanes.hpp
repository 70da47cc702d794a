#pragma once

// The law of bends (plumb::Bend) for the loops of trees, with the numbers of one lane or of all. It is that
// of direct/bends/bend_law.hpp, which has branches, and is compared with it by a test. tree_lanes.hpp
// includes this file after lane_math.hpp.

#include "scene/bends/curvature.hpp"

namespace plumb::simd {
namespace {

/// A bend has these numbers (tree_fields::bend). They never change but with the lengths of its rods.
template <class V>
struct BendNumbers {
  V first, middle, last;  ///< Weights of its particles in w, in 1/m, from the root on.
  V stiffness, curvature, damping;
};

/// A substep has these factors for all bends of a lane.
template <class V>
struct BendFactors {
  V kick, damping, theta;
};

/// The pull of a bend, and its derivative by the end of w, by columns.
template <class V>
struct BendPull {
  Vec<V> pull;
  Mat<V> slope;
};

template <class V>
PLUMB_INLINE void add_to_diagonal(Mat<V>& to, const V& kappa) {
  to.v0.x = to.v0.x + kappa;
  to.v1.y = to.v1.y + kappa;
  to.v2.z = to.v2.z + kappa;
}

/// Adds diagonal 1 + u v^T to a matrix given by columns.
template <class V>
PLUMB_INLINE void add_product(Mat<V>& to, const V& diagonal, const Vec<V>& u, const Vec<V>& v) {
  to.v0 = to.v0 + v.x * u;
  to.v1 = to.v1 + v.y * u;
  to.v2 = to.v2 + v.z * u;
  add_to_diagonal(to, diagonal);
}

/// The squared curvature g at q and what its derivatives are made of.
template <class V>
struct CurvatureAt {
  V below;  ///< It is above 0 where the bend is not folded.
  V over;   ///< 1/(1 - q/4), as far as q is below folded.
  V square, slope;
};
template <class V>
PLUMB_INLINE CurvatureAt<V> curvature_at(const V& q) {
  const V below = V(detail::folded) - q;
  const V kept = select_positive(below, q, V(detail::folded));
  const V over = V(1) / (V(1) - V(0.25) * kept);
  return {below, over, kept * over + V(detail::folded_slope) * (q - kept), over * over};
}

/// A quotient (g(q1) - g(q0))/(q1 - q0) and its derivative by q1.
template <class V>
struct CurvatureQuotient {
  V value, slope;
};
template <class V>
PLUMB_INLINE CurvatureQuotient<V> quotient_between(const V& q0, const V& q1, const CurvatureAt<V>& start,
                                                   const CurvatureAt<V>& end) {
  const V none(0), product = start.over * end.over, steepest(detail::folded_slope), change = q1 - q0;
  const V across = (end.square - start.square) / change;
  const V mixed = select_positive(steepest - across, across, steepest);
  const V mixed_slope = (end.slope - mixed) / change;
  const V below_slope = V(0.25) * (product * end.over);
  return {select_positive(start.below, select_positive(end.below, product, mixed),
                          select_positive(end.below, mixed, steepest)),
          select_positive(start.below, select_positive(end.below, below_slope, mixed_slope),
                          select_positive(end.below, mixed_slope, none))};
}

/// Adds damping, see direct/bends/bend_law.cpp.
template <class V>
PLUMB_INLINE void add_bend_damping(const V& damping, const V& theta, const Vec<V>& start,
                                   const Vec<V>& change, BendPull<V>& out) {
  const V least(detail::no_bend_direction), none(0);
  const Vec<V> w = start + theta * change;
  const V q = dot(w, w), s = dot(w, change), m = q + least * dot(change, change);
  const CurvatureAt<V> at = curvature_at(q);
  const V over = select_positive(m, V(1) / m, none), share = s * over, force = damping * (at.over * share);
  out.pull = out.pull + force * w;
  const Vec<V> of_share =
      over * (theta * change + (w - share * ((theta + theta) * w + (least + least) * change)));
  const Vec<V> of_f = select_positive(at.below, V(0.5) * (at.over * theta), none) * w;
  const V still = damping * (theta * theta / (theta * theta + least));
  add_product(out.slope, select_positive(m, force * theta, still), (damping * at.over) * w,
              of_share + share * of_f);
}

/// Returns the pull of a bend whose w goes from `start` by `change` in a substep of gradient mid or new.
template <bool is_mid, class V>
PLUMB_INLINE BendPull<V> bend_pull_of(const BendNumbers<V>& bend, const BendFactors<V>& factors, bool damps,
                                      const Vec<V>& start, const Vec<V>& change) {
  const Vec<V> end = start + change, first = is_mid ? start : end, both = first + end;
  const V q0 = dot(first, first), q1 = dot(end, end), none(0);
  const CurvatureAt<V> at_start = curvature_at(q0), at_end = curvature_at(q1);
  CurvatureQuotient<V> between{at_end.slope,
                               select_positive(at_end.below, V(0.5) * (at_end.slope * at_end.over), none)};
  if constexpr (is_mid) between = quotient_between(q0, q1, at_start, at_end);
  // With E = k/2 (kappa - rest)^2 the quotient is that of g times 1 - 2 rest/(kappa0 + kappa1).
  const V kappa = root(at_end.square), sum = is_mid ? root(at_start.square) + kappa : kappa + kappa;
  const V over = select_positive(sum, V(1) / sum, none), share = (bend.curvature + bend.curvature) * over;
  const V rate = (between.value * share) * (is_mid ? over : over + over);
  const V along = select_positive(kappa, rate * (at_end.slope / kappa), none);
  const Vec<V> gradient = ((between.slope + between.slope) * (V(1) - share) + along) * end;
  const V half = V(0.5) * (factors.kick * bend.stiffness), value = half * (between.value * (V(1) - share));
  const Vec<V> zero{none, none, none};
  BendPull<V> out{value * both, {zero, zero, zero}};
  add_product(out.slope, is_mid ? value : value + value, half * both, gradient);
  if (damps) add_bend_damping(factors.damping * bend.damping, factors.theta, start, change, out);
  return out;
}

}  // namespace
}  // namespace plumb::simd
