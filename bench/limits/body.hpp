// This is the body of the loops in limit_kernels.hpp. It is included once per instruction set with
// PLUMB_VECTOR(T) set to its vector of T. It has internal linkage throughout, as in kernel/simd.

#include <type_traits>

#include "limit_kernels.hpp"

#define PLUMB_INLINE inline __attribute__((always_inline))

namespace plumb::bench {
namespace {

/// Returns the register inside an xsimd batch; a number is its own.
template <class V>
PLUMB_INLINE auto& bits(V& v) {
  if constexpr (std::is_floating_point_v<V>) {
    return v;
  } else {
    return v.data;
  }
}

template <class V>
PLUMB_INLINE V larger(V a, V b) {
  if constexpr (std::is_floating_point_v<V>) {
    return a > b ? a : b;
  } else {
    return xsimd::max(a, b);
  }
}

template <class V>
struct Triple {
  V x, y, z;
};

/// Projects rods of one common length and share, corrected along their new direction. It has the operations
/// of the kernel's sweep and none of its loads and stores.
///
/// The compiler is told that end a changes each time and that both ends are used. Nothing of a projection
/// goes into the next, so the processor has as many in flight as it can hold. Where there are registers for
/// two (32 of 64 bytes), two are begun before the first is finished, which helps it a little.
template <class V, class T>
std::uint64_t project(std::uint64_t rods) {
  constexpr std::uint64_t lanes = sizeof(V) / sizeof(T), begun = sizeof(V) == 64 ? 2 : 1;
  Triple<V> a[begun];
  for (Triple<V>& end : a) end = {V(T(0.001)), V(T(0.002)), V(T(0.003))};
  const Triple<V> b{V(T(0.003)), V(T(0.001)), V(T(0.002))}, d2{V(T(0.1)), V(T(0.11)), V(T(0.12))};
  const V c0(T(0.001)), length2(T(0.01)), quarter = V(T(0.25)) * length2, share(T(0.125));
  std::uint64_t done = 0;
  for (; done < rods; done += begun * lanes) {
    Triple<V> m[begun];
    V s[begun];
#pragma GCC unroll 2
    for (std::uint64_t k = 0; k < begun; ++k) {
      asm volatile("" : "+v"(bits(a[k].x)), "+v"(bits(a[k].y)), "+v"(bits(a[k].z)));
      const Triple<V> e{b.x - a[k].x, b.y - a[k].y, b.z - a[k].z};
      const Triple<V> sum{d2.x + e.x, d2.y + e.y, d2.z + e.z};
      const V c = c0 + ((e.x * sum.x + e.y * sum.y) + e.z * sum.z);
      s[k] = share * (c / larger(length2 + V(T(0.75)) * c, quarter));
      m[k] = {sum.x + e.x, sum.y + e.y, sum.z + e.z};
    }
#pragma GCC unroll 2
    for (std::uint64_t k = 0; k < begun; ++k) {
      const Triple<V> move{s[k] * m[k].x, s[k] * m[k].y, s[k] * m[k].z};
      V new_a[3] = {a[k].x + move.x, a[k].y + move.y, a[k].z + move.z};
      V new_b[3] = {b.x - move.x, b.y - move.y, b.z - move.z};
      asm volatile("" ::"v"(bits(new_a[0])), "v"(bits(new_a[1])), "v"(bits(new_a[2])), "v"(bits(new_b[0])),
                   "v"(bits(new_b[1])), "v"(bits(new_b[2])));
    }
  }
  return done;
}

template <class V>
void add(float* x, const float* p, std::size_t n) {
  constexpr std::size_t lanes = sizeof(V) / sizeof(float);
  for (std::size_t i = 0; i < n; i += lanes) {
    if constexpr (lanes == 1) {
      x[i] += p[i];
    } else {
      (V::load_aligned(x + i) + V::load_aligned(p + i)).store_aligned(x + i);
    }
  }
}

constexpr LimitKernels limit_table = {add<PLUMB_VECTOR(float)>, project<PLUMB_VECTOR(float), float>,
                                      project<PLUMB_VECTOR(double), double>};

}  // namespace
}  // namespace plumb::bench

#undef PLUMB_INLINE
