#pragma once

// The torque of a twisted line is one more unknown, tau. It is eliminated after all nodes: what it pulls is
// one more right-hand side, and what twists the chain is one more row of the matrix. With p what a unit
// torque pulls node i by once everything below is eliminated, and e = H p + rho_1 u where rho_1 = -(b.H p)/s,
//
//   nu = ... - rho_1 tau        delta_i = ... - tau e
//
// in the equations of bent_lanes.hpp. The row is  sum g_i . delta_i + z tau = r,  in which every node that is
// eliminated hands on its g by what delta_i is made of. What remains is  z tau = r.
//
// bent_lanes.hpp includes this file.

#include "simd/tree/lines/bent_places.hpp"
#include "simd/tree/lines/twist_lanes.hpp"

namespace plumb::simd {
namespace {

/// Every particle of a joint has a vector here.
template <class V>
struct JointVectors {
  Vec<V> own, parent, grand;
};
/// Gives each its share of what the joint's rods have, from the last place of the joint on.
template <class V>
PLUMB_INLINE JointVectors<V> shares_of(const RodPair<V>& rods, std::ptrdiff_t beyond) {
  const V zero(0);
  const Vec<V> none{zero, zero, zero}, first = none - rods.first, middle = rods.first - rods.second;
  if (beyond <= 0) return {rods.second, middle, first};
  return beyond == 1 ? JointVectors<V>{middle, first, none} : JointVectors<V>{first, none, none};
}

/// At a place of a twisted line these act, see PlacedBend.
template <class V>
struct PlacedTwist {
  Mat<V> own_, to_parent_, to_grand_, from_parent_, parent_, parent_to_grand_, from_grand_, grand_to_parent_,
      grand_;
  Vec<V> own_pull_, parent_pull_, grand_pull_;
  JointVectors<V> torque, row;  ///< What a unit torque pulls, and what twists the chain.
  V turn;

  PLUMB_INLINE const Mat<V>& own() const { return own_; }
  PLUMB_INLINE const Mat<V>& to_parent() const { return to_parent_; }
  PLUMB_INLINE const Mat<V>& to_grand() const { return to_grand_; }
  PLUMB_INLINE const Mat<V>& from_parent() const { return from_parent_; }
  PLUMB_INLINE const Mat<V>& parent() const { return parent_; }
  PLUMB_INLINE const Mat<V>& parent_to_grand() const { return parent_to_grand_; }
  PLUMB_INLINE const Mat<V>& from_grand() const { return from_grand_; }
  PLUMB_INLINE const Mat<V>& grand_to_parent() const { return grand_to_parent_; }
  PLUMB_INLINE const Mat<V>& grand() const { return grand_; }
  PLUMB_INLINE const Vec<V>& own_pull() const { return own_pull_; }
  PLUMB_INLINE const Vec<V>& parent_pull() const { return parent_pull_; }
  PLUMB_INLINE const Vec<V>& grand_pull() const { return grand_pull_; }
};

/// Adds the slopes of a joint's pull to the tiles of its particles. `beyond` of them are fixed beyond the
/// tip.
template <class V>
PLUMB_INLINE void add_slopes(const TwistSlopes<V>& slopes, const V& scale, std::ptrdiff_t beyond,
                             PlacedTwist<V>& to) {
  const Mat<V> ff = scale * slopes.first_first, fs = scale * slopes.first_second;
  const Mat<V> sf = scale * slopes.second_first, ss = scale * slopes.second_second;
  if (beyond == 2) {
    to.own_ = to.own_ + ff;
    return;
  }
  const Mat<V> middle = (ff - fs) + (ss - sf), down = sf - ff, up = fs - ff;
  if (beyond == 1) {
    to.own_ = to.own_ + middle;
    to.to_parent_ = to.to_parent_ + down;
    to.from_parent_ = to.from_parent_ + up;
    to.parent_ = to.parent_ + ff;
    return;
  }
  to.own_ = to.own_ + ss;
  to.to_parent_ = to.to_parent_ + (sf - ss);
  to.from_parent_ = to.from_parent_ + (fs - ss);
  to.parent_ = to.parent_ + middle;
  to.to_grand_ = to.to_grand_ - sf;
  to.from_grand_ = to.from_grand_ - fs;
  to.parent_to_grand_ = to.parent_to_grand_ + down;
  to.grand_to_parent_ = to.grand_to_parent_ + up;
  to.grand_ = to.grand_ + ff;
}

/// Returns what acts at a place of a twisted line.
template <bool is_mid, class V, class T, class At>
PLUMB_INLINE PlacedTwist<V> twist_at(const BentLine<V, T, At>& line, std::ptrdiff_t slot, const V& theta) {
  const PlacedBend<V> bend = bend_at<is_mid, V>(line, slot, theta);
  const V zero(0);
  const Vec<V> none{zero, zero, zero};
  PlacedTwist<V> out{bend.own(),         bend.to_parent(),       bend.to_grand(),
                     bend.from_parent(), bend.parent(),          bend.parent_to_grand(),
                     bend.from_grand(),  bend.grand_to_parent(), bend.grand(),
                     bend.own_pull(),    bend.parent_pull(),     bend.grand_pull(),
                     {none, none, none}, {none, none, none},     zero};
  if (!line.is_joint(slot)) return out;
  const TwistOfJoint<V> joint = twist_of_joint<is_mid, V>({line.rod(slot - 1), line.rod(slot)},
                                                          {line.growth(slot - 1), line.growth(slot)});
  const TreeView<T>& tree = line.tree;
  const V torque = line.at.get(tree.torque, 0), growth = theta * line.at.get(tree.twist_stiffness, 0);
  const std::ptrdiff_t beyond = slot + 1 - static_cast<std::ptrdiff_t>(tree.nodes);
  add_slopes(joint.slopes, theta * torque, beyond, out);
  out.torque = shares_of(joint.pull, beyond);
  out.row = shares_of(RodPair<V>{growth * joint.gradient.first, growth * joint.gradient.second}, beyond);
  out.own_pull_ = out.own_pull_ + torque * out.torque.own;
  out.parent_pull_ = out.parent_pull_ + torque * out.torque.parent;
  out.grand_pull_ = out.grand_pull_ + torque * out.torque.grand;
  out.turn = joint.turn;
  return out;
}

/// A node was eliminated with its rod by these, see bent_lanes.hpp.
template <class V>
struct EliminatedNode {
  std::size_t i;
  const Mat<V>&h, &by_parent, &by_grand, &from_parent, &from_grand;
  const Vec<V>&a, &b, &u, &q;
  const V& over;
};

/// The torque changes by this, and the root is pulled so by a unit of it.
template <class V>
struct TorqueChange {
  V change;
  Vec<V> root;

  template <class T, class At>
  PLUMB_INLINE Vec<V> displaced(const TreeView<T>& tree, const At& at, std::size_t i, const Vec<V>& q) const {
    return q - change * at.get3(tree.torque_elimination, i * tree_fields::torque_elimination);
  }
  template <class T, class At>
  PLUMB_INLINE V pulled(const TreeView<T>& tree, const At& at, std::size_t i, const V& rho) const {
    return rho - change * at.get(tree.torque_elimination, i * tree_fields::torque_elimination + 3);
  }
  PLUMB_INLINE Vec<V> root_force() const { return V(-1) * (change * root); }
  template <class T, class At>
  PLUMB_INLINE Vec<V> tip_force(const TreeView<T>& tree, const At& at, const Vec<V>& f) const {
    return f - change * at.get3(tree.torque_elimination,
                                std::size_t{tree.nodes} * tree_fields::torque_elimination);
  }
  template <class T, class At>
  PLUMB_INLINE void apply(const TreeView<T>& tree, const At& at, const V& active) const {
    const V old = at.get(tree.torque, 0);
    at.put(tree.torque, 0, select_nonzero(active, old + change, old));
  }
};

/// What is left of the torque's column and row while a line is eliminated, for the node and its parent.
template <class V>
struct TorqueBorder {
  Vec<V> pull, parent_pull, row, parent_row;
  V own, turn, done;  ///< z, what the chain has turned, and what is taken from r.

  PLUMB_INLINE TorqueBorder() {
    const V zero(0);
    pull = parent_pull = row = parent_row = {zero, zero, zero};
    own = V(-1);
    turn = done = zero;
  }
  PLUMB_INLINE void add(const PlacedTwist<V>& twist) {
    pull = pull + twist.torque.own;
    parent_pull = parent_pull + twist.torque.parent;
    row = row + twist.row.own;
    parent_row = parent_row + twist.row.parent;
    turn = turn + twist.turn;
  }
  template <class T, class At>
  PLUMB_INLINE void put_tip(const TreeView<T>& tree, const At& at) const {
    at.put3(tree.torque_elimination, std::size_t{tree.nodes} * tree_fields::torque_elimination, pull);
  }
  template <class T, class At>
  PLUMB_INLINE void eliminate(const TreeView<T>& tree, const At& at, const EliminatedNode<V>& node,
                              const PlacedTwist<V>& twist) {
    const Vec<V> free = multiply(node.h, pull);
    const V rho = (V(0) - dot(node.b, free)) * node.over;
    const Vec<V> e = free + rho * node.u;
    const std::size_t f = node.i * tree_fields::torque_elimination;
    at.put3(tree.torque_elimination, f, e);
    at.put(tree.torque_elimination, f + 3, rho);
    done = done + dot(row, node.q);
    own = own - dot(row, e);
    pull = parent_pull - (multiply(node.from_parent, e) + rho * node.a);
    parent_pull = twist.torque.grand - multiply(node.from_grand, e);
    const Vec<V> handed = row;
    row = parent_row + multiply_transposed(node.by_parent, handed);
    parent_row = twist.row.grand + multiply_transposed(node.by_grand, handed);
  }
  /// Solves for the torque, and changes the displacement of the root by it.
  template <class T, class At>
  PLUMB_INLINE TorqueChange<V> finish(const TreeView<T>& tree, const At& at, const V& theta, const Mat<V>& h,
                                      Vec<V>& change) const {
    const Vec<V> e = multiply(h, pull);
    const V wanted = at.get(tree.twist_stiffness, 0) * (at.get(tree.twist_start, 0) + theta * turn);
    const V right = ((at.get(tree.torque, 0) - wanted) - done) - dot(row, change);
    const TorqueChange<V> out{right / (own - dot(row, e)), pull};
    change = change - out.change * e;
    return out;
  }
};

/// A line without a twist has no torque.
template <class V>
struct NoTorqueChange {
  template <class T, class At>
  PLUMB_INLINE const Vec<V>& displaced(const TreeView<T>&, const At&, std::size_t, const Vec<V>& q) const {
    return q;
  }
  template <class T, class At>
  PLUMB_INLINE const V& pulled(const TreeView<T>&, const At&, std::size_t, const V& rho) const {
    return rho;
  }
  PLUMB_INLINE Vec<V> root_force() const {
    const V zero(0);
    return {zero, zero, zero};
  }
  template <class T, class At>
  PLUMB_INLINE const Vec<V>& tip_force(const TreeView<T>&, const At&, const Vec<V>& f) const {
    return f;
  }
  template <class T, class At>
  PLUMB_INLINE void apply(const TreeView<T>&, const At&, const V&) const {}
};
template <class V>
struct NoTorqueBorder {
  PLUMB_INLINE void add(const PlacedBend<V>&) {}
  template <class T, class At>
  PLUMB_INLINE void put_tip(const TreeView<T>&, const At&) const {}
  template <class T, class At>
  PLUMB_INLINE void eliminate(const TreeView<T>&, const At&, const EliminatedNode<V>&, const PlacedBend<V>&) {
  }
  template <class T, class At>
  PLUMB_INLINE NoTorqueChange<V> finish(const TreeView<T>&, const At&, const V&, const Mat<V>&,
                                        Vec<V>&) const {
    return {};
  }
};

/// Says how far the chain of a twisted line has turned in a substep that is solved.
template <class V, std::size_t lanes, class T>
PLUMB_INLINE void measure_turn(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const BentLine<V, T, At<V, T, lanes>> line{tree, at};
  V sum(0);
  for (std::ptrdiff_t slot = tree.twist_begin; slot < static_cast<std::ptrdiff_t>(tree.twist_end); ++slot) {
    const RodPair<V> change{line.growth(slot - 1), line.growth(slot)};
    const RodPair<V> middle = sum_of(RodPair<V>{line.rod(slot - 1), line.rod(slot)}, V(0.5), change);
    sum = sum + dot(twist_direction(middle, twist_sizes(middle)), change);
  }
  at.put(tree.twist_turn, 0, sum);
}

}  // namespace
}  // namespace plumb::simd
