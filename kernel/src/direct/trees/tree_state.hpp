#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "direct/bends/line_bends.hpp"
#include "direct/bends/tree_bends.hpp"
#include "direct/grabs/tree_grabs.hpp"
#include "direct/laws/tree_laws.hpp"
#include "direct/twists/tree_twists.hpp"
#include "interface/read_rows.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/trees.hpp"
#include "plumb/scene.hpp"
#include "simd/tree/tree_kernels.hpp"
#include "time/effort.hpp"

namespace plumb::detail {

/// Equal trees share who hangs from whom.
struct TreeTopology {
  explicit TreeTopology(const layouts::Tree& tree, LineBends bends = {});

  LineBends bends;            ///< Lines may have some, and a twist.
  std::uint32_t nodes, ties;  ///< Ties without rods, which bends and twists have, come last.
  Array<std::uint32_t> parent, tie_begin, below_slot;
  std::uint32_t below_slots = 0;
  std::uint32_t rods() const { return nodes - 1 + tie_begin[nodes]; }
  bool is_line = false;            ///< One node follows the other, with at most one tie at either end.
  Array<std::uint8_t> holds_ties;  ///< They say per node whether it or something below it is tied.
};

/// A tree is made of these particles and rods of the scene.
struct TreeMembers {
  std::span<const std::uint32_t> vertices;  ///< They are the island's, as its tree numbers them.
  std::span<const std::uint32_t> edges;
};

/// These numbers of `lanes` equal trees outlive a step. See simd::TreeView.
///
/// `u` is a velocity (m/s) in lanes whose `u_step` is 0. So every tree begins, and gradient mid keeps it so.
/// Otherwise it is the displacement (m) of the last substep, of length u_step (s).
template <class T>
struct TreeState {
  TreeState(std::shared_ptr<const TreeTopology> topology, std::uint32_t lanes);

  /// Puts a tree of the scene, at rest, into a lane.
  void fill_lane(std::uint32_t lane, const Scene& scene, MassModel model, const layouts::Tree& tree,
                 const TreeMembers& members);
  void copy_lane(std::uint32_t lane, const TreeState& from, std::uint32_t from_lane);

  /// Makes u of a lane velocities, m/s, of every node.
  void set_velocities(std::uint32_t lane, std::span<const T> velocity);
  /// Does the same, and forgets accelerations, which the next steps would start from.
  void restart(std::uint32_t lane, std::span<const T> velocity);

  /// Takes over what a substep changes from another state of the same trees.
  void copy_motion(const TreeState& from);

  std::size_t at(std::uint32_t entry, std::uint32_t lane) const { return std::size_t{entry} * lanes + lane; }
  /// Returns three numbers of a lane, from entry `first` of a buffer on.
  template <class Buffer>
  Vec3 read(const Buffer& from, std::size_t first, std::size_t lane) const {
    const auto number = [&](std::size_t c) { return static_cast<double>(from[(first + c) * lanes + lane]); };
    return {number(0), number(1), number(2)};
  }
  /// Reads three numbers of each particle of a run, whose slots from `begin` to `end` number `from` by
  /// entries and lanes. Returns whether its rows are in lanes that these slots have.
  template <class Number>
  bool read_run(const layouts::AlignedBuffer<Number>& from, std::uint32_t begin, std::uint32_t end,
                const Run& run, Vec3* out) const {
    const int shift = std::countr_zero(lanes);  // a division would take longer than all else
    const std::uint32_t slot = run.slot - begin, lane = slot & (lanes - 1);
    const bool is_in_lanes = std::min(run.slot, run.last_slot()) >= begin &&
                             std::max(run.slot, run.last_slot()) < end && run.slot_stride % lanes == 0 &&
                             (run.rows == 1 || (run.row_slot == 1 && lane + run.rows <= lanes));
    if (!is_in_lanes) return false;
    const auto next = 3 * std::ptrdiff_t{static_cast<std::int32_t>(run.slot_stride)};
    read_rows(run,
              RowsAt<Number>{&from[at(3 * (slot >> shift), lane)], static_cast<std::ptrdiff_t>(lanes), next},
              out);
    return true;
  }
  Vec3 position(std::uint32_t node, std::uint32_t lane) const;
  void set_force(std::uint32_t node, std::uint32_t lane, Vec3 newton);

  /// Sets gravity (m/s^2), and takes the forces from a lane.
  void set_gravity(std::uint32_t lane, Vec3 gravity);
  /// Sets whether a lane is left out of steps. It then has no tree of its own, or its tree is moved
  /// elsewhere.
  void set_idle(std::uint32_t lane, bool is_idle);
  /// Makes the displacement of a substep of h (s) of a node's velocity, in a lane where all get theirs.
  void displace(std::uint32_t number, std::uint32_t lane, double h);

  std::shared_ptr<const TreeTopology> topology;
  std::uint32_t lanes;
  std::uint32_t trees;       ///< So many lanes are not idle.
  Array<std::uint8_t> idle;  ///< It is 1 per lane that is.
  layouts::AlignedBuffer<T> node, tie, u, acceleration, acceleration_before, force, tie_delta, tie_u, mu,
      tie_mu, mu_before, tie_mu_before;
  layouts::AlignedBuffer<double> length2, tie_length2, x, tie_x, weight,
      weighs;               ///< The weight is gravity per node, in N, and what it acts on in kg.
  Array<double> mass_unit;  ///< It is per lane, in kg.
  Array<double> scale2;     ///< It is the mean squared length of a rod per lane, in m^2.
  Array<double> u_step,
      u_step_before;  ///< They are of the last substep and the one before, per lane, in s; 0 means that u is
                      ///< a velocity.
  Array<double> mu_kick,
      mu_kick_before;  ///< mu and mu_before were found with these kicks, per lane, in s^2; 0 if unknown.
  /// Fixed ends have these velocities in this step and in the last substep, per tie and lane, in m/s.
  Array<Vec3> tie_velocity, tie_last_velocity;
  Array<std::uint8_t>
      known;  ///< Each lane has taken so many substeps, up to the two that accelerations are from.
  Array<std::uint8_t> gave;  ///< They say per lane whether rods gave in the last substep.
  TreeLaws<T> laws;
  TreeBends<T> bends;
  TreeTwists twists;
  TreeGrabs<T> grabs;
  /// Ties held with these impulses (N s) in this step, per tie and lane. There are none unless pulls are
  /// added up.
  Array<Vec3> hold;
  bool ties_move = false;
  bool is_coupled = false;  ///< Some rod's mass acts on both its ends at once.
  double frequency2 = 0;  ///< It is of the fastest transverse wave of all lanes, squared, in 1/s^2; gradient
                          ///< old alone has it.
  /// So many failing substeps are not halved, per lane, and the next time that they are it will be so many.
  Array<std::uint32_t> elastic, next_elastic;
  Array<Effort> effort;        ///< It says per lane how much may be tried in a substep.
  Array<std::uint8_t> smooth;  ///< They say per lane whether the last acceleration foretells the next.

 private:
  struct Masses;
  void fill_laws(std::uint32_t lane, const Scene& scene, const layouts::Tree& tree,
                 const TreeMembers& members);
  void write_masses(std::uint32_t lane, const Masses& masses, Vec3 gravity);
  /// Writes three numbers into entries `first` and those after it.
  void put(layouts::AlignedBuffer<double>& to, std::uint32_t first, std::uint32_t lane, Vec3 v) const;
};

/// These three visit the fields of a state that substeps change, beside the same of another. They call
/// f(field, other's) for those with numbers for every node and for those with one a lane. For multipliers
/// they call f(field, ties' field, other's, other's).
template <class State, class Other, class F>
void for_node_motion(State& state, Other& other, F&& f) {
  f(state.x, other.x);
  f(state.u, other.u);
  f(state.acceleration, other.acceleration);
  f(state.acceleration_before, other.acceleration_before);
}
template <class State, class Other, class F>
void for_rod_motion(State& state, Other& other, F&& f) {
  f(state.mu, state.tie_mu, other.mu, other.tie_mu);
  f(state.mu_before, state.tie_mu_before, other.mu_before, other.tie_mu_before);
}
template <class State, class Other, class F>
void for_lane_motion(State& state, Other& other, F&& f) {
  f(state.u_step, other.u_step);
  f(state.u_step_before, other.u_step_before);
  f(state.mu_kick, other.mu_kick);
  f(state.mu_kick_before, other.mu_kick_before);
  f(state.smooth, other.smooth);
  f(state.known, other.known);
  f(state.gave, other.gave);
  f(state.elastic, other.elastic);
  f(state.next_elastic, other.next_elastic);
  f(state.effort, other.effort);
}
/// Visits all of them, one by one.
template <class State, class Other, class F>
void for_motion(State& state, Other& other, F&& f) {
  for_node_motion(state, other, f);
  for_rod_motion(state, other, [&f](auto& rods, auto& ties, auto& other_rods, auto& other_ties) {
    f(rods, other_rods);
    f(ties, other_ties);
  });
  for_lane_motion(state, other, f);
}

/// A thread needs this while it steps trees. It is used again from one to the next, so that it stays in the
/// cache.
template <class T>
struct TreeWorkspace {
  TreeWorkspace(const TreeTopology& topology, std::uint32_t lanes);

  simd::TreeView<T> view(TreeState<T>& state);
  void add_bends(TreeState<T>& state, simd::TreeView<T>& to);
  void add_laws(TreeLaws<T>& laws, std::size_t rods, std::size_t ties, simd::TreeView<T>& to);

  layouts::AlignedBuffer<T> memory;  ///< It is one, since each would take as long to make as what it holds.
  // These are parts of it:
  std::span<T> blow, tie_blow;  ///< They are multipliers of a projection, per rod.
  std::span<T> delta, velocity, load, rod, tie_rod, elimination, tie_elimination, below, active, change,
      stiffness, residual, ratio, kick, guess, guess_before, mu_scale, mu_scale_before, u_delta, u_before,
      inverse_kick, push, jolt, bend_start, bend_rate, bent_elimination, clamp_rod, twist_stiffness,
      twist_start, torque, twist_turn, torque_elimination;
  layouts::AlignedBuffer<T> projection_factors, law_start,
      tie_law_start;              ///< Only trees with laws have them.
  bool is_mid = false;            ///< The substep is of gradient mid.
  bool keeps_half_kicks = false;  ///< The gradient is old, though a substep may be of another.
  bool is_line = false;  ///< Multipliers alone are solved for. Others guess displacements from accelerations.
  bool keeps_acceleration = true;   ///< Guesses and estimates of error need them.
  Array<std::uint32_t> iterations;  ///< The last solve took so many in each lane.
  Array<std::uint8_t> failed;       ///< The last solve failed in these lanes.
  Array<Vec3> tie_jump, tie_rest;   ///< How fixed ends change their velocity (m/s), and zeros.
  Array<std::uint8_t> first;        ///< Of these lanes no acceleration is known from two substeps before.
};

/// Masses, weights and scales follow from the scene.
template <class Archive, class T>
void visit_members(Archive& archive, TreeState<T>& of) {
  auto& [topology, lanes, trees, idle, node, tie, u, acceleration, acceleration_before, force, tie_delta,
         tie_u, mu, tie_mu, mu_before, tie_mu_before, length2, tie_length2, x, tie_x, weight, weighs,
         mass_unit, scale2, u_step, u_step_before, mu_kick, mu_kick_before, tie_velocity, tie_last_velocity,
         known, gave, laws, bends, twists, grabs, hold, ties_move, is_coupled, frequency2, elastic,
         next_elastic, effort, smooth] = of;
  archive(trees, idle);
  for_motion(of, of, [&](auto& field, auto&) { archive(field); });
  archive(force, tie_delta, tie_u, length2, tie_length2, tie_x, tie_velocity, tie_last_velocity, laws, bends,
          twists, grabs, hold, ties_move, frequency2);
}

}  // namespace plumb::detail
