// These loops take Newton steps on a line of rods with lumped masses and gradient old. Only the multipliers
// are unknown there, and their matrix is tridiagonal. This file is included after motion_lanes.hpp.
//
// Rod k joins nodes k - 1 and k along d_k. The rod of node 0 and the one beyond the last node are ties; where
// there is none, d = 0. Displacements follow from multipliers,
//
//   delta_k = w_k (load_k + mu_k d_k - mu_{k+1} d_{k+1}),
//
// and with b_k = d_k + delta_k - delta_{k-1} the changes nu of the multipliers solve
//
//   -w_{k-1} (b_k.d_{k-1}) nu_{k-1} + (w_{k-1} + w_k) (b_k.d_k) nu_k - w_k (b_k.d_{k+1}) nu_{k+1} = -C_k.

namespace plumb::simd {
namespace {

/// This is a row of that matrix, with its right-hand side.
template <class V>
struct LineRow {
  V below, diagonal, above, right;
};

/// A rod has its vector d (m), the violation of its length (m²) and its multiplier.
template <class V>
struct LineRod {
  Vec<V> d;
  V violation, mu;
};
/// A node has its load, its displacement (m) and its inverse mass w.
template <class V>
struct LineNode {
  Vec<V> load, delta;
  V w;
};

/// This is a rod with the nodes at its ends, and the rods on either side. If it gives, it has this number
/// among ties or among rods to parents. One that is not there, whose d is 0, has any number.
template <class V>
struct LineSpan {
  const LineRod<V>& last;
  const LineNode<V>& from;
  const LineRod<V>& rod;
  const LineNode<V>& to;
  const LineRod<V>& next;
  bool is_tie;
  std::size_t index;
};

template <Laws laws, class V, class T, class At>
PLUMB_INLINE LineRow<V> line_row(const TreeView<T>& tree, const At& at, const LineSpan<V>& span) {
  const auto& [last, from, rod, to, next, is_tie, index] = span;
  const Vec<V> e = to.delta - from.delta, b = rod.d + e;
  const V violation = rod.violation + (dot(rod.d, e) + V(0.5f) * dot(e, e));
  const V there = dot(rod.d, rod.d);  // a rod that is not there is never violated
  if constexpr (laws == Laws::none) {
    return {V(0) - from.w * dot(b, last.d), (from.w + to.w) * dot(b, rod.d), V(0) - to.w * dot(b, next.d),
            select_nonzero(there, V(0) - violation, V(0))};
  } else {
    const LawRow<V> row = law_row_of<laws, true, V>(tree, at, is_tie ? tie_laws(tree) : rod_laws(tree), index,
                                                    {growth_of(rod.d, e), violation, rod.mu}, V(0));
    const V of_from = row.use * from.w, of_to = row.use * to.w, right = V(0) - row.c;
    return {V(0) - of_from * dot(b, last.d), (of_from + of_to) * dot(b, rod.d) + row.soft,
            V(0) - of_to * dot(b, next.d),
            laws == Laws::two_sided ? right : select_nonzero(there, right, V(0))};
  }
}

template <class V, class T, class At>
PLUMB_INLINE LineRod<V> line_rod(const TreeView<T>& tree, const At& at, std::size_t i) {
  return {at.get3(tree.rod, tree_fields::rod * i), at.get(tree.rod, tree_fields::rod * i + 3),
          at.get(tree.mu, i)};
}
/// Returns the tie at either end of a line, seen along it, or an absent rod.
template <class V, class T, class At>
PLUMB_INLINE LineRod<V> line_tie(const TreeView<T>& tree, const At& at, std::size_t k, bool present,
                                 T direction) {
  if (!present) return {{V(0), V(0), V(0)}, V(0), V(0)};
  return {V(direction) * at.get3(tree.tie_rod, tree_fields::rod * k),
          at.get(tree.tie_rod, tree_fields::rod * k + 3), at.get(tree.tie_mu, k)};
}
template <class V, class T, class At>
PLUMB_INLINE LineNode<V> line_node(const TreeView<T>& tree, const At& at, std::size_t i,
                                   const LineRod<V>& before, const LineRod<V>& after) {
  const Vec<V> load = at.get3(tree.load, 3 * i);
  const V w = at.get(tree.node, tree_fields::node * i + 3);
  return {load, w * ((load + before.mu * before.d) - after.mu * after.d), w};
}
/// Returns a fixed end, which has no inverse mass and is displaced as its anchor is.
template <class V, class T, class At>
PLUMB_INLINE LineNode<V> line_fixed(const TreeView<T>& tree, const At& at, std::size_t k, bool present) {
  const Vec<V> none{V(0), V(0), V(0)};
  return {none, present ? at.get3(tree.tie_delta, 3 * k) : none, V(0)};
}

/// These are the ends of a line that runs from node 0 to the last: whether ties hold them, and the number of
/// the last one.
template <class T>
struct LineEnds {
  explicit LineEnds(const TreeView<T>& tree)
      : nodes(tree.nodes),
        first(tree.tie_begin[1] > 0),
        last(tree.nodes > 1 && tree.tie_begin[tree.nodes] > tree.tie_begin[tree.nodes - 1]),
        last_tie(tree.tie_begin[tree.nodes] - 1) {}
  /// Says whether rod k of the line is a tie, and returns its number among ties or among rods to parents.
  bool is_tie(std::size_t k) const { return (k == 0 && first) || (k == nodes && last); }
  std::size_t number_of(std::size_t k) const { return k == nodes ? (last ? last_tie : 0) : k; }

  std::size_t nodes;
  bool first, last;
  std::size_t last_tie;
};

/// Adds nu to a multiplier of an active lane and returns it.
template <class V, class T, class At>
PLUMB_INLINE V move_multiplier(const At& at, const V& active, T* mu, std::size_t i, const V& nu) {
  const V old = at.get(mu, i), moved = select_nonzero(active, old + nu, old);
  at.put(mu, i, moved);
  return moved;
}

/// Takes a Newton step on one line per lane. Lines with `laws` have rods that give.
template <Laws laws, class V, std::size_t lanes, class T>
PLUMB_INLINE void newton_line_lanes(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const LineEnds<T> ends(tree);
  const std::size_t n = tree.nodes;
  const V zero(0);
  const Vec<V> none{zero, zero, zero};

  // Elimination runs over rods 0 to n and leaves nu_k = right_k - above_k nu_{k+1}.
  LineRod<V> last{none, zero, zero}, rod = line_tie<V>(tree, at, 0, ends.first, T(1));
  LineNode<V> from = line_fixed<V>(tree, at, 0, ends.first);
  V above = zero, right = zero, residual = zero;
  for (std::size_t k = 0; k <= n; ++k) {
    const LineRod<V> next = k + 1 < n    ? line_rod<V>(tree, at, k + 1)
                            : k + 1 == n ? line_tie<V>(tree, at, ends.last_tie, ends.last, T(-1))
                                         : LineRod<V>{none, zero, zero};
    const LineNode<V> to =
        k < n ? line_node<V>(tree, at, k, rod, next) : line_fixed<V>(tree, at, ends.last_tie, ends.last);
    const LineRow<V> row =
        line_row<laws, V, T>(tree, at, {last, from, rod, to, next, ends.is_tie(k), ends.number_of(k)});
    const V over = reciprocal_or_zero(row.diagonal - row.below * above, zero);
    residual = residual + row.right * row.right;
    above = row.above * over;
    right = (row.right - row.below * right) * over;
    at.put(tree.elimination, 2 * k, above);
    at.put(tree.elimination, 2 * k + 1, right);
    last = rod;
    rod = next;
    from = to;
  }

  // Substitution runs back. It moves multipliers, and then the node between two of them.
  const V active = at.get(tree.active, 0);
  V nu = at.get(tree.elimination, 2 * n + 1), mu = zero;
  Vec<V> d = line_tie<V>(tree, at, ends.last_tie, ends.last, T(-1)).d;
  if (ends.last) mu = move_multiplier(at, active, tree.tie_mu, ends.last_tie, nu);
  V sum = zero;
  for (std::size_t k = n; k-- > 0;) {
    const V nu_before = at.get(tree.elimination, 2 * k + 1) - at.get(tree.elimination, 2 * k) * nu;
    const bool tie = k == 0;
    const Vec<V> d_before =
        tie ? line_tie<V>(tree, at, 0, ends.first, T(1)).d : at.get3(tree.rod, tree_fields::rod * k);
    V mu_before = zero;
    if (!tie) mu_before = move_multiplier(at, active, tree.mu, k, nu_before);
    if (tie && ends.first) mu_before = move_multiplier(at, active, tree.tie_mu, 0, nu_before);
    const V w = at.get(tree.node, tree_fields::node * k + 3);
    const Vec<V> change = w * (nu_before * d_before - nu * d);
    sum = sum + dot(change, change);
    const Vec<V> delta = w * ((at.get3(tree.load, 3 * k) + mu_before * d_before) - mu * d);
    const Vec<V> old = at.get3(tree.delta, 3 * k);
    at.put3(tree.delta, 3 * k,
            {select_nonzero(active, delta.x, old.x), select_nonzero(active, delta.y, old.y),
             select_nonzero(active, delta.z, old.z)});
    nu = nu_before;
    mu = mu_before;
    d = d_before;
  }
  at.put(tree.change, 0, sum);
  at.put(tree.residual, 0, residual);
}

}  // namespace
}  // namespace plumb::simd
