#pragma once

#include <cstdint>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/settings.hpp"

/// The innermost loops, one body per instruction set, and the table they are called through.
///
/// All bodies do the same operations (+ - * / max, never fused) in the same order on the
/// same logical vectors (16 floats or 8 doubles). So all give the same bits. `relax_scalar.cpp` is written
/// for reading and is the oracle of the others, which share `relax_lanes.hpp`.
namespace plumb::simd {

/// Fields per rod in BlockView::rod and BlockView::weight: logical vectors for each vector of rods.
inline constexpr std::uint32_t rod_fields = 4;     ///< 2(x_b - x_a) as x, y, z; |x_b - x_a|^2 - L^2
inline constexpr std::uint32_t weight_fields = 4;  ///< L^2; k_a; k_b; 1/L^2 (0 for padding)

template <class T>
inline constexpr std::uint32_t logical_width = layouts::lane_width<T>;

/// What a kernel needs of a block. Positions in m, displacements in m per substep, lengths squared in m^2.
/// The shares are k = omega/4 * w/(w_a + w_b). One half of omega is there as the correction of |d|^2 - L^2 =
/// C along d is C/2. Another is there because directions are kept as twice themselves.
template <class T>
struct BlockView {
  const T* x;  ///< Positions at the start of the substep.
  T* p;        ///< Displacements from x, which sweeps correct.
  T* out;      ///< Where corrections are added: p (Gauss–Seidel) or an accumulator (Jacobi).
  std::uint32_t component_stride;
  T* rod;           ///< rod_fields vectors per vector of rods, made by prepare.
  const T* weight;  ///< weight_fields vectors per vector of rods; not read for uniform ranges.
  const std::uint32_t* address_a;
  const std::uint32_t* address_b;
  T uniform_length2;  ///< Squared length of rods in uniform ranges, in m^2.
  T uniform_share;    ///< Shares k_a = k_b of rods in uniform ranges.
  T uniform_inverse_length2;
};

/// A range of vectors of rods.
struct Range {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool uniform = false;
};

/// Loops for one way of addressing rods. `sweep` projects every rod of each range, range after range; rods of
/// one range share no movable particle. `violation` is the largest |C|/L^2 of a range. It passes over what is
/// not a number, so that a broken island does not keep the others of its block sweeping.
template <class T>
struct AccessKernels {
  void (*prepare)(const BlockView<T>&, Range);
  void (*sweep[3])(const BlockView<T>&, const Range*, std::uint32_t count);  ///< by Gradient
  T (*violation)(const BlockView<T>&, Range);
};

/// Loops over particle numbers, whatever the layout. Lengths are multiples of the logical width.
template <class T>
struct ParticleKernels {
  /// Predicts: p = decay * u + kick.
  void (*predict)(T* p, const T* u, const T* kick, T decay, std::uint32_t n);
  /// Adds what a Jacobi sweep summed: p += acc; acc = 0.
  void (*accumulate)(T* p, T* acc, std::uint32_t n);
  /// Says whether every x + p is finite.
  bool (*all_finite)(const T* x, const T* p, std::uint32_t n);
  /// Moves particles: x += p.
  void (*advance)(T* x, const T* p, std::uint32_t n);
  /// Moves particles with gradient mid: x += p; p = decay * (2p - decay * u). That is the velocity at the end
  /// of a step whose mean velocity is p.
  void (*advance_mid)(T* x, T* p, const T* u, T decay, std::uint32_t n);
  /// The same, damped, for a p that is not converged: x += p; p = decay * (p + kick).
  void (*advance_mid_guarded)(T* x, T* p, const T* kick, T decay, std::uint32_t n);
};

template <class T>
struct Kernels {
  ParticleKernels<T> particles;
  AccessKernels<T> access[3];  ///< by layouts::Access
};

/// Every instruction set, slowest first, and what a processor must have for it (`cpu` is xsimd's list). The
/// files of that name define its tables, and CMakeLists.txt gives those files its flags; Isa names it.
#define PLUMB_FOR_EACH_ISA(row)                                             \
  row(scalar, true) row(sse2, cpu.sse2) row(avx2, cpu.avx2&& cpu.fma3_avx2) \
      row(avx512, cpu.avx512bw&& cpu.avx512dq&& cpu.avx512cd&& __builtin_cpu_supports("avx512vl"))

#define PLUMB_DECLARE_TABLES(isa, supported)       \
  extern const Kernels<float> relax_##isa##_float; \
  extern const Kernels<double> relax_##isa##_double;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported(). Defined in dispatch.cpp.
template <class T>
const Kernels<T>& kernels(Isa isa);

}  // namespace plumb::simd
