#pragma once

#include <cstdint>

#include "direct/twists/loop_twists.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

template <class T>
struct TreeState;
template <class T>
struct TreeWorkspace;

/// Equal lines in lanes have these numbers of their twist, one a lane, see simd::TreeView. Other trees have
/// none.
struct TreeTwists {
  Array<LoopTwistNumbers> numbers;
  Array<double> twisted;  ///< Chains are twisted so far, in rad.
};

/// Gives a lane the numbers of its twist.
template <class T>
void load_twist(TreeState<T>& state, std::uint32_t lane, const BendTable& table, std::uint32_t twist);

/// Prepares for a substep of h (s), whose torques are those of the chains as they are.
template <class T>
void start_twists(const TreeState<T>& state, double h, TreeWorkspace<T>& work);

/// Twists chains by what a substep of h (s) turned, in lanes that took it, and adds up what they ask of ties.
template <class T>
void end_twists(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work);

template <class Archive>
void visit_members(Archive& archive, TreeTwists& of) {
  auto& [numbers, twisted] = of;
  archive(numbers, twisted);
}

}  // namespace plumb::detail
