// Visits of contacts between places, in vectors of lanes. contact_scalar.hpp says what is computed and why;
// the operations and their order are the same here. relax_lanes.hpp includes it, and it has internal linkage
// as that has.

#pragma once

#include "simd/relax/contacts/push_lanes.hpp"

namespace plumb::simd {
namespace {

/// Contacts of one machine vector.
template <class Access, class T>
struct ContactLanes : PushLanes<T> {
  const std::uint32_t* at;
  std::size_t stride;

  PLUMB_INLINE ContactLanes(const ContactView<T>& view, Position here)
      : PushLanes<T>{view.fields + here.v * contact_fields::count * logical_width<T> + here.first},
        at(view.at + here.v * contact_fields::most_terms * logical_width<T> + here.first),
        stride(view.component_stride) {}

  PLUMB_INLINE Triple<T> load_term(const T* data, std::uint32_t term) const {
    if constexpr (std::is_same_v<Access, RecordAccess>)
      return Access::load(data, at + term * logical_width<T>);
    else
      return Access::load(data, at + term * logical_width<T>, stride);
  }
  PLUMB_INLINE void store_term(const Triple<T>& value, T* data, std::uint32_t term) const {
    if constexpr (std::is_same_v<Access, RecordAccess>)
      Access::store(value, data, at + term * logical_width<T>);
    else
      Access::store(value, data, at + term * logical_width<T>, stride);
  }

  /// Returns the sums of terms, made record by record.
  template <std::uint32_t terms>
  PLUMB_INLINE Triple<T> sum_records(const T* data) const {
    Record<T> sums[width<T>];
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      sums[lane] = Record<T>{};
      for (std::uint32_t k = 0; k < terms; ++k)
        sums[lane] += number(contact_fields::weight + k, lane) * load_record(data + place(k, lane));
    }
    Columns<T, width<T>> columns;
    to_columns(sums, columns);
    return {Batch<T>(columns.x), Batch<T>(columns.y), Batch<T>(columns.z)};
  }
  /// Moves the terms by their shares of `by`, kg m. A place that two terms share is written last by the one
  /// that has a weight.
  template <std::uint32_t terms>
  PLUMB_INLINE void move_records(const Triple<T>& by, T* data) const {
    Record<T> records[width<T>];
    to_records(Columns<T, width<T>>{by.x.data, by.y.data, by.z.data}, records);
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      Record<T> p[terms];
      for (std::uint32_t k = 0; k < terms; ++k) p[k] = load_record(data + place(k, lane));
      for (std::uint32_t k = 0; k < terms; ++k)
        store_record(p[k] + number(contact_fields::move + k, lane) * records[lane], data + place(k, lane));
    }
  }
  PLUMB_INLINE T number(std::uint32_t field, std::uint32_t lane) const {
    return this->fields[field * logical_width<T> + lane];
  }
  PLUMB_INLINE std::uint32_t place(std::uint32_t term, std::uint32_t lane) const {
    return at[term * logical_width<T> + lane];
  }
};

/// Says whether terms are summed up record by record, and sums alone are transposed. Where a record of
/// doubles fills a register that takes a fifth off a visit. Where two do, whole terms are transposed as fast.
template <class Access, class T>
constexpr bool sums_records =
    std::is_same_v<Access, RecordAccess>&& std::is_same_v<T, double>&& width<T> == 4;

/// Visits the contacts of a machine vector. Returns what pushes change, in kg m.
template <std::uint32_t terms, class Access, class T>
PLUMB_INLINE Triple<T> visit_contacts(const ContactView<T>& view, const ContactLanes<Access, T>& contacts) {
  namespace f = contact_fields;
  if constexpr (sums_records<Access, T>) {
    const Triple<T> moved = contacts.template sum_records<terms>(view.p);
    const Triple<T> by = set_pushes<T>(contacts, moved - contacts.load3(f::carried));
    contacts.template move_records<terms>(by, view.p);
    return by;
  } else {
    const Batch<T> zero(T(0));
    Triple<T> p[terms], moved{zero, zero, zero};
    for (std::uint32_t k = 0; k < terms; ++k) {
      p[k] = contacts.load_term(view.p, k);
      moved = moved + contacts.load(f::weight + k) * p[k];
    }
    const Triple<T> by = set_pushes<T>(contacts, moved - contacts.load3(f::carried));
    for (std::uint32_t k = 0; k < terms; ++k)
      contacts.store_term(p[k] + contacts.load(f::move + k) * by, view.p, k);
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
