#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/shapes/passing.hpp"
#include "simd/relax/contacts/line_kernels.hpp"
#include "support/graphs.hpp"

/// Lines near each other, and what kernels find of them.
namespace plumb::test::near_lines {

using detail::MovingSegment;
using detail::PairSearch;
using simd::LineKernels;
using simd::LinePair;
using simd::LineRules;
using simd::LineTouch;
using simd::most_line_pairs;
using simd::most_line_touches;

inline constexpr std::uint32_t lines = 60;
inline constexpr LineRules rules{0.004, PairSearch::passes};

/// Lines near each other. Of three, two lie along each other, as they do in a coil. Some are points.
inline std::vector<MovingSegment> some_lines() {
  Random random(11);
  const auto any = [&](double size) {
    return Vec3{size * signed_unit(random), size * signed_unit(random), size * signed_unit(random)};
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

inline std::vector<double> numbers_of(const std::vector<MovingSegment>& from) {
  std::vector<double> out;
  for (const auto& [at, p_by, q_by] : from)
    out.insert(out.end(),
               {at.p.x, at.p.y, at.p.z, at.radius, at.q.x, at.q.y, at.q.z, std::max(norm(p_by), norm(q_by)),
                p_by.x, p_by.y, p_by.z, 0, q_by.x, q_by.y, q_by.z, 0});
  return out;
}

/// Looks at all pairs, and at the last ones in a vector that is not full.
inline std::vector<LineTouch> found(const LineKernels& kernels) {
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

}  // namespace plumb::test::near_lines
