#pragma once

#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

/// The innermost loops of a sparse factorisation without exchange of rows: dense blocks, fronts, in which
/// some variables, the pivots, are eliminated from the rows that they touch (Duff, Reid 1983). Rows and
/// columns are numbered alike, pivots first.
namespace plumb::simd {

/// Columns are padded with zeros to a logical vector; every array starts on a boundary of such vectors.
struct FrontView {
  std::uint32_t rows = 0, pivots = 0;
  std::uint32_t stride = 0;   ///< columns with padding
  double* upper = nullptr;    ///< pivots x stride, of the factor U: row k from column k on, before that zeros
  double* lower = nullptr;    ///< pivots x stride, of the factor L: column k below row k, before that zeros
  double* inverse = nullptr;  ///< of each pivot; 0 for one that was left out
};

struct FrontKernels {
  /// Eliminates the pivots of `block`, rows x stride, of which what is right of and below them
  /// remains, less what they take from it. A pivot whose size is not above its `smallest` is left out: its
  /// equation follows from others. Returns how many were.
  std::uint32_t (*eliminate)(const FrontView&, double* block, const double* smallest);
  /// x, `stride` numbers, the last of them zeros: of the pivots, L^-1 x; of the others, what that takes away.
  void (*forward)(const FrontView&, double* x);
  /// Of the pivots, U^-1 x, given the others.
  void (*backward)(const FrontView&, double* x);
};

#define PLUMB_DECLARE_TABLES(isa, supported) extern const FrontKernels front_##isa;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported().
const FrontKernels& front_kernels(Isa isa);

}  // namespace plumb::simd
