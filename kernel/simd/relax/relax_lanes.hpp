// This is the vector body of every loop in relax_kernels.hpp. Each instruction set includes it once and sets
// PLUMB_ARCH to its xsimd architecture, if batch.hpp needs one. Everything has internal linkage: of an inline
// function that several instruction sets share, the linker would keep one that not every machine can run.
//
// relax_scalar.cpp says what is computed and why. The operations and their order are the same here.

#include "simd/relax/contacts/contact_lanes.hpp"
#include "simd/relax/contacts/end_lanes.hpp"
#include "simd/relax/contacts/line_contact_lanes.hpp"
#include "simd/relax/contacts/line_lanes.hpp"
#include "simd/relax/crowd_lanes.hpp"
#include "simd/relax/law_lanes.hpp"
#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

/// A projection between its two halves consists of twice the direction of the correction (m), its size, and
/// the ends.
template <class Access, class T>
struct Correction {
  Triple<T> m;
  Batch<T> s;
  [[no_unique_address]] typename Access::template Kept<T> kept;
};

/// Finds the correction of a rod by Halley's method (thesis eq. 4.7); relax_scalar.cpp says why.
template <class Access, Gradient gradient, bool uniform, class T>
PLUMB_INLINE Correction<Access, T> correction(const BlockView<T>& block, Position at,
                                              Batch<T> uniform_length2) {
  typename Access::template Kept<T> kept;
  const Triple<T> e = movement<Access>(block, at, kept);
  const Triple<T> d2 = load_direction(block.rod, at);
  const Triple<T> sum = d2 + e;
  const Batch<T> c = load_field<rod_fields>(static_cast<const T*>(block.rod), at, 3) + dot(e, sum);
  const Batch<T> length2 = uniform ? uniform_length2 : load_field<weight_fields>(block.weight, at, 0);
  const Batch<T> divisor = length2 + Batch<T>(T(0.75)) * c;
  const Batch<T> s = c / lanes::max(divisor, Batch<T>(T(0.25)) * length2);
  if constexpr (gradient == Gradient::old) return {d2, s, kept};
  if constexpr (gradient == Gradient::mid) return {sum, s, kept};
  return {sum + e, s, kept};
}

/// Adds a correction to what a rod has been moved by in the substep.
template <class Access, class T>
PLUMB_INLINE void count_move(const BlockView<T>& block, Position at,
                             const Correction<Access, T>& correction) {
  T* const moved = block.moved + at.v * moved_fields * logical_width<T> + at.first;
  const Triple<T> by = correction.s * correction.m;
  (Batch<T>::load_aligned(moved) + by.x).store_aligned(moved);
  (Batch<T>::load_aligned(moved + logical_width<T>) + by.y).store_aligned(moved + logical_width<T>);
  (Batch<T>::load_aligned(moved + 2 * logical_width<T>) + by.z).store_aligned(moved + 2 * logical_width<T>);
}

template <class Access, bool uniform, bool counts, class T>
PLUMB_INLINE void apply(const BlockView<T>& block, Position at, const Correction<Access, T>& correction,
                        Batch<T> uniform_share) {
  if constexpr (counts) count_move<Access>(block, at, correction);
  if constexpr (uniform) {
    const Triple<T> both = (uniform_share * correction.s) * correction.m;
    move<Access>(block, at, correction.kept, both, both);
  } else {
    const Batch<T> share_a = load_field<weight_fields>(block.weight, at, 1);
    const Batch<T> share_b = load_field<weight_fields>(block.weight, at, 2);
    move<Access>(block, at, correction.kept, (share_a * correction.s) * correction.m,
                 (share_b * correction.s) * correction.m);
  }
}

/// Projects the rods of `count` machine vectors. All are begun before the first is finished, since the
/// operations of one depend on each other, and the processor's window alone holds about two.
template <class Access, Gradient gradient, bool uniform, bool counts, std::size_t count, class T>
PLUMB_INLINE void project(const BlockView<T>& block, std::size_t v, Batch<T> length2, Batch<T> share) {
  Correction<Access, T> begun[count];
#pragma GCC unroll 16
  for (std::size_t k = 0; k < count; ++k)
    begun[k] = correction<Access, gradient, uniform>(block, position<T>(v, k), length2);
#pragma GCC unroll 16
  for (std::size_t k = 0; k < count; ++k)
    apply<Access, uniform, counts>(block, position<T>(v, k), begun[k], share);
}

template <class Access, Gradient gradient, bool uniform, bool counts, class T>
PLUMB_INLINE void sweep_range(const BlockView<T>& block, Range range, Batch<T> length2, Batch<T> share) {
  constexpr std::size_t vectors = Access::unroll > parts<T> ? Access::unroll / parts<T> : 1;
  std::size_t v = range.begin;
  for (; v + vectors <= range.end; v += vectors)
    project<Access, gradient, uniform, counts, vectors * parts<T>>(block, v, length2, share);
  if constexpr (vectors > 1)
    for (; v < range.end; ++v) project<Access, gradient, uniform, counts, parts<T>>(block, v, length2, share);
}

template <class Access, Gradient gradient, bool counts, class T>
void sweep(const BlockView<T>& shared, const Range* ranges, std::uint32_t count) {
  const BlockView<T> block = shared;  // stores through its pointers cannot change a copy
  const Batch<T> length2(block.uniform_length2), share(block.uniform_share);
  for (const Range* range = ranges; range != ranges + count; ++range) {
    if (range->uniform) {
      sweep_range<Access, gradient, true, counts>(block, *range, length2, share);
    } else {
      sweep_range<Access, gradient, false, counts>(block, *range, length2, share);
    }
  }
}

template <class Access, class T>
T violation(const BlockView<T>& block, Range range) {
  Batch<T> largest(T(0));
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const Position at = position<T>(range.begin, i);
    const Triple<T> e = Access::difference(block, static_cast<const T*>(block.p), at);
    const Triple<T> sum = load_direction(block.rod, at) + e;
    const Batch<T> c = load_field<rod_fields>(static_cast<const T*>(block.rod), at, 3) + dot(e, sum);
    const Batch<T> inverse = range.uniform ? Batch<T>(block.uniform_inverse_length2)
                                           : load_field<weight_fields>(block.weight, at, 3);
    largest = lanes::max(lanes::abs(c) * inverse, largest);  // max takes the second if one is not a number
  }
  return largest_lane(largest);
}

template <class T>
void predict(T* __restrict p, const T* __restrict u, const T* __restrict kick, T decay, std::uint32_t n) {
  if (decay == 1) {  // there is no drag
    for (std::uint32_t i = 0; i < n; ++i) p[i] = u[i] + kick[i];
    return;
  }
  for (std::uint32_t i = 0; i < n; ++i) p[i] = decay * u[i] + kick[i];
}

template <class T>
void accumulate(T* __restrict p, T* __restrict acc, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    p[i] += acc[i];
    acc[i] = 0;
  }
}

template <class T>
bool all_finite(const T* x, const T* p, std::uint32_t n) {
  Batch<T> zero(T(0));  // it stays zero unless a number is infinite or not a number
  for (std::uint32_t i = 0; i < n; i += width<T>)
    zero = zero + Batch<T>(T(0)) * (Batch<T>::load_aligned(x + i) + Batch<T>::load_aligned(p + i));
  alignas(64) T lanes[width<T>];
  zero.store_aligned(lanes);
  for (const T lane : lanes)
    if (lane != 0) return false;
  return true;
}

template <class T>
void advance(T* __restrict x, const T* __restrict p, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) x[i] += p[i];
}

template <class T>
void advance_mid(T* __restrict x, T* __restrict p, const T* __restrict u, T decay, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    x[i] += p[i];
    p[i] = decay * ((p[i] + p[i]) - decay * u[i]);
  }
}

template <class T>
void advance_mid_guarded(T* __restrict x, T* __restrict p, const T* __restrict kick, T decay,
                         std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    x[i] += p[i];
    p[i] = decay * (p[i] + kick[i]);
  }
}

template <class Access, class T>
constexpr AccessKernels<T> access_kernels = {
    prepare<Access, T>,
    {sweep<Access, Gradient::new_, false, T>, sweep<Access, Gradient::old, false, T>,
     sweep<Access, Gradient::mid, false, T>},
    violation<Access, T>,
    {sweep<Access, Gradient::new_, true, T>, sweep<Access, Gradient::old, true, T>,
     sweep<Access, Gradient::mid, true, T>},
    law_kernels<Access, T>,
};

template <class T>
constexpr Kernels<T> table = {
    {predict<T>, accumulate<T>, all_finite<T>, advance<T>, advance_mid<T>, advance_mid_guarded<T>},
    crowd_kernels<1, T>,
    row_crowd_kernels<T>,
    {access_kernels<RowAccess, T>, access_kernels<GatherAccess, T>, access_kernels<RecordAccess, T>},
    end_kernels<RecordAccess, T>,
    end_kernels<RowAccess, T>,
    contact_kernels<RecordAccess, T>,
    contact_kernels<GatherAccess, T>,
    line_kernels,
    line_contact_kernels<RecordAccess, T>,
    line_contact_kernels<GatherAccess, T>,
};

}  // namespace
}  // namespace plumb::simd

#undef PLUMB_INLINE
