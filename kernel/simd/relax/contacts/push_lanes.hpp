// What visits of ends and of contacts have in common, in vectors of lanes. push_scalar.hpp says what is
// computed and why; the operations and their order are the same here. It has internal linkage, as what
// includes it has.

#pragma once

#include "simd/relax/contacts/push_fields.hpp"
#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

/// The fields of a machine vector of ends or contacts.
template <class T>
struct PushLanes {
  T* fields;

  PLUMB_INLINE Batch<T> load(std::uint32_t field) const {
    return Batch<T>::load_aligned(fields + field * logical_width<T>);
  }
  PLUMB_INLINE Triple<T> load3(std::uint32_t field) const {
    return {load(field), load(field + 1), load(field + 2)};
  }
  PLUMB_INLINE void store(const Batch<T>& value, std::uint32_t field) const {
    value.store_aligned(fields + field * logical_width<T>);
  }
  PLUMB_INLINE void store3(const Triple<T>& value, std::uint32_t field) const {
    store(value.x, field);
    store(value.y, field + 1);
    store(value.z, field + 2);
  }
};

/// Sets the push on what has `moved` (m). Returns what it changes, in kg m.
template <class T>
PLUMB_INLINE Triple<T> set_push(const PushLanes<T>& of, const Triple<T>& moved) {
  namespace f = push_fields;
  const Batch<T> zero(T(0));
  const Triple<T> n = of.load3(f::normal), before = of.load3(f::push);
  const Triple<T> asked = before - of.load(f::over) * (moved + of.load(f::gap) * n);
  const Batch<T> along = dot(asked, n), pressing = lanes::max(along, zero);
  Triple<T> across = asked - along * n;
  const Batch<T> bound = of.load(f::friction) * pressing, square = dot(across, across);
  // What lies takes no root, nor does what is not pressed.
  if (const auto slides = square > bound * bound; lanes::any(slides)) {
    const Batch<T> one(T(1));
    Batch<T> share = lanes::select(slides, zero, one);
    if (const auto presses = slides && (bound > zero); lanes::any(presses))
      share = lanes::select(presses, bound / lanes::sqrt(square), share);
    across = share * across;
  }
  const Triple<T> push = pressing * n + across;
  of.store3(push, f::push);
  return push - before;
}

}  // namespace
}  // namespace plumb::simd
