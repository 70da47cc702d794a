#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "direct/laws/law_factors.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds how the rods of equal trees in lanes give, change their lengths and pull, see simd::TreeView. Trees
/// of rigid rods have none of it.
template <class T>
struct TreeLaws {
  bool any = false;     ///< There are numbers here: some rod gives, or is asked how it pulls.
  bool gives = false;   ///< Some rod is not rigid, or changes its length.
  bool cables = false;  ///< Some rod is one-sided.
  bool breaks = false;  ///< Some rod has a finite strength.
  bool moves = false;   ///< Some rod changes its length.
  bool pulls = false;   ///< Pulls are added up.

  /// Holds numbers of the rods to parents and of those to anchors.
  template <class Number>
  struct Of {
    layouts::AlignedBuffer<Number> rods, ties;
    void make(std::size_t rod_numbers, std::size_t tie_numbers) {
      rods = layouts::AlignedBuffer<Number>(rod_numbers);
      ties = layouts::AlignedBuffer<Number>(tie_numbers);
    }
  };
  Of<T> law;                                 ///< They have tree_fields::law numbers per rod.
  Of<T> half_kick;                           ///< They have one number per rod, and so have the next ones.
  Of<double> length;                         ///< At the end of the last substep, in m.
  Of<double> rate;                           ///< Lengths change by so much, in m/s.
  Of<double> jump;                           ///< Rates changed by so much as the step began, in m/s.
  Of<double> impulse;                        ///< Pulls times substeps, of this step, in N s.
  Of<double> ahead;                          ///< Of it, what the next step takes back, see pulls_ahead.hpp.
  Of<double> blow;                           ///< Of it, what came as the step began. Only while rods move.
  Of<T> step;                                ///< They have tree_fields::law_step numbers per rod.
  Array<LawFactors> factors;                 ///< Steps are made of them, per lane.
  layouts::AlignedBuffer<T> factor_numbers;  ///< They are the same, see simd::law_factors.
  bool steps_are_old = true;                 ///< Steps are to be made anew.

  /// Makes room for `nodes` rods to parents and `ties` to anchors, lanes included. All are rigid.
  void make(std::size_t nodes, std::size_t ties, std::uint32_t lanes) {
    any = true;
    if (law.rods.size() > 0 || law.ties.size() > 0) return;
    law.make(simd::tree_fields::law * nodes, simd::tree_fields::law * ties);
    half_kick.make(nodes, ties);
    length.make(nodes, ties);
    rate.make(nodes, ties);
    jump.make(nodes, ties);
    impulse.make(nodes, ties);
    ahead.make(nodes, ties);
    make_steps(lanes);
    for (auto* const buffer : {&law.rods, &law.ties})
      for (std::size_t i = 0; i * simd::tree_fields::law * lanes < buffer->size(); ++i)
        std::fill_n(buffer->data() + (simd::tree_fields::law * i + 2) * lanes, lanes, T(1));
  }

  /// Makes room for steps of laws that have theirs.
  void make_steps(std::size_t lanes) {
    step.make(simd::tree_fields::law_step * half_kick.rods.size(),
              simd::tree_fields::law_step * half_kick.ties.size());
    factors.assign(lanes, {});
    factor_numbers = layouts::AlignedBuffer<T>(std::size_t{simd::law_factors::count} * lanes);
  }

  /// Writes tree_fields::law numbers of a rod from entry `first` on, and notes what they ask for.
  void put(layouts::AlignedBuffer<T>& to, std::size_t first, std::uint32_t lanes, const RodLaw& of,
           const LawMasses& masses) {
    const auto numbers = law_numbers(of, masses);
    for (std::size_t c = 0; c < numbers.size(); ++c) to[first + c * lanes] = static_cast<T>(numbers[c]);
    gives = gives || !of.is_rigid();
    cables = cables || of.one_sided;
    breaks = breaks || numbers[5] > 0;
  }

  /// Sets the factors of the next substep or projection of a lane.
  void set_factors(std::uint32_t lane, const LawFactors& of) {
    if (of == factors[lane]) return;
    factors[lane] = of;
    steps_are_old = true;
    of.put(factor_numbers.data() + lane, factors.size());
  }

  /// Numbers of laws are copied, too, of which steps are made.
  void copy_flags(const TreeLaws& from) {
    steps_are_old = true;
    any = from.any;
    gives = from.gives;
    cables = from.cables;
    breaks = from.breaks;
    moves = from.moves;
    pulls = from.pulls;
  }
};

/// Visits the numbers of laws beside those of another, as f(rods, ties, numbers per rod, other's rods,
/// other's ties).
template <class Laws, class Other, class F>
void for_laws(Laws& laws, Other& other, F&& f) {
  const auto visit = [&](auto& of, std::uint32_t count, auto& others) {
    f(of.rods, of.ties, count, others.rods, others.ties);
  };
  visit(laws.law, simd::tree_fields::law, other.law);
  visit(laws.half_kick, 1, other.half_kick);
  visit(laws.length, 1, other.length);
  visit(laws.rate, 1, other.rate);
  visit(laws.jump, 1, other.jump);
  visit(laws.impulse, 1, other.impulse);
  visit(laws.ahead, 1, other.ahead);
}

/// Steps are made anew. Trees without numbers, which are many, list none.
template <class Archive, class T>
void visit_members(Archive& archive, TreeLaws<T>& of) {
  auto& [any, gives, cables, breaks, moves, pulls, law, half_kick, length, rate, jump, impulse, ahead, blow,
         step, factors, factor_numbers, steps_are_old] = of;
  archive(any, gives, cables, breaks, moves, pulls);
  if (!any) {
    if (archive.restores() && !factors.empty()) of = {};
    return;
  }
  for_laws(of, of, [&](auto& rods, auto& ties, std::uint32_t, auto&, auto&) { archive(rods, ties); });
  archive(blow.rods, blow.ties);
  std::size_t lanes = factors.size();
  archive(lanes);
  if (!archive.restores()) return;
  if (lanes != factors.size()) of.make_steps(lanes);
  steps_are_old = true;
}

}  // namespace plumb::detail
