#pragma once

#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

/// The innermost loops of a sparse factorisation without exchange of rows (Duff, Reid 1983).
///
/// A front is a dense matrix in which some variables, the pivots, are eliminated from the rows that they
/// touch. Rows and columns are numbered alike, pivots first.
namespace plumb::simd {

/// A front. Its columns are padded with zeros to a logical vector, on whose boundaries all arrays start.
struct FrontView {
  std::uint32_t rows = 0, pivots = 0;
  std::uint32_t stride = 0;   ///< Columns with padding.
  double* upper = nullptr;    ///< Factor U, pivots x stride: row k from column k on, zeros before that.
  double* lower = nullptr;    ///< Factor L, pivots x stride: column k below row k, zeros before that.
  double* inverse = nullptr;  ///< Inverse of every pivot; 0 for one that was left out.
};

/// The loops over a front.
struct FrontKernels {
  /// Eliminates the pivots of `block` (rows x stride) and returns how many were left out.
  ///
  /// What is right of and below the pivots remains, less what they take from it. A pivot whose size is not
  /// above its `smallest` is left out, since its equation follows from others.
  std::uint32_t (*eliminate)(const FrontView&, double* block, const double* smallest);
  /// Replaces x at pivots by L^-1 x, and subtracts from the other entries what that takes away. x has
  /// `stride` numbers, zeros in the padding.
  void (*forward)(const FrontView&, double* x);
  /// Replaces x at pivots by U^-1 x, given the other entries.
  void (*backward)(const FrontView&, double* x);
};

#define PLUMB_DECLARE_TABLES(isa, supported) extern const FrontKernels front_##isa;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported().
const FrontKernels& front_kernels(Isa isa);

}  // namespace plumb::simd
