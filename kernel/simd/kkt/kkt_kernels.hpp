#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

/// Small sparse symmetric matrices [M Jᵀ; J -e] of islands with bodies, in tiles of four unknowns. Contact on
/// one island solves eight places at a time with them.
namespace plumb::simd {

/// Number of right-hand sides that are solved together. What is kept of them is padded to a multiple.
inline constexpr std::size_t kkt_lanes = 8;
/// One number of each of these right-hand sides.
struct alignas(64) Lanes {
  double of[kkt_lanes];
};

/// A tile of 4 x 4 numbers, one column after the other.
struct alignas(64) Block {
  double of[16];
};

/// Four unknowns, those of one column of tiles.
struct alignas(32) Quad {
  double of[4];
};

/// Which tiles of a symmetric matrix are there, by columns of tiles in the order of elimination.
///
/// A matrix and its factors L D Lᵀ share one array of tiles. The diagonal comes first and becomes D⁻¹. What
/// is below it follows and becomes L.
struct KktPattern {
  std::uint32_t columns = 0;             ///< Columns of tiles.
  const std::uint32_t* start = nullptr;  ///< Start of every column's tiles below the diagonal; columns + 1.
  const std::uint32_t* rows = nullptr;   ///< Row of every such tile.
};

/// A weighted sum names its unknowns by their slots.
struct KktSum {
  const std::uint32_t* slots = nullptr;  ///< The unknowns.
  const double* factors = nullptr;       ///< The factor of each.
  std::uint32_t count = 0;               ///< Number of unknowns in the sum.
};

/// A term is an array of numbers times a factor.
struct KktTerm {
  double factor = 0;
  const double* x = nullptr;
};

/// The loops over such matrices. All arrays of lanes start on a boundary of 64 bytes.
struct KktKernels {
  /// Turns a matrix into its factors. Of tiles on the diagonal it reads only what is on or below it.
  ///
  /// `targets` names the tile from which L_i D L_jᵀ is subtracted, for every pair i <= j of tiles of every
  /// column.
  void (*factor)(const KktPattern&, const std::uint32_t* targets, Block* blocks);
  /// Solves for one right-hand side: x holds a Quad for every column and becomes the solution.
  void (*solve)(const KktPattern&, const Block* factors, Quad* x);
  /// Solves for `batches` times kkt_lanes of them; x holds batches x 4 columns x kkt_lanes numbers.
  void (*solve_lanes)(const KktPattern&, const Block* factors, std::size_t batches, double* x);
  /// Sets out, batches x kkt_lanes numbers, to the sum over i of factors[i] * x[slots[i]]. x is as
  /// solve_lanes() leaves it.
  void (*combine)(const double* x, std::uint32_t unknowns, std::size_t batches, const KktSum& sum,
                  double* out);
  /// Adds three terms to `count` numbers, a multiple of kkt_lanes, one term after the other.
  void (*add_three)(double* to, KktTerm a, KktTerm b, KktTerm c, std::uint32_t count);
  /// Adds factors * x to `to`, lane by lane. `to` and `x` hold unknowns x kkt_lanes numbers, `factors` holds
  /// kkt_lanes.
  void (*accumulate)(double* to, const double* factors, const double* x, std::uint32_t unknowns);
};

extern const KktKernels kkt_scalar, kkt_sse2, kkt_avx2, kkt_neon, kkt_simd128;
/// These loops are too short for 512 bits to win. Cores that meet one such instruction between scalar code
/// lower their clock (Cascade Lake: from 2.7 to 2.4 GHz, for the whole step).
inline constexpr const KktKernels& kkt_avx512 = kkt_avx2;

/// The table for an instruction set that is_supported().
const KktKernels& kkt_kernels(Isa isa);

}  // namespace plumb::simd
