#pragma once

/// These numbers say how line_scalar.hpp and line_lanes.hpp find where lines touch. They are those of
/// contact/shapes/touch.hpp and of contacts that are found one by one.
namespace plumb::simd::line_limits {

inline constexpr double least_distance = 1e-12;  ///< m; lines nearer than that have a normal of their own
inline constexpr double least_square = 1e-24;    ///< m², of a line that is not a point
inline constexpr double least_area = 1e-12;      ///< of lines that are not parallel, to their squares
inline constexpr double along = 0.97;            ///< squared cosine of lines that lie along each other
inline constexpr double least_part = 1e-3;       ///< between two places that count
/// What lines move by in all, times this, is how far a touch comes from at most.
inline constexpr double reach = 1.26;
/// A place may come nearer by this share of how far it moves.
inline constexpr double spread = 0.25;

}  // namespace plumb::simd::line_limits
