#pragma once

// This is the equation of a rod that gives (plumb::RodLaw) in a Newton step, for V = one number or a vector
// of lanes. The file before this one defines select_nonzero, select_positive, larger and root.
//
// A rod's multiplier mu pulls its end along d + theta e, at a length between l0 at the start of the substep
// and l1 at its end. With c = l - L the law says
//
//   mu l + psi(c1) = 0,   l = (1 - theta) l0 + theta l1,   psi = s c1 + before.
//
// The equation is kept divided by 1 + s, so that it is one for rods that are broken (s = 0), give or are
// rigid (s infinite). With U = s/(1 + s), Q = 1/(1 + s) and W = U c0 + Q before it says
//
//   Q mu l + U (l1 - l0) + W = 0.
//
// Newton's method is on mu + psi/l = 0, which is linear in mu. Its row is multiplied by Q l l1 (l0 +
// l1)/2L^2. Then it needs one root and no division, since (l1 - l0) (l1 + l0) is what the square of the
// length has grown by. U, Q and W have the factor 1/2L^2 below.
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

#include "simd/inline.hpp"
#include "simd/tree/tree_kernels.hpp"

namespace plumb::simd {
namespace {

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
/// These numbers of a rod hold as long as its substeps are alike, see tree_fields::law_step.
template <class V>
struct LawStep {
  V slope;   ///< U/2L^2, in 1/m^2.
  V give;    ///< Q/2L^2, in 1/m^2.
  V weight;  ///< What W takes of c0, divided by 2L^2, in 1/m^2.
  V length;  ///< L, in m.
  V kept;    ///< What is left of a kick for the end of a substep, over what it was, in 1/s.
};
/// These numbers of a rod hold for one substep, see tree_fields::law_start.
template <class V>
struct LawStart {
  V length;  ///< l0, in m.
  V before;  ///< W/2L^2, in 1/m.
  V excess;  ///< c0, in m.
  V left;    ///< What `before` has of the last substep's kick, of gradient old, in 1/m.
};

/// Returns how much of a rod's own swing a substep of gradient old resolves: all of it up to h omega = 1, and
/// then less. `substep` is 0 for other gradients, which ask nobody.
template <class V>
PLUMB_INLINE V resolved(const LawNumbers<V>& law, const V& substep) {
  const V one(1);
  return one / (one + larger(substep * substep * law.frequency2 - one, V(0)));
}

/// Makes a rod of the squared length `length2` (m²) ready for substeps with these factors.
template <class V>
PLUMB_INLINE LawStep<V> law_step(const LawNumbers<V>& law, const LawFactors<V>& factors, const V& length2) {
  const V zero(0), one(1), half(0.5f), length = root(length2);
  const V scale = half / select_nonzero(length2, length2, one);  // where there is no rod it has none
  // What the substep before left of its kick to the end of it is in half_kick, and the rest is here.
  const V kick = factors.kick - factors.kick_back * resolved(law, factors.substep_before);
  const V now = resolved(law, factors.substep);
  const V pull = kick * law.stiffness, damps = kick * factors.rate * law.damping;
  const V share = factors.share + half * (one - now), slope = pull * share + damps;
  const V give = scale / (one + slope);
  const V kept = half * factors.substep * now / select_nonzero(kick, kick, one);
  const V of_start = give * (slope + (pull * (one - share) - damps));
  return {select_nonzero(law.rigid, scale, give * slope), select_nonzero(law.rigid, zero, give),
          select_nonzero(law.rigid, scale, of_start), length, select_nonzero(law.rigid, zero, kept)};
}

/// Begins a substep of a rod of the squared length `length2`, which is `violation` = C off its own (both m²).
template <class V>
PLUMB_INLINE LawStart<V> start_law(const LawStep<V>& step, const V& length2, const V& violation) {
  const V length = root(length2);
  // C = (l^2 - L^2)/2 = (l - L)(l + L)/2
  const V excess = (violation + violation) / (length + step.length);
  return {length, step.weight * excess, excess, V(0)};
}
/// A cable takes of c0 the positive part into account. Its length is that of the middle of the substep, until
/// when `paid` (m) of it was paid out, and as much will be afterwards. Damping resists the growth of the
/// distance of its ends, as that of other rods does.
template <class V>
PLUMB_INLINE LawStart<V> start_cable(const LawNumbers<V>& law, const LawStep<V>& step,
                                     const LawStart<V>& start, const V& paid) {
  const V excess = start.excess + select_nonzero(law.one_sided, paid, V(0));
  const V taut = larger(excess, V(0)), past = step.weight - step.slope;
  const V cable = step.slope * excess + past * taut + (step.slope - past) * paid;
  return {start.length, select_nonzero(law.one_sided, cable, start.before), excess, start.left};
}

/// Adds what the last substep has left of its kick, with gradient old.
template <class V>
PLUMB_INLINE void add_kick(const LawStep<V>& step, const V& left, LawStart<V>& start) {
  start.left = step.give * left;
  start.before = start.before + start.left;
}

/// Returns the half of a kick that a rod with the multiplier mu leaves for the end of a substep of gradient
/// old, as far as the substep resolves its swing. `half_kick` is that of the substep before, and
/// `kick_before` is that of the factors.
template <class V>
PLUMB_INLINE V end_law(const LawStep<V>& step, const V& length, const V& kick_before, const V& half_kick,
                       const V& mu) {
  return step.kept * ((V(0) - mu * length) - kick_before * half_kick);
}

/// This is where a rod is at an iterate of Newton's method: l1^2 - l0^2 and C at l1 (both m²), and its
/// multiplier.
template <class V>
struct LawIterate {
  V growth, violation, mu;
};
/// A row of Newton's matrix is  use b . (change of e) + soft (change of mu) = -c.
template <class V>
struct LawRow {
  V use, soft, c;
};

/// Returns psi and its derivative for a cable, both times Q/2L^2. A cable never pushes. But where composed
/// substeps turn back, what the last one has left acts the other way, and must not be lost.
template <class V>
struct Pull {
  V psi, slope;
};
template <class V>
PLUMB_INLINE Pull<V> cable_pull(const V& step_slope, const LawStart<V>& start, const V& excess, bool is_mid) {
  const V zero(0), one(1);
  const V taut = larger(excess, zero), taut_before = larger(start.excess, zero);
  const V least = start.left - larger(start.left, zero);
  const V pull = larger(step_slope * taut + (start.before - step_slope * start.excess), least);
  const V slope = select_positive(pull - least, select_positive(excess, step_slope, zero), zero);
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

/// Returns l1 of a rod of the length l0 whose squared length has grown by `growth` (m²).
template <class V>
PLUMB_INLINE V end_length(const V& length, const V& growth) {
  return root(larger(length * length + growth, V(0)));
}

/// A rod that is no cable has these numbers in a Newton step, see tree_fields::law_start. Lines of gradient
/// old have them multiplied by l0 (before and slope) and by its square (give), so that they multiply less
/// later.
template <class V>
struct LawTerms {
  V length, before, slope, give;
};
template <class V>
PLUMB_INLINE LawTerms<V> law_terms(const LawStep<V>& step, const LawStart<V>& start, bool is_line) {
  const LawTerms<V> terms{start.length, start.before, step.slope, step.give};
  if (!is_line) return terms;
  return {terms.length, terms.before * terms.length, terms.slope * terms.length,
          terms.give * (terms.length * terms.length)};
}

/// This is a rod in the middle of a Newton step: its length l1, l0 + l1 and l (m).
template <class V>
struct LawSpan {
  V end, sum, along;
};
template <bool is_old, class V>
PLUMB_INLINE LawSpan<V> law_span(const V& length, const V& growth, const V& theta) {
  const V end = end_length(length, growth);
  return {end, length + end, is_old ? length : length + theta * (end - length)};
}

/// Returns the row of a rod whose psi times l0 + l1 is `psi`, and grows with l1 by `slope`, both times
/// Q/2L^2.
template <bool is_old, class V>
PLUMB_INLINE LawRow<V> row_of(const LawSpan<V>& span, const Pull<V>& pull, const V& give, const V& mu,
                              const V& theta) {
  const V over = span.end * span.along, scale = span.sum * span.along, gives = scale * give;
  const V use = is_old ? scale * pull.slope : larger(scale * pull.slope - theta * pull.psi, V(0));
  return {use, over * gives, over * (pull.psi + mu * gives)};
}

/// Returns the row of a rod that is no cable.
template <class V>
PLUMB_INLINE LawRow<V> law_row(const LawTerms<V>& rod, const V& growth, const V& mu, const V& theta) {
  const LawSpan<V> span = law_span<false>(rod.length, growth, theta);
  return row_of<false>(span, {rod.slope * growth + span.sum * rod.before, rod.slope}, rod.give, mu, theta);
}
/// Returns the same of a line with gradient old, whose terms are multiplied. Where there is no rod all of
/// them are 0, and so is the row.
template <class V>
PLUMB_INLINE LawRow<V> line_law_row(const LawTerms<V>& rod, const V& growth, const V& mu) {
  const V end = end_length(rod.length, growth), sum = rod.length + end, gives = sum * rod.give;
  return {sum * rod.slope, end * gives, end * (rod.slope * growth + (sum * rod.before + mu * gives))};
}

/// A substep's gradient, and what a cable pays out in half of it, see start_cable().
template <class V>
struct CableSubstep {
  V theta, paid;
  bool is_mid;
};
/// Returns the row of a rod among which some are cables, for every lane as its law asks.
template <bool is_old, class V>
PLUMB_INLINE LawRow<V> cable_row(const LawNumbers<V>& law, const LawStep<V>& step, const LawStart<V>& start,
                                 const LawIterate<V>& iterate, const CableSubstep<V>& substep) {
  const auto [growth, violation, mu] = iterate;
  const auto [theta, paid, is_mid] = substep;
  const V zero(0), one(1);
  const LawSpan<V> span = law_span<is_old>(start.length, growth, theta);
  const Pull<V> cable =
      cable_pull(step.slope, start, start.excess + growth / span.sum - (paid + paid), is_mid);
  const Pull<V> pull{
      select_nonzero(law.one_sided, span.sum * cable.psi, step.slope * growth + span.sum * start.before),
      select_nonzero(law.one_sided, cable.slope, step.slope)};
  const LawRow<V> row = row_of<is_old>(span, pull, step.give, mu, theta);
  // A slack cable has the row of its multiplier. A rigid one is taut where it would be too long or pulls.
  const V gives = span.end * span.along * (span.sum * span.along) * step.give;
  const V taut = select_nonzero(law.rigid, violation - mu * (start.length * start.length), row.use);
  const LawRow<V> of_taut{select_nonzero(law.rigid, one, row.use), select_nonzero(law.rigid, zero, row.soft),
                          select_nonzero(law.rigid, violation, row.c)};
  const V rest = select_nonzero(law.rigid, mu, row.c / select_nonzero(gives, gives, one));
  return {select_nonzero(law.one_sided, select_positive(taut, of_taut.use, zero), row.use),
          select_nonzero(law.one_sided, select_positive(taut, of_taut.soft, one), row.soft),
          select_nonzero(law.one_sided, select_positive(taut, of_taut.c, rest), row.c)};
}

/// Rods whose swing is resolved resist no velocity. In a projection of velocities they pull with a multiplier
/// that is known, and slack cables do not pull. The less is resolved, the more a rod also resists as rigid
/// ones do. It pulls with its whole half kick all the same, not only with what it kept of it, so that rods at
/// rest bear their load without a velocity. A rigid cable is taut if it pulled last. `rate` (m/s) is that of
/// a rigid rod's length.
template <class V>
struct KnownPull {
  V mu;
  LawRow<V> row;
};
/// This is what a rod brings to a projection: its squared length (m²), the rate at which half of that grows
/// (m²/s), its last multiplier, and what it has kept of its kick.
template <class V>
struct LawMotion {
  V length2, c, rate, last_mu, half_kick;
};
template <class V>
PLUMB_INLINE KnownPull<V> known_pull(const LawNumbers<V>& law, const LawFactors<V>& factors,
                                     const LawMotion<V>& motion) {
  const V zero(0), one(1), length = root(motion.length2);
  const V seen = resolved(law, factors.substep);
  const V stiff = select_nonzero(law.rigid, one, one - seen);
  const V holds = select_nonzero(law.one_sided, select_positive(zero - motion.last_mu, stiff, zero), stiff);
  const V give = select_nonzero(law.rigid, one, motion.length2);
  const V off = motion.c - length * motion.rate;
  return {select_nonzero(law.rigid, zero, zero - factors.kick_before * motion.half_kick / (length * seen)),
          {holds, (one - holds) * give, holds * off}};
}

}  // namespace
}  // namespace plumb::simd
