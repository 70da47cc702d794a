#pragma once

// These functions read the laws of rods that give from the arrays of a tree. tree_lanes.hpp includes this
// file after lane_math.hpp.

#include "simd/tree/law_math.hpp"

namespace plumb::simd {
namespace {

/// What rods are like for which the loops are compiled: all rigid, some that give, some cables among them, or
/// what the tree says.
enum class Laws { none, two_sided, cables, any };

/// Calls f with the constant for a tree.
template <class T, class F>
PLUMB_INLINE void with_laws(const TreeView<T>& tree, F&& f) {
  if (!tree.has_laws) return f.template operator()<Laws::none>();
  if (tree.has_cables) return f.template operator()<Laws::cables>();
  return f.template operator()<Laws::two_sided>();
}

/// The rods to parents, or those to anchors, have these arrays of what gives.
template <class T>
struct LawArrays {
  const T* law;
  T *step, *start, *half_kick;
  const T* mu;
  const double* rate;
};
template <class T>
PLUMB_INLINE LawArrays<T> rod_laws(const TreeView<T>& tree) {
  return {tree.law, tree.law_step, tree.law_start, tree.half_kick, tree.mu, tree.length_rate};
}
template <class T>
PLUMB_INLINE LawArrays<T> tie_laws(const TreeView<T>& tree) {
  return {tree.tie_law,       tree.tie_law_step, tree.tie_law_start,
          tree.tie_half_kick, tree.tie_mu,       tree.tie_length_rate};
}
template <class V, class T, class At>
PLUMB_INLINE LawNumbers<V> law_numbers(const At& at, const T* laws, std::size_t i) {
  const std::size_t f = i * tree_fields::law;
  return {at.get(laws, f), at.get(laws, f + 1), at.get(laws, f + 2), at.get(laws, f + 3),
          at.get(laws, f + 4)};
}
template <class V, class T, class At>
PLUMB_INLINE LawStart<V> law_start(const At& at, const T* starts, std::size_t i) {
  const std::size_t f = i * tree_fields::law_start;
  return {at.get(starts, f), at.get(starts, f + 1), at.get(starts, f + 2), at.get(starts, f + 3)};
}
template <class V, class T, class At>
PLUMB_INLINE LawStep<V> law_step(const At& at, const T* steps, std::size_t i) {
  const std::size_t f = i * tree_fields::law_step;
  return {at.get(steps, f), at.get(steps, f + 1), at.get(steps, f + 2), at.get(steps, f + 3),
          at.get(steps, f + 4)};
}
template <class V, class T, class At>
PLUMB_INLINE LawFactors<V> law_factors_of(const TreeView<T>& tree, const At& at) {
  const T* const from = tree.law_factors;
  return {at.get(from, law_factors::share),         at.get(from, law_factors::kick),
          at.get(from, law_factors::kick_back),     at.get(from, law_factors::kick_before),
          at.get(from, law_factors::rate),          at.get(from, law_factors::substep),
          at.get(from, law_factors::substep_before)};
}
/// Returns by how much the square of the length of a rod along d grows if its ends come apart by e.
template <class V>
PLUMB_INLINE V growth_of(const Vec<V>& d, const Vec<V>& e) {
  const V along = dot(d, e);
  return (along + along) + dot(e, e);
}
template <class V, class T, class At>
PLUMB_INLINE LawTerms<V> law_terms_of(const At& at, const T* starts, std::size_t i) {
  const std::size_t f = i * tree_fields::law_start;
  return {at.get(starts, f), at.get(starts, f + 1), at.get(starts, f + 2), at.get(starts, f + 3)};
}
/// Returns how much a rod pays out in half a substep of gradient mid, in m. Others ask for the mean length
/// alone.
template <class V, class T, class At>
PLUMB_INLINE V paid_out(const TreeView<T>& tree, const At& at, const LawArrays<T>& arrays, std::size_t i) {
  if (!tree.is_mid || !tree.lengths_change) return V(0);
  const V rate = narrow<V>(load_wide<V>(arrays.rate + i * At::stride + at.lane));
  return rate / (V(2) * at.get(tree.law_factors, law_factors::rate));
}
/// Returns the row of rod i of `arrays`. `theta` is 0 if the gradient `is_old`.
template <Laws laws, bool is_old, class V, class T, class At>
PLUMB_INLINE LawRow<V> law_row_of(const TreeView<T>& tree, const At& at, const LawArrays<T>& arrays,
                                  std::size_t i, const LawIterate<V>& iterate, const V& theta) {
  if (laws == Laws::cables || (laws == Laws::any && tree.has_cables))
    return cable_row<is_old>(law_numbers<V>(at, arrays.law, i), law_step<V>(at, arrays.step, i),
                             law_start<V>(at, arrays.start, i), iterate,
                             CableSubstep<V>{theta, paid_out<V>(tree, at, arrays, i), tree.is_mid});
  const LawTerms<V> terms = law_terms_of<V>(at, arrays.start, i);
  if constexpr (is_old) {
    return line_law_row(terms, iterate.growth, iterate.mu);
  } else {
    return law_row(terms, iterate.growth, iterate.mu, theta);
  }
}
template <class V, class T, class At>
PLUMB_INLINE KnownPull<V> known_pull_of(const TreeView<T>& tree, const At& at, const LawArrays<T>& arrays,
                                        std::size_t i, const Vec<V>& d, const V& c) {
  const V rate = narrow<V>(load_wide<V>(arrays.rate + i * At::stride + at.lane));
  return known_pull(law_numbers<V>(at, arrays.law, i), law_factors_of<V>(tree, at),
                    LawMotion<V>{dot(d, d), c, rate, at.get(arrays.mu, i), at.get(arrays.half_kick, i)});
}

}  // namespace
}  // namespace plumb::simd
