// Visits of contacts of lines, in vectors of lanes. line_contact_scalar.hpp says what is computed and why;
// the operations and their order are the same here. relax_lanes.hpp includes it, and it has internal linkage
// as that has.

#pragma once

#include "simd/relax/contacts/least_distance.hpp"
#include "simd/relax/contacts/push_lanes.hpp"
#include "simd/relax/contacts/term_lanes.hpp"

namespace plumb::simd {
namespace {

/// What the ends of two lines have, each as all components of lanes (Triple) or of one (Record).
template <class Vector>
struct FourEnds {
  Vector p1, q1, p2, q2;
};

/// Returns how far places on two lines have moved against each other.
template <class Vector, class Share>
PLUMB_INLINE Vector moved_between(const FourEnds<Vector>& d, const Share& a, const Share& b) {
  return ((d.p1 - d.p2) + a * (d.q1 - d.p1)) - b * (d.q2 - d.p2);
}

/// Contacts of one machine vector. If all ends are `alike`, their masses are not among the fields.
template <bool alike, class Access, class T>
struct LineContactLanes : PushLanes<T> {
  static constexpr std::uint32_t ends = line_contact_fields::ends, step = logical_width<T>;
  static constexpr std::size_t count =
      alike ? line_contact_fields::count_if_alike : line_contact_fields::count;
  T* p;
  TermLanes<Access, T> terms;
  Batch<T> all_over_mass;

  PLUMB_INLINE LineContactLanes(const LineContactView<T>& view, Position here)
      : PushLanes<T>{view.fields + here.v * count * step + here.first},
        p(view.p),
        terms{view.at + here.v * ends * step + here.first, view.component_stride},
        all_over_mass(view.over_mass) {}

  PLUMB_INLINE Batch<T> over_mass(std::uint32_t end) const {
    return this->load(line_contact_fields::over_mass + end);
  }
  PLUMB_INLINE FourEnds<Triple<T>> load_ends() const {
    return {terms.load(p, 0), terms.load(p, 1), terms.load(p, 2), terms.load(p, 3)};
  }
  PLUMB_INLINE Triple<T> scaled(const Triple<T>& push) const {
    if constexpr (alike)
      return all_over_mass * push;
    else
      return push;
  }
  PLUMB_INLINE Triple<T> share(std::uint32_t end, const Triple<T>& own) const {
    if constexpr (alike)
      return own;
    else
      return over_mass(end) * own;
  }

  // The same, record by record.
  PLUMB_INLINE T number(std::uint32_t field, std::uint32_t lane) const {
    return this->fields[field * step + lane];
  }
  PLUMB_INLINE T* place(std::uint32_t end, std::uint32_t lane) const { return p + terms.place(end, lane); }
  PLUMB_INLINE FourEnds<Record<T>> load_ends(std::uint32_t lane) const {
    return {load_record(place(0, lane)), load_record(place(1, lane)), load_record(place(2, lane)),
            load_record(place(3, lane))};
  }
  PLUMB_INLINE Record<T> share(std::uint32_t end, std::uint32_t lane, const Record<T>& own) const {
    if constexpr (alike)
      return own;
    else
      return number(line_contact_fields::over_mass + end, lane) * own;
  }

  /// Returns how far places have moved against each other.
  PLUMB_INLINE Triple<T> moved() const {
    namespace f = line_contact_fields;
    if constexpr (sums_records<Access, T>) {
      Record<T> sums[width<T>];
      for (std::uint32_t lane = 0; lane < width<T>; ++lane)
        sums[lane] = moved_between(load_ends(lane), number(f::a, lane), number(f::b, lane));
      Columns<T, width<T>> columns;
      to_columns(sums, columns);
      return {Batch<T>(columns.x), Batch<T>(columns.y), Batch<T>(columns.z)};
    } else {
      return moved_between(load_ends(), this->load(f::a), this->load(f::b));
    }
  }
  /// Moves ends as pushes do.
  PLUMB_INLINE void add(const Triple<T>& push) const {
    const Triple<T> by = scaled(push);
    if constexpr (sums_records<Access, T>) {
      Record<T> records[width<T>];
      to_records(Columns<T, width<T>>{by.x.data, by.y.data, by.z.data}, records);
      for (std::uint32_t lane = 0; lane < width<T>; ++lane) add(lane, records[lane]);
    } else {
      const FourEnds<Triple<T>> from = load_ends();
      const Triple<T> on_a = this->load(line_contact_fields::a) * by,
                      on_b = this->load(line_contact_fields::b) * by;
      terms.store(from.p1 + share(0, by - on_a), p, 0);
      terms.store(from.q1 + share(1, on_a), p, 1);
      terms.store(from.p2 - share(2, by - on_b), p, 2);
      terms.store(from.q2 - share(3, on_b), p, 3);
    }
  }
  PLUMB_INLINE void add(std::uint32_t lane, const Record<T>& by) const {
    const FourEnds<Record<T>> from = load_ends(lane);
    const Record<T> on_a = number(line_contact_fields::a, lane) * by,
                    on_b = number(line_contact_fields::b, lane) * by;
    store_record(from.p1 + share(0, lane, by - on_a), place(0, lane));
    store_record(from.q1 + share(1, lane, on_a), place(1, lane));
    store_record(from.p2 - share(2, lane, by - on_b), place(2, lane));
    store_record(from.q2 - share(3, lane, on_b), place(3, lane));
  }
};

/// A visit is a long chain of operations. So many machine vectors of a range go through it side by side.
constexpr std::uint32_t side_by_side = 4;

/// Visits contacts of `n` machine vectors from the k-th of a range on, and calls visited(contacts, by) for
/// each.
template <std::uint32_t n, class Contacts, class T, class Visited>
PLUMB_INLINE void visit_line_contacts(const LineContactView<T>& view, std::size_t begin, std::size_t k,
                                      Visited&& visited) {
  Triple<T> by[n];
  for (std::uint32_t i = 0; i < n; ++i) by[i] = Contacts(view, position<T>(begin, k + i)).moved();
  for (std::uint32_t i = 0; i < n; ++i) by[i] = set_push<T>(Contacts(view, position<T>(begin, k + i)), by[i]);
  for (std::uint32_t i = 0; i < n; ++i) {
    const Contacts contacts(view, position<T>(begin, k + i));
    contacts.add(by[i]);
    visited(contacts, by[i]);
  }
}

template <class Contacts, class T, class Visited>
PLUMB_INLINE void visit_line_ranges(const LineContactView<T>& view, const ContactRange* ranges,
                                    std::uint32_t count, Visited&& visited) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t begin = ranges[i].begin, end = (ranges[i].end - begin) * parts<T>;
    std::size_t k = 0;
    for (; k + side_by_side <= end; k += side_by_side)
      visit_line_contacts<side_by_side, Contacts>(view, begin, k, visited);
    for (; k < end; ++k) visit_line_contacts<1, Contacts>(view, begin, k, visited);
  }
}

template <class Access, class T, class Visited>
PLUMB_INLINE void visit_all_line_contacts(const LineContactView<T>& shared, const ContactRange* ranges,
                                          std::uint32_t count, Visited&& visited) {
  const LineContactView<T> view = shared;  // stores through its pointers cannot change a copy
  if (view.over_mass > 0)
    visit_line_ranges<LineContactLanes<true, Access, T>>(view, ranges, count, visited);
  else
    visit_line_ranges<LineContactLanes<false, Access, T>>(view, ranges, count, visited);
}

template <class Access, class T>
void sweep_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  visit_all_line_contacts<Access>(view, ranges, count, [](const auto&, const Triple<T>&) {});
}

template <class Access, class T>
T measure_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  Batch<T> largest(T(0));
  const auto see = [&](const auto& contacts, const Triple<T>& by) __attribute__((always_inline)) {
    const Batch<T> over = lanes::max(contacts.load(line_contact_fields::over), Batch<T>(least_over<T>));
    largest = lanes::max(lanes::sqrt(dot(by, by)) / over, largest);
  };
  visit_all_line_contacts<Access>(view, ranges, count, see);
  return largest_lane(largest);
}

template <bool alike, class Access, class T>
PLUMB_INLINE void start_line_ranges(const LineContactView<T>& view, const ContactRange* ranges,
                                    std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < (ranges[i].end - ranges[i].begin) * parts<T>; ++k) {
      const LineContactLanes<alike, Access, T> contacts(view, position<T>(ranges[i].begin, k));
      contacts.add(contacts.load3(line_contact_fields::push));
    }
}

template <class Access, class T>
void start_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  if (view.over_mass > 0)
    start_line_ranges<true, Access>(view, ranges, count);
  else
    start_line_ranges<false, Access>(view, ranges, count);
}

template <class Access, class T>
constexpr LineContactKernels<T> line_contact_kernels = {
    start_line_contacts<Access, T>, sweep_line_contacts<Access, T>, measure_line_contacts<Access, T>};

}  // namespace
}  // namespace plumb::simd
