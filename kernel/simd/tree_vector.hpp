// Trees side by side in the lanes of one vector. Included once per instruction set with PLUMB_ARCH set to its
// xsimd architecture and PLUMB_ISA to its name.
#include <cstddef>
#include <xsimd/xsimd.hpp>

#include "tree_kernels.hpp"

namespace plumb::simd {
namespace {

template <class T>
using Batch = xsimd::batch<T, PLUMB_ARCH>;

template <class V>
constexpr std::size_t lanes_of = V::size;

template <class V, class T>
inline __attribute__((always_inline)) V load(const T* from) {
  return V::load_aligned(from);
}
template <class T>
inline __attribute__((always_inline)) void store(const Batch<T>& value, T* to) {
  value.store_aligned(to);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> select_nonzero(const Batch<T>& mask, const Batch<T>& a,
                                                              const Batch<T>& b) {
  return xsimd::select(mask != Batch<T>(T(0)), a, b);
}
template <class T>
inline __attribute__((always_inline)) Batch<T> reciprocal_or_zero(const Batch<T>& s, const Batch<T>& floor) {
  return xsimd::select(xsimd::abs(s) > floor, Batch<T>(T(1)) / s, Batch<T>(T(0)));
}

}  // namespace
}  // namespace plumb::simd

#include "tree_body.hpp"

namespace plumb::simd {
namespace {

template <class T>
void prepare(const TreeView<T>& tree) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    prepare_lanes<Batch<T>, logical_width<T>>(tree, lane);
}
template <class T>
void newton(const TreeView<T>& tree, T theta) {
  for (std::size_t lane = 0; lane < logical_width<T>; lane += Batch<T>::size)
    newton_lanes<Batch<T>, logical_width<T>>(tree, lane, theta);
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
