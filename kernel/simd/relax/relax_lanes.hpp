// The vector body of every loop in kernels.hpp, included once per instruction set with PLUMB_ARCH set to its
// xsimd architecture. Everything has internal linkage: an inline function shared between files compiled for
// different instruction sets would be merged by the linker into one that not every machine can run.
//
// scalar.cpp says what is computed and why; the operations and their order here are the same.

#include <type_traits>
#include <xsimd/xsimd.hpp>

#include "simd/relax/records.hpp"
#include "simd/relax/relax_kernels.hpp"

#define PLUMB_INLINE inline __attribute__((always_inline))

namespace plumb::simd {
namespace {

template <class T>
using Batch = xsimd::batch<T, PLUMB_ARCH>;

template <class T>
constexpr std::uint32_t width = Batch<T>::size;

/// Machine vectors per logical vector.
template <class T>
constexpr std::uint32_t parts = logical_width<T> / width<T>;

template <class T>
struct Triple {
  Batch<T> x, y, z;
};

template <class T>
PLUMB_INLINE Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
PLUMB_INLINE Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
PLUMB_INLINE Triple<T> operator*(const Batch<T>& s, const Triple<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
PLUMB_INLINE Batch<T> dot(const Triple<T>& a, const Triple<T>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

/// The rods of one machine vector: those from lane `first` of logical vector `v`.
struct Position {
  std::size_t v;
  std::size_t first;
};
/// The k-th machine vector from the beginning of logical vector `v`.
template <class T>
PLUMB_INLINE Position position(std::size_t v, std::size_t k) {
  return {v + k / parts<T>, k % parts<T> * width<T>};
}

/// Field `field` of a per-rod array with `fields` fields.
template <std::size_t fields, class T>
PLUMB_INLINE Batch<T> load_field(const T* data, Position at, std::size_t field) {
  return Batch<T>::load_aligned(data + (at.v * fields + field) * logical_width<T> + at.first);
}
template <class T>
PLUMB_INLINE Triple<T> load_direction(const T* rod, Position at) {
  return {load_field<rod_fields>(rod, at, 0), load_field<rod_fields>(rod, at, 1),
          load_field<rod_fields>(rod, at, 2)};
}

/// The two ends of rods, where there are registers to keep them from the beginning of a projection to its
/// end.
template <class T>
struct Ends {
  Triple<T> a, b;
};
template <class T>
struct NoEnds {};

/// Neighbouring rods have neighbouring ends.
struct RowAccess {
  static constexpr std::size_t unroll = 4;

  template <class T>
  using Kept = NoEnds<T>;

  template <class T>
  static PLUMB_INLINE Triple<T> load(const T* from, std::size_t stride) {
    return {Batch<T>::load_unaligned(from), Batch<T>::load_unaligned(from + stride),
            Batch<T>::load_unaligned(from + 2 * stride)};
  }
  /// b - a for the ends of the rods.
  template <class T>
  static PLUMB_INLINE Triple<T> difference(const BlockView<T>& block, const T* data, Position at) {
    const Triple<T> a = load(data + block.address_a[at.v] + at.first, block.component_stride);
    const Triple<T> b = load(data + block.address_b[at.v] + at.first, block.component_stride);
    return b - a;
  }
  template <class T>
  static PLUMB_INLINE void store(const Triple<T>& value, T* to, std::size_t stride) {
    value.x.store_unaligned(to);
    value.y.store_unaligned(to + stride);
    value.z.store_unaligned(to + 2 * stride);
  }
  /// Adds `move_a` to the a ends and takes `move_b` from the b ends. Reads again what it adds to: a vector
  /// shifted by one lane may end in a padding lane that overlaps numbers written a moment ago.
  template <class T>
  static PLUMB_INLINE void apply(const BlockView<T>& block, Position at, const Triple<T>& move_a,
                                 const Triple<T>& move_b) {
    T* a = block.out + block.address_a[at.v] + at.first;
    T* b = block.out + block.address_b[at.v] + at.first;
    store(load(a, block.component_stride) + move_a, a, block.component_stride);
    store(load(b, block.component_stride) - move_b, b, block.component_stride);
  }
};

/// Ends anywhere, collected through the stack: hardware gathers are slower than this on the machines
/// measured.
struct GatherAccess {
  static constexpr std::size_t unroll = 1;

  template <class T>
  using Kept = NoEnds<T>;

  template <class T>
  static PLUMB_INLINE Triple<T> difference(const BlockView<T>& block, const T* data, Position at) {
    alignas(64) T e[3][width<T>];
    const std::uint32_t* a = block.address_a + at.v * logical_width<T> + at.first;
    const std::uint32_t* b = block.address_b + at.v * logical_width<T> + at.first;
    const std::size_t stride = block.component_stride;
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      e[0][lane] = data[b[lane]] - data[a[lane]];
      e[1][lane] = data[b[lane] + stride] - data[a[lane] + stride];
      e[2][lane] = data[b[lane] + 2 * stride] - data[a[lane] + 2 * stride];
    }
    return {Batch<T>::load_aligned(e[0]), Batch<T>::load_aligned(e[1]), Batch<T>::load_aligned(e[2])};
  }
  template <class T>
  static PLUMB_INLINE void apply(const BlockView<T>& block, Position at, const Triple<T>& move_a,
                                 const Triple<T>& move_b) {
    alignas(64) T moves[6][width<T>];
    move_a.x.store_aligned(moves[0]);
    move_a.y.store_aligned(moves[1]);
    move_a.z.store_aligned(moves[2]);
    move_b.x.store_aligned(moves[3]);
    move_b.y.store_aligned(moves[4]);
    move_b.z.store_aligned(moves[5]);
    const std::uint32_t* a = block.address_a + at.v * logical_width<T> + at.first;
    const std::uint32_t* b = block.address_b + at.v * logical_width<T> + at.first;
    const std::size_t stride = block.component_stride;
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      T* to_a = block.out + a[lane];
      T* to_b = block.out + b[lane];
      to_a[0] += moves[0][lane];
      to_a[stride] += moves[1][lane];
      to_a[2 * stride] += moves[2][lane];
      to_b[0] -= moves[3][lane];
      to_b[stride] -= moves[4][lane];
      to_b[2 * stride] -= moves[5][lane];
    }
  }
};

/// Ends anywhere, each a record x y z 0, transposed in registers.
///
/// With 32 registers, both ends of a rod being relaxed are transposed and kept: new ones are made of them as
/// columns and stored without being read again. With 16, it is faster to transpose only their difference and
/// to add to the records in memory.
struct RecordAccess {
  static constexpr std::size_t unroll = 2;

  template <class T>
  using Kept = std::conditional_t<parts<T> == 1, Ends<T>, NoEnds<T>>;

  template <class T>
  static PLUMB_INLINE Triple<T> load(const T* data, const std::uint32_t* addresses) {
    Record<T> records[width<T>];
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) records[lane] = load_record(data + addresses[lane]);
    Columns<T, width<T>> columns;
    to_columns(records, columns);
    return {Batch<T>(columns.x), Batch<T>(columns.y), Batch<T>(columns.z)};
  }
  template <class T>
  static PLUMB_INLINE void store(const Triple<T>& value, T* data, const std::uint32_t* addresses) {
    Record<T> records[width<T>];
    to_records(Columns<T, width<T>>{value.x.data, value.y.data, value.z.data}, records);
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) store_record(records[lane], data + addresses[lane]);
  }
  template <class T>
  static PLUMB_INLINE Ends<T> load_ends(const BlockView<T>& block, Position at) {
    return {load(static_cast<const T*>(block.p), block.address_a + at.v * logical_width<T> + at.first),
            load(static_cast<const T*>(block.p), block.address_b + at.v * logical_width<T> + at.first)};
  }
  template <class T>
  static PLUMB_INLINE void store_ends(const BlockView<T>& block, Position at, const Triple<T>& a,
                                      const Triple<T>& b) {
    store(a, block.out, block.address_a + at.v * logical_width<T> + at.first);
    store(b, block.out, block.address_b + at.v * logical_width<T> + at.first);
  }

  template <class T>
  static PLUMB_INLINE Triple<T> difference(const BlockView<T>& block, const T* data, Position at) {
    const std::uint32_t* a = block.address_a + at.v * logical_width<T> + at.first;
    const std::uint32_t* b = block.address_b + at.v * logical_width<T> + at.first;
    Record<T> e[width<T>];
    for (std::uint32_t lane = 0; lane < width<T>; ++lane)
      e[lane] = load_record(data + b[lane]) - load_record(data + a[lane]);
    Columns<T, width<T>> columns;
    to_columns(e, columns);
    return {Batch<T>(columns.x), Batch<T>(columns.y), Batch<T>(columns.z)};
  }
  template <class T>
  static PLUMB_INLINE void apply(const BlockView<T>& block, Position at, const Triple<T>& move_a,
                                 const Triple<T>& move_b) {
    const std::uint32_t* a = block.address_a + at.v * logical_width<T> + at.first;
    const std::uint32_t* b = block.address_b + at.v * logical_width<T> + at.first;
    Record<T> moves_a[width<T>], moves_b[width<T>];
    to_records(Columns<T, width<T>>{move_a.x.data, move_a.y.data, move_a.z.data}, moves_a);
    to_records(Columns<T, width<T>>{move_b.x.data, move_b.y.data, move_b.z.data}, moves_b);
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      store_record(load_record(block.out + a[lane]) + moves_a[lane], block.out + a[lane]);
      store_record(load_record(block.out + b[lane]) - moves_b[lane], block.out + b[lane]);
    }
  }
};

template <class Access, class T>
void prepare(const BlockView<T>& block, Range range) {
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const Position at = position<T>(range.begin, i);
    const Triple<T> d = Access::difference(block, block.x, at);
    const Batch<T> length2 =
        range.uniform ? Batch<T>(block.uniform_length2) : load_field<weight_fields>(block.weight, at, 0);
    T* rod = block.rod + std::size_t{at.v} * rod_fields * logical_width<T> + at.first;
    (d.x + d.x).store_aligned(rod);
    (d.y + d.y).store_aligned(rod + logical_width<T>);
    (d.z + d.z).store_aligned(rod + 2 * logical_width<T>);
    (dot(d, d) - length2).store_aligned(rod + 3 * logical_width<T>);
  }
}

/// A projection between its two halves: twice the direction of the correction, its size, and the ends.
template <class Access, class T>
struct Correction {
  Triple<T> m;
  Batch<T> s;
  [[no_unique_address]] typename Access::template Kept<T> kept;
};

template <class Access, Gradient gradient, bool uniform, class T>
PLUMB_INLINE Correction<Access, T> correction(const BlockView<T>& block, Position at,
                                              Batch<T> uniform_length2) {
  using Kept = typename Access::template Kept<T>;
  Kept kept;
  Triple<T> e;
  if constexpr (std::is_same_v<Kept, Ends<T>>) {
    kept = Access::load_ends(block, at);
    e = kept.b - kept.a;
  } else {
    e = Access::difference(block, static_cast<const T*>(block.p), at);
  }
  const Triple<T> d2 = load_direction(block.rod, at);
  const Triple<T> sum = d2 + e;
  const Batch<T> c = load_field<rod_fields>(static_cast<const T*>(block.rod), at, 3) + dot(e, sum);
  const Batch<T> length2 = uniform ? uniform_length2 : load_field<weight_fields>(block.weight, at, 0);
  const Batch<T> divisor = length2 + Batch<T>(T(0.75)) * c;
  const Batch<T> s = c / xsimd::max(divisor, Batch<T>(T(0.25)) * length2);
  if constexpr (gradient == Gradient::old) return {d2, s, kept};
  if constexpr (gradient == Gradient::mid) return {sum, s, kept};
  return {sum + e, s, kept};
}

/// Moves the ends, or adds to the sums that stand for them (Jacobi).
template <class Access, class T>
PLUMB_INLINE void move(const BlockView<T>& block, Position at, const typename Access::template Kept<T>& kept,
                       const Triple<T>& move_a, const Triple<T>& move_b) {
  if constexpr (std::is_same_v<typename Access::template Kept<T>, Ends<T>>) {
    if (block.out == block.p) return Access::store_ends(block, at, kept.a + move_a, kept.b - move_b);
  }
  Access::apply(block, at, move_a, move_b);
}

template <class Access, bool uniform, class T>
PLUMB_INLINE void apply(const BlockView<T>& block, Position at, const Correction<Access, T>& correction,
                        Batch<T> uniform_share) {
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

/// Projects the rods of `count` machine vectors. All are begun before the first is finished: each is one long
/// chain of dependent operations, and the processor's window alone holds only about two.
template <class Access, Gradient gradient, bool uniform, std::size_t count, class T>
PLUMB_INLINE void project(const BlockView<T>& block, std::size_t v, Batch<T> length2, Batch<T> share) {
  Correction<Access, T> begun[count];
#pragma GCC unroll 16
  for (std::size_t k = 0; k < count; ++k)
    begun[k] = correction<Access, gradient, uniform>(block, position<T>(v, k), length2);
#pragma GCC unroll 16
  for (std::size_t k = 0; k < count; ++k) apply<Access, uniform>(block, position<T>(v, k), begun[k], share);
}

template <class Access, Gradient gradient, bool uniform, class T>
PLUMB_INLINE void sweep_range(const BlockView<T>& block, Range range, Batch<T> length2, Batch<T> share) {
  constexpr std::size_t vectors = Access::unroll > parts<T> ? Access::unroll / parts<T> : 1;
  std::size_t v = range.begin;
  for (; v + vectors <= range.end; v += vectors)
    project<Access, gradient, uniform, vectors * parts<T>>(block, v, length2, share);
  if constexpr (vectors > 1)
    for (; v < range.end; ++v) project<Access, gradient, uniform, parts<T>>(block, v, length2, share);
}

template <class Access, Gradient gradient, class T>
void sweep(const BlockView<T>& shared, const Range* ranges, std::uint32_t count) {
  const BlockView<T> block = shared;  // a copy that stores through its pointers cannot change
  const Batch<T> length2(block.uniform_length2), share(block.uniform_share);
  for (const Range* range = ranges; range != ranges + count; ++range) {
    if (range->uniform) {
      sweep_range<Access, gradient, true>(block, *range, length2, share);
    } else {
      sweep_range<Access, gradient, false>(block, *range, length2, share);
    }
  }
}

template <class T>
PLUMB_INLINE T largest_lane(const Batch<T>& batch) {
  alignas(64) T lanes[width<T>];
  batch.store_aligned(lanes);
  T largest = 0;
  for (const T lane : lanes) largest = lane > largest ? lane : largest;
  return largest;
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
    largest =
        xsimd::max(xsimd::abs(c) * inverse, largest);  // of two, max takes the second if one is not a number
  }
  return largest_lane(largest);
}

template <class T>
void predict(T* __restrict p, const T* __restrict u, const T* __restrict kick, T decay, std::uint32_t n) {
  if (decay == 1) {  // no drag
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
  Batch<T> zero(T(0));  // stays zero unless a number is infinite or not a number
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
    {sweep<Access, Gradient::new_, T>, sweep<Access, Gradient::old, T>, sweep<Access, Gradient::mid, T>},
    violation<Access, T>,
};

template <class T>
constexpr Kernels<T> table = {
    {predict<T>, accumulate<T>, all_finite<T>, advance<T>, advance_mid<T>, advance_mid_guarded<T>},
    {access_kernels<RowAccess, T>, access_kernels<GatherAccess, T>, access_kernels<RecordAccess, T>},
};

}  // namespace
}  // namespace plumb::simd

#undef PLUMB_INLINE
