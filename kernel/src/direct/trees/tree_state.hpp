#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/trees.hpp"
#include "plumb/scene.hpp"
#include "simd/tree/tree_kernels.hpp"

namespace plumb::detail {

/// What equal trees share: who hangs from whom.
struct TreeTopology {
  explicit TreeTopology(const layouts::Tree& tree);

  std::uint32_t nodes, ties;
  std::vector<std::uint32_t> parent, tie_begin, below_slot;
  std::uint32_t below_slots = 0;
  bool is_line = false;                  ///< one node after the other, with at most one tie at either end
  std::vector<std::uint8_t> holds_ties;  ///< per node: whether it or something below it is tied
};

/// Which particles and rods of the scene a tree is made of.
struct TreeMembers {
  std::span<const std::uint32_t> vertices;  ///< the island's, as its tree numbers them
  std::span<const std::uint32_t> edges;
};

/// The numbers of `lanes` equal trees that outlive a step. See simd::TreeView.
///
/// `u` is a velocity (m/s) in lanes whose `u_step` is 0, which is how every tree begins and how gradient mid
/// keeps it, and otherwise the displacement of the last substep, of length u_step (s).
template <class T>
struct TreeState {
  TreeState(std::shared_ptr<const TreeTopology> topology, std::uint32_t lanes);

  /// Puts a tree of the scene, at rest, into a lane.
  void fill_lane(std::uint32_t lane, const Scene& scene, MassModel model, const layouts::Tree& tree,
                 const TreeMembers& members);
  void copy_lane(std::uint32_t lane, const TreeState& from, std::uint32_t from_lane);

  /// Makes u of a lane velocities, m/s, of every node.
  void set_velocities(std::uint32_t lane, const layouts::AlignedBuffer<T>& velocity);
  /// The same, and forgets accelerations, which the next steps would start from.
  void restart(std::uint32_t lane, const layouts::AlignedBuffer<T>& velocity);

  /// Takes over what a substep changes from another state of the same trees.
  void copy_motion(const TreeState& from);

  std::size_t at(std::uint32_t entry, std::uint32_t lane) const { return std::size_t{entry} * lanes + lane; }
  Vec3 position(std::uint32_t node, std::uint32_t lane) const;
  void set_force(std::uint32_t node, std::uint32_t lane, Vec3 newton);

  /// Whether a lane is left out of steps: it has no tree of its own, or its tree is moved elsewhere.
  void set_idle(std::uint32_t lane, bool is_idle);

  std::shared_ptr<const TreeTopology> topology;
  std::uint32_t lanes;
  std::uint32_t trees;             ///< lanes that are not idle
  std::vector<std::uint8_t> idle;  ///< per lane
  layouts::AlignedBuffer<T> node, tie, u, acceleration, acceleration_before, force, tie_delta, tie_u, mu,
      tie_mu, mu_before, tie_mu_before;
  layouts::AlignedBuffer<double> length2, tie_length2, x, tie_x, weight;  ///< weight: gravity per node, N
  std::vector<double> mass_unit;                                          ///< kg, per lane
  std::vector<double> scale2;  ///< m^2, per lane: mean squared length of a rod
  std::vector<double> u_step,
      u_step_before;  ///< s, per lane: of the last substep and the one before; 0: a velocity
  std::vector<double> mu_kick,
      mu_kick_before;  ///< s^2, per lane: kicks with which mu and mu_before were found; 0: unknown
  /// m/s, per tie and lane: of fixed ends, in this step and in the last substep.
  std::vector<Vec3> tie_velocity, tie_last_velocity;
  std::vector<std::uint8_t> known;  ///< per lane: substeps taken, up to the two that accelerations are from
  bool ties_move = false;
  bool is_coupled = false;  ///< some rod's mass acts on both its ends at once
  double frequency2 = 0;  ///< 1/s^2, of the fastest transverse wave of all lanes, squared; gradient old only
  std::vector<std::uint8_t> smooth;  ///< per lane: whether the last acceleration foretells the next

 private:
  struct Masses;
  void write_masses(std::uint32_t lane, const Masses& masses, Vec3 gravity);
  /// Writes three numbers into entries `first` and those after it.
  void put(layouts::AlignedBuffer<double>& to, std::uint32_t first, std::uint32_t lane, Vec3 v) const;
};

/// The fields of a state that substeps change, beside the same of another: f(field, other's) of those with
/// numbers for every node and of those with one a lane, f(field, ties' field, other's, other's) of
/// multipliers.
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
}
/// All of them, one by one.
template <class State, class Other, class F>
void for_motion(State& state, Other& other, F&& f) {
  for_node_motion(state, other, f);
  for_rod_motion(state, other, [&f](auto& rods, auto& ties, auto& other_rods, auto& other_ties) {
    f(rods, other_rods);
    f(ties, other_ties);
  });
  for_lane_motion(state, other, f);
}

/// What a thread needs while it steps trees; reused from one to the next, so that it stays in its cache.
template <class T>
struct TreeWorkspace {
  TreeWorkspace(const TreeTopology& topology, std::uint32_t lanes);

  simd::TreeView<T> view(TreeState<T>& state);

  layouts::AlignedBuffer<T> delta, velocity, load, rod, tie_rod, elimination, tie_elimination, below, active,
      change, stiffness, residual, ratio, kick, guess, guess_before, mu_scale, mu_scale_before, u_delta,
      u_before, inverse_kick, push, jolt;
  bool guesses = true;             ///< displacements, from accelerations; lines find theirs from multipliers
  bool keeps_acceleration = true;  ///< for guesses and estimates of error
  std::vector<std::uint8_t> failed;  ///< per lane, of the last solve
  std::vector<std::uint8_t> first;   ///< per lane: no acceleration is known from two substeps before
};

}  // namespace plumb::detail
