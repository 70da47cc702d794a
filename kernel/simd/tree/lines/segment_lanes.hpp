// These loops take Newton steps on a long line cut into as many segments as a logical vector has
// lanes (partitioned elimination, Wang 1981; SPIKE, Polizzi and Sameh 2006). This file is included after
// line_lanes.hpp.
//
// Lane l holds nodes l s to l s + s - 1. Its rod 0 stands where a line keeps its tie. It leads to the last
// node of lane l - 1, and in lane 0 to the fixed end. All but the last rod of a segment are eliminated in
// every lane at once, in terms of the last rod's nu and of that of the lane before,
//
//   nu_k = alpha_k + beta_k nu_last + gamma_k nu_last_before,
//
// which leaves one tridiagonal system with a row per lane.
#include <cstring>

namespace plumb::simd {
namespace {

/// Every lane has a number here, and there is room for a neighbour at either end, to read a vector shifted by
/// one lane. Vectors are copied as bytes: clang 14 for WebAssembly loses numbers that are copied one by one.
template <class T>
struct Neighbors {
  static constexpr std::size_t lanes = logical_width<T>;
  T values[lanes + 2] = {};

  template <class V>
  PLUMB_INLINE void put(std::size_t lane, const V& value) {
    std::memcpy(values + lane + 1, &value, sizeof value);
  }
  template <class V>
  PLUMB_INLINE V from_before(std::size_t lane) const {
    return read<V>(values + lane);
  }
  template <class V>
  PLUMB_INLINE V own(std::size_t lane) const {
    return read<V>(values + lane + 1);
  }
  template <class V>
  PLUMB_INLINE V from_after(std::size_t lane) const {
    return read<V>(values + lane + 2);
  }

 private:
  template <class V>
  PLUMB_INLINE static V read(const T* from) {
    V out;
    std::memcpy(&out, from, sizeof out);
    return out;
  }
};
template <class T>
struct NeighborVec {
  Neighbors<T> x, y, z;
  template <class V>
  PLUMB_INLINE void put(std::size_t lane, const Vec<V>& v) {
    x.put(lane, v.x);
    y.put(lane, v.y);
    z.put(lane, v.z);
  }
  template <class V>
  PLUMB_INLINE Vec<V> from_before(std::size_t lane) const {
    return {x.template from_before<V>(lane), y.template from_before<V>(lane),
            z.template from_before<V>(lane)};
  }
  template <class V>
  PLUMB_INLINE Vec<V> from_after(std::size_t lane) const {
    return {x.template from_after<V>(lane), y.template from_after<V>(lane), z.template from_after<V>(lane)};
  }
};

/// This is what lanes tell each other.
template <class T>
struct SegmentEnds {
  NeighborVec<T> first_d, last_d, last_delta;
  Neighbors<T> first_mu, last_w;
  Neighbors<T> alpha, beta, gamma;  ///< of the first rod
  Neighbors<T> nu_first, nu_last;
};

/// These are the rows of the last rods of all lanes, one tridiagonal system.
template <class T>
struct Separators {
  alignas(64) T below[logical_width<T>], diagonal[logical_width<T>], above[logical_width<T>],
      right[logical_width<T>], lower[logical_width<T>];
};

constexpr std::size_t segment_fields = 3;

template <class V, class T, class At>
PLUMB_INLINE void put_segment_ends(const TreeView<T>& tree, const At& at, SegmentEnds<T>& ends) {
  const LineRod<V> first = line_tie<V>(tree, at, 0, true, T(1));
  const std::size_t s = tree.nodes - 1;
  ends.first_d.put(at.lane, first.d);
  ends.first_mu.put(at.lane, first.mu);
  ends.last_d.put(at.lane, at.get3(tree.rod, tree_fields::rod * s));
  ends.last_w.put(at.lane, at.get(tree.node, tree_fields::node * s + 3));
}
template <class V, class T, class At>
PLUMB_INLINE LineRod<V> first_rod_after(const At& at, const SegmentEnds<T>& ends) {
  return {ends.first_d.template from_after<V>(at.lane), V(0), ends.first_mu.template from_after<V>(at.lane)};
}
template <class V, class T, class At>
PLUMB_INLINE void put_last_delta(const TreeView<T>& tree, const At& at, SegmentEnds<T>& ends) {
  const std::size_t s = tree.nodes - 1;
  ends.last_delta.put(
      at.lane, line_node<V>(tree, at, s, line_rod<V>(tree, at, s), first_rod_after<V>(at, ends)).delta);
}

template <Laws laws, class V, class T, class At>
PLUMB_INLINE void eliminate_segment(const TreeView<T>& tree, const At& at, SegmentEnds<T>& ends,
                                    Separators<T>& rows) {
  const std::size_t s = tree.nodes, lane = at.lane;
  const V zero(0);
  LineRod<V> last{ends.last_d.template from_before<V>(lane), zero, zero},
      rod = line_tie<V>(tree, at, 0, true, T(1));
  LineNode<V> from{{zero, zero, zero},
                   ends.last_delta.template from_before<V>(lane),
                   ends.last_w.template from_before<V>(lane)};
  V above = zero, right = zero, fill = V(0) - V(1), residual = zero;
  for (std::size_t k = 0; k < s; ++k) {
    const LineRod<V> next = k + 1 < s ? line_rod<V>(tree, at, k + 1) : first_rod_after<V>(at, ends);
    const LineNode<V> to = line_node<V>(tree, at, k, rod, next);
    const LineRow<V> row = line_row<laws, V, T>(tree, at, {last, from, rod, to, next, k == 0, k});
    residual = residual + row.right * row.right;
    if (k + 1 == s) {
      store(row.below, rows.lower + lane);
      store(row.diagonal, rows.diagonal + lane);
      store(row.above, rows.above + lane);
      store(row.right, rows.right + lane);
      break;
    }
    const V over = reciprocal_or_zero(row.diagonal - row.below * above, zero);
    above = row.above * over;
    right = (row.right - row.below * right) * over;
    fill = V(0) - row.below * fill * over;
    at.put(tree.elimination, segment_fields * k, above);
    at.put(tree.elimination, segment_fields * k + 1, right);
    at.put(tree.elimination, segment_fields * k + 2, fill);
    last = rod;
    rod = next;
    from = to;
  }
  at.put(tree.residual, 0, residual);
  V alpha = zero, beta = V(1), gamma = zero;
  for (std::size_t k = s - 1; k-- > 0;) {
    const V c = at.get(tree.elimination, segment_fields * k);
    alpha = at.get(tree.elimination, segment_fields * k + 1) - c * alpha;
    beta = V(0) - c * beta;
    gamma = V(0) - at.get(tree.elimination, segment_fields * k + 2) - c * gamma;
    at.put(tree.elimination, segment_fields * k, beta);
    at.put(tree.elimination, segment_fields * k + 1, alpha);
    at.put(tree.elimination, segment_fields * k + 2, gamma);
  }
  ends.alpha.put(lane, alpha);
  ends.beta.put(lane, beta);
  ends.gamma.put(lane, gamma);
}

/// Makes the rows that are left once a lane's own rods and the first of the next are expressed by separators.
template <class V, class T, class At>
PLUMB_INLINE void close_separator(const TreeView<T>& tree, const At& at, const SegmentEnds<T>& ends,
                                  Separators<T>& rows) {
  const std::size_t k = tree.nodes - 2, lane = at.lane;
  const V lower = load<V>(rows.lower + lane), above = load<V>(rows.above + lane);
  const V beta = at.get(tree.elimination, segment_fields * k),
          alpha = at.get(tree.elimination, segment_fields * k + 1),
          gamma = at.get(tree.elimination, segment_fields * k + 2);
  store(lower * gamma, rows.below + lane);
  store((load<V>(rows.diagonal + lane) + lower * beta) + above * ends.gamma.template from_after<V>(lane),
        rows.diagonal + lane);
  store((load<V>(rows.right + lane) - lower * alpha) - above * ends.alpha.template from_after<V>(lane),
        rows.right + lane);
  store(above * ends.beta.template from_after<V>(lane), rows.above + lane);
}

template <class T>
PLUMB_INLINE void solve_separators(Separators<T>& rows, Neighbors<T>& nu) {
  constexpr std::size_t n = logical_width<T>;
  T above = 0, right = 0;
  for (std::size_t l = 0; l < n; ++l) {
    const T pivot = rows.diagonal[l] - rows.below[l] * above;
    const T over = pivot != 0 ? 1 / pivot : 0;
    above = rows.above[l] * over;
    right = (rows.right[l] - rows.below[l] * right) * over;
    rows.above[l] = above;
    rows.right[l] = right;
  }
  T next = 0;
  for (std::size_t l = n; l-- > 0;) nu.values[l + 1] = next = rows.right[l] - rows.above[l] * next;
}

template <class V, class T, class At>
PLUMB_INLINE V segment_nu(const TreeView<T>& tree, const At& at, std::size_t k, const V& own,
                          const V& before) {
  return (at.get(tree.elimination, segment_fields * k + 1) +
          at.get(tree.elimination, segment_fields * k) * own) +
         at.get(tree.elimination, segment_fields * k + 2) * before;
}

template <class V, class T, class At>
PLUMB_INLINE void substitute_segment(const TreeView<T>& tree, const At& at, const SegmentEnds<T>& ends) {
  const V own = ends.nu_last.template own<V>(at.lane), before = ends.nu_last.template from_before<V>(at.lane);
  V nu = ends.nu_first.template from_after<V>(at.lane);
  V mu = ends.first_mu.template from_after<V>(at.lane) + nu, sum(0);
  Vec<V> d = ends.first_d.template from_after<V>(at.lane);
  for (std::size_t k = tree.nodes; k-- > 0;) {
    const V nu_before = k + 1 == tree.nodes ? own : segment_nu(tree, at, k, own, before);
    T* const multipliers = k == 0 ? tree.tie_mu : tree.mu;
    const V mu_before = at.get(multipliers, k) + nu_before;
    at.put(multipliers, k, mu_before);
    const Vec<V> d_before = k == 0 ? at.get3(tree.tie_rod, 0) : at.get3(tree.rod, tree_fields::rod * k);
    const V w = at.get(tree.node, tree_fields::node * k + 3);
    const Vec<V> change = w * (nu_before * d_before - nu * d);
    sum = sum + dot(change, change);
    at.put3(tree.delta, 3 * k, w * ((at.get3(tree.load, 3 * k) + mu_before * d_before) - mu * d));
    nu = nu_before;
    mu = mu_before;
    d = d_before;
  }
  at.put(tree.change, 0, sum);
}

/// Takes a Newton step. `for_lanes(f)` calls f(at) for every machine vector of the logical one. Lines with
/// `laws` have rods that give.
template <Laws laws, class V, class T, class ForLanes>
PLUMB_INLINE void newton_segments_lanes(const TreeView<T>& tree, ForLanes&& for_lanes) {
  SegmentEnds<T> ends;
  Separators<T> rows;
  for_lanes([&](const auto& at) { put_segment_ends<V>(tree, at, ends); });
  for_lanes([&](const auto& at) { put_last_delta<V>(tree, at, ends); });
  for (std::size_t c = 0; c < 3; ++c) {
    Neighbors<T>& component = c == 0 ? ends.last_delta.x : c == 1 ? ends.last_delta.y : ends.last_delta.z;
    component.values[0] = tree.tie_delta[c * logical_width<T>];
  }
  for_lanes([&](const auto& at) { eliminate_segment<laws, V>(tree, at, ends, rows); });
  for_lanes([&](const auto& at) { close_separator<V>(tree, at, ends, rows); });
  solve_separators(rows, ends.nu_last);
  for_lanes([&](const auto& at) {
    const V own = ends.nu_last.template own<V>(at.lane);
    ends.nu_first.put(at.lane, segment_nu(tree, at, 0, own, ends.nu_last.template from_before<V>(at.lane)));
  });
  for_lanes([&](const auto& at) { substitute_segment<V>(tree, at, ends); });
}

}  // namespace
}  // namespace plumb::simd
