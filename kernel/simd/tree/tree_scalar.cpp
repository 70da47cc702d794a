// One lane goes after the other here. This is the oracle of the vector bodies, and the solver of a tree
// alone.
#include "simd/tree/one_lane.hpp"

// The loops need what the file above defines.
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
  if (tree.lanes == 1) return prepare_lanes<T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane) prepare_lanes<T, logical_width<T>>(tree, lane);
}
template <Laws laws, class T>
void newton_with(const TreeView<T>& tree, T theta) {
  if (tree.lanes == 1) return newton_lanes<laws, T, 1>(tree, 0, theta);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane)
    newton_lanes<laws, T, logical_width<T>>(tree, lane, theta);
}
template <Laws laws, bool twisted, class T>
void newton_bent(const TreeView<T>& tree, T theta) {
  if (tree.lanes == 1) return newton_bent_lanes<laws, twisted, T, 1>(tree, 0, theta);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane)
    newton_bent_lanes<laws, twisted, T, logical_width<T>>(tree, lane, theta);
}
template <class T>
void newton(const TreeView<T>& tree, T theta) {
  if (with_bends(tree, [&]<Laws laws, bool twisted>() { newton_bent<laws, twisted>(tree, theta); })) return;
  with_laws(tree, [&]<Laws laws>() { newton_with<laws>(tree, theta); });
}
template <Laws laws, class T>
void newton_line_with(const TreeView<T>& tree) {
  if (tree.lanes == 1) return newton_line_lanes<laws, T, 1>(tree, 0);
  for (std::size_t lane = 0; lane < logical_width<T>; ++lane)
    newton_line_lanes<laws, T, logical_width<T>>(tree, lane);
}
template <class T>
void newton_line(const TreeView<T>& tree) {
  with_laws(tree, [&]<Laws laws>() { newton_line_with<laws>(tree); });
}
template <Laws laws, class T>
void newton_segments_with(const TreeView<T>& tree) {
  newton_segments_lanes<laws, T>(tree, [](auto&& f) {
    for (std::size_t lane = 0; lane < logical_width<T>; ++lane) f(At<T, T, logical_width<T>>{lane});
  });
}
template <class T>
void newton_segments(const TreeView<T>& tree) {
  with_laws(tree, [&]<Laws laws>() { newton_segments_with<laws>(tree); });
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
