#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "direct/loops/loop_rod.hpp"
#include "direct/nets/rod_lines.hpp"
#include "linear/sparse_ldu.hpp"
#include "plumb/layouts/graph.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// The linear system of an island, for displacements of nodes and multipliers of rods:
///
///   [ M - theta Lambda   -A^T ]        M: mass matrix; Lambda: Laplacian of the multipliers
///   [ B                  soft ]        A, B: +direction at a, -direction at b of every rod
///
/// Values: one per node, its diagonal; then per rod the coupling of its ends, what -A^T has at b (3) and at a
/// (3), what B has at a (3) and at b (3), and soft.
struct LoopSystem {
  LoopSystem(const std::vector<LoopRod>& rods, std::uint32_t nodes, bool couples);

  static constexpr std::uint32_t per_rod = 14;
  std::size_t at(std::uint32_t rod) const { return nodes + std::size_t{per_rod} * rod; }

  std::uint32_t nodes;
  bool couples;  ///< whether ends of a rod meet other than through it
  SparseAnalysis analysis;
};

/// What equal islands share. Vertices: the movable ones (nodes), then the fixed ones.
struct LoopTopology {
  explicit LoopTopology(const layouts::Graph& island);

  /// Solves by lines, which `positions` of the island's vertices show.
  void use_lines(std::span<const Vec3> positions);

  std::uint32_t nodes = 0, vertices;
  std::vector<std::uint32_t> order;  ///< by vertex, which of the island's it is
  std::vector<LoopRod> rods;
  /// One of both. Lines where factorisations would be dear; systems are then made by who needs them all the
  /// same.
  std::unique_ptr<const LoopSystem> system;
  std::unique_ptr<const RodLines> lines;
};

/// What steps change of an island.
///
/// `u` is a velocity (m/s) if `u_step` is 0, and otherwise the displacement of the last substep, of length
/// u_step (s). Masses are in units of the mean one, multipliers in those units.
struct LoopMotion {
  std::vector<double> x;                  ///< m, 3 per vertex
  std::vector<double> u, mu;              ///< 3 per node; per rod
  std::vector<Vec3> fixed_last_velocity;  ///< m/s, per fixed vertex
  /// Where errors are estimated: m/s^2, 3 per node, of the last two substeps, rods included.
  std::vector<double> acceleration, acceleration_before;
  std::uint32_t known = 0;        ///< substeps taken, up to the two that accelerations are from
  std::uint32_t damped = 0;       ///< substeps to be taken with gradient new
  std::uint32_t next_damped = 0;  ///< how many that will be the next time
  /// s: longer substeps are cut before they are tried.
  double longest = std::numeric_limits<double>::infinity();
  double u_step = 0;   ///< s
  double mu_kick = 0;  ///< s^2: the kick when mu was found; 0: not yet
};

/// The numbers of one island that outlive a step. In double, whatever the precision of the world.
struct LoopState : LoopMotion {
  LoopState(std::shared_ptr<const LoopTopology> topology, const Scene& scene, MassModel model,
            std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> edges);

  LoopMotion& motion() { return *this; }
  const LoopMotion& motion() const { return *this; }
  Vec3 position(std::uint32_t vertex) const { return {x[3 * vertex], x[3 * vertex + 1], x[3 * vertex + 2]}; }
  void set_force(std::uint32_t node, Vec3 newton);

  std::shared_ptr<const LoopTopology> topology;
  std::vector<double> force, weight;            ///< 3 per node; force and weight (gravity) by unit of mass
  std::vector<double> mass, coupling, length2;  ///< per node; per rod; m^2, per rod
  std::vector<Vec3> fixed_velocity;             ///< m/s, per fixed vertex
  bool anchors_move = false;
  double mass_unit = 1;  ///< kg
  double scale2 = 1;     ///< m^2: mean squared length of a rod
};

}  // namespace plumb::detail
