#pragma once

#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

/// The innermost loops of the direct solve on trees: one Newton step on all rods of a tree at once, in time
/// linear in their number, for one tree or for a logical vector of equal trees side by side in lanes.
///
/// A tree's nodes are its movable particles, numbered so that a parent comes before its children. Every node
/// but the first has a rod to its parent; rods to fixed particles are pins of their node. All bodies do the
/// same operations in the same order on every lane, so a tree moves alike in any lane, alone, and on any
/// instruction set.
namespace plumb::simd {

/// Numbers per node or pin in the arrays of TreeView.
namespace tree_fields {
inline constexpr std::uint32_t node = 4;  ///< mass_ii; mass_ip to the parent; smallest pivot; 1/least_i
inline constexpr std::uint32_t pin = 2;   ///< mass_if to the fixed end; smallest pivot
inline constexpr std::uint32_t rod = 4;   ///< x_i - x_p as x, y, z; C = (|x_i - x_p|^2 - L^2)/2
inline constexpr std::uint32_t elimination = 16;  ///< delta_i = P delta_p + q; mu_i = rho + n.delta_p
inline constexpr std::uint32_t pin_elimination =
    11;                                     ///< a; y; rho; of the first of a node's pins: a, kappa of its rod
inline constexpr std::uint32_t below = 13;  ///< three rows; r; a diagonal
}  // namespace tree_fields

inline constexpr std::uint32_t no_slot = 0xffffffff;

/// A tree, or `lanes` of them. Every array holds `lanes` numbers for each entry. Lengths in m, masses in
/// units of the tree's mean mass, multipliers mu in those units: a rod's end i is pulled by mu (d + theta
/// (delta_i - delta_p)).
template <class T>
struct TreeView {
  std::uint32_t nodes = 0;
  std::uint32_t lanes = 1;
  const std::uint32_t* parent = nullptr;     ///< per node; not read for node 0
  const std::uint32_t* pin_begin = nullptr;  ///< nodes + 1, into the pins

  bool is_coupled = false;  ///< some rod's mass acts on both its ends at once
  bool is_plain = false;    ///< not, and at most one pin: no rod can be redundant
  const T* node = nullptr;
  const T* pin = nullptr;
  const double* length2 = nullptr;      ///< m^2, per node, of the rod to its parent
  const double* pin_length2 = nullptr;  ///< m^2, per pin

  double* x = nullptr;  ///< position, 3 per node; double, so that a float solve keeps its digits anywhere
  T* u = nullptr;       ///< 3 per node: displacement of the last substep, m, or velocity, m/s
  const T* force = nullptr;  ///< 3 per node, divided by the unit of mass

  const double* pin_x = nullptr;  ///< position of the fixed end, 3 per pin
  const T* pin_delta = nullptr;   ///< its displacement in this substep, 3 per pin
  const T* pin_u = nullptr;       ///< and in the one before, 3 per pin

  bool guesses = false;              ///< whether delta starts from u and the next two
  bool guesses_multipliers = true;   ///< whether mu starts from mu and mu_before; if not, both stay
  bool keeps_acceleration = false;   ///< if not, the next two and what is made of them are left alone
  T* acceleration_before = nullptr;  ///< of the one before
  T* acceleration = nullptr;         ///< 3 per node, of the last substep, rods included (m/s^2)

  // Per lane:
  const T* ratio = nullptr;  ///< how many times u goes into a substep
  const T* kick = nullptr;   ///< s^2: how many times force does
  const T* guess = nullptr;  ///< s^2: how many times the last acceleration goes into the first guess of delta
  const T* guess_before = nullptr;     ///< and the one before
  const T* mu_scale = nullptr;         ///< what the last multipliers are taken times, as a first guess
  const T* mu_scale_before = nullptr;  ///< and those of the substep before
  const T* u_delta = nullptr;          ///< u becomes u_delta delta - u_before ratio u
  const T* u_before = nullptr;
  const T* inverse_kick = nullptr;  ///< 1/s^2
  const T* active = nullptr;        ///< 1 to update a lane, 0 to leave it as it is
  T* change = nullptr;              ///< out: sum over nodes of |change of delta|^2
  T* stiffness = nullptr;           ///< out: of find_stiffness()
  T* residual = nullptr;            ///< out: sum over rods of C^2, before the change
  T* push = nullptr;                ///< out: sum over nodes of |acceleration|^2
  T* jolt = nullptr;                ///< out: sum over nodes of |change of acceleration over two substeps|^2

  T* delta = nullptr;  ///< displacement being solved for, 3 per node
  T* mu = nullptr;     ///< multiplier per node; not read for node 0
  T* pin_mu = nullptr;
  /// Of the substep before the last; prepare() puts the last one's here, to go back to if the new one fails.
  T* mu_before = nullptr;
  T* pin_mu_before = nullptr;
  T* load = nullptr;  ///< M u + kick, 3 per node
  T* rod = nullptr;
  T* pin_rod = nullptr;
  T* elimination = nullptr;
  T* pin_elimination = nullptr;
  const std::uint32_t* below_slot =
      nullptr;  ///< per node: where children other than the next add to its block
  std::uint32_t below_slots = 0;
  T* below = nullptr;
};

template <class T>
struct TreeKernels {
  /// Begins a substep: load = ratio M u + kick force, a first guess of delta and mu, rods.
  void (*prepare)(const TreeView<T>&);
  /// One Newton step on M delta = load + sum mu (d + theta B delta), C(delta) = 0.
  void (*newton)(const TreeView<T>&, T theta);
  /// The same for lines with lumped masses and theta 0, in a fraction of the time.
  void (*newton_line)(const TreeView<T>&);
  /// The same for one long line cut into as many segments as there are lanes; node 0 of every lane has a pin,
  /// which in lanes after the first is the rod to the last node of the lane before.
  void (*newton_segments)(const TreeView<T>&);
  /// Into stiffness: a bound for |kick| omega^2 of a lane's waves across its rods, the largest 2/least_i
  /// times the sum of |mu| of a node's rods (Gershgorin). least is the diagonal of a matrix below the mass
  /// matrix.
  void (*find_stiffness)(const TreeView<T>&);
  /// Ends it: moves x and u of active lanes, keeps their acceleration.
  void (*advance)(const TreeView<T>&);
  /// Moves delta, now taken as a velocity times a time, onto what no rod resists, adding what forces do:
  /// M delta' = M delta + kick force + J^T lambda, J delta' = 0, where fixed ends go from pin_u to pin_delta.
  /// Exact in one call.
  void (*project)(const TreeView<T>&);
};

#define PLUMB_DECLARE_TABLES(isa, supported)          \
  extern const TreeKernels<float> tree_##isa##_float; \
  extern const TreeKernels<double> tree_##isa##_double;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported(). One tree alone (lanes = 1) is solved by the scalar
/// one.
template <class T>
const TreeKernels<T>& tree_kernels(Isa isa);

}  // namespace plumb::simd
