// Loops over the particles of a crowd, written for reading. Of the first two compilers make vectors, and what
// lies in records has none, so that bodies of all instruction sets share these. For rows they are the oracle
// of crowd_lanes.hpp. Everything has internal linkage.

#pragma once

#include <cstddef>

#include "simd/relax/relax_kernels.hpp"

namespace plumb::simd {
namespace {

template <class T>
void predict_crowd(T* __restrict p, const T* __restrict v, const T* __restrict a, T keep, T by,
                   std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) p[i] = keep * v[i] + by * a[i];
}

template <class T>
void advance_crowd(T* __restrict x, T* __restrict v, const T* __restrict p, T over, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    v[i] = over * p[i];
    x[i] += p[i];
  }
}

/// So many sums do not wait for each other.
constexpr std::uint32_t sums_at_once = 8;

/// Adds what is left of such numbers, at most so many, and then the sums.
template <class T>
double end_sums(const double* mass, const T* of, std::uint32_t n, double* sums) {
  for (std::uint32_t k = 0; k < n; ++k) sums[k] += mass[k] * (double{of[k]} * of[k]);
  double sum = 0;
  for (std::uint32_t k = 0; k < sums_at_once; ++k) sum += sums[k];
  return sum;
}

template <class T>
double weigh_squares(const double* mass, const T* of, std::uint32_t n) {
  double sums[sums_at_once] = {};
  std::uint32_t i = 0;
  for (; i + sums_at_once <= n; i += sums_at_once)
    for (std::uint32_t k = 0; k < sums_at_once; ++k) sums[k] += mass[i + k] * (double{of[i + k]} * of[i + k]);
  return end_sums(mass + i, of + i, n - i, sums);
}

/// Particles in rows have a stride of one logical vector from x to y and to z. Records are rows of one.
template <std::uint32_t stride>
constexpr std::uint32_t crowd_pitch = stride == 1 ? 4 : 3 * stride;

/// Returns the square of how far (m²) the k-th particle of a row is displaced.
template <std::uint32_t stride, class T>
T square_of_move(const T* p, std::uint32_t k) {
  const T x = p[k], y = p[stride + k], z = p[2 * stride + k];
  return (x * x + y * y) + z * z;
}

template <std::uint32_t stride, class T>
T find_farthest(const T* p, std::uint32_t n) {
  T most[stride] = {};
  for (std::uint32_t first = 0; first < n; first += crowd_pitch<stride>)
    for (std::uint32_t k = 0; k < stride; ++k) {
      const T square = square_of_move<stride>(p + first, k);
      most[k] = square > most[k] ? square : most[k];
    }
  T out = 0;
  for (const T each : most) out = each > out ? each : out;
  return out;
}

template <std::uint32_t stride, class T>
std::uint32_t list_fast(const T* x, const T* p, const FastRules<T>& rules, std::uint32_t n,
                        std::uint32_t* to) {
  std::uint32_t count = 0;
  for (std::uint32_t first = 0; first < n; first += crowd_pitch<stride>)
    for (std::uint32_t k = 0; k < stride; ++k) {
      if (!(square_of_move<stride>(p + first, k) > rules.least2)) continue;
      bool is_within = true;
      for (std::uint32_t c = 0; c < 3; ++c) {
        const T at = x[first + c * stride + k];
        is_within = is_within && at >= rules.low[c] && at <= rules.high[c];
      }
      if (is_within) to[count++] = first + k;
    }
  return count;
}

template <std::uint32_t stride, class T>
constexpr CrowdKernels<T> crowd_kernels = {predict_crowd<T>, advance_crowd<T>, weigh_squares<T>,
                                           find_farthest<stride, T>, list_fast<stride, T>};

}  // namespace
}  // namespace plumb::simd
