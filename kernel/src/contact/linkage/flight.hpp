#pragma once

#include <array>
#include <cstdint>

#include "contact/linkage/linkage_state.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Moves an island alone in the air by Runge-Kutta steps of order 4 or 6: accelerations that keep the second
/// derivatives of constraints, one factorisation each, and at the end positions and velocities that keep the
/// constraints themselves. Nothing pushes but gravity, forces, air, drag and elastics that a step can follow.
class Flight {
 public:
  /// Takes one step of `h` (s); the order is 4 or 6. Returns false if constraints are not kept; then nothing
  /// has moved.
  bool step(LinkageState& state, std::uint32_t order, double h, Tally& report);
  /// Takes from velocities what constraints forbid, where anchors have changed theirs since the last substep.
  void follow_anchors(LinkageState& state);

 private:
  static constexpr std::size_t most_stages = 7;
  /// Where a stage is, how it moves and how that changes.
  struct Stage {
    Array<Vec3> x, v, a;
  };

  void brake(const Linkage& linkage, const Stage& stage);
  void accelerate(LinkageState& state, Stage& stage, double time);
  void count_pulls(LinkageState& state, const Stage& stage, double time);
  void take_forbidden(LinkageState& state);
  bool land(LinkageState& state, Tally& report);

  std::array<Stage, most_stages> stages_;
  Array<Vec3> before_x_, before_v_, force_, rigid_, braked_, momentum_;
  Array<simd::Quad> unknowns_;
  Array<double> pulls_;         ///< multipliers
  Array<double> rod_impulses_;  ///< N s, of rods that give in the step, if some may break
  LinkagePulls before_pulls_;
};

}  // namespace plumb::detail
