#pragma once

#include <algorithm>
#include <optional>

#include "contact/shapes/sweep.hpp"

/// This file says where two shapes that may pass through each other are to be kept apart.
///
/// What is near is kept apart where it is near. What moves fast may pass by that, and is kept apart along the
/// plane in which it touches first.
namespace plumb::detail {

/// Returns how far (m) two lines move against each other, at most.
inline double moves_between(const MovingSegment& a, const MovingSegment& b) {
  return std::max(
      {norm(a.p_by - b.p_by), norm(a.p_by - b.q_by), norm(a.q_by - b.p_by), norm(a.q_by - b.q_by)});
}

/// Returns how two lines move against each other at a place of each, m.
inline Vec3 moved_between(const MovingSegment& a, const MovingSegment& b, double at_a, double at_b) {
  return between(a.p_by, a.q_by, at_a) - between(b.p_by, b.q_by, at_b);
}

/// Says which pairs may pass through each other.
struct PairSearch {
  double margin = 0;  ///< m, of contact
  double close = 0;   ///< m, what is nearer touches
  /// What moves by more than the margin and this share of its radii is fast.
  static constexpr double passes = 0.5;

  /// Returns whether two shapes may pass each other, or some of their radii (m), that move by `moves` (m)
  /// against each other.
  bool is_fast(double moves, double radii) const { return moves > margin + passes * radii; }
  /// Returns whether a shape that moves by so much (m) may be fast against another one that does not move
  /// more.
  bool may_be_fast(double moves, double radius) const { return 2 * moves > margin + passes * radius; }
  /// Returns how near (m) what is fast is kept apart where it is.
  double reach(double radii) const { return margin + passes * radii; }
  /// Returns how deep (m) two shapes may be in each other after others pushed them.
  double harmless(double thinner) const {
    // What sweeps leave may be a share of a shape.
    return std::max(close, std::min(margin, 0.25 * thinner));
  }

  /// Returns the plane that two lines touch in first, unless they do at the start.
  std::optional<Touch> first_touch(const MovingSegment& a, const MovingSegment& b) const {
    const auto first = sweep(a, b, close);
    if (!first || first->time == 0) return std::nullopt;
    const Vec3 by = moved_between(a, b, first->a, first->b);
    return Touch{-first->time * dot(first->normal, by), first->normal, first->a, first->b};
  }

  /// Returns the plane that two lines are to stay apart in, if they go through each other by more than is
  /// harmless. Lines that overlap at the start may do so by as much more, or by half of what they are apart.
  std::optional<Touch> passed(MovingSegment a, MovingSegment b) const {
    const double radii = a.at.radius + b.at.radius, thinner = std::min(a.at.radius, b.at.radius);
    const double apart = touch(a.at, b.at).gap + radii;
    const double bears = harmless(thinner);
    a.at.radius = std::min(radii - bears, std::max(0.5 * apart, apart - bears));
    b.at.radius = 0;
    const auto first = sweep(a, b, std::min(close, 0.01 * a.at.radius));
    if (!first || first->time == 0) return std::nullopt;
    const Vec3 by = moved_between(a, b, first->a, first->b);
    const double along = dot(first->normal, by);
    if (!(-along * (1 - first->time) > close)) return std::nullopt;
    // What overlaps along the normal at the start is to do so no more.
    const double gap = a.at.radius - first->time * along - radii;
    return Touch{std::max(gap, 0.0), first->normal, first->a, first->b};
  }
};

}  // namespace plumb::detail
