// Trees stand side by side in the lanes of one vector. Each instruction set includes this file once and sets
// PLUMB_ARCH to its xsimd architecture, if batch.hpp needs one.
#include <cstddef>
#include <cstring>

#include "simd/batch.hpp"
#include "simd/tree/tree_kernels.hpp"

namespace plumb::simd {
namespace {

template <class T>
using Batch = BatchOf<T>;

template <class V, class T>
inline __attribute__((always_inline)) V load(const T* from) {
  return V::load_aligned(from);
}
template <class T>
inline __attribute__((always_inline)) void store(const Batch<T>& value, T* to) {
  value.store_aligned(to);
}
/// It holds as many doubles as V has lanes, in two registers where V holds floats.
template <class V>
using Wide __attribute__((vector_size(V::size * sizeof(double)))) = double;
template <class V>
using Narrow __attribute__((vector_size(V::size * sizeof(typename V::value_type)))) = typename V::value_type;

template <class V>
inline __attribute__((always_inline)) Wide<V> load_wide(const double* from) {
  Wide<V> value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <class V>
inline __attribute__((always_inline)) V narrow(Wide<V> value) {
  const Narrow<V> narrowed = __builtin_convertvector(value, Narrow<V>);
  V result;
  std::memcpy(&result, &narrowed, sizeof result);
  return result;
}
template <class T>
inline __attribute__((always_inline)) void add_wide(const Batch<T>& value, double* to) {
  Narrow<Batch<T>> narrowed;
  std::memcpy(&narrowed, &value, sizeof narrowed);
  const Wide<Batch<T>> sum = load_wide<Batch<T>>(to) + __builtin_convertvector(narrowed, Wide<Batch<T>>);
  std::memcpy(to, &sum, sizeof sum);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> select_nonzero(const Batch<T>& mask, const Batch<T>& a,
                                                              const Batch<T>& b) {
  return lanes::select(mask != Batch<T>(T(0)), a, b);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> select_positive(const Batch<T>& value, const Batch<T>& a,
                                                               const Batch<T>& b) {
  return lanes::select(value > Batch<T>(T(0)), a, b);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> root(const Batch<T>& value) {
  return lanes::sqrt(value);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> larger(const Batch<T>& a, const Batch<T>& b) {
  return lanes::select(a > b, a, b);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> reciprocal_or_zero(const Batch<T>& s, const Batch<T>& floor) {
  return lanes::select(lanes::abs(s) > floor, Batch<T>(T(1)) / s, Batch<T>(T(0)));
}

}  // namespace
}  // namespace plumb::simd

#include "simd/tree/tree_lanes.hpp"

// Bent lines and motion need what the file above defines.
#include "simd/tree/lines/bent_lanes.hpp"
#include "simd/tree/motion_lanes.hpp"

// Lines and segments need what the files above define.
#include "simd/tree/lines/line_lanes.hpp"
#include "simd/tree/lines/segment_lanes.hpp"

namespace plumb::simd {
namespace {

template <class T>
void prepare(const TreeView<T>& tree) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    prepare_lanes<Batch<T>, logical_width<T>>(tree, lane);
}
template <Laws laws, class T>
void newton_with(const TreeView<T>& tree, T theta) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    newton_lanes<laws, Batch<T>, logical_width<T>>(tree, lane, theta);
}
template <Laws laws, bool twisted, class T>
void newton_bent(const TreeView<T>& tree, T theta) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    newton_bent_lanes<laws, twisted, Batch<T>, logical_width<T>>(tree, lane, theta);
}
template <class T>
void newton(const TreeView<T>& tree, T theta) {
  if (with_bends(tree, [&]<Laws laws, bool twisted>() { newton_bent<laws, twisted>(tree, theta); })) return;
  with_laws(tree, [&]<Laws laws>() { newton_with<laws>(tree, theta); });
}
template <Laws laws, class T>
void newton_line_with(const TreeView<T>& tree) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    newton_line_lanes<laws, Batch<T>, logical_width<T>>(tree, lane);
}
template <class T>
void newton_line(const TreeView<T>& tree) {
  with_laws(tree, [&]<Laws laws>() { newton_line_with<laws>(tree); });
}
template <Laws laws, class T>
void newton_segments_with(const TreeView<T>& tree) {
  newton_segments_lanes<laws, Batch<T>>(tree, [](auto&& f) {
    for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
      f(At<Batch<T>, T, logical_width<T>>{lane});
  });
}
template <class T>
void newton_segments(const TreeView<T>& tree) {
  with_laws(tree, [&]<Laws laws>() { newton_segments_with<laws>(tree); });
}
template <class T>
void find_stiffness(const TreeView<T>& tree) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    find_stiffness_lanes<Batch<T>, logical_width<T>>(tree, lane);
}
template <class T>
void advance(const TreeView<T>& tree) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    advance_lanes<Batch<T>, logical_width<T>>(tree, lane);
}
template <class T>
void project(const TreeView<T>& tree) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    project_lanes<Batch<T>, logical_width<T>>(tree, lane);
}

}  // namespace
}  // namespace plumb::simd
