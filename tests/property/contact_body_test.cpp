// Visits of contacts: every instruction set has the bits of the scalar body, in records and in rows; and a
// visit does what Coulomb's law says.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "simd/relax/contacts/contact_lanes.hpp"
#include "simd/relax/contacts/push_fields.hpp"
#include "simd/relax/contacts/push_lanes.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using layouts::AlignedBuffer;
using test::Random;
namespace f = contact_fields;

/// Contacts between particles that no others move, in a range with two terms and one with four. Places are
/// records, or in rows of one lane width. The last lane of each vector is padding.
template <class T>
struct SomeContacts {
  static constexpr std::uint32_t vectors = 5, with_two = 2, lanes = logical_width<T>, count = vectors * lanes;
  static constexpr std::uint32_t particles = count * f::most_terms;
  bool in_rows;
  AlignedBuffer<T> p, fields{std::size_t{count} * f::count};
  std::vector<std::uint32_t> at = std::vector<std::uint32_t>(std::size_t{count} * f::most_terms);
  std::vector<ContactRange> ranges{{0, with_two, 2}, {with_two, vectors, 4}};

  SomeContacts(std::uint64_t seed, bool rows) : in_rows(rows), p(4 * (particles + lanes)) {
    Random random(seed);
    const auto unit = [&] { return static_cast<T>(test::signed_unit(random)); };
    std::vector<std::uint32_t> order(particles);
    std::iota(order.begin(), order.end(), 0u);
    for (std::uint32_t i = particles; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool is_padding = i % lanes == lanes - 1;
      T moves = 0;
      for (std::uint32_t k = 0; k < f::most_terms; ++k) {
        const std::uint32_t place = number(is_padding ? particles : order[f::most_terms * i + k]);
        at[(i / lanes * f::most_terms + k) * lanes + i % lanes] = place;
        for (std::uint32_t c = 0; c < 3; ++c) p[place + c * stride()] = is_padding ? T(0) : T(0.02) * unit();
        if (is_padding || (i < with_two * lanes && k >= 2)) continue;
        const T weight = unit(), inverse = T(1.5) + unit();
        field(i, f::weight + k) = weight;
        field(i, f::move + k) = weight * inverse;
        moves += weight * weight * inverse;
      }
      if (is_padding) continue;
      T n[3] = {unit(), unit(), T(1.5) + unit()};
      const T size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (std::uint32_t c = 0; c < 3; ++c) {
        field(i, f::normal + c) = n[c] / size;
        field(i, f::push + c) = T(i % 4 == 0 ? 0 : 0.02) * n[c] / size + T(i % 4 == 0 ? 0 : 0.01) * unit();
        field(i, f::carried + c) = T(i % 3 == 0 ? 0.005 : 0) * unit();
      }
      field(i, f::gap) = T(0.01) * unit();
      field(i, f::over) = 1 / moves;
      field(i, f::moves) = moves;
      field(i, f::friction) = T(i % 5 == 0 ? 0 : 0.4);
    }
  }
  std::uint32_t stride() const { return in_rows ? lanes : 1; }
  std::uint32_t number(std::uint32_t particle) const {
    return in_rows ? particle / lanes * 3 * lanes + particle % lanes : 4 * particle;
  }
  T& field(std::uint32_t i, std::uint32_t field) {
    return fields[(std::size_t{i / lanes} * f::count + field) * lanes + i % lanes];
  }
  ContactView<T> view() { return {p.data(), fields.data(), at.data(), stride()}; }
};

/// Measures a sweep, which solves what no others move, and sweeps again. Returns all numbers, those of places
/// in the order of particles.
template <class T>
std::vector<T> visited(const ContactKernels<T>& kernels, bool in_rows) {
  SomeContacts<T> contacts(7, in_rows);
  const auto count = static_cast<std::uint32_t>(contacts.ranges.size());
  std::vector<T> out{kernels.measure(contacts.view(), contacts.ranges.data(), count)};
  kernels.sweep(contacts.view(), contacts.ranges.data(), count);
  for (std::uint32_t i = 0; i < SomeContacts<T>::particles; ++i)
    for (std::uint32_t c = 0; c < 3; ++c)
      out.push_back(contacts.p[contacts.number(i) + c * contacts.stride()]);
  out.insert(out.end(), contacts.fields.data(), contacts.fields.data() + contacts.fields.size());
  return out;
}

template <class T>
void expect_scalar_bits() {
  const std::vector<T> wanted = visited<T>(kernels<T>(Isa::scalar).contacts, false);
  EXPECT_TRUE(std::all_of(wanted.begin(), wanted.end(), [](T each) { return std::isfinite(each); }));
  EXPECT_GT(wanted.front(), T(1e-4)) << "nothing moves";
  EXPECT_EQ(visited<T>(kernels<T>(Isa::scalar).row_contacts, true), wanted);
  EXPECT_EQ(visited<T>(contact_kernels<RecordAccess, T>, false), wanted);
  EXPECT_EQ(visited<T>(contact_kernels<GatherAccess, T>, true), wanted);
  for (const Isa isa : all_isas())
    if (is_supported(isa)) {
      EXPECT_EQ(visited<T>(kernels<T>(isa).contacts, false), wanted) << to_string(isa);
      EXPECT_EQ(visited<T>(kernels<T>(isa).row_contacts, true), wanted) << to_string(isa);
    }
}

TEST(ContactBody, HasTheBitsOfTheScalarBodyInRecordsAndRows) {
  expect_scalar_bits<float>();
  expect_scalar_bits<double>();
}

// After a visit a contact that is pressed keeps its gap. It holds, or slides with friction times its push.
TEST(ContactBody, KeepsGapsOpenWithinTheConeOfFriction) {
  SomeContacts<double> contacts(3, false);
  for (std::uint32_t i = 0; i < SomeContacts<double>::count; ++i)
    for (std::uint32_t c = 0; c < 3; ++c) contacts.field(i, f::push + c) = 0;
  kernels<double>(best_isa()).contacts.sweep(contacts.view(), contacts.ranges.data(), 2);
  std::uint32_t held = 0, slid = 0, open = 0;
  for (std::uint32_t i = 0; i < SomeContacts<double>::count; ++i) {
    if (contacts.field(i, f::over) == 0) continue;
    double along = 0, push = 0, across2 = 0, moved2 = 0;
    for (std::uint32_t c = 0; c < 3; ++c) {
      double moved = -contacts.field(i, f::carried + c);
      for (std::uint32_t k = 0; k < f::most_terms; ++k)
        moved += contacts.field(i, f::weight + k) *
                 contacts.p[contacts.at[(i / contacts.lanes * f::most_terms + k) * contacts.lanes +
                                        i % contacts.lanes] +
                            c];
      along += contacts.field(i, f::normal + c) * moved;
      moved2 += moved * moved;
      push += contacts.field(i, f::normal + c) * contacts.field(i, f::push + c);
    }
    const double bound = contacts.field(i, f::friction) * push;
    // Numbers of some centimetres and kilograms are good to 1e-16.
    if (push == 0) {
      EXPECT_GE(along, -contacts.field(i, f::gap) - 1e-15) << i;
      ++open;
      continue;
    }
    EXPECT_NEAR(along, -contacts.field(i, f::gap), 1e-15) << i;
    for (std::uint32_t c = 0; c < 3; ++c) {
      const double each = contacts.field(i, f::push + c) - push * contacts.field(i, f::normal + c);
      across2 += each * each;
    }
    const double across = std::sqrt(across2);
    EXPECT_LE(across, bound + 1e-16) << i;
    const double slides = std::sqrt(std::max(0.0, moved2 - along * along));
    if (across < 0.999 * bound) {
      EXPECT_NEAR(slides, 0, 1e-9) << i;  // a root of what rounding leaves of squares
      ++held;
    } else {
      ++slid;
    }
  }
  EXPECT_GT(held, 0u);
  EXPECT_GT(slid, 0u);
  EXPECT_GT(open, 0u);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
