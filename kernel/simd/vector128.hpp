// Vectors of 128 bits for processors without bodies of xsimd that give the bits of x86. NEON and WebAssembly
// use them. Every processor that g++ or clang has vectors for can, so tests run them too.
//
// They have the names of xsimd that bodies use. Of two numbers, max and min take the second unless the first
// is larger or smaller, also where one is not a number or both are zeros, as x86 does.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "simd/inline.hpp"

#if defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

namespace plumb::simd {
namespace {
namespace vector128 {

template <class T>
struct LanesOf {
  typedef T type __attribute__((vector_size(16)));
};

/// Holds in every lane all bits or none.
template <class T>
struct Mask {
  using Lanes = typename LanesOf<std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>>::type;
  Lanes data;

  PLUMB_INLINE explicit Mask(Lanes lanes) : data(lanes) {}
  friend PLUMB_INLINE Mask operator&&(const Mask& a, const Mask& b) { return Mask(a.data & b.data); }
  friend PLUMB_INLINE Mask operator||(const Mask& a, const Mask& b) { return Mask(a.data | b.data); }
};

/// Holds four floats or two doubles.
template <class T>
struct Batch {
  static constexpr std::size_t size = 16 / sizeof(T);
  using value_type = T;
  using Lanes = typename LanesOf<T>::type;
  Lanes data;

  Batch() = default;
  PLUMB_INLINE Batch(Lanes lanes) : data(lanes) {}
  PLUMB_INLINE explicit Batch(T value) {
    if constexpr (size == 4)
      data = Lanes{value, value, value, value};
    else
      data = Lanes{value, value};
  }

  static PLUMB_INLINE Batch load_unaligned(const T* from) {
    Batch out;
    std::memcpy(&out.data, from, sizeof out.data);
    return out;
  }
  static PLUMB_INLINE Batch load_aligned(const T* from) {
    Batch out;
    std::memcpy(&out.data, __builtin_assume_aligned(from, 16), sizeof out.data);
    return out;
  }
  PLUMB_INLINE void store_unaligned(T* to) const { std::memcpy(to, &data, sizeof data); }
  PLUMB_INLINE void store_aligned(T* to) const {
    std::memcpy(__builtin_assume_aligned(to, 16), &data, sizeof data);
  }

  friend PLUMB_INLINE Batch operator+(const Batch& a, const Batch& b) { return a.data + b.data; }
  friend PLUMB_INLINE Batch operator-(const Batch& a, const Batch& b) { return a.data - b.data; }
  friend PLUMB_INLINE Batch operator*(const Batch& a, const Batch& b) { return a.data * b.data; }
  friend PLUMB_INLINE Batch operator/(const Batch& a, const Batch& b) { return a.data / b.data; }
  friend PLUMB_INLINE Mask<T> operator<(const Batch& a, const Batch& b) { return Mask<T>(a.data < b.data); }
  friend PLUMB_INLINE Mask<T> operator>(const Batch& a, const Batch& b) { return Mask<T>(a.data > b.data); }
  friend PLUMB_INLINE Mask<T> operator<=(const Batch& a, const Batch& b) { return Mask<T>(a.data <= b.data); }
  friend PLUMB_INLINE Mask<T> operator>=(const Batch& a, const Batch& b) { return Mask<T>(a.data >= b.data); }
  friend PLUMB_INLINE Mask<T> operator==(const Batch& a, const Batch& b) { return Mask<T>(a.data == b.data); }
  friend PLUMB_INLINE Mask<T> operator!=(const Batch& a, const Batch& b) { return Mask<T>(a.data != b.data); }
};

#ifdef __wasm_simd128__
template <class T>
PLUMB_INLINE v128_t to_bits(const Batch<T>& batch) {
  return reinterpret_cast<v128_t>(batch.data);
}
template <class T>
PLUMB_INLINE typename Batch<T>::Lanes to_lanes(v128_t bits) {
  return reinterpret_cast<typename Batch<T>::Lanes>(bits);
}
#endif

template <class T>
PLUMB_INLINE Batch<T> select(const Mask<T>& mask, const Batch<T>& a, const Batch<T>& b) {
  return mask.data ? a.data : b.data;
}
template <class T>
PLUMB_INLINE bool any(const Mask<T>& mask) {
  std::uint64_t halves[2];
  std::memcpy(halves, &mask.data, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}
template <class T>
PLUMB_INLINE Batch<T> max(const Batch<T>& a, const Batch<T>& b) {
#ifdef __wasm_simd128__
  if constexpr (sizeof(T) == 4) return to_lanes<T>(wasm_f32x4_pmax(to_bits(b), to_bits(a)));
  return to_lanes<T>(wasm_f64x2_pmax(to_bits(b), to_bits(a)));
#else
  return select(a > b, a, b);
#endif
}
template <class T>
PLUMB_INLINE Batch<T> min(const Batch<T>& a, const Batch<T>& b) {
#ifdef __wasm_simd128__
  if constexpr (sizeof(T) == 4) return to_lanes<T>(wasm_f32x4_pmin(to_bits(b), to_bits(a)));
  return to_lanes<T>(wasm_f64x2_pmin(to_bits(b), to_bits(a)));
#else
  return select(a < b, a, b);
#endif
}
template <class T>
PLUMB_INLINE Batch<T> abs(const Batch<T>& a) {
  using Bits = typename Mask<T>::Lanes;
  const Bits sign = reinterpret_cast<Bits>(Batch<T>(T(-0.0)).data);
  return reinterpret_cast<typename Batch<T>::Lanes>(reinterpret_cast<Bits>(a.data) & ~sign);
}
template <class T>
PLUMB_INLINE Batch<T> sqrt(const Batch<T>& a) {
#if defined(__aarch64__)
  if constexpr (sizeof(T) == 4)
    return vsqrtq_f32(a.data);
  else
    return vsqrtq_f64(a.data);
#elif defined(__wasm_simd128__)
  if constexpr (sizeof(T) == 4) return to_lanes<T>(wasm_f32x4_sqrt(to_bits(a)));
  return to_lanes<T>(wasm_f64x2_sqrt(to_bits(a)));
#else
  Batch<T> out;
  for (std::size_t lane = 0; lane < Batch<T>::size; ++lane) out.data[lane] = std::sqrt(a.data[lane]);
  return out;
#endif
}
/// Returns the sum of each of two vectors.
PLUMB_INLINE Batch<double> haddp(const Batch<double>* rows) {
  return __builtin_shufflevector(rows[0].data, rows[1].data, 0, 2) +
         __builtin_shufflevector(rows[0].data, rows[1].data, 1, 3);
}

}  // namespace vector128
}  // namespace
}  // namespace plumb::simd
