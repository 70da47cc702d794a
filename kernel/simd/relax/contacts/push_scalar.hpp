// What a visit of an end and one of a contact have in common, one at a time, written for reading: the oracle
// of push_lanes.hpp. Everything has internal linkage.

#pragma once

#include <cmath>

#include "simd/relax/contacts/push_fields.hpp"
#include "simd/relax/scalar_access.hpp"

namespace plumb::simd {
namespace {

/// The fields of one end or contact.
template <class T>
struct OnePush {
  T* fields;

  T& operator()(std::uint32_t field) const { return fields[std::size_t{field} * logical_width<T>]; }
  Triple<T> load3(std::uint32_t field) const {
    return {(*this)(field), (*this)(field + 1), (*this)(field + 2)};
  }
  void store3(const Triple<T>& value, std::uint32_t field) const {
    (*this)(field) = value.x;
    (*this)(field + 1) = value.y;
    (*this)(field + 2) = value.z;
  }
};

template <class T>
void add_to_place(T* p, std::uint32_t stride, const Triple<T>& old, T moves, const Triple<T>& by) {
  p[0] = old.x + moves * by.x;
  p[stride] = old.y + moves * by.y;
  p[2 * stride] = old.z + moves * by.z;
}

/// Sets the pushes on what has `moved` (m) in the substep. That along the normal closes the gap that is left,
/// but never pulls. That across it takes back what slides, as long as it is no larger than friction times the
/// other (Coulomb). All masses are points, so that a push moves a place alike in all directions. Returns what
/// both change, in kg m.
template <class T>
Triple<T> set_pushes(const OnePush<T>& of, const Triple<T>& moved) {
  namespace f = push_fields;
  const Triple<T> n = of.load3(f::normal), before = of.load3(f::across);
  const T along = dot(n, moved), over = of(f::over), push_before = of(f::push);
  const T left = push_before - over * (of(f::gap) + along);
  const T push = left > 0 ? left : T(0);
  Triple<T> across{before.x - over * (moved.x - along * n.x), before.y - over * (moved.y - along * n.y),
                   before.z - over * (moved.z - along * n.z)};
  // What the normal has turned by since the push was kept would pull along it.
  const T along_normal = dot(across, n);
  across = {across.x - along_normal * n.x, across.y - along_normal * n.y, across.z - along_normal * n.z};
  const T bound = of(f::friction) * push, square = dot(across, across);
  const T share = square > bound * bound ? bound / std::sqrt(square) : T(1);
  across = {share * across.x, share * across.y, share * across.z};
  const T pushed = push - push_before;
  of(f::push) = push;
  of.store3(across, f::across);
  return {pushed * n.x + (across.x - before.x), pushed * n.y + (across.y - before.y),
          pushed * n.z + (across.z - before.z)};
}

}  // namespace
}  // namespace plumb::simd
