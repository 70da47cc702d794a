// These loops come before and after Newton's method in a substep of trees. This file is included after
// tree_lanes.hpp and bent_lanes.hpp.

namespace plumb::simd {
namespace {

/// A rod goes from `from` to `to` (m) and violates its length by C (m²). Both are made in double.
template <class V>
struct RodVector {
  Vec<V> d;
  V violation;
};
template <class V, std::size_t lanes>
PLUMB_INLINE RodVector<V> rod_vector(const double* from, const double* to, const double* length2) {
  const auto dx = load_wide<V>(to) - load_wide<V>(from),
             dy = load_wide<V>(to + lanes) - load_wide<V>(from + lanes),
             dz = load_wide<V>(to + 2 * lanes) - load_wide<V>(from + 2 * lanes);
  return {{narrow<V>(dx), narrow<V>(dy), narrow<V>(dz)},
          narrow<V>(0.5 * (((dx * dx + dy * dy) + dz * dz) - load_wide<V>(length2)))};
}

template <class V, class At, class T>
PLUMB_INLINE void prepare_rod(const At& at, const double* from, const double* to, const double* length2,
                              T* rods, std::size_t i) {
  const RodVector<V> rod = rod_vector<V, At::stride>(from, to, length2);
  at.put3(rods, i * tree_fields::rod, rod.d);
  at.put(rods, i * tree_fields::rod + 3, rod.violation);
}

template <class V, class T, class At>
PLUMB_INLINE void guess_multiplier(const At& at, const V& scale, const V& scale_before, T* mu, T* mu_before,
                                   std::size_t i) {
  const V last = at.get(mu, i), before = at.get(mu_before, i);
  at.put(mu_before, i, last);
  at.put(mu, i, scale * last + scale_before * before);
}

/// Makes the start of the law of rod i of `arrays` from its tree_fields::rod numbers in `rods`.
template <class V, class T, class At>
PLUMB_INLINE void prepare_law(const TreeView<T>& tree, const At& at, const T* rods, const double* length2,
                              const LawArrays<T>& arrays, std::size_t i) {
  if (tree.makes_law_steps) {
    const LawStep<V> made = law_step(law_numbers<V>(at, arrays.law, i), law_factors_of<V>(tree, at),
                                     narrow<V>(load_wide<V>(length2)));
    const std::size_t f = i * tree_fields::law_step;
    at.put(arrays.step, f, made.slope);
    at.put(arrays.step, f + 1, made.give);
    at.put(arrays.step, f + 2, made.weight);
    at.put(arrays.step, f + 3, made.length);
    at.put(arrays.step, f + 4, made.kept);
  }
  const LawStep<V> step = law_step<V>(at, arrays.step, i);
  const Vec<V> d = at.get3(rods, i * tree_fields::rod);
  LawStart<V> start = start_law(step, dot(d, d), at.get(rods, i * tree_fields::rod + 3));
  if (tree.has_cables)
    start = start_cable(law_numbers<V>(at, arrays.law, i), step, start, paid_out<V>(tree, at, arrays, i));
  if (tree.keeps_half_kicks)
    add_kick(step, at.get(tree.law_factors, law_factors::kick_before) * at.get(arrays.half_kick, i), start);
  const std::size_t f = i * tree_fields::law_start;
  const LawTerms<V> terms = law_terms(step, start, tree.is_line);
  at.put(arrays.start, f, start.length);
  at.put(arrays.start, f + 1, tree.has_cables ? start.before : terms.before);
  at.put(arrays.start, f + 2, tree.has_cables ? start.excess : terms.slope);
  at.put(arrays.start, f + 3, tree.has_cables ? start.left : terms.give);
}
/// Keeps what is left of the kicks of all rods for the next substep.
template <class V, std::size_t lanes, class T>
PLUMB_INLINE void keep_half_kicks(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const V active = at.get(tree.active, 0);
  const V kick_before = at.get(tree.law_factors, law_factors::kick_before);
  const auto keep = [&](const LawArrays<T>& arrays, const T* mu, std::size_t i) {
    const V last = at.get(arrays.half_kick, i);
    const V kept = end_law(law_step<V>(at, arrays.step, i), at.get(arrays.start, i * tree_fields::law_start),
                           kick_before, last, at.get(mu, i));
    at.put(arrays.half_kick, i, select_nonzero(active, kept, last));
  };
  for (std::size_t i = 1; i < tree.nodes; ++i) keep(rod_laws(tree), tree.mu, i);
  for (std::size_t k = 0; k < tree.tie_begin[tree.nodes]; ++k) keep(tie_laws(tree), tree.tie_mu, k);
}

/// Does what TreeKernels::prepare() says, with masses that couple the ends of rods or without.
template <bool coupled, class V, std::size_t lanes, class T>
PLUMB_INLINE void prepare_nodes(const TreeView<T>& tree, std::size_t lane) {
  using namespace tree_fields;
  const At<V, T, lanes> at{lane};
  const V ratio = at.get(tree.ratio, 0), kick = at.get(tree.kick, 0);
  const V scale = at.get(tree.mu_scale, 0), scale_before = at.get(tree.mu_scale_before, 0);
  const V guess = at.get(tree.guess, 0), guess_before = at.get(tree.guess_before, 0);
  const auto place = [&](const double* data, std::size_t entry) { return data + entry * lanes + lane; };
  for (std::size_t i = 0; i < tree.nodes; ++i) {
    if (tree.guesses_multipliers) guess_multiplier(at, scale, scale_before, tree.mu, tree.mu_before, i);
    const Vec<V> u = ratio * at.get3(tree.u, 3 * i);
    if (tree.guesses)
      at.put3(tree.delta, 3 * i,
              (u + guess * at.get3(tree.acceleration, 3 * i)) +
                  guess_before * at.get3(tree.acceleration_before, 3 * i));
    Vec<V> load = at.get(tree.node, node * i) * u + kick * at.get3(tree.force, 3 * i);
    for (std::size_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) {
      if (tree.guesses_multipliers)
        guess_multiplier(at, scale, scale_before, tree.tie_mu, tree.tie_mu_before, k);
      if constexpr (coupled) load = load + at.get(tree.tie, tie * k) * at.get3(tree.tie_u, 3 * k);
      prepare_rod<V>(at, place(tree.tie_x, 3 * k), place(tree.x, 3 * i), place(tree.tie_length2, k),
                     tree.tie_rod, k);
      if (tree.has_laws)
        prepare_law<V>(tree, at, tree.tie_rod, place(tree.tie_length2, k), tie_laws(tree), k);
    }
    if (i > 0) {
      const std::size_t p = tree.parent[i];
      prepare_rod<V>(at, place(tree.x, 3 * p), place(tree.x, 3 * i), place(tree.length2, i), tree.rod, i);
      if (tree.has_laws) prepare_law<V>(tree, at, tree.rod, place(tree.length2, i), rod_laws(tree), i);
      if constexpr (coupled) {
        const V coupling = at.get(tree.node, node * i + 1);
        load = load + coupling * (ratio * at.get3(tree.u, 3 * p));
        at.put3(tree.load, 3 * p, at.get3(tree.load, 3 * p) + coupling * u);
      }
    }
    at.put3(tree.load, 3 * i, load);
  }
}

template <class V, std::size_t lanes, class T>
PLUMB_INLINE void prepare_lanes(const TreeView<T>& tree, std::size_t lane) {
  if constexpr (bends_in<T>)
    if (tree.has_bends) prepare_bends<V, lanes>(tree, lane);
  if (tree.is_coupled)
    prepare_nodes<true, V, lanes>(tree, lane);
  else
    prepare_nodes<false, V, lanes>(tree, lane);
}

/// Does what TreeKernels::find_stiffness() says, from the tips to the root.
template <class V, std::size_t lanes, class T>
PLUMB_INLINE void find_stiffness_lanes(const TreeView<T>& tree, std::size_t lane) {
  using namespace tree_fields;
  const At<V, T, lanes> at{lane};
  const auto magnitude = [](const V& mu) { return larger(mu, V(0) - mu); };
  for (std::size_t slot = 0; slot < tree.below_slots; ++slot) at.put(tree.below, slot * below, V(0));
  V largest(0), carried(0);  // carried comes from i + 1 if i is its parent
  for (std::size_t i = tree.nodes; i-- > 0;) {
    V pull = carried;
    carried = V(0);
    if (tree.below_slot[i] != no_slot) pull = pull + at.get(tree.below, tree.below_slot[i] * below);
    for (std::size_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k)
      pull = pull + magnitude(at.get(tree.tie_mu, k));
    if (i > 0) {
      const std::size_t p = tree.parent[i];
      const V own = magnitude(at.get(tree.mu, i));
      pull = pull + own;
      if (p + 1 == i) {
        carried = own;
      } else {
        const std::size_t slot = tree.below_slot[p] * below;
        at.put(tree.below, slot, at.get(tree.below, slot) + own);
      }
    }
    largest = larger(largest, at.get(tree.node, node * i + 3) * (pull + pull));
  }
  at.put(tree.stiffness, 0, largest);
}

/// Does what TreeKernels::advance() says.
template <class V, std::size_t lanes, class T>
PLUMB_INLINE void advance_lanes(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const V active = at.get(tree.active, 0), ratio = at.get(tree.ratio, 0), over = at.get(tree.inverse_kick, 0);
  const V u_delta = at.get(tree.u_delta, 0), u_before = at.get(tree.u_before, 0);
  if constexpr (bends_in<T>)
    if (tree.twist_end > 0) measure_turn<V, lanes>(tree, lane);
  if (tree.has_laws && tree.keeps_half_kicks) keep_half_kicks<V, lanes>(tree, lane);
  V push(0), jolt(0);
  for (std::size_t i = 0; i < 3 * std::size_t{tree.nodes}; ++i) {
    const V delta = at.get(tree.delta, i), u = at.get(tree.u, i), before = ratio * u;
    if (tree.keeps_acceleration) {
      const V last = at.get(tree.acceleration, i), second_last = at.get(tree.acceleration_before, i);
      const V acceleration = over * (delta - before), change = acceleration - second_last;
      push = push + acceleration * acceleration;
      jolt = jolt + change * change;
      at.put(tree.acceleration_before, i, select_nonzero(active, last, second_last));
      at.put(tree.acceleration, i, select_nonzero(active, acceleration, last));
    }
    at.put(tree.u, i, select_nonzero(active, u_delta * delta - u_before * before, u));
    add_wide(select_nonzero(active, delta, V(0)), tree.x + i * lanes + lane);
  }
  at.put(tree.push, 0, push);
  at.put(tree.jolt, 0, jolt);
}

}  // namespace
}  // namespace plumb::simd
