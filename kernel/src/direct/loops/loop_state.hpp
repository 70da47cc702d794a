#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "direct/bends/loop_bends.hpp"
#include "direct/elastic_nets/net_matrix.hpp"
#include "direct/grabs/loop_grabs.hpp"
#include "direct/laws/loop_laws.hpp"
#include "direct/locks/locks.hpp"
#include "direct/loops/loop_elements.hpp"
#include "direct/loops/loop_rod.hpp"
#include "direct/nets/rod_lines.hpp"
#include "direct/reels/loop_reels.hpp"
#include "direct/tackles/loop_tackles.hpp"
#include "direct/twists/loop_twists.hpp"
#include "linear/sparse_ldu.hpp"
#include "plumb/layouts/graph.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "time/effort.hpp"
#include "time/pace.hpp"

namespace plumb::detail {

/// An island has this linear system for displacements of nodes and multipliers of rods:
///
///   [ M - theta Lambda   -A^T ]        M: mass matrix; Lambda: Laplacian of the multipliers
///   [ B                  soft ]        A, B: +direction at a, -direction at b of every rod
///
/// Its values begin with the diagonal of every node. Then every rod has the coupling of its ends, what -A^T
/// has at b (3) and at a (3), what B has at a (3) and at b (3), and soft. Bends add 3 x 3 numbers to M for
/// each pair of their particles. They are never rigid, so that a multiplier would only make the system
/// larger. Every tackle has a row and a multiplier, after those of rods, and adds to Lambda (LoopTackle).
/// Pulleys with friction have theirs after them. Every twist adds its torque, after those: one for all of its
/// chain, which keeps the rest sparse.
struct LoopSystem {
  LoopSystem(const Array<LoopRod>& rods, std::uint32_t nodes, bool couples,
             const LoopElements& elements = {});

  static constexpr std::uint32_t per_rod = 14;
  std::size_t at(std::uint32_t rod) const { return nodes + std::size_t{per_rod} * rod; }
  std::size_t at_bends() const { return at(rods); }  ///< Bends begin there.
  std::size_t at_tackles() const { return at_bends() + std::size_t{LoopBend::values} * bends; }
  std::size_t at_twists() const { return at_tackles() + tackle_values; }
  std::size_t values() const { return at_twists() + twist_values; }
  /// Returns the variable of a twist's torque.
  std::uint32_t torque(std::uint32_t twist) const { return nodes + rods + tackles + pulleys + twist; }

  std::uint32_t nodes, rods, bends, tackles, pulleys;
  std::size_t tackle_values = 0, twist_values = 0;
  bool couples;  ///< It says whether ends of a rod meet other than through it.
  SparseAnalysis analysis;
};

/// Equal islands share their topology. Vertices are the movable ones (nodes), then the fixed ones.
struct LoopTopology : LoopElements {
  explicit LoopTopology(const layouts::Graph& island, LoopElements elements = {});
  /// Vertices keep their numbers; the movable ones come first, and no rod begins at a fixed one.
  LoopTopology(std::uint32_t nodes, std::uint32_t vertices, Array<LoopRod> rods);

  /// Lets the island be solved by lines, which `positions` (m) of its vertices show.
  void use_lines(std::span<const Vec3> positions);
  /// Lets the island, whose rods all give, be solved without a factorisation.
  void use_net();

  std::uint32_t nodes = 0, vertices;
  Array<std::uint32_t> order;  ///< It says by vertex which of the island's it is.
  Array<LoopRod> rods;
  Array<std::uint32_t> anchored;  ///< These rods end at fixed vertices, those of reels left out.
  /// One of these is there. The others are for islands whose factorisations would be dear. Who needs a system
  /// all the same makes it.
  std::unique_ptr<const LoopSystem> system;
  std::unique_ptr<const RodLines> lines;
  std::unique_ptr<const NetPattern> net;

 private:
  void find_anchored();
  void renumber(const Array<std::uint32_t>& nodes_in_order);
};

/// Steps change these numbers of an island.
///
/// `u` is a velocity (m/s) if `u_step` is 0, and otherwise the displacement of the last substep, of length
/// u_step (s). Masses are in units of the mean one, multipliers in those units.
struct LoopMotion {
  Array<double> x;  ///< Positions have 3 numbers per vertex, in m.
  Array<double> u,
      mu;  ///< u has 3 numbers per node, and mu one per rod, tackle and pulley with friction.
  Array<Vec3> fixed_last_velocity;  ///< There is one per fixed vertex, in m/s.
  /// Where errors are estimated, these are accelerations of the last two substeps, rods included: 3 per node,
  /// in m/s^2.
  Array<double> acceleration, acceleration_before;
  std::uint32_t known = 0;        ///< So many substeps were taken, up to the two that accelerations are from.
  std::uint32_t damped = 0;       ///< So many substeps are to be taken with gradient new.
  std::uint32_t next_damped = 0;  ///< The next time it will be so many.
  Pace pace;                      ///< It says into which pieces substeps are cut before they are tried.
  Effort effort;                  ///< It says how much may be tried in a substep.
  Array<double> twisted;          ///< Chains are twisted so far, in rad.
  LoopLaws laws;
  Array<LoopTackleMotion> tackles;
  Array<double> pulley_impulses;  ///< Segments behind pulleys with friction pulled so in this step, N s.
  Array<LoopReelMotion> reels;
  Array<LoopGrab> grabs;
  /// Fixed vertices held with these impulses (N s) in this step. There is one each if pulls are added up, or
  /// if there are bends, tackles, twists or reels.
  Array<Vec3> hold;
  double u_step = 0;   ///< It is in s.
  double mu_kick = 0;  ///< It is the kick (s^2) with which mu was found, or 0.
  bool gave = false;   ///< Rods gave in the last substep, and may not fit.
};

/// These numbers of one island outlive a step. They are in double, whatever the precision of the world.
struct LoopState : LoopMotion {
  /// Has the right sizes and no numbers.
  explicit LoopState(std::shared_ptr<const LoopTopology> topology);
  LoopState(std::shared_ptr<const LoopTopology> topology, const Scene& scene, MassModel model,
            std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> edges);

  LoopMotion& motion() { return *this; }
  const LoopMotion& motion() const { return *this; }
  Vec3 position(std::uint32_t vertex) const { return {x[3 * vertex], x[3 * vertex + 1], x[3 * vertex + 2]}; }
  void set_force(std::uint32_t node, Vec3 newton);
  /// Sets gravity (m/s^2), and takes the forces away.
  void set_gravity(Vec3 gravity);

  std::shared_ptr<const LoopTopology> topology;
  Array<double> force,
      weight;            ///< They have 3 numbers per node, divided by the unit of mass; weight is gravity.
  Array<double> weighs;  ///< It is per node what gravity acts on, divided likewise.
  Array<double> mass, coupling,
      length2;                 ///< Masses are per node; couplings and squared lengths (m^2) per rod.
  Array<Vec3> fixed_velocity;  ///< There is one per fixed vertex, in m/s.
  Array<LoopBendNumbers> bends;
  Array<TackleLaw> tackle_laws;
  Array<LoopTwistNumbers> twists;
  Array<LoopReelNumbers> reel_numbers;
  Locks locks;
  ChangedNumbers changed;  ///< in the substep under way
  bool anchors_move = false;
  double mass_unit = 1;  ///< It is in kg.
  double scale2 = 1;     ///< It is the mean squared length of a rod, in m^2.
};

template <class Archive>
void visit_members(Archive& archive, LoopMotion& of) {
  auto& [x, u, mu, fixed_last_velocity, acceleration, acceleration_before, known, damped, next_damped, pace,
         effort, twisted, laws, tackles, pulley_impulses, reels, grabs, hold, u_step, mu_kick, gave] = of;
  archive(x, u, mu, fixed_last_velocity, acceleration, acceleration_before, known, damped, next_damped, pace,
          effort, twisted, laws, tackles, pulley_impulses, reels, grabs, hold, u_step, mu_kick, gave);
}
/// What a program and steps change beside the motion. Reels change masses, and laws lengths.
template <class Archive>
void visit_members(Archive& archive, LoopState& of) {
  archive(of.motion(), of.force, of.mass, of.length2, of.fixed_velocity, of.twists, of.locks,
          of.anchors_move);
}

}  // namespace plumb::detail
