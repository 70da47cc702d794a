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

/// Sets the pushes on what has `moved` (m). Returns what they change, in kg m.
template <class T>
PLUMB_INLINE Triple<T> set_pushes(const PushLanes<T>& of, const Triple<T>& moved) {
  namespace f = push_fields;
  const Batch<T> zero(T(0));
  const Triple<T> n = of.load3(f::normal), across_before = of.load3(f::across);
  const Batch<T> over = of.load(f::over), along = dot(n, moved), before = of.load(f::push);
  const Batch<T> push = lanes::max(before - over * (of.load(f::gap) + along), zero);
  Triple<T> across = across_before - over * (moved - along * n);
  across = across - dot(across, n) * n;
  const Batch<T> bound = of.load(f::friction) * push, square = dot(across, across);
  // What lies takes no root, nor does what is not pressed.
  if (const auto slides = square > bound * bound; lanes::any(slides)) {
    const Batch<T> one(T(1));
    Batch<T> share = lanes::select(slides, zero, one);
    if (const auto presses = slides && (bound > zero); lanes::any(presses))
      share = lanes::select(presses, bound / lanes::sqrt(square), share);
    across = share * across;
  }
  of.store(push, f::push);
  of.store3(across, f::across);
  return (push - before) * n + (across - across_before);
}

}  // namespace
}  // namespace plumb::simd
