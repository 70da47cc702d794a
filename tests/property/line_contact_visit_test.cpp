// One visit of a contact of two lines, by the body that is written for reading.

#include <gtest/gtest.h>

#include <algorithm>

#include "simd/relax/contacts/line_contact_scalar.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

namespace f = line_contact_fields;

// The middle of a line of 1 kg at each end comes down on the end of another one, which alone answers for its
// line.
TEST(LineContactVisit, SharesAPushAmongEnds) {
  constexpr std::uint32_t width = logical_width<double>;
  double fields[f::count_if_alike * width] = {}, p[16] = {};
  std::uint32_t at[f::ends * width] = {};
  for (std::uint32_t k = 0; k < f::ends; ++k) at[k * width] = 4 * k;
  const auto field = [&](std::uint32_t k) -> double& { return fields[k * width]; };
  field(f::normal + 1) = 1;
  field(f::gap) = 0.001;
  field(f::a) = 0.5;
  field(f::b) = 1;
  field(f::over) = 1 / 1.5;  // of 1/2 for the middle and 1 for the end
  for (const std::uint32_t k : {0u, 1u}) p[4 * k + 1] = -0.004;
  const LineContactView<double> view{p, fields, at, 1, 1.0};
  const Triple<double> by = OneLineContact<double>(view, 0, 0).visit();
  // Numbers of 4 mm are good to 1e-18.
  EXPECT_NEAR(by.y, 0.002, 1e-17);
  const double wanted[f::ends] = {-0.003, -0.003, 0, -0.002};
  for (std::uint32_t k = 0; k < f::ends; ++k) EXPECT_NEAR(p[4 * k + 1], wanted[k], 1e-17) << k;
  EXPECT_NEAR((p[1] + p[5]) / 2 - p[13], -0.001, 1e-17) << "the gap may be lost, and no more";
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
