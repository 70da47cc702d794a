// Visits of ends that ground may hold: every instruction set has the bits of the scalar body, on ends that
// touch, that do not, and that are padding; and a visit does what Coulomb's law says.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "simd/relax/contacts/end_lanes.hpp"
#include "simd/relax/contacts/least_distance.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using layouts::AlignedBuffer;
using test::Random;

/// Ends near the origin, in vectors of which the last has padding.
template <class T>
struct SomeEnds {
  static constexpr std::uint32_t vectors = 5, lanes = logical_width<T>, count = vectors * lanes;
  AlignedBuffer<T> x{4 * (count + 1)}, p{4 * (count + 1)};
  AlignedBuffer<T> fields{std::size_t{count} * end_fields::count};
  std::vector<std::uint32_t> at, all;
  std::vector<std::uint8_t> touched = std::vector<std::uint8_t>(vectors);

  explicit SomeEnds(std::uint64_t seed) {
    Random random(seed);
    const auto unit = [&] { return static_cast<T>(test::signed_unit(random)); };
    for (std::uint32_t v = 0; v < vectors; ++v) all.push_back(v);
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool is_padding = i + 3 >= count;
      at.push_back(4 * (is_padding ? count : i));
      if (is_padding) continue;
      for (std::uint32_t c = 0; c < 3; ++c) {
        x[4 * i + c] = unit();
        p[4 * i + c] = T(0.02) * unit();
        field(i, end_fields::force + c) = T(i % 4 == 0 ? 0 : 50) * unit();
      }
      const T mass = T(1.5) + unit();
      field(i, end_fields::mass) = mass;
      field(i, end_fields::moves) = 1 / mass;
      field(i, end_fields::friction) = T(i % 5 == 0 ? 0 : 0.4);
      field(i, end_fields::radius) = T(0.01);
    }
  }
  T& field(std::uint32_t i, std::uint32_t field) {
    return fields[(std::size_t{i / lanes} * end_fields::count + field) * lanes + i % lanes];
  }
  EndView<T> view() { return {x.data(), p.data(), fields.data(), at.data()}; }
};

/// The same ends where neighbouring lanes are neighbouring numbers. Padding has rows of its own, too.
template <class T>
struct EndsInRows : SomeEnds<T> {
  static constexpr std::uint32_t lanes = SomeEnds<T>::lanes, numbers = 3 * SomeEnds<T>::count;
  AlignedBuffer<T> x_rows{numbers}, p_rows{numbers};
  std::vector<std::uint32_t> rows;

  explicit EndsInRows(std::uint64_t seed) : SomeEnds<T>(seed) {
    for (std::uint32_t v = 0; v < SomeEnds<T>::vectors; ++v) rows.push_back(3 * lanes * v);
    for (std::uint32_t i = 0; i < SomeEnds<T>::count; ++i)
      for (std::uint32_t c = 0; c < 3; ++c) {
        x_rows[number(i, c)] = this->x[this->at[i] + c];
        p_rows[number(i, c)] = this->p[this->at[i] + c];
      }
  }
  static std::uint32_t number(std::uint32_t i, std::uint32_t c) {
    return i / lanes * 3 * lanes + c * lanes + i % lanes;
  }
  EndView<T> view() { return {x_rows.data(), p_rows.data(), this->fields.data(), rows.data(), lanes}; }
};

template <class T>
EndGround<T> ground(int kind) {
  if (kind == 0) return {true, {T(0.6), T(0.8), 0}, {}, 0, T(0.05)};
  if (kind == 1) return {false, {T(0.1), T(-0.2), 0}, {}, 0, T(0.7)};
  return {false, {T(-0.5), 0, T(0.1)}, {1, T(0.5), 0}, T(0.8), T(0.3)};
}

template <class T>
constexpr EndRules<T> rules{T(2e-3), T(0.25), T(0.5), T(5e-4), T(0.1), T(1e-4)};

/// Finds, starts, sweeps, watches, sweeps again, measures and keeps. Returns all numbers, those of places in
/// the order of lanes.
template <class T, class EndsOf>
std::vector<T> visited(const EndKernels<T>& kernels, int kind) {
  EndsOf ends(7 + kind);
  constexpr bool in_rows = std::is_same_v<EndsOf, EndsInRows<T>>;
  const EndView<T> view = ends.view();
  const auto place = [&](std::uint32_t i, std::uint32_t c) -> T& {
    return view.p[in_rows ? EndsInRows<T>::number(i, c) : ends.at[i] + c];
  };
  kernels.find(view, {0, EndsOf::vectors}, ground<T>(kind), rules<T>, ends.touched.data());
  std::vector<T> out(ends.touched.begin(), ends.touched.end());
  kernels.start(view, ends.all.data(), EndsOf::vectors);
  kernels.sweep(view, ends.all.data(), EndsOf::vectors);
  // They are thrown about, so that others go in.
  for (std::uint32_t i = 0; i + 3 < EndsOf::count; ++i) place(i, 1) -= T(0.01) * T(i % 7);
  out.push_back(kernels.watch(view, {0, EndsOf::vectors}, T(5e-4), ends.touched.data()) ? 1 : 0);
  kernels.sweep(view, ends.all.data(), EndsOf::vectors);
  out.push_back(kernels.measure(view, ends.all.data(), EndsOf::vectors));
  kernels.keep(view, {0, EndsOf::vectors}, T(1e4));
  out.insert(out.end(), ends.touched.begin(), ends.touched.end());
  for (std::uint32_t i = 0; i < EndsOf::count; ++i)
    for (std::uint32_t c = 0; c < 3; ++c) out.push_back(place(i, c));
  out.insert(out.end(), ends.fields.data(), ends.fields.data() + ends.fields.size());
  return out;
}

template <class T>
void expect_scalar_bits() {
  using Records = SomeEnds<T>;
  using Rows = EndsInRows<T>;
  for (const int kind : {0, 1, 2}) {
    const std::vector<T> wanted = visited<T, Records>(kernels<T>(Isa::scalar).ends, kind);
    EXPECT_TRUE(std::all_of(wanted.begin(), wanted.end(), [](T each) { return std::isfinite(each); }));
    EXPECT_EQ((visited<T, Records>(end_kernels<RecordAccess, T>, kind)), wanted);
    EXPECT_EQ((visited<T, Rows>(end_kernels<RowAccess, T>, kind)), wanted);
    for (const Isa isa : all_isas())
      if (is_supported(isa)) {
        EXPECT_EQ((visited<T, Records>(kernels<T>(isa).ends, kind)), wanted) << to_string(isa);
        EXPECT_EQ((visited<T, Rows>(kernels<T>(isa).row_ends, kind)), wanted) << to_string(isa);
      }
  }
}

TEST(EndBody, HasTheBitsOfTheScalarBodyInRecordsAndRows) {
  expect_scalar_bits<float>();
  expect_scalar_bits<double>();
}

// A single end touches at once; padding and what is far away never do.
TEST(EndBody, FindsWhatComesNear) {
  SomeEnds<double> ends(1);
  for (std::uint32_t i = 0; i < SomeEnds<double>::count; ++i) ends.x[4 * i + 1] = 10 + i;
  ends.x[4 * 9 + 1] = 0.02;
  ends.p[4 * 9 + 1] = -0.02;
  const EndGround<double> plane{true, {0, 1, 0}, {}, 0, 0};
  kernels<double>(best_isa())
      .ends.find(ends.view(), {0, SomeEnds<double>::vectors}, plane, rules<double>, ends.touched.data());
  EXPECT_EQ(ends.touched, (std::vector<std::uint8_t>{0, 1, 0, 0, 0}));
  EXPECT_NEAR(ends.field(9, end_fields::gap), 0.01, 1e-15);
  EXPECT_EQ(ends.field(9, end_fields::over), ends.field(9, end_fields::mass));
  EXPECT_EQ(ends.field(8, end_fields::over), 0);
}

// An end that goes in is put on the surface, and friction takes back its share of the way along it.
TEST(EndBody, KeepsAGapOpenWithinTheCone) {
  SomeEnds<double> ends(1);
  const EndGround<double> plane{true, {0, 1, 0}, {}, 0, 0};
  const double gap = 0.001, down = 0.004, aside = 0.003;
  for (std::uint32_t i = 0; i < SomeEnds<double>::count; ++i)
    for (std::uint32_t c = 0; c < 3; ++c) ends.field(i, end_fields::force + c) = 0;
  ends.x[4 * 1 + 1] = ends.field(1, end_fields::radius) + gap;
  ends.p[4 * 1] = aside;
  ends.p[4 * 1 + 1] = -down;
  ends.p[4 * 1 + 2] = 0;
  const EndKernels<double>& own = kernels<double>(best_isa()).ends;
  own.find(ends.view(), {0, 1}, plane, rules<double>, ends.touched.data());
  const std::uint32_t first = 0;
  const double most = own.measure(ends.view(), &first, 1);
  // Rounding is of a few numbers of 4 mm, each good to 1e-18.
  EXPECT_NEAR(ends.p[4 * 1 + 1], -gap, 1e-17);
  const double held = ends.field(1, end_fields::friction) * (down - gap);
  EXPECT_NEAR(ends.p[4 * 1], aside - held, 1e-17);
  EXPECT_GE(most, std::hypot(down - gap, held) - 1e-17);
  EXPECT_LT(own.measure(ends.view(), &first, 1), 1e-17) << "it is solved";
  EXPECT_GT(least_distance<double>, 0);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
