// This is the body of Newton's method on trees, for V = T (one lane after the other, the oracle) and for
// vectors of lanes. V needs + - * /, and the file before this one defines load, store, select_nonzero and the
// like.
//
// Once everything below node i is eliminated, i and the rod to its parent p have the equations
//
//   K delta_i + kappa delta_p - a nu = r        b . (delta_i - delta_p) = c
//
// Here e = delta_i - delta_p, and K is a block of 3 x 3. The force points along a = d + theta e, and b = d +
// e is the gradient of C at the iterate. With H = K^-1, q = H r, u = H a, w = H^T b, s = b . u the equations
// become
//
//   nu      = (c - b.q + (b + kappa w) . delta_p) / s
//   delta_i = q + nu u - kappa H delta_p
//   K_p    += (kappa u + a) (b + kappa w)^T / s - kappa^2 H
//   r_p    -= (kappa u + a) (c - b.q) / s + kappa q
//
// A tie has the same equations with delta_p = 0. It takes a rank from H. A rod that gives has the second
// equation  use b . (delta_i - delta_p) + soft nu = c  (simd/tree/law_math.hpp), so that s = use b . u +
// soft.

#include "simd/tree/lane_math.hpp"
#include "simd/tree/law_lanes.hpp"

namespace plumb::simd {
namespace {

/// A node has this block while what is below it is added up.
template <class V>
struct NodeBlock {
  Mat<V> rows;
  Vec<V> r;
  V diagonal;  ///< It is added to all three numbers of the diagonal.
};

template <class V, class T, class At>
PLUMB_INLINE void add_below(const TreeView<T>& tree, const At& at, std::size_t node, NodeBlock<V>& block) {
  if (tree.below_slot[node] == no_slot) return;
  const std::size_t f = tree.below_slot[node] * tree_fields::below;
  block.rows.v0 = block.rows.v0 + at.get3(tree.below, f);
  block.rows.v1 = block.rows.v1 + at.get3(tree.below, f + 3);
  block.rows.v2 = block.rows.v2 + at.get3(tree.below, f + 6);
  block.r = block.r + at.get3(tree.below, f + 9);
  block.diagonal = block.diagonal + at.get(tree.below, f + 12);
}
template <class V, class T, class At>
PLUMB_INLINE void put_below(const TreeView<T>& tree, const At& at, std::size_t node,
                            const NodeBlock<V>& block) {
  const std::size_t f = tree.below_slot[node] * tree_fields::below;
  at.put3(tree.below, f, block.rows.v0);
  at.put3(tree.below, f + 3, block.rows.v1);
  at.put3(tree.below, f + 6, block.rows.v2);
  at.put3(tree.below, f + 9, block.r);
  at.put(tree.below, f + 12, block.diagonal);
}

template <class V>
PLUMB_INLINE NodeBlock<V> empty_block() {
  const V zero(0);
  const Vec<V> none{zero, zero, zero};
  return {{none, none, none}, none, zero};
}

/// Puts the known pull of a rod where its projection adds to it, if anybody asks. Returns it.
template <class V, class T, class At>
PLUMB_INLINE V put_known(const At& at, std::size_t i, const V& mu, T* const blow) {
  if (blow != nullptr) at.put(blow, i, mu);
  return mu;
}

/// A node whose ties and everything below it are eliminated has delta_i = q + H f for a force f from above.
template <class V>
struct Free {
  Mat<V> h;  ///< H is kept by columns.
  Vec<V> q;
  V residual;  ///< It is the sum of C^2 over its ties.
};

/// Eliminates the ties of node i one after the other. `linear` leaves theta and C out, as projections of
/// velocities do.
template <bool linear, Laws laws, class V, class T, class At>
PLUMB_INLINE Free<V> free_node(const TreeView<T>& tree, const At& at, std::size_t i, NodeBlock<V> block,
                               const Vec<V>& delta, V theta) {
  using namespace tree_fields;
  for (std::size_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) {
    if constexpr (!linear) {
      const Vec<V> a = at.get3(tree.tie_rod, k * rod) + theta * (delta - at.get3(tree.tie_delta, 3 * k));
      const V mu = at.get(tree.tie_mu, k);
      block.r = block.r + mu * a - at.get(tree.tie, k * tie) * at.get3(tree.tie_delta, 3 * k);
      block.diagonal = block.diagonal - theta * mu;
    } else {
      block.r =
          block.r + at.get(tree.tie, k * tie) * (at.get3(tree.tie_u, 3 * k) - at.get3(tree.tie_delta, 3 * k));
      if constexpr (laws != Laws::none) {
        const Vec<V> d = at.get3(tree.tie_rod, k * rod);
        const V mu = known_pull_of<V>(tree, at, tie_laws(tree), k, d, V(0)).mu;
        block.r = block.r + put_known(at, k, mu, tree.tie_blow) * d;
      }
    }
  }
  block.rows.v0.x = block.rows.v0.x + block.diagonal;
  block.rows.v1.y = block.rows.v1.y + block.diagonal;
  block.rows.v2.z = block.rows.v2.z + block.diagonal;
  Free<V> node{inverse(block.rows), block.r, V(0)};
  node.q = multiply(node.h, block.r);
  const V size = trace(node.h);
  for (std::size_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) {
    const Vec<V> d = at.get3(tree.tie_rod, k * rod), e = delta - at.get3(tree.tie_delta, 3 * k);
    Vec<V> a = d, b = d;
    V c = dot(d, e);
    if constexpr (!linear) {
      a = d + theta * e;
      b = d + e;
      c = at.get(tree.tie_rod, k * rod + 3) + (c + V(T(0.5)) * dot(e, e));
    }
    V soft(0);
    if constexpr (laws != Laws::none) {
      const LawRow<V> row =
          linear ? known_pull_of<V>(tree, at, tie_laws(tree), k, d, c).row
                 : law_row_of<laws, false, V>(tree, at, tie_laws(tree), k,
                                              {growth_of(d, e), c, at.get(tree.tie_mu, k)}, theta);
      b = row.use * b;
      soft = row.soft;
      c = row.c;
    }
    if constexpr (!linear) node.residual = node.residual + c * c;
    const Vec<V> u = multiply(node.h, a), w = multiply_transposed(node.h, b);
    V pivot = dot(b, u);
    if constexpr (laws != Laws::none) pivot = pivot + soft;
    const V over = reciprocal_or_zero(pivot, (at.get(tree.tie, k * tie + 1) * size) * dot(b, b));
    const V rho = (V(0) - c - dot(b, node.q)) * over;
    const Vec<V> y = over * w;
    node.q = node.q + rho * u;
    node.h = {node.h.v0 - y.x * u, node.h.v1 - y.y * u, node.h.v2 - y.z * u};
    at.put3(tree.tie_elimination, k * tie_elimination, a);
    at.put3(tree.tie_elimination, k * tie_elimination + 3, y);
    at.put(tree.tie_elimination, k * tie_elimination + 6, rho);
  }
  return node;
}

/// The rod to the parent has a force along a, the gradient b and the violation c. kappa couples its ends, mu
/// is its multiplier, and soft is what it gives.
template <class V>
struct RodEquation {
  Vec<V> a, b;
  V c, kappa, mu, soft;
};

/// Makes the equation of node i's rod and adds what the node itself has to its block.
template <bool linear, bool plain, Laws laws, class V, class T, class At>
PLUMB_INLINE RodEquation<V> rod_equation(const TreeView<T>& tree, const At& at, std::size_t i,
                                         NodeBlock<V>& block, V theta) {
  using namespace tree_fields;
  const Vec<V> delta = at.get3(tree.delta, 3 * i), above = at.get3(tree.delta, 3 * tree.parent[i]);
  const Vec<V> d = at.get3(tree.rod, i * rod), e = delta - above;
  const V coupling = plain ? V(0) : at.get(tree.node, i * tree_fields::node + 1);
  const V mass = at.get(tree.node, i * tree_fields::node);
  block.diagonal = block.diagonal + mass;
  RodEquation<V> own{d, d, dot(d, e), coupling, V(0), V(0)};
  if constexpr (linear) {
    block.r = block.r + at.get(tree.kick, 0) * at.get3(tree.force, 3 * i);
    if constexpr (laws != Laws::none) {
      const KnownPull<V> known = known_pull_of<V>(tree, at, rod_laws(tree), i, d, own.c);
      own.mu = known.mu;
      own.b = known.row.use * d;
      own.soft = known.row.soft;
      own.c = known.row.c;
      block.r = block.r + put_known(at, i, own.mu, tree.blow) * d;
    }
  } else {
    own.a = d + theta * e;
    own.b = d + e;
    own.c = at.get(tree.rod, i * rod + 3) + (own.c + V(T(0.5)) * dot(e, e));
    own.mu = at.get(tree.mu, i);
    if constexpr (laws != Laws::none) {
      const LawRow<V> row =
          law_row_of<laws, false, V>(tree, at, rod_laws(tree), i, {growth_of(d, e), own.c, own.mu}, theta);
      own.b = row.use * own.b;
      own.soft = row.soft;
      own.c = row.c;
    }
    const V pull = theta * own.mu;
    own.kappa = plain ? pull : coupling + pull;
    block.diagonal = block.diagonal - pull;
    Vec<V> r = at.get3(tree.load, 3 * i) - mass * delta;
    if constexpr (!plain) r = r - coupling * above;
    block.r = block.r + (r + own.mu * own.a);
  }
  return own;
}

/// Eliminates node i. `block` holds everything below it and becomes what is added to its parent. The C^2 of
/// its rod and its ties are added to `residual`. All is passed by reference, since copies of blocks would go
/// through memory.
template <bool linear, bool plain, Laws laws, class V, class T, class At>
PLUMB_INLINE void eliminate_node(const TreeView<T>& tree, const At& at, std::size_t i, const V& theta,
                                 NodeBlock<V>& block, V& residual) {
  using namespace tree_fields;
  const auto [a, b, c, kappa, mu, soft] = rod_equation<linear, plain, laws>(tree, at, i, block, theta);
  if (tree.tie_begin[i] != tree.tie_begin[i + 1]) {
    at.put3(tree.tie_elimination, tree.tie_begin[i] * tie_elimination + 7, a);
    at.put(tree.tie_elimination, tree.tie_begin[i] * tie_elimination + 10, kappa);
  }
  const Vec<V> delta = at.get3(tree.delta, 3 * i);
  const Free<V> node = free_node<linear, laws>(tree, at, i, block, delta, theta);
  if constexpr (!linear) residual = residual + (node.residual + c * c);
  const Vec<V> u = multiply(node.h, a), w = multiply_transposed(node.h, b);
  V pivot = dot(b, u);
  if constexpr (laws != Laws::none) pivot = pivot + soft;
  const V over = plain
                     ? V(1) / pivot
                     : reciprocal_or_zero(
                           pivot, (at.get(tree.node, i * tree_fields::node + 2) * trace(node.h)) * dot(b, b));
  const V rho = (V(0) - c - dot(b, node.q)) * over;
  const Vec<V> n = over * (b + kappa * w);
  const Vec<V> q = node.q + rho * u;

  // What is kept is delta_i = P delta_p + q with P = u n^T - kappa H by columns.
  const std::size_t f = i * elimination;
  const Mat<V> columns{n.x * u - kappa * node.h.v0, n.y * u - kappa * node.h.v1, n.z * u - kappa * node.h.v2};
  at.put3(tree.elimination, f, columns.v0);
  at.put3(tree.elimination, f + 3, columns.v1);
  at.put3(tree.elimination, f + 6, columns.v2);
  at.put3(tree.elimination, f + 9, q);
  at.put3(tree.elimination, f + 12, n);
  at.put(tree.elimination, f + 15, rho);

  // The parent adds kappa P + a n^T to its block and -(kappa q + (rho + mu) a) to its right-hand side.
  block.rows.v0 = kappa * Vec<V>{columns.v0.x, columns.v1.x, columns.v2.x} + a.x * n;
  block.rows.v1 = kappa * Vec<V>{columns.v0.y, columns.v1.y, columns.v2.y} + a.y * n;
  block.rows.v2 = kappa * Vec<V>{columns.v0.z, columns.v1.z, columns.v2.z} + a.z * n;
  block.r = Vec<V>{V(0), V(0), V(0)} - (kappa * q + (rho + mu) * a);
  if constexpr (!linear && !plain) block.r = block.r - at.get(tree.node, i * tree_fields::node + 1) * delta;
  block.diagonal = V(0) - theta * mu;
}

/// Eliminates all nodes from the tips to the root and returns the root's displacement. `plain` trees have
/// lumped masses and at most one tie, so that no rod can be redundant. Trees with `laws` have rods that give.
template <bool linear, bool plain, Laws laws, class V, class T, class At>
PLUMB_INLINE Vec<V> eliminate(const TreeView<T>& tree, const At& at, V theta) {
  using namespace tree_fields;
  for (std::size_t slot = 0; slot < tree.below_slots * tree_fields::below; ++slot)
    at.put(tree.below, slot, V(0));
  NodeBlock<V> carried = empty_block<V>();  // it comes from i + 1 if i is its parent
  V residual(0);
  for (std::size_t i = tree.nodes; i-- > 1;) {
    const std::size_t p = tree.parent[i];
    NodeBlock<V> block = carried;
    add_below(tree, at, i, block);
    eliminate_node<linear, plain, laws>(tree, at, i, theta, block, residual);
    if (p + 1 == i) {
      carried = block;
    } else {
      add_below(tree, at, p, block);
      put_below(tree, at, p, block);
      carried = empty_block<V>();
    }
  }
  NodeBlock<V> block = carried;
  add_below(tree, at, 0, block);
  const Vec<V> delta = at.get3(tree.delta, 0);
  const V mass = at.get(tree.node, 0);
  block.diagonal = block.diagonal + mass;
  if constexpr (linear) {
    block.r = block.r + at.get(tree.kick, 0) * at.get3(tree.force, 0);
  } else {
    block.r = block.r + (at.get3(tree.load, 0) - mass * delta);
  }
  const Free<V> root = free_node<linear, laws>(tree, at, 0, block, delta, theta);
  if constexpr (!linear) at.put(tree.residual, 0, residual + root.residual);
  return root.q;
}

/// Adds to the multipliers of a node's ties, the last eliminated first. `f` is the force from above.
template <class V, class T, class At>
PLUMB_INLINE void pull_ties(const TreeView<T>& tree, const At& at, std::size_t i, Vec<V> f, const V& active,
                            T* const to) {
  using namespace tree_fields;
  for (std::size_t k = tree.tie_begin[i + 1]; k-- > tree.tie_begin[i];) {
    const Vec<V> a = at.get3(tree.tie_elimination, k * tie_elimination);
    const Vec<V> y = at.get3(tree.tie_elimination, k * tie_elimination + 3);
    const V nu = at.get(tree.tie_elimination, k * tie_elimination + 6) - dot(y, f);
    f = f + nu * a;
    const V mu = at.get(to, k);
    at.put(to, k, select_nonzero(active, mu + nu, mu));
  }
}

/// Goes from the root to the tips and adds the solution to delta and mu.
template <bool linear, class V, class T, class At>
PLUMB_INLINE void substitute(const TreeView<T>& tree, const At& at, const Vec<V>& root) {
  using namespace tree_fields;
  const V active = at.get(tree.active, 0);
  const auto update = [&](std::size_t i, const Vec<V>& change) {
    const Vec<V> old = at.get3(tree.delta, 3 * i), now = old + change;
    at.put3(tree.delta, 3 * i,
            {select_nonzero(active, now.x, old.x), select_nonzero(active, now.y, old.y),
             select_nonzero(active, now.z, old.z)});
    at.put3(tree.elimination, i * elimination + 9, change);  // children that do not follow find it here
  };
  T* const mus = linear ? tree.blow : tree.mu;
  T* const tie_mus = linear ? tree.tie_blow : tree.tie_mu;
  if (!linear || mus != nullptr) pull_ties(tree, at, 0, Vec<V>{V(0), V(0), V(0)}, active, tie_mus);
  update(0, root);
  V sum = dot(root, root);
  Vec<V> last = root;
  for (std::size_t i = 1; i < tree.nodes; ++i) {
    const std::size_t p = tree.parent[i], f = i * elimination;
    const Vec<V> above = p + 1 == i ? last : at.get3(tree.elimination, p * elimination + 9);
    const Mat<V> columns{at.get3(tree.elimination, f), at.get3(tree.elimination, f + 3),
                         at.get3(tree.elimination, f + 6)};
    const Vec<V> change = at.get3(tree.elimination, f + 9) + multiply(columns, above);
    if (!linear || mus != nullptr) {
      const V nu = at.get(tree.elimination, f + 15) + dot(at.get3(tree.elimination, f + 12), above);
      if (tree.tie_begin[i] != tree.tie_begin[i + 1]) {
        const std::size_t first = tree.tie_begin[i] * tie_elimination;
        pull_ties(
            tree, at, i,
            nu * at.get3(tree.tie_elimination, first + 7) - at.get(tree.tie_elimination, first + 10) * above,
            active, tie_mus);
      }
      const V mu = at.get(mus, i);
      at.put(mus, i, select_nonzero(active, mu + nu, mu));
    }
    sum = sum + dot(change, change);
    update(i, change);
    last = change;
  }
  at.put(tree.change, 0, sum);
}

template <Laws laws, class V, std::size_t lanes, class T>
PLUMB_INLINE void newton_lanes(const TreeView<T>& tree, std::size_t lane, T theta) {
  const At<V, T, lanes> at{lane};
  const Vec<V> root = tree.is_plain ? eliminate<false, true, laws>(tree, at, V(theta))
                                    : eliminate<false, false, laws>(tree, at, V(theta));
  substitute<false>(tree, at, root);
}

template <class V, std::size_t lanes, class T>
PLUMB_INLINE void project_lanes(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const Vec<V> root = tree.has_laws ? eliminate<true, false, Laws::any>(tree, at, V(0))
                                    : eliminate<true, false, Laws::none>(tree, at, V(0));
  substitute<true>(tree, at, root);
}

}  // namespace
}  // namespace plumb::simd
