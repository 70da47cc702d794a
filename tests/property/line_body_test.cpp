// Where lines touch each other: every instruction set has the bits of the scalar body, and finds what
// touches() finds for one pair after the other.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <algorithm>
#include <cstring>
#include <vector>

#include "contact/shapes/passing.hpp"
#include "contact/shapes/touch.hpp"
#include "simd/relax/contacts/line_kernels.hpp"
#include "simd/relax/contacts/line_lanes.hpp"
#include "simd/relax/contacts/line_limits.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/graphs.hpp"

namespace plumb::simd {
namespace {

using detail::MovingSegment;
using detail::PairSearch;
using test::Random;

constexpr std::uint32_t lines = 60;
constexpr LineRules rules{0.004, PairSearch::passes};

/// Lines near each other. Of three, two lie along each other, as they do in a coil. Some are points.
std::vector<MovingSegment> some_lines() {
  Random random(11);
  const auto any = [&](double size) {
    return Vec3{size * test::signed_unit(random), size * test::signed_unit(random),
                size * test::signed_unit(random)};
  };
  std::vector<MovingSegment> out;
  for (std::uint32_t i = 0; i < lines; ++i) {
    const Vec3 p = any(0.12), q = i % 7 == 0   ? p
                                  : i % 3 != 1 ? p + Vec3{0.1, 0, 0} + any(0.004)
                                               : p + any(0.1);
    const double fast = i % 11 == 0 ? 0.05 : 0.002;
    out.push_back({{p, q, 0.01 + 0.01 * (i % 2)}, any(fast), any(fast)});
  }
  return out;
}

std::vector<double> numbers_of(const std::vector<MovingSegment>& from) {
  std::vector<double> out;
  for (const auto& [at, p_by, q_by] : from)
    out.insert(out.end(),
               {at.p.x, at.p.y, at.p.z, at.radius, at.q.x, at.q.y, at.q.z, std::max(norm(p_by), norm(q_by)),
                p_by.x, p_by.y, p_by.z, 0, q_by.x, q_by.y, q_by.z, 0});
  return out;
}

/// Looks at all pairs, and at the last ones in a vector that is not full.
std::vector<LineTouch> found(const LineKernels& kernels) {
  const std::vector<double> numbers = numbers_of(some_lines());
  std::vector<LinePair> pairs;
  for (std::uint32_t i = 0; i < lines; ++i)
    for (std::uint32_t k = 0; k < i; ++k) pairs.push_back({k, i});
  std::vector<LineTouch> out;
  for (std::size_t first = 0; first < pairs.size(); first += most_line_pairs - 3) {
    LineTouch touches[most_line_touches * most_line_pairs];
    const auto count =
        static_cast<std::uint32_t>(std::min(pairs.size() - first, std::size_t{most_line_pairs - 3}));
    const std::uint32_t more = kernels.find(numbers.data(), &pairs[first], count, rules, touches);
    for (std::uint32_t k = 0; k < more; ++k) {
      if (touches[k].which == LineTouch::fast)
        touches[k] = {0, 0, 0, 0, 0, 0, 0, touches[k].pair, LineTouch::fast};
      touches[k].pair += static_cast<std::uint32_t>(first);
      out.push_back(touches[k]);
    }
  }
  return out;
}

TEST(LineBody, EveryInstructionSetFindsTheSameBits) {
  const std::vector<LineTouch> wanted = found(kernels<double>(Isa::scalar).lines);
  const auto is_fast = [](const LineTouch& each) { return each.which == LineTouch::fast; };
  EXPECT_GT(std::count_if(wanted.begin(), wanted.end(), is_fast), 10);
  EXPECT_GT(wanted.size(), 200u);
  const auto expect_same = [&](const LineKernels& kernels) {
    const std::vector<LineTouch> got = found(kernels);
    ASSERT_EQ(got.size(), wanted.size());
    EXPECT_EQ(std::memcmp(got.data(), wanted.data(), wanted.size() * sizeof(LineTouch)), 0);
  };
  expect_same(line_kernels);
  for (const Isa isa : all_isas())
    if (is_supported(isa)) expect_same(kernels<double>(isa).lines);
}

TEST(LineBody, FindsWhatOnePairAfterTheOtherDoes) {
  const std::vector<MovingSegment> all = some_lines();
  const std::vector<LineTouch> got = found(kernels<double>(Isa::scalar).lines);
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
}  // namespace plumb::simd
