// One visit of an end that ground may hold, by the body that is written for reading: the law of Coulomb.

#include <gtest/gtest.h>

#include <cmath>

#include "simd/relax/contacts/end_scalar.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

// An end slides while it is pressed on. Where friction may, it holds; else it takes its share of the push.
TEST(EndVisit, HoldsWithinTheConeAndSlidesBeyond) {
  double fields[end_fields::count * logical_width<double>] = {};
  double p[4] = {};
  const std::uint32_t at[logical_width<double>] = {};
  const EndView<double> view{nullptr, p, fields, at};
  const OneEnd<records, double> end(view, 0, 0);
  end(end_fields::normal + 1) = 1;
  end(end_fields::over) = end(end_fields::mass) = 2;
  end(end_fields::moves) = 0.5;
  end(end_fields::friction) = 0.5;
  for (const double aside : {0.001, 0.003}) {
    end.store3({0, 0, 0}, end_fields::push);
    p[0] = 0.6 * aside;
    p[1] = -0.004;
    p[2] = 0.8 * aside;
    visit_end(view, end);
    // Numbers of 4 mm are good to 1e-18.
    EXPECT_NEAR(p[1], 0, 1e-17);
    EXPECT_NEAR(end(end_fields::push + 1), 2 * 0.004, 1e-17);
    EXPECT_NEAR(std::hypot(p[0], p[2]), aside > 0.002 ? aside - 0.002 : 0, 1e-17);
  }
  // It is lifted off: nothing pulls it back.
  p[1] = 0.01;
  visit_end(view, end);
  for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(end(end_fields::push + c), 0);
  EXPECT_NEAR(p[1], 0.01 - 0.004, 1e-17) << "the push that held it is taken back";
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
