// Visits of contacts between places, one at a time, written for reading: the oracle of contact_lanes.hpp.
// Everything has internal linkage.

#pragma once

#include <cmath>

#include "simd/relax/scalar_access.hpp"

namespace plumb::simd {
namespace {

/// Visits a contact. The push along the normal closes the gap that is left, but never pulls. The push across
/// it takes back what slides, as long as it is no larger than friction times the other (Coulomb). All masses
/// are points, so that a push moves a place alike in all directions. Returns what both change, in kg m.
template <std::uint32_t terms, class T>
Triple<T> visit_contact(const ContactView<T>& view, std::size_t v, std::uint32_t lane) {
  namespace f = contact_fields;
  constexpr std::uint32_t width = logical_width<T>;
  T* const fields = view.fields + v * f::count * width + lane;
  const auto field = [&](std::uint32_t k) -> T& { return fields[k * width]; };
  const auto field3 = [&](std::uint32_t k) { return Triple<T>{field(k), field(k + 1), field(k + 2)}; };
  const std::uint32_t* const at = view.at + v * f::most_terms * width + lane;
  Triple<T> p[terms], moved{};
  for (std::uint32_t k = 0; k < terms; ++k) {
    p[k] = load<T>(view.p, at[k * width], view.component_stride);
    const T weight = field(f::weight + k);
    moved = {moved.x + weight * p[k].x, moved.y + weight * p[k].y, moved.z + weight * p[k].z};
  }
  const Triple<T> n = field3(f::normal), before = field3(f::across), carried = field3(f::carried);
  moved = {moved.x - carried.x, moved.y - carried.y, moved.z - carried.z};
  const T along = dot(n, moved), over = field(f::over), push_before = field(f::push);
  const T left = push_before - over * (field(f::gap) + along);
  const T push = left > 0 ? left : T(0);
  Triple<T> across{before.x - over * (moved.x - along * n.x), before.y - over * (moved.y - along * n.y),
                   before.z - over * (moved.z - along * n.z)};
  // What the normal has turned by since the push was kept would pull along it.
  const T along_normal = dot(across, n);
  across = {across.x - along_normal * n.x, across.y - along_normal * n.y, across.z - along_normal * n.z};
  const T bound = field(f::friction) * push, square = dot(across, across);
  if (square > bound * bound) {
    const T share = bound > 0 ? bound / std::sqrt(square) : T(0);
    across = {share * across.x, share * across.y, share * across.z};
  }
  const T more = push - push_before;
  const Triple<T> by{more * n.x + (across.x - before.x), more * n.y + (across.y - before.y),
                     more * n.z + (across.z - before.z)};
  field(f::push) = push;
  field(f::across) = across.x;
  field(f::across + 1) = across.y;
  field(f::across + 2) = across.z;
  for (std::uint32_t k = 0; k < terms; ++k) {
    T* const to = view.p + at[k * width];
    const T move = field(f::move + k);
    to[0] = p[k].x + move * by.x;
    to[view.component_stride] = p[k].y + move * by.y;
    to[2 * view.component_stride] = p[k].z + move * by.z;
  }
  return by;
}

/// Calls visited(v, lane, by) after every visit.
template <std::uint32_t terms, class T, class Visited>
void visit_contacts(const ContactView<T>& view, const ContactRange& range, Visited&& visited) {
  for (std::size_t v = range.begin; v < range.end; ++v)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane)
      visited(v, lane, visit_contact<terms>(view, v, lane));
}

template <AccessKind, class T>
void sweep_contacts(const ContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  const auto visited = [](std::size_t, std::uint32_t, const Triple<T>&) {};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (ranges[i].terms == 2)
      visit_contacts<2>(view, ranges[i], visited);
    else
      visit_contacts<4>(view, ranges[i], visited);
  }
}

template <AccessKind, class T>
T measure_contacts(const ContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  constexpr std::uint32_t width = logical_width<T>;
  T largest = 0;
  const auto visited = [&](std::size_t v, std::uint32_t lane, const Triple<T>& by) {
    const T moves = view.fields[(v * contact_fields::count + contact_fields::moves) * width + lane];
    const T change = moves * std::sqrt(dot(by, by));
    largest = change > largest ? change : largest;
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (ranges[i].terms == 2)
      visit_contacts<2>(view, ranges[i], visited);
    else
      visit_contacts<4>(view, ranges[i], visited);
  }
  return largest;
}

template <AccessKind access, class T>
constexpr ContactKernels<T> contact_kernels = {sweep_contacts<access, T>, measure_contacts<access, T>};

}  // namespace
}  // namespace plumb::simd
