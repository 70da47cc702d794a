// This is the body of Newton's method on bent lines: trees that never branch, with a bend where rods meet.
// Once everything below node i is eliminated, i and the rod to its parent p have the equations
//
//   K delta_i + K_p delta_p + K_g delta_g - a nu = r        b . (delta_i - delta_p) = c
//
// with g the parent of p, where K_p has what a rod of a tree has as kappa. With H = K^-1, q = H r, u = H a, w
// = H^T b, s = b . u the equations become
//
//   nu      = (c - b.q + (b + K_p^T w) . delta_p + K_g^T w . delta_g) / s
//   delta_i = q + nu u - H K_p delta_p - H K_g delta_g
//
// so that a line takes linear time. tree_lanes.hpp has the rest, and this file is included after it.

#include "simd/tree/lines/bend_lanes.hpp"

namespace plumb::simd {
namespace {

template <class V>
PLUMB_INLINE Mat<V> operator+(const Mat<V>& a, const Mat<V>& b) {
  return {a.v0 + b.v0, a.v1 + b.v1, a.v2 + b.v2};
}
template <class V>
PLUMB_INLINE Mat<V> operator*(const V& s, const Mat<V>& a) {
  return {s * a.v0, s * a.v1, s * a.v2};
}
/// Multiplies two matrices given by columns.
template <class V>
PLUMB_INLINE Mat<V> product(const Mat<V>& a, const Mat<V>& b) {
  return {multiply(a, b.v0), multiply(a, b.v1), multiply(a, b.v2)};
}
template <class V>
PLUMB_INLINE Mat<V> no_matrix() {
  const V zero(0);
  const Vec<V> none{zero, zero, zero};
  return {none, none, none};
}

/// Reads the numbers of a line's bends. Places run from the root's clamp, -2, to the tip's, nodes + 1. A bend
/// has the slot of its last place.
template <class V, class T, class At>
struct BentLine {
  const TreeView<T>& tree;
  const At& at;

  PLUMB_INLINE std::uint32_t end(std::ptrdiff_t place) const {
    return place < 0 ? tree.bend_ends[place + 2]
                     : tree.bend_ends[place - static_cast<std::ptrdiff_t>(tree.nodes) + 2];
  }
  PLUMB_INLINE bool is_node(std::ptrdiff_t place) const {
    return place >= 0 && place < static_cast<std::ptrdiff_t>(tree.nodes);
  }
  /// Returns where a place stands; that of no particle is not used.
  PLUMB_INLINE const double* position(std::ptrdiff_t place) const {
    const std::size_t i = is_node(place) ? static_cast<std::size_t>(place) : end(place);
    return (is_node(place) ? tree.x : tree.tie_x) + 3 * i * At::stride + at.lane;
  }
  PLUMB_INLINE Vec<V> delta(std::ptrdiff_t place) const {
    return is_node(place) ? at.get3(tree.delta, 3 * static_cast<std::size_t>(place))
                          : at.get3(tree.tie_delta, 3 * std::size_t{end(place)});
  }
  /// Says whether a bend ends at a place, whose particles then all are there.
  PLUMB_INLINE bool is_there(std::ptrdiff_t slot) const {
    const auto has = [this](std::ptrdiff_t place) { return is_node(place) || end(place) != no_slot; };
    return has(slot) && has(slot - 1) && has(slot - 2);
  }
  PLUMB_INLINE BendNumbers<V> numbers(std::ptrdiff_t slot) const {
    const std::size_t f = static_cast<std::size_t>(slot) * tree_fields::bend;
    return {at.get(tree.bend, f),     at.get(tree.bend, f + 1), at.get(tree.bend, f + 2),
            at.get(tree.bend, f + 3), at.get(tree.bend, f + 4), at.get(tree.bend, f + 5)};
  }
};

/// Measures w of all bends where a substep starts.
template <class V, std::size_t lanes, class T>
PLUMB_INLINE void prepare_bends(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const BentLine<V, T, At<V, T, lanes>> line{tree, at};
  for (std::ptrdiff_t slot = 0; slot < static_cast<std::ptrdiff_t>(tree.nodes) + 2; ++slot) {
    if (!line.is_there(slot)) continue;
    const BendNumbers<V> bend = line.numbers(slot);
    const double* const middle = line.position(slot - 1);
    const auto way = [&](const double* from, const double* to) {
      return Vec<V>{narrow<V>(load_wide<V>(to) - load_wide<V>(from)),
                    narrow<V>(load_wide<V>(to + lanes) - load_wide<V>(from + lanes)),
                    narrow<V>(load_wide<V>(to + 2 * lanes) - load_wide<V>(from + 2 * lanes))};
    };
    at.put3(tree.bend_start, 3 * static_cast<std::size_t>(slot),
            bend.last * way(middle, line.position(slot)) - bend.first * way(line.position(slot - 2), middle));
  }
}

/// A node and its parent have these from bends and from what is below. Matrices are given by columns.
template <class V>
struct BentBlock {
  Mat<V> own, to_parent, from_parent, parent;
  Vec<V> r, parent_r;
  V residual;  ///< It is the sum of C^2 over all rods so far.
};

/// A bend pulls a node, its parent and that one's parent, by these weights. Those of fixed particles are 0.
template <class V>
struct PlacedBend {
  BendPull<V> of;
  V own, parent, grand;
};

template <bool is_mid, class V, class T, class At>
PLUMB_INLINE PlacedBend<V> bend_at(const BentLine<V, T, At>& line, std::ptrdiff_t slot, const V& theta) {
  const V none(0);
  if (!line.is_there(slot)) return {{{none, none, none}, no_matrix<V>()}, none, none, none};
  const TreeView<T>& tree = line.tree;
  const BendNumbers<V> bend = line.numbers(slot);
  const Vec<V> middle = line.delta(slot - 1);
  const Vec<V> change =
      bend.last * (line.delta(slot) - middle) - bend.first * (middle - line.delta(slot - 2));
  const V kick = line.at.get(tree.kick, 0);
  const Vec<V> start = line.at.get3(tree.bend_start, 3 * static_cast<std::size_t>(slot));
  const BendFactors<V> factors{kick, kick * line.at.get(tree.bend_rate, 0), theta};
  // Beyond the tip a bend begins with fixed particles.
  const std::ptrdiff_t beyond = slot + 1 - static_cast<std::ptrdiff_t>(tree.nodes);
  const V of[4] = {bend.last, bend.middle, bend.first, none};
  const std::ptrdiff_t skipped = beyond > 0 ? beyond : 0, node = slot - skipped;
  return {bend_pull_of<is_mid>(bend, factors, tree.has_bend_damping, start, change), of[skipped],
          node > 0 ? of[skipped + 1] : none, node > 1 && skipped == 0 ? of[2] : none};
}

template <class V>
PLUMB_INLINE void add_bend(const PlacedBend<V>& bend, BentBlock<V>& block) {
  const Mat<V> across = (bend.own * bend.parent) * bend.of.slope;
  block.own = block.own + (bend.own * bend.own) * bend.of.slope;
  block.to_parent = block.to_parent + across;
  block.from_parent = block.from_parent + across;
  block.parent = block.parent + (bend.parent * bend.parent) * bend.of.slope;
  block.r = block.r - bend.own * bend.of.pull;
  block.parent_r = block.parent_r - bend.parent * bend.of.pull;
}

/// Returns the block of a node as trees have it, by rows.
template <class V>
PLUMB_INLINE NodeBlock<V> as_node(const BentBlock<V>& block) {
  const Mat<V>& m = block.own;
  return {{{m.v0.x, m.v1.x, m.v2.x}, {m.v0.y, m.v1.y, m.v2.y}, {m.v0.z, m.v1.z, m.v2.z}}, block.r, V(0)};
}

template <class T, class At, class V>
PLUMB_INLINE void put_matrix(const At& at, T* to, std::size_t f, const Mat<V>& m) {
  at.put3(to, f, m.v0);
  at.put3(to, f + 3, m.v1);
  at.put3(to, f + 6, m.v2);
}
template <class V, class T, class At>
PLUMB_INLINE Mat<V> get_matrix(const At& at, const T* from, std::size_t f) {
  return {at.get3(from, f), at.get3(from, f + 3), at.get3(from, f + 6)};
}

/// Eliminates node i and its rod. `block` becomes what is left to its parent.
template <Laws laws, class V, class T, class At>
PLUMB_INLINE void eliminate_bent_node(const TreeView<T>& tree, const At& at, std::size_t i, const V& theta,
                                      const PlacedBend<V>& bend, BentBlock<V>& block) {
  using namespace tree_fields;
  NodeBlock<V> own = as_node(block);
  const auto [a, b, c, kappa, mu, soft] = rod_equation<false, false, laws>(tree, at, i, own, theta);
  add_to_diagonal(block.to_parent, kappa);
  add_to_diagonal(block.from_parent, kappa);
  const Mat<V> to_grand = (bend.own * bend.grand) * bend.of.slope;
  const Mat<V> across = (bend.parent * bend.grand) * bend.of.slope;
  if (tree.tie_begin[i] != tree.tie_begin[i + 1]) {
    const std::size_t f = std::size_t{tree.nodes} * bent_elimination;
    at.put3(tree.bent_elimination, f, a);
    put_matrix(at, tree.bent_elimination, f + 3, block.to_parent);
    put_matrix(at, tree.bent_elimination, f + 12, to_grand);
  }
  const Vec<V> delta = at.get3(tree.delta, 3 * i);
  const Free<V> node = free_node<false, laws>(tree, at, i, own, delta, theta);
  const Vec<V> u = multiply(node.h, a), w = multiply_transposed(node.h, b);
  const V floor = (at.get(tree.node, i * tree_fields::node + 2) * trace(node.h)) * dot(b, b);
  const V over = reciprocal_or_zero(dot(b, u) + soft, floor);
  const V rho = (V(0) - c - dot(b, node.q)) * over;
  const Vec<V> n = over * (b + multiply_transposed(block.to_parent, w));
  const Vec<V> m = over * multiply_transposed(to_grand, w);
  const Vec<V> q = node.q + rho * u;

  // What is kept is delta_i = P delta_p + Q delta_g + q and nu = rho + n.delta_p + m.delta_g.
  Mat<V> by_parent = V(-1) * product(node.h, block.to_parent);
  Mat<V> by_grand = V(-1) * product(node.h, to_grand);
  add_product(by_parent, V(0), u, n);
  add_product(by_grand, V(0), u, m);
  const std::size_t f = i * bent_elimination;
  put_matrix(at, tree.bent_elimination, f, by_parent);
  put_matrix(at, tree.bent_elimination, f + 9, by_grand);
  at.put3(tree.bent_elimination, f + 18, q);
  at.put3(tree.bent_elimination, f + 21, n);
  at.put3(tree.bent_elimination, f + 24, m);
  at.put(tree.bent_elimination, f + 27, rho);

  BentBlock<V> next{block.parent + product(block.from_parent, by_parent),
                    across + product(block.from_parent, by_grand),
                    across + product(to_grand, by_parent),
                    (bend.grand * bend.grand) * bend.of.slope + product(to_grand, by_grand),
                    block.parent_r - multiply(block.from_parent, q) - (rho + mu) * a -
                        at.get(tree.node, i * tree_fields::node + 1) * delta,
                    V(-1) * (bend.grand * bend.of.pull + multiply(to_grand, q)),
                    block.residual + (node.residual + c * c)};
  add_product(next.own, V(0) - theta * mu, a, n);
  add_product(next.to_parent, V(0), a, m);
  block = next;
}

/// Eliminates all nodes from the tip to the root and returns the root's displacement.
template <bool is_mid, Laws laws, class V, class T, class At>
PLUMB_INLINE Vec<V> eliminate_bent(const TreeView<T>& tree, const At& at, const V& theta) {
  const BentLine<V, T, At> line{tree, at};
  const V zero(0);
  const Vec<V> none{zero, zero, zero};
  BentBlock<V> block{no_matrix<V>(), no_matrix<V>(), no_matrix<V>(), no_matrix<V>(), none, none, zero};
  const auto nodes = static_cast<std::ptrdiff_t>(tree.nodes);
  add_bend(bend_at<is_mid, V>(line, nodes + 1, theta), block);
  add_bend(bend_at<is_mid, V>(line, nodes, theta), block);
  for (std::ptrdiff_t i = nodes; i-- > 1;) {
    const PlacedBend<V> bend = bend_at<is_mid, V>(line, i, theta);
    add_bend(bend, block);
    eliminate_bent_node<laws>(tree, at, static_cast<std::size_t>(i), theta, bend, block);
  }
  add_bend(bend_at<is_mid, V>(line, 0, theta), block);
  NodeBlock<V> own = as_node(block);
  const Vec<V> delta = at.get3(tree.delta, 0);
  const V mass = at.get(tree.node, 0);
  own.diagonal = own.diagonal + mass;
  own.r = own.r + (at.get3(tree.load, 0) - mass * delta);
  const Free<V> root = free_node<false, laws>(tree, at, 0, own, delta, theta);
  at.put(tree.residual, 0, block.residual + root.residual);
  return root.q;
}

/// Goes from the root to the tip and adds the solution to delta and mu.
template <class V, class T, class At>
PLUMB_INLINE void substitute_bent(const TreeView<T>& tree, const At& at, const Vec<V>& root) {
  using namespace tree_fields;
  const V active = at.get(tree.active, 0), zero(0);
  const auto update = [&](std::size_t i, const Vec<V>& change) {
    const Vec<V> old = at.get3(tree.delta, 3 * i), now = old + change;
    at.put3(tree.delta, 3 * i,
            {select_nonzero(active, now.x, old.x), select_nonzero(active, now.y, old.y),
             select_nonzero(active, now.z, old.z)});
  };
  Vec<V> above = root, before{zero, zero, zero};
  pull_ties(tree, at, 0, before, active, tree.tie_mu);
  update(0, root);
  V sum = dot(root, root);
  for (std::size_t i = 1; i < tree.nodes; ++i) {
    const std::size_t f = i * bent_elimination;
    const T* const from = tree.bent_elimination;
    const Vec<V> change = at.get3(from, f + 18) + (multiply(get_matrix<V>(at, from, f), above) +
                                                   multiply(get_matrix<V>(at, from, f + 9), before));
    const V nu =
        at.get(from, f + 27) + (dot(at.get3(from, f + 21), above) + dot(at.get3(from, f + 24), before));
    if (tree.tie_begin[i] != tree.tie_begin[i + 1]) {
      const std::size_t last = std::size_t{tree.nodes} * bent_elimination;
      pull_ties(tree, at, i,
                nu * at.get3(from, last) - (multiply(get_matrix<V>(at, from, last + 3), above) +
                                            multiply(get_matrix<V>(at, from, last + 12), before)),
                active, tree.tie_mu);
    }
    const V mu = at.get(tree.mu, i);
    at.put(tree.mu, i, select_nonzero(active, mu + nu, mu));
    sum = sum + dot(change, change);
    update(i, change);
    before = above;
    above = change;
  }
  at.put(tree.change, 0, sum);
}

template <Laws laws, class V, std::size_t lanes, class T>
PLUMB_INLINE void newton_bent_lanes(const TreeView<T>& tree, std::size_t lane, T theta) {
  const At<V, T, lanes> at{lane};
  const Vec<V> root = theta < 1 ? eliminate_bent<true, laws>(tree, at, V(theta))
                                : eliminate_bent<false, laws>(tree, at, V(theta));
  substitute_bent(tree, at, root);
}

}  // namespace
}  // namespace plumb::simd
