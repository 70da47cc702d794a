#pragma once

#include <cstddef>
#include <cstdint>

#include "plumb/settings.hpp"

namespace plumb::bench {

/// Loops that do nothing but show what a machine can do, one set per instruction set.
struct LimitKernels {
  /// x += p, `n` a multiple of 16, both on 64-byte boundaries.
  void (*add)(float* x, const float* p, std::size_t n);
  /// Projects about `rods` rods without memory, and returns how many it were.
  std::uint64_t (*project_float)(std::uint64_t rods);
  std::uint64_t (*project_double)(std::uint64_t rods);
};

extern const LimitKernels limits_scalar, limits_sse2, limits_avx2, limits_avx512;

const LimitKernels& limit_kernels(Isa isa);

}  // namespace plumb::bench
