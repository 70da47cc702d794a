// How the scalar bodies of relaxation, which are written for reading, reach the ends of rods, and what both
// make of rods before a substep. Everything has internal linkage.

#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/relax/relax_kernels.hpp"

namespace plumb::simd {
namespace {

enum AccessKind { rows, gather, records };

template <class T>
struct Triple {
  T x, y, z;
};

template <class T>
T dot(const Triple<T>& a, const Triple<T>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

/// Element of the x of one end of rod `lane` of vector `v`.
template <AccessKind access, class T>
std::uint32_t address(const std::uint32_t* addresses, std::uint32_t v, std::uint32_t lane) {
  return access == rows ? addresses[v] + lane : addresses[v * logical_width<T> + lane];
}

template <class T>
Triple<T> load(const T* data, std::uint32_t at, std::uint32_t stride) {
  return {data[at], data[at + stride], data[at + 2 * stride]};
}

/// For each rod of the substep: twice d = x_b - x_a, and c0 = |d|^2 - L^2.
template <AccessKind access, class T>
void prepare(const BlockView<T>& block, Range range) {
  constexpr std::uint32_t width = logical_width<T>;
  for (std::uint32_t v = range.begin; v < range.end; ++v) {
    T* rod = block.rod + std::size_t{v} * rod_fields * width;
    const T* weight = block.weight + std::size_t{v} * weight_fields * width;
    for (std::uint32_t lane = 0; lane < width; ++lane) {
      const auto a = load(block.x, address<access, T>(block.address_a, v, lane), block.component_stride);
      const auto b = load(block.x, address<access, T>(block.address_b, v, lane), block.component_stride);
      const Triple<T> d{b.x - a.x, b.y - a.y, b.z - a.z};
      const T length2 = range.uniform ? block.uniform_length2 : weight[lane];
      rod[lane] = d.x + d.x;
      rod[width + lane] = d.y + d.y;
      rod[2 * width + lane] = d.z + d.z;
      rod[3 * width + lane] = ((d.x * d.x + d.y * d.y) + d.z * d.z) - length2;
    }
  }
}

}  // namespace
}  // namespace plumb::simd
