#pragma once

// This is the equation of a rod that gives (plumb::RodLaw) in a Newton step, for V = one number or a vector
// of lanes. The file before this one defines select_nonzero, select_positive, larger and root.
//
// A rod's multiplier mu pulls its end along d + theta e, at a length between l0 at the start of the substep
// and l1 at its end. With c = l - L the law says
//
//   mu l + psi(c1) = 0,   l = (1 - theta) l0 + theta l1,   psi = slope c1 + before.
//
// Trees take these functions in lanes, and islands with loops take them one rod after the other.
//
// A cable takes the positive parts of c, psi and, with gradient mid, the share of c that it was taut in. Then
// psi is the change of its energy over the change of c (Gonzalez 1996), which mid keeps to rounding.
//
// Gradient old takes k/2 ((c0 + c1)/2)^2 for the potential of a substep, which makes it variational (Marsden,
// West 2001). A rod pulls along d by half of its kick where the substep starts, and by the other half where
// it ends. Rods too stiff for the substep would swing for ever, though, and gain energy where their
// directions change. They take more of c1 than of c0, which damps what no substep resolves, and give their
// whole kick at the start. In the limit they are those of SHAKE.

#include "simd/tree/tree_kernels.hpp"

namespace plumb::simd {
namespace {

#define PLUMB_LAW_INLINE inline __attribute__((always_inline))

/// These numbers of a rod never change, see tree_fields::law.
template <class V>
struct LawNumbers {
  V stiffness, damping, rigid, one_sided, frequency2;
};
/// These are the same for all rods in a substep, see law_factors.
template <class V>
struct LawFactors {
  V share, kick, kick_back, kick_before, rate, substep, substep_before;
};
/// These numbers of a rod hold for one substep, see tree_fields::law_start.
template <class V>
struct LawStart {
  V length;  ///< l0, in m.
  V excess;  ///< c0, in m.
  V slope;   ///< psi grows by it with c1.
  V before;  ///< psi if c1 is 0, in m times the unit of mu.
};

/// Returns `value` of a rod that pushes, too, and the positive part of it of a cable.
template <class V>
PLUMB_LAW_INLINE V taut_part(const LawNumbers<V>& law, const V& value) {
  return select_nonzero(law.one_sided, larger(value, V(0)), value);
}

/// Returns how much of a rod's own swing a substep of gradient old resolves: all of it up to h omega = 1, and
/// then less. `substep` is 0 for other gradients, which ask nobody.
template <class V>
PLUMB_LAW_INLINE V resolved(const LawNumbers<V>& law, const V& substep) {
  const V one(1);
  return one / (one + larger(substep * substep * law.frequency2 - one, V(0)));
}

/// Returns the weight (s^2) of a rod's pull in this substep. What the substep before left of its kick to the
/// end of it is in half_kick, and the rest is here.
template <class V>
PLUMB_LAW_INLINE V own_kick(const LawNumbers<V>& law, const LawFactors<V>& factors) {
  return factors.kick - factors.kick_back * resolved(law, factors.substep_before);
}

/// Begins a substep of a rod of the squared length `length2`, which is `violation` = C off its own (both m²).
template <class V>
PLUMB_LAW_INLINE LawStart<V> start_law(const LawNumbers<V>& law, const LawFactors<V>& factors,
                                       const V& half_kick, const V& length2, const V& violation) {
  const V twice = violation + violation, length = root(length2), one(1), half(0.5f);
  // C = (l^2 - L^2)/2 = (l - L)(l + L)/2
  const V excess = twice / (length + root(larger(length2 - twice, V(0))));
  const V kick = own_kick(law, factors), pull = kick * law.stiffness;
  const V damps = kick * factors.rate * law.damping;
  const V share = factors.share + half * (one - resolved(law, factors.substep));
  return {length, excess, pull * share + damps,
          (pull * (one - share) - damps) * taut_part(law, excess) + factors.kick_before * half_kick};
}

/// Returns l1 of a rod whose squared length has grown by `growth` (m²).
template <class V>
PLUMB_LAW_INLINE V end_length(const LawStart<V>& start, const V& growth) {
  return root(larger(start.length * start.length + growth, V(0)));
}

/// Returns the half of a kick that a rod with the multiplier mu leaves for the end of a substep of gradient
/// old, as far as the substep resolves its swing. `half_kick` is that of the substep before. Other gradients
/// leave none (factors.substep = 0).
template <class V>
PLUMB_LAW_INLINE V end_law(const LawNumbers<V>& law, const LawFactors<V>& factors, const LawStart<V>& start,
                           const V& half_kick, const V& mu) {
  const V own = (V(0) - mu * start.length) - factors.kick_before * half_kick, kick = own_kick(law, factors);
  const V kept = V(0.5f) * factors.substep * resolved(law, factors.substep);
  return kept * own / select_nonzero(kick, kick, V(1));
}

/// This is where a rod is at an iterate of Newton's method: l1^2 - l0^2 and C at l1 (both m²), and its
/// multiplier.
template <class V>
struct LawIterate {
  V growth, violation, mu;
};
/// These say of all rods of a substep whether some are cables, and whether its gradient is mid.
struct LawKind {
  bool has_cables, is_mid;
};

/// A row of Newton's matrix is  use b . (change of e) + soft (change of mu) = -c.
template <class V>
struct LawRow {
  V use, soft, c;
};

/// Returns psi and its derivative for a cable.
template <class V>
struct Pull {
  V psi, slope;
};
template <class V>
PLUMB_LAW_INLINE Pull<V> cable_pull(const LawStart<V>& start, const V& excess, bool is_mid) {
  const V zero(0), one(1);
  const V taut = larger(excess, zero), taut_before = larger(start.excess, zero);
  const V pull = larger(start.slope * taut + start.before, zero);
  const V slope = select_positive(pull, select_positive(excess, start.slope, zero), zero);
  if (!is_mid) return {pull, slope};
  const V change = excess - start.excess;
  const V over = one / select_nonzero(change, change, one);
  // The share is 1 where the cable is taut all the time. Its derivative is not 0 where it is so for a part.
  const V share = select_nonzero(change, (taut - taut_before) * over, select_positive(excess, one, zero));
  const V from_slack = zero - start.excess * over * over, from_taut = start.excess * over * over;
  const V share_slope = select_positive(excess, select_positive(start.excess, zero, from_slack),
                                        select_positive(start.excess, from_taut, zero));
  return {pull * share, slope * share + pull * share_slope};
}

/// Returns the row of an elastic rod, or of a broken one, whose psi is 0. `end` is l1, `excess` is c1.
template <class V>
PLUMB_LAW_INLINE LawRow<V> elastic_row(const LawStart<V>& start, const Pull<V>& pull, const V& end,
                                       const V& mu, const V& theta) {
  const V zero(0), one(1);
  const V length = start.length + theta * (end - start.length);
  const V phi = pull.psi / length;
  const V rest = mu + phi, slope = pull.slope - theta * phi;
  const V soft = end * length / select_positive(slope, slope, one);
  return {select_positive(slope, one, zero), select_positive(slope, soft, one),
          select_positive(slope, soft * rest, rest)};
}

/// Returns the row of a rod in a substep, for every lane as its law asks.
template <class V>
PLUMB_LAW_INLINE LawRow<V> law_row(const LawNumbers<V>& law, const LawStart<V>& start,
                                   const LawIterate<V>& iterate, const V& theta, LawKind kind) {
  const auto [growth, violation, mu] = iterate;
  const V zero(0), one(1);
  const V end = end_length(start, growth), excess = start.excess + growth / (start.length + end);
  Pull<V> pull{start.slope * excess + start.before, start.slope};
  LawRow<V> stiff{one, zero, violation};
  if (kind.has_cables) {
    const Pull<V> cable = cable_pull(start, excess, kind.is_mid);
    pull.psi = select_nonzero(law.one_sided, cable.psi, pull.psi);
    pull.slope = select_nonzero(law.one_sided, cable.slope, pull.slope);
    // A rigid cable is taut where it would be too long or pulls.
    const V taut = select_nonzero(law.one_sided, violation - mu * (start.length * start.length), one);
    stiff = {select_positive(taut, one, zero), select_positive(taut, zero, one),
             select_positive(taut, violation, mu)};
  }
  const LawRow<V> soft = elastic_row(start, pull, end, mu, theta);
  return {select_nonzero(law.rigid, stiff.use, soft.use), select_nonzero(law.rigid, stiff.soft, soft.soft),
          select_nonzero(law.rigid, stiff.c, soft.c)};
}

/// Rods whose swing is resolved resist no velocity. In a projection of velocities they pull with a multiplier
/// that is known, and slack cables do not pull. The less is resolved, the more a rod resists as rigid ones
/// do. A rigid cable is taut if it pulled last. The slope of a rigid rod is its length times the rate of
/// that, where its length changes.
template <class V>
struct KnownPull {
  V mu;
  LawRow<V> row;
};
template <class V>
PLUMB_LAW_INLINE KnownPull<V> known_pull(const LawNumbers<V>& law, const LawFactors<V>& factors,
                                         const LawStart<V>& start, const V& c, const V& last_mu) {
  const V zero(0), one(1);
  const V stiff = select_nonzero(law.rigid, one, one - resolved(law, factors.substep));
  const V holds = select_nonzero(law.one_sided, select_positive(zero - last_mu, stiff, zero), stiff);
  const V give = select_nonzero(law.rigid, one, start.length * start.length);
  return {select_nonzero(law.rigid, zero, zero - start.before / start.length),
          {holds, (one - holds) * give, holds * (c - start.slope)}};
}

}  // namespace
}  // namespace plumb::simd
