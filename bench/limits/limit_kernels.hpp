#pragma once

#include <cstddef>
#include <cstdint>

#include "plumb/settings.hpp"

namespace plumb::bench {

/// Holds loops that do nothing but show what a machine can do. There is one set per instruction set.
struct LimitKernels {
  /// Computes x += p. `n` is a multiple of 16, and both arrays lie on 64-byte boundaries.
  void (*add)(float* x, const float* p, std::size_t n);
  /// Projects about `rods` rods without memory. Returns how many it were.
  std::uint64_t (*project_float)(std::uint64_t rods);
  std::uint64_t (*project_double)(std::uint64_t rods);
};

extern const LimitKernels limits_scalar, limits_sse2, limits_avx2, limits_avx512;

const LimitKernels& limit_kernels(Isa isa);

}  // namespace plumb::bench
