// Where lines touch each other: the scalar body finds what touches() finds for one pair after the other.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/shapes/passing.hpp"
#include "contact/shapes/touch.hpp"
#include "simd/relax/contacts/line_limits.hpp"
#include "simd/relax/contacts/line_scalar.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/near_lines.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using namespace test::near_lines;

TEST(LineVisit, FindsWhatOnePairAfterTheOtherDoes) {
  const std::vector<MovingSegment> all = some_lines();
  const std::vector<LineTouch> got = found(line_kernels);
  std::size_t at = 0, along = 0;
  std::uint32_t pair = 0;
  for (std::uint32_t i = 0; i < lines; ++i)
    for (std::uint32_t k = 0; k < i; ++k, ++pair) {
      const MovingSegment &a = all[k], &b = all[i];
      const double moves = std::max(norm(a.p_by), norm(a.q_by)) + std::max(norm(b.p_by), norm(b.q_by));
      const double reach = rules.margin + line_limits::reach * moves;
      if (detail::are_apart(a.at, b.at, reach)) continue;
      if (detail::PairSearch{rules.margin}.is_fast(detail::moves_between(a, b), a.at.radius + b.at.radius)) {
        ASSERT_LT(at, got.size());
        EXPECT_EQ(got[at].pair, pair);
        EXPECT_EQ(got[at++].which, LineTouch::fast);
        continue;
      }
      const detail::Touches near = detail::touches(a.at, b.at, reach);
      for (std::uint32_t n = 0; n < near.count; ++n) {
        const detail::Touch& touch = near.at[n];
        const Vec3 shift = detail::moved_between(a, b, touch.a, touch.b);
        const double left =
            touch.gap + dot(touch.normal, shift) - rules.margin - line_limits::spread * norm(shift);
        ASSERT_GT(std::abs(left), 1e-12);  // so that rounding decides nothing
        if (touch.gap > reach || left > 0) continue;
        ASSERT_LT(at, got.size());
        EXPECT_EQ(got[at].pair, pair);
        EXPECT_EQ(got[at].which, n);
        EXPECT_EQ(got[at].gap, touch.gap);
        EXPECT_EQ((Vec3{got[at].x, got[at].y, got[at].z}), touch.normal);
        EXPECT_EQ(got[at].a, touch.a);
        EXPECT_EQ(got[at++].b, touch.b);
        along += n > 0;
      }
    }
  EXPECT_EQ(at, got.size());
  EXPECT_GT(along, 20u);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
