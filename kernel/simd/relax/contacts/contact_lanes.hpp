// Visits of contacts between places, in vectors of lanes. contact_scalar.hpp says what is computed and why;
// the operations and their order are the same here. relax_lanes.hpp includes it, and it has internal linkage
// as that has.

#pragma once

#include "simd/relax/contacts/push_lanes.hpp"
#include "simd/relax/contacts/term_lanes.hpp"

namespace plumb::simd {
namespace {

/// Contacts of one machine vector.
template <class Access, class T>
struct ContactLanes : PushLanes<T> {
  TermLanes<Access, T> terms;

  PLUMB_INLINE ContactLanes(const ContactView<T>& view, Position here)
      : PushLanes<T>{view.fields + here.v * contact_fields::count * logical_width<T> + here.first},
        terms{view.at + here.v * contact_fields::most_terms * logical_width<T> + here.first,
              view.component_stride} {}

  PLUMB_INLINE const T* numbers(std::uint32_t field) const { return this->fields + field * logical_width<T>; }
};

/// Visits the contacts of a machine vector. Returns what its push changes, in kg m.
template <std::uint32_t terms, class Access, class T>
PLUMB_INLINE Triple<T> visit_contacts(const ContactView<T>& view, const ContactLanes<Access, T>& contacts) {
  namespace f = contact_fields;
  if constexpr (sums_records<Access, T>) {
    constexpr std::uint32_t step = logical_width<T>;
    const Triple<T> moved =
        contacts.terms.template sum_records<terms, step>(contacts.numbers(f::weight), view.p);
    const Triple<T> by = set_push<T>(contacts, moved - contacts.load3(f::carried));
    contacts.terms.template move_records<terms, step>(contacts.numbers(f::move), by, view.p);
    return by;
  } else {
    const Batch<T> zero(T(0));
    Triple<T> p[terms], moved{zero, zero, zero};
    for (std::uint32_t k = 0; k < terms; ++k) {
      p[k] = contacts.terms.load(view.p, k);
      moved = moved + contacts.load(f::weight + k) * p[k];
    }
    const Triple<T> by = set_push<T>(contacts, moved - contacts.load3(f::carried));
    for (std::uint32_t k = 0; k < terms; ++k)
      contacts.terms.store(p[k] + contacts.load(f::move + k) * by, view.p, k);
    return by;
  }
}

/// Calls visited(contacts, by) after the visits of every machine vector.
template <std::uint32_t terms, class Access, class T, class Visited>
PLUMB_INLINE void visit_range(const ContactView<T>& view, const ContactRange& range, Visited&& visited) {
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const ContactLanes<Access, T> contacts(view, position<T>(range.begin, i));
    visited(contacts, visit_contacts<terms>(view, contacts));
  }
}

template <class Access, class T>
void sweep_contacts(const ContactView<T>& shared, const ContactRange* ranges, std::uint32_t count) {
  const ContactView<T> view = shared;  // stores through its pointers cannot change a copy
  const auto visited = [](const ContactLanes<Access, T>&, const Triple<T>&) {};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (ranges[i].terms == 2)
      visit_range<2, Access>(view, ranges[i], visited);
    else
      visit_range<4, Access>(view, ranges[i], visited);
  }
}

template <class Access, class T>
T measure_contacts(const ContactView<T>& shared, const ContactRange* ranges, std::uint32_t count) {
  const ContactView<T> view = shared;
  Batch<T> largest(T(0));
  const auto visited = [&](const ContactLanes<Access, T>& contacts, const Triple<T>& by) {
    largest = lanes::max(contacts.load(contact_fields::moves) * lanes::sqrt(dot(by, by)), largest);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (ranges[i].terms == 2)
      visit_range<2, Access>(view, ranges[i], visited);
    else
      visit_range<4, Access>(view, ranges[i], visited);
  }
  return largest_lane(largest);
}

template <class Access, class T>
constexpr ContactKernels<T> contact_kernels = {sweep_contacts<Access, T>, measure_contacts<Access, T>};

}  // namespace
}  // namespace plumb::simd
