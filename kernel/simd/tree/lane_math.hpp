// The loops of trees work with these vectors and matrices, whose numbers are those of one lane or of all.
// tree_lanes.hpp includes this file.

#include "simd/inline.hpp"

namespace plumb::simd {
namespace {

template <class V>
struct Vec {
  V x, y, z;
};
template <class V>
PLUMB_INLINE Vec<V> operator+(const Vec<V>& a, const Vec<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
PLUMB_INLINE Vec<V> operator-(const Vec<V>& a, const Vec<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
PLUMB_INLINE Vec<V> operator*(const V& s, const Vec<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class V>
PLUMB_INLINE V dot(const Vec<V>& a, const Vec<V>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class V>
PLUMB_INLINE Vec<V> cross(const Vec<V>& a, const Vec<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A matrix of 3 x 3 consists of three rows or of three columns, as the name says where it is used.
template <class V>
struct Mat {
  Vec<V> v0, v1, v2;
};
/// Multiplies a matrix given by columns with a.
template <class V>
PLUMB_INLINE Vec<V> multiply(const Mat<V>& columns, const Vec<V>& a) {
  return (a.x * columns.v0 + a.y * columns.v1) + a.z * columns.v2;
}
/// Multiplies the transpose of a matrix given by columns with a.
template <class V>
PLUMB_INLINE Vec<V> multiply_transposed(const Mat<V>& columns, const Vec<V>& a) {
  return {dot(columns.v0, a), dot(columns.v1, a), dot(columns.v2, a)};
}
/// Returns the columns of the inverse of a matrix given by rows, by cofactors.
template <class V>
PLUMB_INLINE Mat<V> inverse(const Mat<V>& rows) {
  const Vec<V> c0 = cross(rows.v1, rows.v2), c1 = cross(rows.v2, rows.v0), c2 = cross(rows.v0, rows.v1);
  const V over = V(1) / dot(rows.v0, c0);
  return {over * c0, over * c1, over * c2};
}

template <class V>
PLUMB_INLINE V trace(const Mat<V>& m) {
  return (m.v0.x + m.v1.y) + m.v2.z;
}

/// Reads and writes entries of arrays that hold `lanes` numbers for each, of one lane or of all in a vector.
template <class V, class T, std::size_t lanes>
struct At {
  static constexpr std::size_t stride = lanes;
  std::size_t lane;

  PLUMB_INLINE V get(const T* data, std::size_t entry) const { return load<V>(data + entry * lanes + lane); }
  PLUMB_INLINE Vec<V> get3(const T* data, std::size_t entry) const {
    return {get(data, entry), get(data, entry + 1), get(data, entry + 2)};
  }
  PLUMB_INLINE void put(T* data, std::size_t entry, const V& value) const {
    store(value, data + entry * lanes + lane);
  }
  PLUMB_INLINE void put3(T* data, std::size_t entry, const Vec<V>& value) const {
    put(data, entry, value.x);
    put(data, entry + 1, value.y);
    put(data, entry + 2, value.z);
  }
};

}  // namespace
}  // namespace plumb::simd
