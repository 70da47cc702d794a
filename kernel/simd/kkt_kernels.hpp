#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels.hpp"

/// The innermost loops of contact on one island: what pushes at eight places do, side by side.
namespace plumb::simd {

/// Right hand sides solved together; what is kept of them is padded to so many.
inline constexpr std::size_t kkt_lanes = 8;

/// Factors L D Lᵀ, by columns in the order of elimination.
struct KktView {
  std::uint32_t unknowns = 0;
  const std::uint32_t* start = nullptr;  ///< of every column's entries, and their end
  const std::uint32_t* rows = nullptr;   ///< of the entries
  const double* diagonal = nullptr;      ///< inverse pivots
  const double* entries = nullptr;       ///< of L
};

/// All arrays of lanes start on 64 bytes.
struct KktKernels {
  /// x: batches x unknowns x kkt_lanes.
  void (*solve)(const KktView&, std::size_t batches, double* x);
  /// out, batches x kkt_lanes = sum over i of factors[i] * x[slots[i]], of every batch as solve() leaves it.
  void (*combine)(const double* x, std::uint32_t unknowns, std::size_t batches, const std::uint32_t* slots,
                  const double* factors, std::uint32_t count, double* out);
  /// to += a * x + b * y + c * z, of `count` numbers, a multiple of kkt_lanes.
  void (*add_three)(double* to, double a, const double* x, double b, const double* y, double c,
                    const double* z, std::uint32_t count);
  /// to, unknowns x kkt_lanes, += factors, kkt_lanes numbers, times x, lane by lane.
  void (*accumulate)(double* to, const double* factors, const double* x, std::uint32_t unknowns);
};

#define PLUMB_DECLARE_TABLES(isa, supported) extern const KktKernels kkt_##isa;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported().
const KktKernels& kkt_kernels(Isa isa);

}  // namespace plumb::simd
