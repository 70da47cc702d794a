// These functions transpose between records (x y z 0) and columns (x x x ...) for access_lanes.hpp, and have
// internal linkage as it has. They use the compiler's vectors: xsimd 8 has no transpose, and shuffles with
// constant indices are all it takes.

#pragma once

#include <cstdint>
#include <cstring>
#include <utility>

namespace plumb::simd {
namespace {

template <class T, std::uint32_t n>
struct VectorOf {
  typedef T type __attribute__((vector_size(n * sizeof(T))));
};
template <class T, std::uint32_t n>
using Vector = typename VectorOf<T, n>::type;

template <class T>
using Record = Vector<T, 4>;

template <class T, std::uint32_t n>
struct Columns {
  Vector<T, n> x, y, z;
};

/// Columns of records whose last number counts.
template <class T, std::uint32_t n>
struct FourColumns {
  Vector<T, n> x, y, z, w;
};

template <class T>
inline __attribute__((always_inline)) Record<T> load_record(const T* from) {
  Record<T> record;
  std::memcpy(&record, from, sizeof record);
  return record;
}

template <class T>
inline __attribute__((always_inline)) void store_record(Record<T> record, T* to) {
  std::memcpy(to, &record, sizeof record);
}

/// Joins every fourth record into one vector: record 4 j + k becomes the j-th four numbers.
template <class T, std::uint32_t n>
inline __attribute__((always_inline)) Vector<T, n> join(const Record<T>* records, std::uint32_t k) {
  Vector<T, n> joined;
  if constexpr (n == 4) {
    joined = records[k];
  } else if constexpr (n == 8) {
    joined = __builtin_shufflevector(records[k], records[4 + k], 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    const Vector<T, 8> low = __builtin_shufflevector(records[k], records[4 + k], 0, 1, 2, 3, 4, 5, 6, 7);
    const Vector<T, 8> high =
        __builtin_shufflevector(records[8 + k], records[12 + k], 0, 1, 2, 3, 4, 5, 6, 7);
    joined = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
  return joined;
}

/// Takes apart what join() makes.
template <class T, std::uint32_t n>
inline __attribute__((always_inline)) void split(Vector<T, n> joined, Record<T>* records, std::uint32_t k) {
  if constexpr (n == 4) {
    records[k] = joined;
  } else if constexpr (n == 8) {
    records[k] = __builtin_shufflevector(joined, joined, 0, 1, 2, 3);
    records[4 + k] = __builtin_shufflevector(joined, joined, 4, 5, 6, 7);
  } else {
    records[k] = __builtin_shufflevector(joined, joined, 0, 1, 2, 3);
    records[4 + k] = __builtin_shufflevector(joined, joined, 4, 5, 6, 7);
    records[8 + k] = __builtin_shufflevector(joined, joined, 8, 9, 10, 11);
    records[12 + k] = __builtin_shufflevector(joined, joined, 12, 13, 14, 15);
  }
}

/// Shuffles every four lanes alike: p0 p1 p2 p3 are indices into the four of `a` (0 to 3) and of `b` (4 to
/// 7).
template <int p0, int p1, int p2, int p3, class V>
inline __attribute__((always_inline)) V shuffle_fours(V a, V b) {
  constexpr int n = sizeof(V) / sizeof(a[0]);
  const auto index = [](int i) constexpr {
    constexpr int pattern[4] = {p0, p1, p2, p3};
    const int p = pattern[i % 4];
    return i / 4 * 4 + (p < 4 ? p : n + p - 4);
  };
  return [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    return __builtin_shufflevector(a, b, index(i)...);
  }
  (std::make_integer_sequence<int, n>{});
}

/// Takes every other lane of both, the even ones or the odd ones, by turns. For doubles that is one
/// instruction within halves of 128 bits, where what shuffle_fours() does else takes several.
template <class V>
inline __attribute__((always_inline)) V even_of_two(V a, V b) {
  return shuffle_fours<0, 4, 2, 6>(a, b);
}
template <class V>
inline __attribute__((always_inline)) V odd_of_two(V a, V b) {
  return shuffle_fours<1, 5, 3, 7>(a, b);
}

template <class T, std::uint32_t n>
inline __attribute__((always_inline)) void to_four_columns(const Record<T>* records,
                                                           FourColumns<T, n>& columns) {
  if constexpr (n == 2) {
    columns.x = __builtin_shufflevector(records[0], records[1], 0, 4);
    columns.y = __builtin_shufflevector(records[0], records[1], 1, 5);
    columns.z = __builtin_shufflevector(records[0], records[1], 2, 6);
    columns.w = __builtin_shufflevector(records[0], records[1], 3, 7);
  } else {
    const auto r0 = join<T, n>(records, 0), r1 = join<T, n>(records, 1);
    const auto r2 = join<T, n>(records, 2), r3 = join<T, n>(records, 3);
    if constexpr (sizeof(T) == 8) {
      const auto xz01 = even_of_two(r0, r1), xz23 = even_of_two(r2, r3);
      const auto yw01 = odd_of_two(r0, r1), yw23 = odd_of_two(r2, r3);
      columns.x = shuffle_fours<0, 1, 4, 5>(xz01, xz23);
      columns.y = shuffle_fours<0, 1, 4, 5>(yw01, yw23);
      columns.z = shuffle_fours<2, 3, 6, 7>(xz01, xz23);
      columns.w = shuffle_fours<2, 3, 6, 7>(yw01, yw23);
    } else {
      const auto xy01 = shuffle_fours<0, 4, 1, 5>(r0, r1), xy23 = shuffle_fours<0, 4, 1, 5>(r2, r3);
      const auto zw01 = shuffle_fours<2, 6, 3, 7>(r0, r1), zw23 = shuffle_fours<2, 6, 3, 7>(r2, r3);
      columns.x = shuffle_fours<0, 1, 4, 5>(xy01, xy23);
      columns.y = shuffle_fours<2, 3, 6, 7>(xy01, xy23);
      columns.z = shuffle_fours<0, 1, 4, 5>(zw01, zw23);
      columns.w = shuffle_fours<2, 3, 6, 7>(zw01, zw23);
    }
  }
}

template <class T, std::uint32_t n>
inline __attribute__((always_inline)) void to_columns(const Record<T>* records, Columns<T, n>& columns) {
  FourColumns<T, n> all;
  to_four_columns(records, all);
  columns = {all.x, all.y, all.z};
}

template <class T, std::uint32_t n>
inline __attribute__((always_inline)) void to_records(const Columns<T, n>& columns, Record<T>* records) {
  if constexpr (n == 2) {
    const Record<T> xy = __builtin_shufflevector(columns.x, columns.y, 0, 1, 2, 3);
    const Record<T> z = __builtin_shufflevector(columns.z, Vector<T, 2>{}, 0, 1, 2, 3);
    records[0] = __builtin_shufflevector(xy, z, 0, 2, 4, 6);
    records[1] = __builtin_shufflevector(xy, z, 1, 3, 5, 7);
  } else if constexpr (sizeof(T) == 8) {
    const Vector<T, n> zero{};
    const auto xy02 = even_of_two(columns.x, columns.y), z02 = even_of_two(columns.z, zero);
    const auto xy13 = odd_of_two(columns.x, columns.y), z13 = odd_of_two(columns.z, zero);
    split<T, n>(shuffle_fours<0, 1, 4, 5>(xy02, z02), records, 0);
    split<T, n>(shuffle_fours<0, 1, 4, 5>(xy13, z13), records, 1);
    split<T, n>(shuffle_fours<2, 3, 6, 7>(xy02, z02), records, 2);
    split<T, n>(shuffle_fours<2, 3, 6, 7>(xy13, z13), records, 3);
  } else {
    const Vector<T, n> zero{};
    const auto xy_low = shuffle_fours<0, 4, 1, 5>(columns.x, columns.y);   // x0 y0 x1 y1
    const auto xy_high = shuffle_fours<2, 6, 3, 7>(columns.x, columns.y);  // x2 y2 x3 y3
    const auto z_low = shuffle_fours<0, 4, 1, 5>(columns.z, zero);         // z0 0 z1 0
    const auto z_high = shuffle_fours<2, 6, 3, 7>(columns.z, zero);
    split<T, n>(shuffle_fours<0, 1, 4, 5>(xy_low, z_low), records, 0);
    split<T, n>(shuffle_fours<2, 3, 6, 7>(xy_low, z_low), records, 1);
    split<T, n>(shuffle_fours<0, 1, 4, 5>(xy_high, z_high), records, 2);
    split<T, n>(shuffle_fours<2, 3, 6, 7>(xy_high, z_high), records, 3);
  }
}

}  // namespace
}  // namespace plumb::simd
