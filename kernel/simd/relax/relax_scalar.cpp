// The projection of a rod, one rod at a time, written for reading. Every other body must give the same bits.

#include <cmath>

#include "simd/relax/contacts/contact_scalar.hpp"
#include "simd/relax/contacts/end_scalar.hpp"
#include "simd/relax/contacts/line_contact_scalar.hpp"
#include "simd/relax/contacts/line_scalar.hpp"
#include "simd/relax/crowd_loops.hpp"
#include "simd/relax/law_scalar.hpp"

namespace plumb::simd {
namespace {

/// e = p_b - p_a, how far the rod's vector moved since the start of the substep, and its violation
/// C = |d + e|^2 - L^2, made from small numbers so that float keeps it: c0 + e.(2d + e).
template <class T>
struct Violation {
  Triple<T> e;
  Triple<T> sum;  // 2d + e: twice the middle direction
  T c;
};
template <AccessKind access, class T>
Violation<T> violation_of(const BlockView<T>& block, std::uint32_t v, std::uint32_t lane, std::uint32_t at_a,
                          std::uint32_t at_b) {
  constexpr std::uint32_t width = logical_width<T>;
  const T* rod = block.rod + std::size_t{v} * rod_fields * width;
  const auto a = load<T>(block.p, at_a, block.component_stride);
  const auto b = load<T>(block.p, at_b, block.component_stride);
  Violation<T> out;
  out.e = {b.x - a.x, b.y - a.y, b.z - a.z};
  out.sum = {rod[lane] + out.e.x, rod[width + lane] + out.e.y, rod[2 * width + lane] + out.e.z};
  out.c = rod[3 * width + lane] + ((out.e.x * out.sum.x + out.e.y * out.sum.y) + out.e.z * out.sum.z);
  return out;
}

/// One projection (thesis eq. 4.7): move the ends along m, in proportion to k_a and k_b, so that C becomes 0.
///
/// The step is Halley's, s = C / (L^2 + 3/4 C): its residual is cubic (a strain of 1 % leaves one of
/// 2.5e-7), it needs no square root, and it stays bounded from collapsed (C = -L^2) to far overlong rods.
/// Exact arithmetic never reaches the lower bound on the divisor; rounding can when particles are thrown far.
template <AccessKind access, Gradient gradient, bool counts, class T>
void sweep_range(const BlockView<T>& block, Range range) {
  constexpr std::uint32_t width = logical_width<T>;
  const std::uint32_t stride = block.component_stride;
  for (std::uint32_t v = range.begin; v < range.end; ++v) {
    const T* rod = block.rod + std::size_t{v} * rod_fields * width;
    const T* weight = block.weight + std::size_t{v} * weight_fields * width;
    for (std::uint32_t lane = 0; lane < width; ++lane) {
      const std::uint32_t at_a = address<access, T>(block.address_a, v, lane);
      const std::uint32_t at_b = address<access, T>(block.address_b, v, lane);
      const T length2 = range.uniform ? block.uniform_length2 : weight[lane];
      const T share_a = range.uniform ? block.uniform_share : weight[width + lane];
      const T share_b = range.uniform ? block.uniform_share : weight[2 * width + lane];

      const auto [e, sum, c] = violation_of<access>(block, v, lane, at_a, at_b);
      const T divisor = length2 + T(0.75) * c;
      const T bound = T(0.25) * length2;
      const T s = c / (divisor > bound ? divisor : bound);
      Triple<T> m{};  // twice the direction of the correction
      if constexpr (gradient == Gradient::old) m = {rod[lane], rod[width + lane], rod[2 * width + lane]};
      if constexpr (gradient == Gradient::mid) m = sum;
      if constexpr (gradient == Gradient::new_) m = {sum.x + e.x, sum.y + e.y, sum.z + e.z};

      if constexpr (counts) {
        T* const moved = block.moved + std::size_t{v} * moved_fields * width + lane;
        moved[0] += s * m.x;
        moved[width] += s * m.y;
        moved[2 * width] += s * m.z;
      }
      const T move_a = share_a * s, move_b = share_b * s;
      block.out[at_a] += move_a * m.x;
      block.out[at_a + stride] += move_a * m.y;
      block.out[at_a + 2 * stride] += move_a * m.z;
      block.out[at_b] -= move_b * m.x;
      block.out[at_b + stride] -= move_b * m.y;
      block.out[at_b + 2 * stride] -= move_b * m.z;
    }
  }
}

template <AccessKind access, Gradient gradient, bool counts, class T>
void sweep(const BlockView<T>& block, const Range* ranges, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) sweep_range<access, gradient, counts>(block, ranges[i]);
}

template <AccessKind access, class T>
T violation(const BlockView<T>& block, Range range) {
  constexpr std::uint32_t width = logical_width<T>;
  T largest = 0;
  for (std::uint32_t v = range.begin; v < range.end; ++v) {
    const T* weight = block.weight + std::size_t{v} * weight_fields * width;
    for (std::uint32_t lane = 0; lane < width; ++lane) {
      const std::uint32_t at_a = address<access, T>(block.address_a, v, lane);
      const std::uint32_t at_b = address<access, T>(block.address_b, v, lane);
      const T inverse = range.uniform ? block.uniform_inverse_length2 : weight[3 * width + lane];
      const T relative = std::fabs(violation_of<access>(block, v, lane, at_a, at_b).c) * inverse;
      largest = relative > largest ? relative : largest;
    }
  }
  return largest;
}

template <class T>
void predict(T* p, const T* u, const T* kick, T decay, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) p[i] = decay * u[i] + kick[i];
}

template <class T>
void accumulate(T* p, T* acc, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    p[i] += acc[i];
    acc[i] = 0;
  }
}

template <class T>
bool all_finite(const T* x, const T* p, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i)
    if (!std::isfinite(x[i] + p[i])) return false;
  return true;
}

template <class T>
void advance(T* x, const T* p, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) x[i] += p[i];
}

template <class T>
void advance_mid(T* x, T* p, const T* u, T decay, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    x[i] += p[i];
    p[i] = decay * ((p[i] + p[i]) - decay * u[i]);
  }
}

template <class T>
void advance_mid_guarded(T* x, T* p, const T* kick, T decay, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    x[i] += p[i];
    p[i] = decay * (p[i] + kick[i]);
  }
}

template <AccessKind access, class T>
constexpr AccessKernels<T> access_kernels = {
    prepare<access, T>,
    {sweep<access, Gradient::new_, false, T>, sweep<access, Gradient::old, false, T>,
     sweep<access, Gradient::mid, false, T>},
    violation<access, T>,
    {sweep<access, Gradient::new_, true, T>, sweep<access, Gradient::old, true, T>,
     sweep<access, Gradient::mid, true, T>},
    law_kernels<access, T>,
};

template <class T>
constexpr Kernels<T> table = {
    {predict<T>, accumulate<T>, all_finite<T>, advance<T>, advance_mid<T>, advance_mid_guarded<T>},
    crowd_kernels<1, T>,
    crowd_kernels<logical_width<T>, T>,
    {access_kernels<rows, T>, access_kernels<gather, T>, access_kernels<records, T>},
    end_kernels<records, T>,
    end_kernels<rows, T>,
    contact_kernels<records, T>,
    contact_kernels<rows, T>,
    line_kernels,
    line_contact_kernels<T>,
    line_contact_kernels<T>,
};

}  // namespace

constinit const Kernels<float> relax_scalar_float = table<float>;
constinit const Kernels<double> relax_scalar_double = table<double>;

}  // namespace plumb::simd
