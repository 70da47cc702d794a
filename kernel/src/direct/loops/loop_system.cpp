#include <algorithm>
#include <cstdint>
#include <utility>

#include "direct/loops/loop_state.hpp"
#include "linear/elimination_order.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {
namespace {

using Index = std::uint32_t;

/// An island with so many nodes has these rods and elements.
struct Parts {
  const Array<LoopRod>& rods;
  const LoopElements& elements;
  Index nodes;

  Index rod_count() const { return static_cast<Index>(rods.size()); }
  Index tackle_count() const { return static_cast<Index>(elements.tackles.size()); }
  Index twist_count() const { return static_cast<Index>(elements.twists.size()); }
  /// These are the first variables of multipliers and of torques, and their end.
  Index first_tackle() const { return nodes + rod_count(); }
  Index first_pulley() const { return first_tackle() + tackle_count(); }
  Index first_torque() const { return first_pulley() + elements.pulleys(); }
  Index variables() const { return first_torque() + twist_count(); }
};

/// Returns the pairs of nodes that rods and elements couple.
Array<std::pair<Index, Index>> edges_of(const Parts& of) {
  const LoopElements& elements = of.elements;
  const Index nodes = of.nodes;
  Array<std::pair<Index, Index>> out;
  for (const LoopRod rod : of.rods)
    if (rod.b < nodes) out.emplace_back(rod.a, rod.b);
  const auto add = [&](Index a, Index b) {
    if (a < nodes && b < nodes) out.emplace_back(a, b);
  };
  for (const LoopBend& bend : elements.bends)
    for (const auto [i, j] : LoopBend::pairs)
      if (i != j) add(bend.vertices[i], bend.vertices[j]);
  for (const LoopTackle& tackle : elements.tackles)
    for (Index s = 0; s < tackle.segments(); ++s) add(tackle.vertices[s], tackle.vertices[s + 1]);
  for (const LoopTwist& twist : elements.twists)
    for (Index k = 0; k < twist.joints(); ++k) {
      const auto [a, b, c] = twist.joint(k);
      add(a, b);
      add(b, c);
      add(a, c);
    }
  return out;
}

/// Puts nodes in the order given, and every rod or tackle right after the last of its nodes. Its pivot is
/// then what all of them can yield, which is never zero but for those that others make redundant. Pulleys
/// come before their tackle, since its first segment alone may yield nothing. Torques come last, since they
/// meet all of a chain.
Array<Index> with_rods(const Array<Index>& nodes, const Parts& of) {
  const Array<LoopRod>& rods = of.rods;
  const Array<LoopTackle>& tackles = of.elements.tackles;
  const auto n = static_cast<Index>(nodes.size());
  Array<Index> number(n);
  for (Index i = 0; i < n; ++i) number[nodes[i]] = i;
  Array<Array<Index>> after(n);
  for (Index k = 0; k < rods.size(); ++k)
    after[rods[k].b < n ? std::max(number[rods[k].a], number[rods[k].b]) : number[rods[k].a]].push_back(k);
  for (Index t = 0; t < tackles.size(); ++t) {
    Index last = 0;
    for (const Index vertex : tackles[t].vertices)
      if (vertex < n) last = std::max(last, number[vertex]);
    for (Index p = 0; p < tackles[t].pulleys(); ++p)
      after[last].push_back(of.first_pulley() - n + tackles[t].first_pulley + p);
    after[last].push_back(static_cast<Index>(rods.size()) + t);
  }
  Array<Index> order;
  for (Index i = 0; i < n; ++i) {
    order.push_back(nodes[i]);
    for (const Index k : after[i]) order.push_back(n + k);
  }
  for (Index torque = of.first_torque(); torque < of.variables(); ++torque) order.push_back(torque);
  return order;
}

/// Adds what bends couple to a pattern and its entries. Of a bend's values `at` is the first.
void add_bend(const LoopBend& bend, Index nodes, Index at, SparsePattern& pattern,
              Array<SparseEntry>& entries) {
  for (const auto [i, j] : LoopBend::pairs) {
    const Index a = bend.vertices[i], b = bend.vertices[j];
    for (Index row = 0; row < 3; ++row)
      for (Index column = 0; column < 3; ++column, ++at) {
        if (a >= nodes || b >= nodes) continue;
        entries.push_back({a, row, b, column, at});
        if (a != b) entries.push_back({b, row, a, column, at});
      }
    if (a < nodes && b < nodes && a != b) pattern.meet.emplace_back(a, b);
  }
}

/// Adds what the pulleys of a tackle, the variable `row`, couple. Of that tackle's values `at` is the first.
void add_pulleys(const Parts& of, const LoopTackle& tackle, Index row, Index at, SparsePattern& pattern,
                 Array<SparseEntry>& entries) {
  const Index first = of.first_pulley() + tackle.first_pulley;
  for (Index p = 0; p < tackle.pulleys(); ++p) {
    const Index own = first + p, before = p > 0 ? own - 1 : row, value = at + tackle.at_pulley(p);
    for (Index o = p + 1; o <= tackle.segments(); ++o) {
      const Index a = tackle.vertices[o], behind = o - p - 1;
      if (a >= of.nodes) continue;
      pattern.meet.emplace_back(a, own);
      for (Index c = 0; c < 3; ++c) {
        if (behind < 2) entries.push_back({a, c, own, 0, value + 3 * behind + c});
        entries.push_back({own, 0, a, c, value + LoopTackle::in_pulley + 3 * behind + c});
      }
    }
    pattern.meet.emplace_back(before, own);
    entries.push_back({own, 0, own, 0, value + tackle.in_own(p)});
    entries.push_back({own, 0, before, 0, value + tackle.in_own(p) + 1});
  }
}

/// Adds what a tackle, the variable `row`, couples. Of its values `at` is the first.
void add_tackle(const LoopTackle& tackle, Index nodes, Index row, Index at, SparsePattern& pattern,
                Array<SparseEntry>& entries) {
  const auto add_tile = [&](Index a, Index b, Index value) {
    for (Index r = 0; r < 3; ++r)
      for (Index c = 0; c < 3; ++c) entries.push_back({a, r, b, c, value + 3 * r + c});
  };
  for (Index o = 0; o < tackle.vertices.size(); ++o) {
    const Index a = tackle.vertices[o], value = at + LoopTackle::per_vertex * o;
    if (a >= nodes) continue;
    pattern.meet.emplace_back(a, row);
    for (Index c = 0; c < 3; ++c) {
      entries.push_back({a, c, row, 0, value + c});
      entries.push_back({row, 0, a, c, value + 3 + c});
    }
  }
  for (Index s = 0; s < tackle.segments(); ++s) {
    const Index a = tackle.vertices[s], b = tackle.vertices[s + 1];
    const Index value = at + tackle.at_segments() + LoopTackle::per_segment * s;
    if (a < nodes) add_tile(a, a, value);
    if (b < nodes) add_tile(b, b, value);
    if (a >= nodes || b >= nodes) continue;
    add_tile(a, b, value + 9);
    add_tile(b, a, value + 9);
    pattern.meet.emplace_back(a, b);
  }
  entries.push_back({row, 0, row, 0, at + tackle.at_soft()});
}

/// Adds what a twist couples, as add_bend() does. `torque` is its variable.
void add_twist(const LoopTwist& twist, Index nodes, Index torque, Index at, SparsePattern& pattern,
               Array<SparseEntry>& entries) {
  for (Index k = 0; k < twist.joints(); ++k) {
    const std::array<Index, 3> joint = twist.joint(k);
    for (const Index a : joint)
      for (const Index b : joint)
        for (Index c = 0; c < 9; ++c, ++at)
          if (a < nodes && b < nodes) entries.push_back({a, c / 3, b, c % 3, at});
    for (const bool is_row : {false, true})
      for (const Index a : joint)
        for (Index c = 0; c < 3; ++c, ++at)
          if (a < nodes)
            entries.push_back(is_row ? SparseEntry{torque, 0, a, c, at} : SparseEntry{a, c, torque, 0, at});
    for (Index i = 0; i < 3; ++i) {
      const Index a = joint[i], b = joint[(i + 1) % 3];
      if (a < nodes) pattern.meet.emplace_back(a, torque);
      if (a < nodes && b < nodes) pattern.meet.emplace_back(a, b);
    }
  }
  entries.push_back({torque, 0, torque, 0, at});
}

/// Adds what the elements of an island couple. Of their values `at` is the first.
void add_elements(const Parts& of, Index at, SparsePattern& pattern, Array<SparseEntry>& entries) {
  for (const LoopBend& bend : of.elements.bends) {
    add_bend(bend, of.nodes, at, pattern, entries);
    at += LoopBend::values;
  }
  Index row = of.first_tackle();
  for (const LoopTackle& tackle : of.elements.tackles) {
    add_pulleys(of, tackle, row, at, pattern, entries);
    add_tackle(tackle, of.nodes, row++, at, pattern, entries);
    at += tackle.values();
  }
  row = of.first_torque();
  for (const LoopTwist& twist : of.elements.twists) {
    add_twist(twist, of.nodes, row++, at, pattern, entries);
    at += twist.values();
  }
}

SparseAnalysis analyse(const Parts& of, bool couples) {
  const auto& [rods, elements, nodes] = of;
  SparsePattern pattern;
  pattern.size.assign(nodes, 3);
  pattern.size.resize(of.variables(), 1);
  Array<SparseEntry> entries;
  for (Index i = 0; i < nodes; ++i)
    for (Index c = 0; c < 3; ++c) entries.push_back({i, c, i, c, i});
  for (Index k = 0; k < rods.size(); ++k) {
    const auto [a, b] = rods[k];
    const Index rod = nodes + k, at = nodes + LoopSystem::per_rod * k;
    pattern.meet.emplace_back(a, rod);
    if (b < nodes) pattern.meet.emplace_back(b, rod);
    if (b < nodes && couples) pattern.meet.emplace_back(a, b);
    for (Index c = 0; c < 3; ++c) {
      entries.push_back({a, c, rod, 0, at + 4 + c});
      entries.push_back({rod, 0, a, c, at + 7 + c});
      if (b >= nodes) continue;
      entries.push_back({b, c, rod, 0, at + 1 + c});
      entries.push_back({rod, 0, b, c, at + 10 + c});
      if (!couples) continue;
      entries.push_back({a, c, b, c, at});
      entries.push_back({b, c, a, c, at});
    }
    entries.push_back({rod, 0, rod, 0, at + 13});
  }
  add_elements(of, nodes + LoopSystem::per_rod * of.rod_count(), pattern, entries);
  const Array<std::pair<Index, Index>> edges = edges_of(of);
  pattern.order = with_rods(order_by_degree(nodes, edges), of);
  if (nodes > least_dissected) {
    SparsePattern other = pattern;
    other.order = with_rods(order_by_dissection(nodes, edges), of);
    if (SparseAnalysis::estimate(other) < SparseAnalysis::estimate(pattern)) pattern = std::move(other);
  }
  return SparseAnalysis(pattern, entries);
}

}  // namespace

LoopSystem::LoopSystem(const Array<LoopRod>& of, std::uint32_t count, bool coupled,
                       const LoopElements& elements)
    : nodes(count),
      rods(static_cast<std::uint32_t>(of.size())),
      bends(static_cast<std::uint32_t>(elements.bends.size())),
      tackles(static_cast<std::uint32_t>(elements.tackles.size())),
      pulleys(elements.pulleys()),
      couples(coupled),
      analysis(analyse({of, elements, count}, coupled)) {
  for (const LoopTackle& tackle : elements.tackles) tackle_values += tackle.values();
  for (const LoopTwist& twist : elements.twists) twist_values += twist.values();
}

}  // namespace plumb::detail
