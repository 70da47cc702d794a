// These functions let the loops of trees work on plain numbers, one lane after the other. tree_scalar.cpp is
// the oracle of the vector bodies and includes this file before the loops.
#include <cmath>
#include <cstddef>

#include "simd/tree/tree_kernels.hpp"

namespace plumb::simd {
namespace {

template <class V>
inline V load(const V* from) {
  return *from;
}
template <class V>
inline void store(V value, V* to) {
  *to = value;
}
template <class V>
inline double load_wide(const double* from) {
  return *from;
}
template <class V>
inline V narrow(double value) {
  return static_cast<V>(value);
}
template <class V>
inline void add_wide(V value, double* to) {
  *to += static_cast<double>(value);
}
/// a where `mask` is not 0, else b.
template <class V>
inline V select_nonzero(V mask, V a, V b) {
  return mask != 0 ? a : b;
}
/// a where `value` is above 0, else b.
template <class V>
inline V select_positive(V value, V a, V b) {
  return value > 0 ? a : b;
}
template <class V>
inline V root(V value) {
  return std::sqrt(value);
}
template <class V>
inline V larger(V a, V b) {
  return a > b ? a : b;
}
/// 1/s, or 0 if |s| is not above `floor`: a rod or tie that others make redundant then pulls nothing.
template <class V>
inline V reciprocal_or_zero(V s, V floor) {
  return std::abs(s) > floor ? 1 / s : 0;
}

}  // namespace
}  // namespace plumb::simd
