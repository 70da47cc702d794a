// Visits of ends that ground may hold, in vectors of lanes. end_scalar.hpp says what is computed and why; the
// operations and their order are the same here. relax_lanes.hpp includes it, and it has internal linkage as
// that has.

#pragma once

#include "simd/relax/contacts/least_distance.hpp"
#include "simd/relax/contacts/push_lanes.hpp"
#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

/// Ends of one machine vector.
template <class Access, class T>
struct EndLanes : PushLanes<T> {
  static constexpr bool in_rows = std::is_same_v<Access, RowAccess>;
  const std::uint32_t* at;
  std::size_t first, stride;

  PLUMB_INLINE EndLanes(const EndView<T>& view, Position here)
      : PushLanes<T>{view.fields + here.v * end_fields::count * logical_width<T> + here.first},
        at(view.at + (in_rows ? here.v : here.v * logical_width<T> + here.first)),
        first(here.first),
        stride(view.component_stride) {}

  PLUMB_INLINE Triple<T> load_places(const T* data) const {
    if constexpr (in_rows) return Access::load(data + *at + first, stride);
    return RecordAccess::load(data, at);
  }
  PLUMB_INLINE void store_places(const Triple<T>& value, T* data) const {
    if constexpr (in_rows)
      Access::store(value, data + *at + first, stride);
    else
      Access::store(value, data, at);
  }
};

template <class T>
PLUMB_INLINE Triple<T> triple(const T* three) {
  return {Batch<T>(three[0]), Batch<T>(three[1]), Batch<T>(three[2])};
}

/// Visits the ends of a machine vector. Returns what its push changes, in kg m.
template <class Access, class T>
PLUMB_INLINE Triple<T> visit_ends(const EndView<T>& view, const EndLanes<Access, T>& ends) {
  const Triple<T> p = ends.load_places(view.p), by = set_push<T>(ends, p);
  ends.store_places(p + ends.load(end_fields::moves) * by, view.p);
  return by;
}

template <class Access, class T>
void sweep_ends(const EndView<T>& shared, const std::uint32_t* vectors, std::uint32_t count) {
  const EndView<T> view = shared;  // stores through its pointers cannot change a copy
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < parts<T>; ++k)
      visit_ends(view, EndLanes<Access, T>(view, position<T>(vectors[i], k)));
}

template <class Access, class T>
T measure_ends(const EndView<T>& view, const std::uint32_t* vectors, std::uint32_t count) {
  Batch<T> largest(T(0));
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < parts<T>; ++k) {
      const EndLanes<Access, T> ends(view, position<T>(vectors[i], k));
      const Triple<T> by = visit_ends(view, ends);
      largest = lanes::max(ends.load(end_fields::moves) * lanes::sqrt(dot(by, by)), largest);
    }
  return largest_lane(largest);
}

template <class Access, class T>
void start_ends(const EndView<T>& view, const std::uint32_t* vectors, std::uint32_t count) {
  namespace f = end_fields;
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < parts<T>; ++k) {
      const EndLanes<Access, T> ends(view, position<T>(vectors[i], k));
      const Triple<T> p = ends.load_places(view.p);
      ends.store_places(p + ends.load(f::moves) * ends.load3(f::push), view.p);
    }
}

/// Finds the gaps between ends and ground, and the normals there. Returns the gaps.
template <class T>
PLUMB_INLINE Batch<T> gap_of_ends(const EndGround<T>& ground, const Triple<T>& x, const Batch<T>& radius,
                                  Triple<T>& normal) {
  const Triple<T> place = triple(ground.place);
  const Batch<T> far(ground.far);
  if (ground.is_plane) {
    normal = place;
    return (dot(place, x) - far) - radius;
  }
  const Triple<T> along = triple(ground.along);
  const Batch<T> t = lanes::min(lanes::max(Batch<T>(ground.inverse) * dot(x - place, along), Batch<T>(T(0))),
                                Batch<T>(T(1)));
  const Triple<T> apart = x - (place + t * along);
  const Batch<T> distance = lanes::sqrt(dot(apart, apart));
  normal = (Batch<T>(T(1)) / lanes::max(distance, Batch<T>(least_distance<T>))) * apart;
  return (distance - far) - radius;
}

template <class Access, class T>
PLUMB_INLINE bool find_vector_of_ends(const EndView<T>& view, const EndLanes<Access, T>& ends,
                                      const EndGround<T>& ground, const EndRules<T>& rules) {
  namespace f = end_fields;
  const Batch<T> zero(T(0)), margin(rules.margin), radius = ends.load(f::radius), mass = ends.load(f::mass);
  Triple<T> n;
  const Batch<T> gap = gap_of_ends(ground, ends.load_places(view.x), radius, n);
  const Triple<T> p = ends.load_places(view.p);
  const Batch<T> moves = lanes::sqrt(dot(p, p)), least = margin + Batch<T>(rules.passes) * radius;
  auto comes = (gap + dot(n, p) <= margin + Batch<T>(rules.spread) * moves) && (mass > zero);
  if (!ground.is_plane) comes = comes && ((moves <= least) || (gap <= least));
  const Triple<T> force = ends.load3(f::force);
  const Batch<T> square(rules.square);
  const Batch<T> held = lanes::select(comes && (dot(force, n) > zero), square, zero);
  const Batch<T> back = lanes::min(Batch<T>(rules.share) * (gap + Batch<T>(rules.slop)), zero);
  ends.store3(n, f::normal);
  ends.store(lanes::select(gap >= zero, gap, back), f::gap);
  ends.store3(held * force, f::push);
  ends.store(lanes::select(comes, mass, zero), f::over);
  return lanes::any(comes);
}

template <class Access, class T>
void find_ends(const EndView<T>& view, Range range, const EndGround<T>& ground, const EndRules<T>& rules,
               std::uint8_t* touched) {
  for (std::uint32_t v = range.begin; v < range.end; ++v) {
    bool any = false;
    for (std::size_t k = 0; k < parts<T>; ++k)
      any |= find_vector_of_ends(view, EndLanes<Access, T>(view, position<T>(v, k)), ground, rules);
    touched[v] = any ? 1 : 0;
  }
}

template <class Access, class T>
bool watch_ends(const EndView<T>& view, Range range, T most, std::uint8_t* touched) {
  namespace f = end_fields;
  bool any = false;
  for (std::uint32_t v = range.begin; v < range.end; ++v)
    for (std::size_t k = 0; k < parts<T>; ++k) {
      const EndLanes<Access, T> ends(view, position<T>(v, k));
      const Batch<T> zero(T(0)), over = ends.load(f::over), mass = ends.load(f::mass);
      const Triple<T> p = ends.load_places(view.p);
      const auto goes = (ends.load(f::gap) + dot(ends.load3(f::normal), p) < Batch<T>(-most)) &&
                        (over == zero) && (mass > zero);
      if (!lanes::any(goes)) continue;
      ends.store(lanes::select(goes, mass, over), f::over);
      touched[v] = 1;
      any = true;
    }
  return any;
}

template <class Access, class T>
void keep_ends(const EndView<T>& view, Range range, T over) {
  namespace f = end_fields;
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const EndLanes<Access, T> ends(view, position<T>(range.begin, i));
    ends.store3(Batch<T>(over) * ends.load3(f::push), f::force);
  }
}

template <class Access, class T>
constexpr EndKernels<T> end_kernels = {find_ends<Access, T>,  watch_ends<Access, T>,   start_ends<Access, T>,
                                       sweep_ends<Access, T>, measure_ends<Access, T>, keep_ends<Access, T>};

}  // namespace
}  // namespace plumb::simd
