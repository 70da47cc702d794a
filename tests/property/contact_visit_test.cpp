// One visit of a contact between two places, by the body that is written for reading: momentum, and the law
// of Coulomb.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simd/relax/contacts/contact_scalar.hpp"
#include "simd/relax/contacts/push_scalar.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

namespace f = contact_fields;

// A particle of 1 kg comes down on one of 3 kg. Both slide past each other, within the cone and beyond it.
TEST(ContactVisit, KeepsMomentumAndTheCone) {
  constexpr std::uint32_t width = logical_width<double>;
  double fields[f::count * width] = {}, p[8] = {};
  std::uint32_t at[f::most_terms * width] = {};
  at[width] = 4;
  const auto field = [&](std::uint32_t k) -> double& { return fields[k * width]; };
  field(f::normal + 1) = 1;
  field(f::gap) = 0.001;
  field(f::over) = 0.75;  // 1 / (1/1 + 1/3)
  field(f::moves) = 1 / 0.75;
  field(f::friction) = 0.5;
  field(f::weight) = field(f::move) = 1;
  field(f::weight + 1) = -1;
  field(f::move + 1) = -1.0 / 3;
  const ContactView<double> view{p, fields, at};
  for (const double aside : {0.001, 0.004}) {
    for (std::uint32_t k = 0; k < 3; ++k) field(f::push + k) = 0;
    const double start[8] = {aside, -0.004, 0, 0, 0, 0.001, 0, 0};
    std::copy(start, start + 8, p);
    visit_contact<2>(view, 0, 0);
    // Numbers of 4 mm are good to 1e-18.
    for (std::uint32_t c = 0; c < 3; ++c)
      EXPECT_NEAR(p[c] + 3 * p[4 + c], start[c] + 3 * start[4 + c], 1e-17) << "momentum";
    EXPECT_NEAR(p[1] - p[5], -0.001, 1e-17) << "the gap may be lost, and no more";
    EXPECT_NEAR(field(f::push + 1), 0.75 * 0.004, 1e-17);
    EXPECT_NEAR(p[0] - p[4], aside > 0.002 ? aside - 0.002 : 0, 1e-17) << "friction may take 2 mm";
  }
  // They part: nothing pulls them back, and what held them is taken back.
  p[1] = p[5] + 0.01;
  visit_contact<2>(view, 0, 0);
  for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(field(f::push + c), 0);
  EXPECT_NEAR(p[1] - p[5], 0.01 - 0.004, 1e-17);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
