// Vectors of doubles for the bodies of fronts, of blocks of four and of right hand sides in lanes. Included
// once per instruction set with PLUMB_ARCH set to its xsimd architecture, if batch.hpp needs one.
#include "simd/batch.hpp"

namespace plumb::simd {
namespace {

using Batch = BatchOf<double>;

template <class V>
inline __attribute__((always_inline)) V load(const double* from) {
  return V::load_aligned(from);
}
template <class V>
inline __attribute__((always_inline)) V broadcast(double value) {
  return V(value);
}
/// In lane i the sum of values[i], as many values as lanes: (0 + 1) + (2 + 3), as the scalar body adds.
template <class... Vs>
inline __attribute__((always_inline)) Batch horizontal_sums(const Vs&... values) {
  const Batch rows[] = {values...};
  return lanes::haddp(rows);
}
inline __attribute__((always_inline)) void store(const Batch& value, double* to) {
  value.store_aligned(to);
}

}  // namespace
}  // namespace plumb::simd
