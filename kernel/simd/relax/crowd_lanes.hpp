// Loops over rows of a crowd's particles, in vectors of lanes. crowd_loops.hpp says what is computed, and has
// what compilers make good vectors of; the operations and their order are the same here. It has internal
// linkage, as relax_lanes.hpp has, which includes it.

#pragma once

#include "simd/relax/crowd_loops.hpp"
#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

double weigh_squares_in_lanes(const double* mass, const double* of, std::uint32_t n) {
  constexpr std::uint32_t size = width<double>, together = sums_at_once / size;
  Batch<double> sums[together];
  for (Batch<double>& each : sums) each = Batch<double>(0.0);
  std::uint32_t i = 0;
  for (; i + sums_at_once <= n; i += sums_at_once)
    for (std::uint32_t k = 0; k < together; ++k) {
      const auto each = Batch<double>::load_unaligned(of + i + k * size);
      sums[k] = sums[k] + Batch<double>::load_unaligned(mass + i + k * size) * (each * each);
    }
  alignas(64) double out[sums_at_once];
  for (std::uint32_t k = 0; k < together; ++k) sums[k].store_aligned(out + k * size);
  return end_sums(mass + i, of + i, n - i, out);
}
double weigh_squares_in_lanes(const double* mass, const float* of, std::uint32_t n) {
  return weigh_squares(mass, of, n);
}

template <class T>
T find_farthest_in_rows(const T* p, std::uint32_t n) {
  constexpr std::uint32_t stride = logical_width<T>;
  Batch<T> most[parts<T>];
  for (Batch<T>& each : most) each = Batch<T>(T(0));
  for (std::uint32_t first = 0; first < n; first += crowd_pitch<stride>)
    for (std::uint32_t k = 0; k < parts<T>; ++k) {
      const Triple<T> by = RowAccess::load(p + first + k * width<T>, stride);
      most[k] = lanes::max(dot(by, by), most[k]);
    }
  for (const Batch<T>& each : most) most[0] = lanes::max(each, most[0]);
  return largest_lane(most[0]);
}

template <class T>
std::uint32_t list_fast_in_rows(const T* x, const T* p, const FastRules<T>& rules, std::uint32_t n,
                                std::uint32_t* to) {
  constexpr std::uint32_t stride = logical_width<T>;
  const Batch<T> low[3] = {Batch<T>(rules.low[0]), Batch<T>(rules.low[1]), Batch<T>(rules.low[2])},
                 high[3] = {Batch<T>(rules.high[0]), Batch<T>(rules.high[1]), Batch<T>(rules.high[2])},
                 zero(T(0)), one(T(1)), least2(rules.least2);
  std::uint32_t count = 0;
  for (std::uint32_t first = 0; first < n; first += crowd_pitch<stride>)
    for (std::uint32_t k = 0; k < parts<T>; ++k) {
      const std::uint32_t own = first + k * width<T>;
      const Triple<T> by = RowAccess::load(p + own, stride), at = RowAccess::load(x + own, stride);
      const auto is_within = (at.x >= low[0]) && (at.x <= high[0]) && (at.y >= low[1]) && (at.y <= high[1]) &&
                             (at.z >= low[2]) && (at.z <= high[2]);
      const auto is_fast = is_within && (dot(by, by) > least2);
      if (!lanes::any(is_fast)) continue;
      alignas(64) T found[width<T>];
      lanes::select(is_fast, one, zero).store_aligned(found);
      for (std::uint32_t lane = 0; lane < width<T>; ++lane)
        if (found[lane] != 0) to[count++] = own + lane;
    }
  return count;
}

template <class T>
constexpr CrowdKernels<T> row_crowd_kernels = {predict_crowd<T>, advance_crowd<T>, weigh_squares_in_lanes,
                                               find_farthest_in_rows<T>, list_fast_in_rows<T>};

}  // namespace
}  // namespace plumb::simd
