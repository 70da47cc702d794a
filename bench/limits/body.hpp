// The body of the loops in limit_kernels.hpp, included once per instruction set with PLUMB_VECTOR(T) set to its vector
// of T. Internal linkage throughout, as in kernel/simd.

#include <type_traits>

#include "limit_kernels.hpp"

#define PLUMB_INLINE inline __attribute__((always_inline))

namespace plumb::bench {
namespace {

/// The register inside an xsimd batch; a number is its own.
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

/// Rods of one common length and share, corrected along their new direction: the operations of the kernel's sweep and
/// none of its loads and stores. The compiler is told that end a changes each time and that both ends are used;
/// nothing of a projection goes into the next, so the processor has as many in flight as it can hold.
template <class V, class T>
std::uint64_t project(std::uint64_t rods) {
  constexpr std::uint64_t lanes = sizeof(V) / sizeof(T);
  Triple<V> a{V(T(0.001)), V(T(0.002)), V(T(0.003))};
  const Triple<V> b{V(T(0.003)), V(T(0.001)), V(T(0.002))}, d2{V(T(0.1)), V(T(0.11)), V(T(0.12))};
  const V c0(T(0.001)), length2(T(0.01)), quarter = V(T(0.25)) * length2, share(T(0.125));
  std::uint64_t done = 0;
  for (; done < rods; done += lanes) {
    asm volatile("" : "+v"(bits(a.x)), "+v"(bits(a.y)), "+v"(bits(a.z)));
    const Triple<V> e{b.x - a.x, b.y - a.y, b.z - a.z};
    const Triple<V> sum{d2.x + e.x, d2.y + e.y, d2.z + e.z};
    const V c = c0 + ((e.x * sum.x + e.y * sum.y) + e.z * sum.z);
    const V s = share * (c / larger(length2 + V(T(0.75)) * c, quarter));
    const Triple<V> move{s * (sum.x + e.x), s * (sum.y + e.y), s * (sum.z + e.z)};
    V new_a[3] = {a.x + move.x, a.y + move.y, a.z + move.z};
    V new_b[3] = {b.x - move.x, b.y - move.y, b.z - move.z};
    asm volatile("" ::"v"(bits(new_a[0])), "v"(bits(new_a[1])), "v"(bits(new_a[2])), "v"(bits(new_b[0])),
                 "v"(bits(new_b[1])), "v"(bits(new_b[2])));
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
