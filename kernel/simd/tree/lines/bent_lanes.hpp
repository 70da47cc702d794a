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
// so that a line takes linear time. torque_lanes.hpp has what a twisted line has more, and tree_lanes.hpp the
// rest. This file is included after it.

#include <type_traits>

#include "simd/tree/lines/bent_places.hpp"
#include "simd/tree/lines/torque_lanes.hpp"

namespace plumb::simd {
namespace {

/// Returns the block of a node as trees have it, by rows.
template <class V>
PLUMB_INLINE NodeBlock<V> as_node(const BentBlock<V>& block) {
  const Mat<V>& m = block.own;
  return {{{m.v0.x, m.v1.x, m.v2.x}, {m.v0.y, m.v1.y, m.v2.y}, {m.v0.z, m.v1.z, m.v2.z}}, block.r, V(0)};
}

/// Keeps what substitution makes delta_i and nu of: delta_i = P delta_p + Q delta_g + q and nu = rho +
/// n.delta_p + m.delta_g.
template <class V>
struct BentRow {
  Mat<V> by_parent, by_grand;
  Vec<V> q, n, m;
  V rho;
};
template <class V, class T, class At>
PLUMB_INLINE void put_row(const TreeView<T>& tree, const At& at, std::size_t i, const BentRow<V>& row) {
  const std::size_t f = i * tree_fields::bent_elimination;
  put_matrix(at, tree.bent_elimination, f, row.by_parent);
  put_matrix(at, tree.bent_elimination, f + 9, row.by_grand);
  at.put3(tree.bent_elimination, f + 18, row.q);
  at.put3(tree.bent_elimination, f + 21, row.n);
  at.put3(tree.bent_elimination, f + 24, row.m);
  at.put(tree.bent_elimination, f + 27, row.rho);
}

/// What is left to a node and its parent while a line is eliminated.
template <class V, class Border>
struct BentRest {
  BentBlock<V> block;
  Border border;
};

/// Eliminates node i and its rod. `rest` becomes what is left to its parent.
template <Laws laws, class V, class T, class At, class Elements, class Border>
PLUMB_INLINE void eliminate_bent_node(const TreeView<T>& tree, const At& at, std::size_t i, const V& theta,
                                      const Elements& elements, BentRest<V, Border>& rest) {
  BentBlock<V>& block = rest.block;
  NodeBlock<V> own = as_node(block);
  const auto [a, b, c, kappa, mu, soft] = rod_equation<false, false, laws>(tree, at, i, own, theta);
  add_to_diagonal(block.to_parent, kappa);
  add_to_diagonal(block.from_parent, kappa);
  const Mat<V> to_grand = elements.to_grand(), from_grand = elements.from_grand();
  if (tree.tie_begin[i] != tree.tie_begin[i + 1]) {
    const std::size_t f = std::size_t{tree.nodes} * tree_fields::bent_elimination;
    at.put3(tree.bent_elimination, f, a);
    put_matrix(at, tree.bent_elimination, f + 3, block.to_parent);
    put_matrix(at, tree.bent_elimination, f + 12, to_grand);
    rest.border.put_tip(tree, at);
  }
  const Vec<V> delta = at.get3(tree.delta, 3 * i);
  const Free<V> node = free_node<false, laws>(tree, at, i, own, delta, theta);
  const Vec<V> u = multiply(node.h, a), w = multiply_transposed(node.h, b);
  const V floor = (at.get(tree.node, i * tree_fields::node + 2) * trace(node.h)) * dot(b, b);
  const V over = reciprocal_or_zero(dot(b, u) + soft, floor);
  const V rho = (V(0) - c - dot(b, node.q)) * over;
  BentRow<V> row{V(-1) * product(node.h, block.to_parent),
                 V(-1) * product(node.h, to_grand),
                 node.q + rho * u,
                 over * (b + multiply_transposed(block.to_parent, w)),
                 over * multiply_transposed(to_grand, w),
                 rho};
  add_product(row.by_parent, V(0), u, row.n);
  add_product(row.by_grand, V(0), u, row.m);
  put_row(tree, at, i, row);
  rest.border.eliminate(
      tree, at, {i, node.h, row.by_parent, row.by_grand, block.from_parent, from_grand, a, b, u, row.q, over},
      elements);

  BentBlock<V> next{block.parent + product(block.from_parent, row.by_parent),
                    elements.parent_to_grand() + product(block.from_parent, row.by_grand),
                    elements.grand_to_parent() + product(from_grand, row.by_parent),
                    elements.grand() + product(from_grand, row.by_grand),
                    block.parent_r - multiply(block.from_parent, row.q) - (rho + mu) * a -
                        at.get(tree.node, i * tree_fields::node + 1) * delta,
                    V(-1) * (elements.grand_pull() + multiply(from_grand, row.q)),
                    block.residual + (node.residual + c * c)};
  add_product(next.own, V(0) - theta * mu, a, row.n);
  add_product(next.to_parent, V(0), a, row.m);
  block = next;
}

/// Returns what acts at a place of a line, with or without a twist.
template <bool is_mid, bool twisted, class V, class T, class At>
PLUMB_INLINE auto elements_at(const BentLine<V, T, At>& line, std::ptrdiff_t slot, const V& theta) {
  if constexpr (twisted) {
    return twist_at<is_mid, V>(line, slot, theta);
  } else {
    return bend_at<is_mid, V>(line, slot, theta);
  }
}

/// Eliminates all nodes from the tip to the root. `root` becomes the root's displacement. Returns the change
/// of torque.
template <bool is_mid, Laws laws, bool twisted, class V, class T, class At>
PLUMB_INLINE auto eliminate_bent(const TreeView<T>& tree, const At& at, const V& theta, Vec<V>& root_change) {
  const BentLine<V, T, At> line{tree, at};
  const V zero(0);
  const Vec<V> none{zero, zero, zero};
  using Border = std::conditional_t<twisted, TorqueBorder<V>, NoTorqueBorder<V>>;
  BentRest<V, Border> rest{{no_matrix<V>(), no_matrix<V>(), no_matrix<V>(), no_matrix<V>(), none, none, zero},
                           Border()};
  const auto nodes = static_cast<std::ptrdiff_t>(tree.nodes);
  for (std::ptrdiff_t slot = nodes + 2; slot-- > 0;) {
    const auto elements = elements_at<is_mid, twisted, V>(line, slot, theta);
    add_elements(elements, rest.block);
    rest.border.add(elements);
    if (slot > 0 && slot < nodes)
      eliminate_bent_node<laws>(tree, at, static_cast<std::size_t>(slot), theta, elements, rest);
  }
  NodeBlock<V> own = as_node(rest.block);
  const Vec<V> delta = at.get3(tree.delta, 0);
  const V mass = at.get(tree.node, 0);
  own.diagonal = own.diagonal + mass;
  own.r = own.r + (at.get3(tree.load, 0) - mass * delta);
  const Free<V> root = free_node<false, laws>(tree, at, 0, own, delta, theta);
  at.put(tree.residual, 0, rest.block.residual + root.residual);
  root_change = root.q;
  return rest.border.finish(tree, at, theta, root.h, root_change);
}

/// Goes from the root to the tip and adds the solution to delta, mu and the torque.
template <class V, class T, class At, class Torque>
PLUMB_INLINE void substitute_bent(const TreeView<T>& tree, const At& at, const Vec<V>& root,
                                  const Torque& torque) {
  using namespace tree_fields;
  const V active = at.get(tree.active, 0), zero(0);
  const auto update = [&](std::size_t i, const Vec<V>& change) {
    const Vec<V> old = at.get3(tree.delta, 3 * i), now = old + change;
    at.put3(tree.delta, 3 * i,
            {select_nonzero(active, now.x, old.x), select_nonzero(active, now.y, old.y),
             select_nonzero(active, now.z, old.z)});
  };
  Vec<V> above = root, before{zero, zero, zero};
  pull_ties(tree, at, 0, torque.root_force(), active, tree.tie_mu);
  torque.apply(tree, at, active);
  update(0, root);
  V sum = dot(root, root);
  for (std::size_t i = 1; i < tree.nodes; ++i) {
    const std::size_t f = i * bent_elimination;
    const T* const from = tree.bent_elimination;
    const Vec<V> change =
        torque.displaced(tree, at, i, at.get3(from, f + 18)) +
        (multiply(get_matrix<V>(at, from, f), above) + multiply(get_matrix<V>(at, from, f + 9), before));
    const V nu = torque.pulled(tree, at, i, at.get(from, f + 27)) +
                 (dot(at.get3(from, f + 21), above) + dot(at.get3(from, f + 24), before));
    if (tree.tie_begin[i] != tree.tie_begin[i + 1]) {
      const std::size_t last = std::size_t{tree.nodes} * bent_elimination;
      const Vec<V> force = nu * at.get3(from, last) - (multiply(get_matrix<V>(at, from, last + 3), above) +
                                                       multiply(get_matrix<V>(at, from, last + 12), before));
      pull_ties(tree, at, i, torque.tip_force(tree, at, force), active, tree.tie_mu);
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

template <bool is_mid, Laws laws, bool twisted, class V, class T, class At>
PLUMB_INLINE void newton_bent_step(const TreeView<T>& tree, const At& at, const V& theta) {
  Vec<V> root{V(0), V(0), V(0)};
  const auto torque = eliminate_bent<is_mid, laws, twisted>(tree, at, theta, root);
  substitute_bent(tree, at, root, torque);
}

/// Takes a Newton step of a line with bends, twisted or not.
template <Laws laws, bool twisted, class V, std::size_t lanes, class T>
PLUMB_INLINE void newton_bent_lanes(const TreeView<T>& tree, std::size_t lane, T theta) {
  const At<V, T, lanes> at{lane};
  return theta < 1 ? newton_bent_step<true, laws, twisted>(tree, at, V(theta))
                   : newton_bent_step<false, laws, twisted>(tree, at, V(theta));
}

/// Calls f<laws, twisted>() for what a line with bends or a twist has. Returns false for other trees.
template <class T, class F>
PLUMB_INLINE bool with_bends(const TreeView<T>& tree, F&& f) {
  if constexpr (bends_in<T>) {
    if (!tree.has_bends) return false;
    if (tree.twist_end > 0)
      tree.has_laws ? f.template operator()<Laws::any, true>() : f.template operator()<Laws::none, true>();
    else
      tree.has_laws ? f.template operator()<Laws::any, false>() : f.template operator()<Laws::none, false>();
    return true;
  }
  return false;
}

}  // namespace
}  // namespace plumb::simd
