// One lane after the other: the oracle of the vector bodies, and the solver of a tree alone.
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

#include "simd/tree/tree_lanes.hpp"

// After what it builds on.
#include "simd/tree/motion_lanes.hpp"

// After what they build on.
#include "simd/tree/line_lanes.hpp"
#include "simd/tree/segment_lanes.hpp"

namespace plumb::simd {
namespace {

template <class T>
void prepare(const TreeView<T>& tree) {
  if (tree.lanes == 1) return prepare_lanes<T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane) prepare_lanes<T, logical_width<T>>(tree, lane);
}
template <class T>
void newton(const TreeView<T>& tree, T theta) {
  if (tree.lanes == 1) return newton_lanes<T, 1>(tree, 0, theta);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane)
    newton_lanes<T, logical_width<T>>(tree, lane, theta);
}
template <class T>
void newton_line(const TreeView<T>& tree) {
  if (tree.lanes == 1) return newton_line_lanes<T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane)
    newton_line_lanes<T, logical_width<T>>(tree, lane);
}
template <class T>
void newton_segments(const TreeView<T>& tree) {
  newton_segments_lanes<T>(tree, [](auto&& f) {
    for (std::size_t lane = 0; lane < logical_width<T>; ++lane) f(At<T, T, logical_width<T>>{lane});
  });
}
template <class T>
void find_stiffness(const TreeView<T>& tree) {
  if (tree.lanes == 1) return find_stiffness_lanes<T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane)
    find_stiffness_lanes<T, logical_width<T>>(tree, lane);
}
template <class T>
void advance(const TreeView<T>& tree) {
  if (tree.lanes == 1) return advance_lanes<T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane) advance_lanes<T, logical_width<T>>(tree, lane);
}
template <class T>
void project(const TreeView<T>& tree) {
  if (tree.lanes == 1) return project_lanes<T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane) project_lanes<T, logical_width<T>>(tree, lane);
}

}  // namespace

constinit const TreeKernels<float> tree_scalar_float{
    prepare<float>,        newton<float>,  newton_line<float>, newton_segments<float>,
    find_stiffness<float>, advance<float>, project<float>};
constinit const TreeKernels<double> tree_scalar_double{
    prepare<double>,        newton<double>,  newton_line<double>, newton_segments<double>,
    find_stiffness<double>, advance<double>, project<double>};

}  // namespace plumb::simd
