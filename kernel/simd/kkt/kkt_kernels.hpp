#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

/// Small sparse symmetric matrices in blocks of four unknowns, [M Jᵀ; J -e] of limbs, and what contact on one
/// island does eight places at a time.
namespace plumb::simd {

/// Right hand sides solved together; what is kept of them is padded to so many.
inline constexpr std::size_t kkt_lanes = 8;
struct alignas(64) Lanes {
  double of[kkt_lanes];
};

/// Four by four, a column after the other.
struct alignas(64) Block {
  double of[16];
};

/// Four unknowns, those of one block column.
struct alignas(32) Quad {
  double of[4];
};

/// Which blocks there are of a symmetric matrix, by block columns in the order of elimination. Of a matrix
/// and of its factors L D Lᵀ an array of blocks: the diagonal, which becomes D⁻¹, then what is below it, L in
/// the end.
struct KktPattern {
  std::uint32_t columns = 0;
  const std::uint32_t* start = nullptr;  ///< of every column's blocks below the diagonal, and their end
  const std::uint32_t* rows = nullptr;   ///< of the blocks
};

/// All arrays of lanes start on 64 bytes.
struct KktKernels {
  /// A matrix becomes its factors; of blocks on the diagonal only what is on or below it is read. `targets`:
  /// for every column, for every pair i <= j of its blocks, the block that L_i D L_jᵀ is taken from.
  void (*factor)(const KktPattern&, const std::uint32_t* targets, Block* blocks);
  /// x: a Quad for every column.
  void (*solve)(const KktPattern&, const Block* factors, Quad* x);
  /// x: batches x 4 columns x kkt_lanes.
  void (*solve_lanes)(const KktPattern&, const Block* factors, std::size_t batches, double* x);
  /// out, batches x kkt_lanes = sum over i of factors[i] * x[slots[i]], of every batch as solve_lanes()
  /// leaves it.
  void (*combine)(const double* x, std::uint32_t unknowns, std::size_t batches, const std::uint32_t* slots,
                  const double* factors, std::uint32_t count, double* out);
  /// to += a * x + b * y + c * z, of `count` numbers, a multiple of kkt_lanes.
  void (*add_three)(double* to, double a, const double* x, double b, const double* y, double c,
                    const double* z, std::uint32_t count);
  /// to, unknowns x kkt_lanes, += factors, kkt_lanes numbers, times x, lane by lane.
  void (*accumulate)(double* to, const double* factors, const double* x, std::uint32_t unknowns);
};

extern const KktKernels kkt_scalar, kkt_sse2, kkt_avx2;
/// These loops are too short for 512 bits to win, and cores that meet one such instruction between scalar
/// code lower their clock (Cascade Lake: from 2.7 to 2.4 GHz, for the whole step).
inline constexpr const KktKernels& kkt_avx512 = kkt_avx2;

/// The table for an instruction set that is_supported().
const KktKernels& kkt_kernels(Isa isa);

}  // namespace plumb::simd
