#pragma once

#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

/// The innermost loops of the direct solve on trees: one Newton step on all rods of a tree at once, in time
/// linear in their number. They solve one tree, or a logical vector of equal trees side by side in lanes.
///
/// A tree's nodes are its movable particles, numbered so that a parent comes before its children. Every node
/// but the first has a rod to its parent. Rods to anchors are the ties of their node. All bodies do
/// the same operations in the same order on every lane. A tree therefore moves alike in any lane, alone, and
/// on any instruction set.
namespace plumb::simd {

/// Numbers per node or tie in the arrays of TreeView.
namespace tree_fields {
inline constexpr std::uint32_t node = 4;  ///< mass_ii; mass_ip to the parent; smallest pivot; 1/least_i
inline constexpr std::uint32_t tie = 2;   ///< mass_if to the anchor; smallest pivot
inline constexpr std::uint32_t rod = 4;   ///< x_i - x_p as x, y, z; C = (|x_i - x_p|^2 - L^2)/2
inline constexpr std::uint32_t elimination = 16;  ///< delta_i = P delta_p + q; mu_i = rho + n.delta_p
inline constexpr std::uint32_t tie_elimination =
    11;  ///< a; y; rho; for the first of a node's ties also a, kappa of its rod
/// Stiffness and damping divided by the unit of mass; 1 if rigid; 1 if one-sided; square of the rod's own
/// frequency (1/s^2); strength divided by the unit of mass, or 0 if it never breaks. A broken rod has zeros.
inline constexpr std::uint32_t law = 6;
inline constexpr std::uint32_t law_step = 5;   ///< See LawStep in simd/tree/law_math.hpp.
inline constexpr std::uint32_t law_start = 4;  ///< See LawTerms there, or LawStart if there are cables.
/// Weights of a bend's particles in w, from the root on (1/m); stiffness, curvature at rest, damping.
inline constexpr std::uint32_t bend = 6;
inline constexpr std::uint32_t bent_elimination =
    28;  ///< delta_i = P delta_p + Q delta_g + q; mu_i = rho + n.delta_p + m.delta_g
inline constexpr std::uint32_t bent_tip = 21;  ///< Of a tip with a tie: a; what couples it to p; to g.
inline constexpr std::uint32_t torque_elimination = 4;  ///< Of a unit torque: e; rho_1. The tip has p behind.
inline constexpr std::uint32_t below = 13;  ///< Sums of a node's children: three rows; r; a diagonal
}  // namespace tree_fields

/// The value of TreeView::below_slot for a node that needs none.
inline constexpr std::uint32_t no_slot = 0xffffffff;

/// These factors turn a law into an equation of a substep, by lane. A rod of stiffness k and damping r has
/// psi = own (k (share c1 + (1 - share) c0) + rate r (c1 - c0)) + kick_before half_kick, where own is kick
/// without what the half kick has of it (simd/tree/law_math.hpp).
namespace law_factors {
inline constexpr std::uint32_t share = 0;        ///< Of the end of the substep.
inline constexpr std::uint32_t kick = 1;         ///< Of forces, in s^2.
inline constexpr std::uint32_t kick_back = 2;    ///< What a half kick has of that, in s^2, of gradient old.
inline constexpr std::uint32_t kick_before = 3;  ///< In s; 0 where there is no last substep.
inline constexpr std::uint32_t rate = 4;         ///< 1 over the substep, in 1/s.
inline constexpr std::uint32_t substep = 5;      ///< In s, of gradient old, and 0 of the others.
inline constexpr std::uint32_t substep_before = 6;  ///< The last one, the same.
inline constexpr std::uint32_t count = 7;           ///< Numbers per lane.
}  // namespace law_factors

/// A tree, or `lanes` equal ones. Every array holds `lanes` numbers for each entry.
///
/// Lengths are in m. Masses are in units of the tree's mean mass, and multipliers mu in these: a rod pulls
/// its end i by mu (d + theta (delta_i - delta_p)).
template <class T>
struct TreeView {
  std::uint32_t nodes = 0;
  std::uint32_t lanes = 1;
  const std::uint32_t* parent = nullptr;     ///< Parent of every node; not read for node 0.
  const std::uint32_t* tie_begin = nullptr;  ///< Start of every node's ties; nodes + 1 entries.

  bool is_coupled = false;  ///< Whether some rod's mass acts on both its ends at once.
  bool is_plain = false;    ///< Whether none does and there is at most one tie, so that no rod is redundant.
  const T* node = nullptr;  ///< tree_fields::node numbers per node.
  const T* tie = nullptr;   ///< tree_fields::tie numbers per tie.
  const double* length2 = nullptr;      ///< Squared length of the rod to the parent, in m^2, per node.
  const double* tie_length2 = nullptr;  ///< Squared length of the rod to the anchor, in m^2, per tie.

  // These are of trees with rods that give (plumb::RodLaw). Others have none.
  bool has_laws = false;       ///< Whether there are such rods.
  bool has_cables = false;     ///< Whether some of them are one-sided.
  bool is_mid = false;         ///< Whether the substep is of gradient mid.
  bool is_line = false;        ///< Whether newton_line() or newton_segments() takes its steps.
  const T* law = nullptr;      ///< tree_fields::law numbers of the rod to the parent, per node.
  const T* tie_law = nullptr;  ///< The same of the rod to the anchor, per tie.
  /// Whether prepare() makes `law_step` anew, as where `law`, `law_factors` or lengths have changed.
  bool makes_law_steps = false;
  T* law_step = nullptr;                ///< tree_fields::law_step numbers per node.
  T* tie_law_step = nullptr;            ///< The same per tie.
  T* law_start = nullptr;               ///< tree_fields::law_start numbers per node; prepare() makes them.
  T* tie_law_start = nullptr;           ///< The same per tie.
  bool lengths_change = false;          ///< Some rod has a rate.
  const double* length_rate = nullptr;  ///< Rate of the length of the rod to the parent, in m/s, per node.
  const double* tie_length_rate = nullptr;  ///< The same per tie.
  bool keeps_half_kicks = false;            ///< Whether the gradient is old, which has half kicks.
  /// Half of the last kick of the rod to the parent, in m/s times the unit of mu, of gradient old, per node.
  T* half_kick = nullptr;
  T* tie_half_kick = nullptr;      ///< The same per tie.
  const T* law_factors = nullptr;  ///< law_factors::count numbers per lane.

  // These are of lines with bends (plumb::Bend). Others have none.
  bool has_bends = false;         ///< Whether there are bends.
  bool has_bend_damping = false;  ///< Whether some of them are damped.
  /// Ties that hold what is fixed beyond the ends, or no_slot: the root's clamp and anchor, the tip's anchor
  /// and clamp.
  const std::uint32_t* bend_ends = nullptr;
  const T* bend = nullptr;        ///< tree_fields::bend numbers per place where a bend may end, nodes + 2.
  T* bend_start = nullptr;        ///< w of every bend where the substep starts, 3 per place; of prepare().
  const T* bend_rate = nullptr;   ///< 1 over the substep (1/s), per lane.
  T* bent_elimination = nullptr;  ///< tree_fields::bent_elimination numbers per node, then bent_tip.

  // These are of lines with a twist (plumb::Twist), in double. Others have none.
  std::uint32_t twist_begin = 0, twist_end = 0;  ///< Its joints are at these places where a bend may end.
  T* clamp_rod = nullptr;  ///< From the root's clamp to its anchor, and from the tip's to its clamp.
  const T* twist_stiffness = nullptr;  ///< Torque by angle, times the kick (m²), per lane.
  const T* twist_start = nullptr;      ///< The chain's twist if nothing turned (rad), where torque is taken.
  T* torque = nullptr;                 ///< Torque times the kick (m²), which is solved for, per lane.
  T* twist_turn = nullptr;             ///< Result of advance(): how far the chain has turned (rad), per lane.
  T* torque_elimination = nullptr;     ///< tree_fields::torque_elimination numbers per node, then 3.

  double* x =
      nullptr;     ///< Positions, 3 per node, in double, so that a float solve keeps its digits anywhere.
  T* u = nullptr;  ///< Displacement of the last substep (m), or velocity (m/s), 3 per node.
  const T* force = nullptr;  ///< Force divided by the unit of mass, 3 per node.

  const double* tie_x = nullptr;  ///< Position of the anchor, 3 per tie.
  const T* tie_delta = nullptr;   ///< The anchor's displacement in this substep, 3 per tie.
  const T* tie_u = nullptr;       ///< The anchor's displacement in the last substep, 3 per tie.

  /// Whether prepare() guesses delta from `u`, `acceleration` and `acceleration_before`. Otherwise delta
  /// stays.
  bool guesses = false;
  /// Whether prepare() guesses mu from `mu` and `mu_before`. Otherwise both stay.
  bool guesses_multipliers = true;
  /// Whether advance() keeps accelerations and sums `push` and `jolt`. Otherwise these four are left alone.
  bool keeps_acceleration = false;
  T* acceleration_before = nullptr;  ///< Acceleration of the substep before the last, 3 per node, in m/s^2.
  T* acceleration = nullptr;         ///< Acceleration of the last substep, pull of rods included, the same.

  // One number per lane:
  const T* ratio = nullptr;            ///< Factor that turns u into a displacement of this substep.
  const T* kick = nullptr;             ///< Factor that turns force into a displacement, in s^2.
  const T* guess = nullptr;            ///< Weight of the last acceleration in the guess of delta, in s^2.
  const T* guess_before = nullptr;     ///< Weight of the acceleration before it, in s^2.
  const T* mu_scale = nullptr;         ///< Weight of the last multipliers in the guess of mu.
  const T* mu_scale_before = nullptr;  ///< Weight of the multipliers before them.
  const T* u_delta = nullptr;          ///< advance() sets u to u_delta delta - u_before ratio u.
  const T* u_before = nullptr;         ///< The second factor of that.
  const T* inverse_kick = nullptr;     ///< 1/kick, in 1/s^2, which turns a displacement into an acceleration.
  const T* active = nullptr;           ///< 1 to update a lane, 0 to leave it as it is.
  T* change = nullptr;                 ///< Result: sum over nodes of |change of delta|^2.
  T* stiffness = nullptr;              ///< Result of find_stiffness().
  T* residual = nullptr;               ///< Result: sum over rods of C^2, before the change.
  T* push = nullptr;                   ///< Result: sum over nodes of |acceleration|^2.
  T* jolt = nullptr;  ///< Result: sum over nodes of |change of acceleration over two substeps|^2.

  T* delta = nullptr;   ///< Displacement that is solved for, 3 per node.
  T* mu = nullptr;      ///< Multiplier of the rod to the parent, per node; not read for node 0.
  T* tie_mu = nullptr;  ///< Multiplier of the rod to the anchor, per tie.
  /// Multipliers of the substep before. prepare() keeps the last ones here, to go back to if the new ones
  /// fail.
  T* mu_before = nullptr;
  T* tie_mu_before = nullptr;    ///< The same of ties.
  T* blow = nullptr;             ///< Multipliers of a projection, as mu; null if nobody asks.
  T* tie_blow = nullptr;         ///< The same of ties.
  T* load = nullptr;             ///< M u + kick force, 3 per node.
  T* rod = nullptr;              ///< tree_fields::rod numbers per node.
  T* tie_rod = nullptr;          ///< tree_fields::rod numbers per tie.
  T* elimination = nullptr;      ///< tree_fields::elimination numbers per node.
  T* tie_elimination = nullptr;  ///< tree_fields::tie_elimination numbers per tie.
  /// Where children of a node other than the next add to its tile, or no_slot; per node.
  const std::uint32_t* below_slot = nullptr;
  std::uint32_t below_slots = 0;  ///< Number of such places.
  T* below = nullptr;             ///< tree_fields::below numbers per place.
};

/// The loops over a tree. A line is a tree whose every node has at most one child.
template <class T>
struct TreeKernels {
  /// Begins a substep: computes load = ratio M u + kick force, guesses delta and mu, and prepares the rods.
  void (*prepare)(const TreeView<T>&);
  /// Takes one Newton step on M delta = load + sum mu (d + theta B delta), C(delta) = 0. Bends add their
  /// pulls to the right-hand side.
  void (*newton)(const TreeView<T>&, T theta);
  /// The same for lines with lumped masses and theta 0, in a fraction of the time.
  void (*newton_line)(const TreeView<T>&);
  /// The same for one long line that is cut into as many segments as there are lanes. Node 0 of every lane
  /// has a tie. In lanes after the first this tie is the rod to the last node of the lane before.
  void (*newton_segments)(const TreeView<T>&);
  /// Bounds |kick| omega^2 of the waves across a lane's rods, and puts the bound into `stiffness`.
  ///
  /// It is the largest 2/least_i times the sum of |mu| of a node's rods (Gershgorin). least_i is the diagonal
  /// of a matrix below the mass matrix.
  void (*find_stiffness)(const TreeView<T>&);
  /// Ends a substep: moves x and u of active lanes, and keeps their accelerations.
  void (*advance)(const TreeView<T>&);
  /// Moves delta, taken as a velocity times a time, onto what no rod resists, and adds what forces do.
  ///
  /// It solves M delta' = M delta + kick force + J^T lambda, J delta' = 0, exactly in one call. Anchors go
  /// from tie_u to tie_delta.
  void (*project)(const TreeView<T>&);
};

#define PLUMB_DECLARE_TABLES(isa, supported)          \
  extern const TreeKernels<float> tree_##isa##_float; \
  extern const TreeKernels<double> tree_##isa##_double;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported(). The scalar one solves a tree alone (lanes = 1).
template <class T>
const TreeKernels<T>& tree_kernels(Isa isa);

}  // namespace plumb::simd
