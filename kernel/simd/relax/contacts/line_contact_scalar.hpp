// Visits of contacts of lines, one at a time, written for reading: the oracle of line_contact_lanes.hpp.
// Everything has internal linkage.

#pragma once

#include <cmath>

#include "simd/relax/contacts/least_distance.hpp"
#include "simd/relax/contacts/push_scalar.hpp"

namespace plumb::simd {
namespace {

/// One contact between the places a and b, from 0 to 1, on two lines.
template <class T>
struct OneLineContact : OnePush<T> {
  static constexpr std::uint32_t ends = line_contact_fields::ends;
  const LineContactView<T>& view;
  const std::uint32_t* at;
  bool alike;
  T a, b;

  OneLineContact(const LineContactView<T>& of, std::size_t v, std::uint32_t lane)
      : OnePush<T>{of.fields + v * fields_of(of) * logical_width<T> + lane},
        view(of),
        at(of.at + v * ends * logical_width<T> + lane),
        alike(of.over_mass > 0),
        a((*this)(line_contact_fields::a)),
        b((*this)(line_contact_fields::b)) {}
  static std::size_t fields_of(const LineContactView<T>& of) {
    return of.over_mass > 0 ? line_contact_fields::count_if_alike : line_contact_fields::count;
  }

  T over_mass(std::uint32_t end) const { return (*this)(line_contact_fields::over_mass + end); }
  Triple<T> moved(std::uint32_t end) const {
    return load<T>(view.p, at[end * logical_width<T>], view.component_stride);
  }
  /// Returns how far both places have moved against each other. A place moves as its line's first end does,
  /// and by a share of what the second one goes farther.
  Triple<T> moved() const {
    const auto sum = [&](T p1, T q1, T p2, T q2) { return ((p1 - p2) + a * (q1 - p1)) - b * (q2 - p2); };
    const Triple<T> p1 = moved(0), q1 = moved(1), p2 = moved(2), q2 = moved(3);
    return {sum(p1.x, q1.x, p2.x, q2.x), sum(p1.y, q1.y, p2.y, q2.y), sum(p1.z, q1.z, p2.z, q2.z)};
  }
  /// Moves the ends as a push does, which acts on each by its share.
  void add(const Triple<T>& push) const {
    const T all = alike ? view.over_mass : T(1);
    const Triple<T> by{all * push.x, all * push.y, all * push.z};
    const auto share = [&](std::uint32_t end, T of) {
      const T on_second = (end < 2 ? a : b) * of, own = end % 2 == 1 ? on_second : of - on_second;
      return alike ? own : over_mass(end) * own;
    };
    for (std::uint32_t end = 0; end < ends; ++end)
      add_to_place(view.p + at[end * logical_width<T>], view.component_stride, moved(end),
                   T(end < 2 ? 1 : -1), {share(end, by.x), share(end, by.y), share(end, by.z)});
  }
  /// Visits it. Returns what its push changes, in kg m.
  Triple<T> visit() const {
    const Triple<T> by = set_push(*this, moved());
    add(by);
    return by;
  }
};

/// Calls f(contact) for all contacts, in their order.
template <class T, class F>
void for_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count,
                       F&& f) {
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::size_t v = ranges[i].begin; v < ranges[i].end; ++v)
      for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) f(OneLineContact<T>(view, v, lane));
}

template <class T>
void start_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  for_line_contacts(view, ranges, count, [](const OneLineContact<T>& contact) {
    contact.add(contact.load3(line_contact_fields::push));
  });
}

template <class T>
void sweep_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  for_line_contacts(view, ranges, count, [](const OneLineContact<T>& contact) { contact.visit(); });
}

template <class T>
T measure_line_contacts(const LineContactView<T>& view, const ContactRange* ranges, std::uint32_t count) {
  T largest = 0;
  for_line_contacts(view, ranges, count, [&](const OneLineContact<T>& contact) {
    const Triple<T> by = contact.visit();
    const T over = contact(line_contact_fields::over);
    const T change = std::sqrt(dot(by, by)) / (over > least_over<T> ? over : least_over<T>);
    largest = change > largest ? change : largest;
  });
  return largest;
}

template <class T>
constexpr LineContactKernels<T> line_contact_kernels = {start_line_contacts<T>, sweep_line_contacts<T>,
                                                        measure_line_contacts<T>};

}  // namespace
}  // namespace plumb::simd
