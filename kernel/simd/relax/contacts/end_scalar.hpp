// Visits of ends that ground may hold, one at a time, written for reading: the oracle of end_lanes.hpp.
// Everything has internal linkage.

#pragma once

#include <cmath>

#include "simd/relax/contacts/least_distance.hpp"
#include "simd/relax/contacts/push_scalar.hpp"
#include "simd/relax/scalar_access.hpp"

namespace plumb::simd {
namespace {

/// One end, and its fields.
template <AccessKind access, class T>
struct OneEnd : OnePush<T> {
  std::uint32_t at, stride;

  OneEnd(const EndView<T>& view, std::uint32_t v, std::uint32_t lane)
      : OnePush<T>{view.fields + std::size_t{v} * end_fields::count * logical_width<T> + lane},
        at(address<access, T>(view.at, v, lane)),
        stride(view.component_stride) {}
};

/// Visits an end, which is a particle. Returns what its push changes, in kg m.
template <AccessKind access, class T>
Triple<T> visit_end(const EndView<T>& view, const OneEnd<access, T>& end) {
  const Triple<T> p = load<T>(view.p, end.at, end.stride), by = set_push(end, p);
  add_to_place(view.p + end.at, end.stride, p, end(end_fields::moves), by);
  return by;
}

template <AccessKind access, class T>
void sweep_ends(const EndView<T>& view, const std::uint32_t* vectors, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane)
      visit_end(view, OneEnd<access, T>(view, vectors[i], lane));
}

template <AccessKind access, class T>
T measure_ends(const EndView<T>& view, const std::uint32_t* vectors, std::uint32_t count) {
  T largest = 0;
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const OneEnd<access, T> end(view, vectors[i], lane);
      const Triple<T> by = visit_end(view, end);
      const T moved = end(end_fields::moves) * std::sqrt(dot(by, by));
      largest = moved > largest ? moved : largest;
    }
  return largest;
}

template <AccessKind access, class T>
void start_ends(const EndView<T>& view, const std::uint32_t* vectors, std::uint32_t count) {
  namespace f = end_fields;
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const OneEnd<access, T> end(view, vectors[i], lane);
      add_to_place(view.p + end.at, end.stride, load<T>(view.p, end.at, end.stride), end(f::moves),
                   end.load3(f::push));
    }
}

/// Finds the gap between an end and ground, and the normal there.
template <class T>
T gap_of_end(const EndGround<T>& ground, const Triple<T>& x, T radius, Triple<T>& normal) {
  const Triple<T> place{ground.place[0], ground.place[1], ground.place[2]};
  if (ground.is_plane) {
    normal = place;
    return (dot(place, x) - ground.far) - radius;
  }
  const Triple<T> along{ground.along[0], ground.along[1], ground.along[2]};
  const T at = ground.inverse * dot(Triple<T>{x.x - place.x, x.y - place.y, x.z - place.z}, along);
  const T above = at > 0 ? at : T(0), t = above < 1 ? above : T(1);
  const Triple<T> apart{x.x - (place.x + t * along.x), x.y - (place.y + t * along.y),
                        x.z - (place.z + t * along.z)};
  const T distance = std::sqrt(dot(apart, apart));
  const T over = T(1) / (distance > least_distance<T> ? distance : least_distance<T>);
  normal = {over * apart.x, over * apart.y, over * apart.z};
  return (distance - ground.far) - radius;
}

/// Finds whether an end touches. It does if it is about to come near where others do not push it. What held
/// it in the last substep does so again, unless it would pull along the new normal.
template <AccessKind access, class T>
bool find_end(const EndView<T>& view, const OneEnd<access, T>& end, const EndGround<T>& ground,
              const EndRules<T>& rules) {
  namespace f = end_fields;
  Triple<T> n;
  const T radius = end(f::radius), gap = gap_of_end(ground, load<T>(view.x, end.at, end.stride), radius, n);
  const Triple<T> p = load<T>(view.p, end.at, end.stride);
  const T moves = std::sqrt(dot(p, p)), least = rules.margin + rules.passes * radius;
  bool comes = gap + dot(n, p) <= rules.margin + rules.spread * moves && end(f::mass) > 0;
  // What is round is left on the other side of a tangent plane soon.
  if (!ground.is_plane) comes = comes && (moves <= least || gap <= least);
  const Triple<T> force = end.load3(f::force);
  const T held = comes && dot(force, n) > 0 ? rules.square : T(0);
  const T beyond = rules.share * (gap + rules.slop), back = beyond < 0 ? beyond : T(0);
  end.store3(n, f::normal);
  end(f::gap) = gap >= 0 ? gap : back;
  end.store3({held * force.x, held * force.y, held * force.z}, f::push);
  end(f::over) = comes ? end(f::mass) : T(0);
  return comes;
}

template <AccessKind access, class T>
void find_ends(const EndView<T>& view, Range range, const EndGround<T>& ground, const EndRules<T>& rules,
               std::uint8_t* touched) {
  for (std::uint32_t v = range.begin; v < range.end; ++v) {
    touched[v] = 0;
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane)
      if (find_end(view, OneEnd<access, T>(view, v, lane), ground, rules)) touched[v] = 1;
  }
}

template <AccessKind access, class T>
bool watch_ends(const EndView<T>& view, Range range, T most, std::uint8_t* touched) {
  namespace f = end_fields;
  bool any = false;
  for (std::uint32_t v = range.begin; v < range.end; ++v)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const OneEnd<access, T> end(view, v, lane);
      const T deep = end(f::gap) + dot(end.load3(f::normal), load<T>(view.p, end.at, end.stride));
      if (!(deep < -most && end(f::over) == 0 && end(f::mass) > 0)) continue;
      end(f::over) = end(f::mass);
      touched[v] = 1;
      any = true;
    }
  return any;
}

template <AccessKind access, class T>
void keep_ends(const EndView<T>& view, Range range, T over) {
  namespace f = end_fields;
  for (std::uint32_t v = range.begin; v < range.end; ++v)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const OneEnd<access, T> end(view, v, lane);
      const Triple<T> push = end.load3(f::push);
      end.store3({over * push.x, over * push.y, over * push.z}, f::force);
    }
}

template <AccessKind access, class T>
constexpr EndKernels<T> end_kernels = {find_ends<access, T>,  watch_ends<access, T>,   start_ends<access, T>,
                                       sweep_ends<access, T>, measure_ends<access, T>, keep_ends<access, T>};

}  // namespace
}  // namespace plumb::simd
