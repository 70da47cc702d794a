#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "direct/bends/loop_bends.hpp"
#include "plumb/layouts/aligned_buffer.hpp"

namespace plumb::detail {

template <class T>
struct TreeState;
template <class T>
struct TreeWorkspace;

/// Holds the bends of equal lines in lanes, see simd::TreeView. Trees without bends and twists have none of
/// it.
template <class T>
struct TreeBends {
  layouts::AlignedBuffer<T> law;  ///< It has simd::tree_fields::bend numbers per slot.
  bool damped = false;            ///< Some bend is.

  bool any() const { return law.size() > 0; }
};

/// Gives a lane the numbers of its bends, in the order of its topology.
template <class T>
void load_bends(TreeState<T>& state, std::uint32_t lane, const BendTable& table,
                std::span<const std::uint32_t> bends);

/// Returns the numbers of the bend of a slot.
template <class T>
BendNumbers bend_numbers(const TreeState<T>& state, std::uint32_t slot, std::uint32_t lane);

/// Prepares for a substep of h (s). Rods that change their length change the numbers of bends.
template <class T>
void begin_bends(TreeState<T>& state, double h, TreeWorkspace<T>& work);

/// Adds up what bends asked of ties in a substep of `h` (s), and what they pulled with along rods.
template <class T>
void hold_bends(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work);

template <class Archive, class T>
void visit_members(Archive& archive, TreeBends<T>& of) {
  auto& [law, damped] = of;  // what dampens is known from the start
  archive(law);
}

}  // namespace plumb::detail
