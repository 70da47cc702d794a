// Visits of contacts between places, one at a time, written for reading: the oracle of contact_lanes.hpp.
// Everything has internal linkage.

#pragma once

#include <cmath>

#include "simd/relax/contacts/push_scalar.hpp"

namespace plumb::simd {
namespace {

/// Visits a contact, whose place is a sum of particles. Returns what its push changes, in kg m.
template <std::uint32_t terms, class T>
Triple<T> visit_contact(const ContactView<T>& view, std::size_t v, std::uint32_t lane) {
  namespace f = contact_fields;
  constexpr std::uint32_t width = logical_width<T>;
  const OnePush<T> contact{view.fields + v * f::count * width + lane};
  const std::uint32_t* const at = view.at + v * f::most_terms * width + lane;
  Triple<T> p[terms], moved{};
  for (std::uint32_t k = 0; k < terms; ++k) {
    p[k] = load<T>(view.p, at[k * width], view.component_stride);
    const T weight = contact(f::weight + k);
    moved = {moved.x + weight * p[k].x, moved.y + weight * p[k].y, moved.z + weight * p[k].z};
  }
  const Triple<T> carried = contact.load3(f::carried);
  const Triple<T> by = set_push(contact, {moved.x - carried.x, moved.y - carried.y, moved.z - carried.z});
  for (std::uint32_t k = 0; k < terms; ++k)
    add_to_place(view.p + at[k * width], view.component_stride, p[k], contact(f::move + k), by);
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
