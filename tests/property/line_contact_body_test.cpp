// Visits of contacts of lines: every instruction set has the bits of the scalar body, in records and in rows,
// with masses that differ and with those that do not. A visit keeps momentum and does what Coulomb's law
// says.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "simd/relax/contacts/line_contact_lanes.hpp"
#include "simd/relax/contacts/term_lanes.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using layouts::AlignedBuffer;
using test::Random;
namespace f = line_contact_fields;

/// Contacts of lines between particles that no others move, in two ranges. Places are records, or in rows of
/// one lane width. The last lane of each vector is padding.
template <class T>
struct SomeContacts {
  static constexpr std::uint32_t vectors = 7, lanes = logical_width<T>, count = vectors * lanes;
  static constexpr std::uint32_t particles = count * f::ends;
  bool in_rows, alike;
  AlignedBuffer<T> p, fields{std::size_t{count} * f::count};
  std::vector<T> mass = std::vector<T>(particles, T(0.5));  ///< kg
  std::vector<std::uint32_t> at = std::vector<std::uint32_t>(std::size_t{count} * f::ends), order = at;
  std::vector<ContactRange> ranges{{0, 5, f::ends}, {5, vectors, f::ends}};

  SomeContacts(std::uint64_t seed, bool rows, bool same)
      : in_rows(rows), alike(same), p(4 * (particles + lanes)) {
    Random random(seed);
    const auto unit = [&] { return static_cast<T>(test::signed_unit(random)); };
    std::iota(order.begin(), order.end(), 0u);
    for (std::uint32_t i = particles; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool is_padding = i % lanes == lanes - 1;
      const T a = i % 6 == 0 ? T(i % 4 == 0) : (1 + unit()) / 2, b = (1 + unit()) / 2;
      const T weight[f::ends] = {1 - a, a, 1 - b, b};
      T moves = 0;
      for (std::uint32_t k = 0; k < f::ends; ++k) {
        const std::uint32_t particle = order[f::ends * i + k];
        const std::uint32_t place = number(is_padding ? particles : particle);
        at[(i / lanes * f::ends + k) * lanes + i % lanes] = place;
        for (std::uint32_t c = 0; c < 3; ++c) p[place + c * stride()] = is_padding ? T(0) : T(0.02) * unit();
        if (is_padding) continue;
        if (!alike) mass[particle] = T(1.5) + unit();
        if (!alike) field(i, f::over_mass + k) = 1 / mass[particle];
        moves += weight[k] * weight[k] / mass[particle];
      }
      if (is_padding) continue;
      T n[3] = {unit(), unit(), T(1.5) + unit()};
      const T size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (std::uint32_t c = 0; c < 3; ++c) {
        field(i, f::normal + c) = n[c] / size;
        field(i, f::push + c) = T(i % 4 == 0 ? 0 : 0.02) * n[c] / size + T(i % 4 == 0 ? 0 : 0.01) * unit();
      }
      field(i, f::gap) = T(0.01) * unit();
      field(i, f::over) = 1 / moves;
      field(i, f::friction) = T(i % 5 == 0 ? 0 : 0.4);
      field(i, f::a) = a;
      field(i, f::b) = b;
    }
  }
  std::uint32_t stride() const { return in_rows ? lanes : 1; }
  std::uint32_t number(std::uint32_t particle) const {
    return in_rows ? particle / lanes * 3 * lanes + particle % lanes : 4 * particle;
  }
  T& field(std::uint32_t i, std::uint32_t field) {
    const std::size_t each = alike ? f::count_if_alike : f::count;
    return fields[(i / lanes * each + field) * lanes + i % lanes];
  }
  T moved(std::uint32_t i, std::uint32_t c) {
    const auto of = [&](std::uint32_t k) { return p[number(order[f::ends * i + k]) + c * stride()]; };
    const T a = field(i, f::a), b = field(i, f::b);
    return of(0) + a * (of(1) - of(0)) - of(2) - b * (of(3) - of(2));
  }
  T momentum(std::uint32_t c) const {
    T out = 0;
    for (std::uint32_t i = 0; i < particles; ++i) out += mass[i] * p[number(i) + c * stride()];
    return out;
  }
  LineContactView<T> view() { return {p.data(), fields.data(), at.data(), stride(), alike ? T(2) : T(0)}; }
};

/// Starts, measures a sweep, which solves what no others move, and sweeps again. Returns all numbers, those
/// of places in the order of particles.
template <class T>
std::vector<T> visited(const LineContactKernels<T>& kernels, bool in_rows, bool alike) {
  SomeContacts<T> contacts(7, in_rows, alike);
  const auto count = static_cast<std::uint32_t>(contacts.ranges.size());
  kernels.start(contacts.view(), contacts.ranges.data(), count);
  std::vector<T> out{kernels.measure(contacts.view(), contacts.ranges.data(), count)};
  kernels.sweep(contacts.view(), contacts.ranges.data(), count);
  for (std::uint32_t i = 0; i < SomeContacts<T>::particles; ++i)
    for (std::uint32_t c = 0; c < 3; ++c)
      out.push_back(contacts.p[contacts.number(i) + c * contacts.stride()]);
  out.insert(out.end(), contacts.fields.data(), contacts.fields.data() + contacts.fields.size());
  return out;
}

template <class T>
void expect_scalar_bits(bool alike) {
  const std::vector<T> wanted = visited<T>(kernels<T>(Isa::scalar).line_contacts, false, alike);
  EXPECT_TRUE(std::all_of(wanted.begin(), wanted.end(), [](T each) { return std::isfinite(each); }));
  EXPECT_GT(wanted.front(), T(1e-4)) << "nothing moves";
  EXPECT_EQ(visited<T>(kernels<T>(Isa::scalar).row_line_contacts, true, alike), wanted);
  EXPECT_EQ(visited<T>(line_contact_kernels<RecordAccess, T>, false, alike), wanted);
  EXPECT_EQ(visited<T>(line_contact_kernels<GatherAccess, T>, true, alike), wanted);
  for (const Isa isa : all_isas())
    if (is_supported(isa)) {
      EXPECT_EQ(visited<T>(kernels<T>(isa).line_contacts, false, alike), wanted) << to_string(isa);
      EXPECT_EQ(visited<T>(kernels<T>(isa).row_line_contacts, true, alike), wanted) << to_string(isa);
    }
}

TEST(LineContactBody, HasTheBitsOfTheScalarBodyInRecordsAndRows) {
  for (const bool alike : {false, true}) {
    expect_scalar_bits<float>(alike);
    expect_scalar_bits<double>(alike);
  }
}

// After a visit a contact that is pressed keeps its gap. It holds, or slides with friction times its push.
TEST(LineContactBody, KeepsMomentumAndGapsOpenWithinTheConeOfFriction) {
  for (const bool alike : {false, true}) {
    SomeContacts<double> contacts(3, false, alike);
    std::vector<double> before;
    for (std::uint32_t c = 0; c < 3; ++c) before.push_back(contacts.momentum(c));
    kernels<double>(best_isa()).line_contacts.sweep(contacts.view(), contacts.ranges.data(), 2);
    for (std::uint32_t c = 0; c < 3; ++c)
      EXPECT_NEAR(contacts.momentum(c), before[c], 1e-14) << "224 of 1 kg and centimetres";
    std::uint32_t held = 0, slid = 0, open = 0;
    for (std::uint32_t i = 0; i < SomeContacts<double>::count; ++i) {
      if (contacts.field(i, f::over) == 0) continue;
      double along = 0, push = 0, across2 = 0, slides2 = 0;
      const auto normal = [&](std::uint32_t c) { return contacts.field(i, f::normal + c); };
      for (std::uint32_t c = 0; c < 3; ++c) {
        along += normal(c) * contacts.moved(i, c);
        push += normal(c) * contacts.field(i, f::push + c);
      }
      for (std::uint32_t c = 0; c < 3; ++c) {
        const double across = contacts.field(i, f::push + c) - push * normal(c);
        const double slides = contacts.moved(i, c) - along * normal(c);
        across2 += across * across;
        slides2 += slides * slides;
      }
      // Numbers of some centimetres and kilograms are good to 1e-16.
      if (push == 0) {
        EXPECT_GE(along, -contacts.field(i, f::gap) - 1e-15) << i;
        ++open;
        continue;
      }
      const double bound = contacts.field(i, f::friction) * push;
      EXPECT_NEAR(along, -contacts.field(i, f::gap), 1e-15) << i;
      EXPECT_LE(std::sqrt(across2), bound + 1e-16) << i;
      if (std::sqrt(across2) < 0.999 * bound) {
        EXPECT_NEAR(std::sqrt(slides2), 0, 1e-15) << i;
        ++held;
      } else {
        ++slid;
      }
    }
    EXPECT_GT(held, 0u);
    EXPECT_GT(slid, 0u);
    EXPECT_GT(open, 0u);
  }
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
