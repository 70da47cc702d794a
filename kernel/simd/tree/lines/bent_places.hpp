#pragma once

// The bends of a bent line, by their places along it, and what they do to Newton's matrix. bent_lanes.hpp
// includes this file.

#include "simd/tree/lines/bend_lanes.hpp"

namespace plumb::simd {
namespace {

/// Lines with bends or a twist are solved in double, so that float needs none of this.
template <class T>
constexpr bool bends_in = sizeof(T) == sizeof(double);

template <class V>
PLUMB_INLINE Mat<V> operator+(const Mat<V>& a, const Mat<V>& b) {
  return {a.v0 + b.v0, a.v1 + b.v1, a.v2 + b.v2};
}
template <class V>
PLUMB_INLINE Mat<V> operator*(const V& s, const Mat<V>& a) {
  return {s * a.v0, s * a.v1, s * a.v2};
}
template <class V>
PLUMB_INLINE Mat<V> operator-(const Mat<V>& a, const Mat<V>& b) {
  return {a.v0 - b.v0, a.v1 - b.v1, a.v2 - b.v2};
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
  /// Says whether the twisted chain has a joint there, whose rods then both are.
  PLUMB_INLINE bool is_joint(std::ptrdiff_t slot) const {
    return slot >= static_cast<std::ptrdiff_t>(tree.twist_begin) &&
           slot < static_cast<std::ptrdiff_t>(tree.twist_end);
  }
  /// Returns the way to a place from the one before where the substep starts, and how far that changes.
  PLUMB_INLINE Vec<V> rod(std::ptrdiff_t place) const {
    using tree_fields::rod;
    const auto nodes = static_cast<std::ptrdiff_t>(tree.nodes);
    if (place > 0 && place < nodes) return at.get3(tree.rod, rod * static_cast<std::size_t>(place));
    if (place == 0) return at.get3(tree.tie_rod, rod * std::size_t{end(-1)});
    if (place == nodes) return V(-1) * at.get3(tree.tie_rod, rod * std::size_t{end(nodes)});
    return at.get3(tree.clamp_rod, place < 0 ? 0 : 3);
  }
  PLUMB_INLINE Vec<V> growth(std::ptrdiff_t place) const { return delta(place) - delta(place - 1); }

  PLUMB_INLINE BendNumbers<V> numbers(std::ptrdiff_t slot) const {
    const std::size_t f = static_cast<std::size_t>(slot) * tree_fields::bend;
    return {at.get(tree.bend, f),     at.get(tree.bend, f + 1), at.get(tree.bend, f + 2),
            at.get(tree.bend, f + 3), at.get(tree.bend, f + 4), at.get(tree.bend, f + 5)};
  }
};

/// Measures w of all bends where a substep starts, and the ways from anchors to clamps.
template <class V, std::size_t lanes, class T>
PLUMB_INLINE void prepare_bends(const TreeView<T>& tree, std::size_t lane) {
  const At<V, T, lanes> at{lane};
  const BentLine<V, T, At<V, T, lanes>> line{tree, at};
  const auto way = [](const double* from, const double* to) {
    return Vec<V>{narrow<V>(load_wide<V>(to) - load_wide<V>(from)),
                  narrow<V>(load_wide<V>(to + lanes) - load_wide<V>(from + lanes)),
                  narrow<V>(load_wide<V>(to + 2 * lanes) - load_wide<V>(from + 2 * lanes))};
  };
  const auto nodes = static_cast<std::ptrdiff_t>(tree.nodes);
  for (std::ptrdiff_t slot = 0; slot < nodes + 2; ++slot) {
    if (!line.is_there(slot)) continue;
    const BendNumbers<V> bend = line.numbers(slot);
    const double* const middle = line.position(slot - 1);
    at.put3(tree.bend_start, 3 * static_cast<std::size_t>(slot),
            bend.last * way(middle, line.position(slot)) - bend.first * way(line.position(slot - 2), middle));
  }
  if (line.is_joint(0)) at.put3(tree.clamp_rod, 0, way(line.position(-2), line.position(-1)));
  if (line.is_joint(nodes + 1))
    at.put3(tree.clamp_rod, 3, way(line.position(nodes), line.position(nodes + 1)));
}

/// A node and its parent have these from bends and from what is below. Matrices are given by columns.
template <class V>
struct BentBlock {
  Mat<V> own, to_parent, from_parent, parent;
  Vec<V> r, parent_r;
  V residual;  ///< It is the sum of C^2 over all rods so far.
};

/// A bend pulls a node, its parent and that one's parent, by these weights. Those of fixed particles are 0.
/// Matrices have the pulls of the first that they name by the place of the second.
template <class V>
struct PlacedBend {
  BendPull<V> of;
  V own_weight, parent_weight, grand_weight;

  PLUMB_INLINE Mat<V> own() const { return (own_weight * own_weight) * of.slope; }
  PLUMB_INLINE Mat<V> to_parent() const { return (own_weight * parent_weight) * of.slope; }
  PLUMB_INLINE Mat<V> to_grand() const { return (own_weight * grand_weight) * of.slope; }
  PLUMB_INLINE Mat<V> from_parent() const { return to_parent(); }
  PLUMB_INLINE Mat<V> parent() const { return (parent_weight * parent_weight) * of.slope; }
  PLUMB_INLINE Mat<V> parent_to_grand() const { return (parent_weight * grand_weight) * of.slope; }
  PLUMB_INLINE Mat<V> from_grand() const { return to_grand(); }
  PLUMB_INLINE Mat<V> grand_to_parent() const { return parent_to_grand(); }
  PLUMB_INLINE Mat<V> grand() const { return (grand_weight * grand_weight) * of.slope; }
  PLUMB_INLINE Vec<V> own_pull() const { return own_weight * of.pull; }
  PLUMB_INLINE Vec<V> parent_pull() const { return parent_weight * of.pull; }
  PLUMB_INLINE Vec<V> grand_pull() const { return grand_weight * of.pull; }
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
  PlacedBend<V> out{bend_pull_of<is_mid>(bend, factors, tree.has_bend_damping, start, change), bend.last,
                    slot > 0 ? bend.middle : none, slot > 1 ? bend.first : none};
  if (const std::ptrdiff_t beyond = slot + 1 - static_cast<std::ptrdiff_t>(tree.nodes); beyond > 0) {
    // Beyond the tip a bend begins with fixed particles.
    out.own_weight = beyond == 1 ? bend.middle : bend.first;
    out.parent_weight = beyond == 1 ? bend.first : none;
    out.grand_weight = none;
  }
  return out;
}

/// Adds what acts at a place to the block of its node.
template <class V, class Elements>
PLUMB_INLINE void add_elements(const Elements& elements, BentBlock<V>& block) {
  block.own = block.own + elements.own();
  block.to_parent = block.to_parent + elements.to_parent();
  block.from_parent = block.from_parent + elements.from_parent();
  block.parent = block.parent + elements.parent();
  block.r = block.r - elements.own_pull();
  block.parent_r = block.parent_r - elements.parent_pull();
}

}  // namespace
}  // namespace plumb::simd
