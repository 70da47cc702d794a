// The loops of relax_lanes.hpp and law_lanes.hpp reach the ends of their rods in these ways. visit_lanes.hpp
// alone includes this one.

#include <type_traits>

#include "simd/batch.hpp"
#include "simd/inline.hpp"
#include "simd/relax/records.hpp"
#include "simd/relax/relax_kernels.hpp"

namespace plumb::simd {
namespace {

template <class T>
using Batch = BatchOf<T>;

template <class T>
constexpr std::uint32_t width = Batch<T>::size;

/// A logical vector consists of so many machine vectors.
template <class T>
constexpr std::uint32_t parts = logical_width<T> / width<T>;

/// Vectors hold the three components of as many places as there are lanes, in m.
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

/// A position names the rods of one machine vector, which begin in lane `first` of logical vector `v`.
struct Position {
  std::size_t v;
  std::size_t first;
};
/// Returns the k-th machine vector from the beginning of logical vector `v`.
template <class T>
PLUMB_INLINE Position position(std::size_t v, std::size_t k) {
  return {v + k / parts<T>, k % parts<T> * width<T>};
}

/// Loads field `field` of an array that has `fields` fields for every rod.
template <std::size_t fields, class T>
PLUMB_INLINE Batch<T> load_field(const T* data, Position at, std::size_t field) {
  return Batch<T>::load_aligned(data + (at.v * fields + field) * logical_width<T> + at.first);
}
template <class T>
PLUMB_INLINE Triple<T> load_direction(const T* rod, Position at) {
  return {load_field<rod_fields>(rod, at, 0), load_field<rod_fields>(rod, at, 1),
          load_field<rod_fields>(rod, at, 2)};
}

/// The two ends of rods stay here from the beginning of a projection to its end, where there are registers
/// enough.
template <class T>
struct Ends {
  Triple<T> a, b;
};
template <class T>
struct NoEnds {};

/// This access is for rows, in which neighbouring rods have neighbouring ends.
struct RowAccess {
  static constexpr std::size_t unroll = 4;

  template <class T>
  using Kept = NoEnds<T>;

  template <class T>
  static PLUMB_INLINE Triple<T> load(const T* from, std::size_t stride) {
    return {Batch<T>::load_unaligned(from), Batch<T>::load_unaligned(from + stride),
            Batch<T>::load_unaligned(from + 2 * stride)};
  }
  /// Returns b - a for the two ends of every rod.
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
  /// Adds `move_a` to the a ends and takes `move_b` from the b ends. It reads again what it adds to, since a
  /// vector shifted by one lane may end in a padding lane that overlaps numbers written a moment ago.
  template <class T>
  static PLUMB_INLINE void apply(const BlockView<T>& block, Position at, const Triple<T>& move_a,
                                 const Triple<T>& move_b) {
    T* a = block.out + block.address_a[at.v] + at.first;
    T* b = block.out + block.address_b[at.v] + at.first;
    store(load(a, block.component_stride) + move_a, a, block.component_stride);
    store(load(b, block.component_stride) - move_b, b, block.component_stride);
  }
};

/// This access is for ends that lie anywhere. It collects them through the stack, since hardware gathers are
/// slower on the machines measured.
struct GatherAccess {
  static constexpr std::size_t unroll = 1;

  template <class T>
  using Kept = NoEnds<T>;

  template <class T>
  static PLUMB_INLINE Triple<T> load(const T* data, const std::uint32_t* addresses, std::size_t stride) {
    alignas(64) T out[3][width<T>];
    for (std::uint32_t lane = 0; lane < width<T>; ++lane)
      for (std::size_t c = 0; c < 3; ++c) out[c][lane] = data[addresses[lane] + c * stride];
    return {Batch<T>::load_aligned(out[0]), Batch<T>::load_aligned(out[1]), Batch<T>::load_aligned(out[2])};
  }
  template <class T>
  static PLUMB_INLINE void store(const Triple<T>& value, T* data, const std::uint32_t* addresses,
                                 std::size_t stride) {
    alignas(64) T in[3][width<T>];
    value.x.store_aligned(in[0]);
    value.y.store_aligned(in[1]);
    value.z.store_aligned(in[2]);
    for (std::uint32_t lane = 0; lane < width<T>; ++lane)
      for (std::size_t c = 0; c < 3; ++c) data[addresses[lane] + c * stride] = in[c][lane];
  }

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

/// This access is for ends that lie anywhere, each as a record x y z 0, and transposes them in registers.
///
/// With 32 registers both ends of a rod are transposed and kept. New ones are made of them as columns, and
/// stored without being read again. With 16 it is faster to transpose their difference alone and to add to
/// memory.
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

}  // namespace
}  // namespace plumb::simd
