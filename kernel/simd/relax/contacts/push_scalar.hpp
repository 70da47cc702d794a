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

/// Sets the push on what has `moved` (m) in the substep. All masses are points, so that a push moves a place
/// alike in all directions: what is asked for takes back what slides, and closes the gap that is left. Of
/// that the nearest is taken that ground can give. It never pulls, and across the normal it is no larger than
/// friction times what presses (Coulomb). Returns what changes, in kg m.
template <class T>
Triple<T> set_push(const OnePush<T>& of, const Triple<T>& moved) {
  namespace f = push_fields;
  const Triple<T> n = of.load3(f::normal), before = of.load3(f::push);
  const T over = of(f::over), gap = of(f::gap);
  const Triple<T> asked{before.x - over * (moved.x + gap * n.x), before.y - over * (moved.y + gap * n.y),
                        before.z - over * (moved.z + gap * n.z)};
  const T along = dot(asked, n), pressing = along > 0 ? along : T(0);
  const Triple<T> across{asked.x - along * n.x, asked.y - along * n.y, asked.z - along * n.z};
  const T bound = of(f::friction) * pressing, square = dot(across, across);
  const T share = square > bound * bound ? bound / std::sqrt(square) : T(1);
  const Triple<T> push{pressing * n.x + share * across.x, pressing * n.y + share * across.y,
                       pressing * n.z + share * across.z};
  of.store3(push, f::push);
  return {push.x - before.x, push.y - before.y, push.z - before.z};
}

}  // namespace
}  // namespace plumb::simd
