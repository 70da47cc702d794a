#pragma once

#include <algorithm>
#include <optional>

#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/meshes/triangle_mesh.hpp"

/// This file says when something that moves straight on first touches something that stands still, or moves,
/// too.
namespace plumb::detail {

/// This is a rounded segment whose ends move straight, by p_by and q_by (m).
struct MovingSegment {
  Segment at;
  Vec3 p_by{}, q_by{};
};

/// Says when and how something is touched first.
struct FirstTouch {
  double time = 0;  ///< share of the way, 0 to 1
  Vec3 normal{};    ///< unit vector from what stands still
  double at = 0;    ///< place along the segment, from 0 to 1
};

/// Says how near a segment is to something convex.
struct Separation {
  double distance = 0;  ///< m, of the line
  Vec3 normal{};        ///< unit vector from the other to the line
  Vec3 on_line{};       ///< the nearest place on the line, m
};

/// Returns where a place on a segment is, from 0 at p to 1 at q.
inline double place_along(Vec3 p, Vec3 q, Vec3 place) {
  const double square = dot(q - p, q - p);
  return square > 0 ? std::clamp(dot(place - p, q - p) / square, 0.0, 1.0) : 0;
}

/// Finds the first touch of what moves and something convex. `see(t)` says how far they are apart at a time,
/// and `approach(normal)` how far (m) any part goes against that normal in all, at most.
///
/// Time advances by as much as nothing can touch within (Mirtich 1996), until they are nearer than `close`
/// (m). Returns the time, or nothing if they do not touch. What touches at the start does so at time 0.
template <class See, class Approach>
std::optional<double> advance(double close, See&& see, Approach&& approach) {
  constexpr int most_advances = 64;
  double t = 0;
  for (int i = 0; i < most_advances; ++i) {
    const Separation now = see(t);
    if (now.distance <= close) return t;
    // Nothing is beyond the plane between both.
    const double by = approach(now.normal);
    if (!(by > 0) || now.distance - 0.5 * close > (1 - t) * by) return std::nullopt;
    t += (now.distance - 0.5 * close) / by;
  }
  return t;  // It is so near that it hardly advances.
}

/// Finds the first touch of a segment with something convex, from which `separation_of(p, q)` says how far
/// the line is.
template <class SeparationOf>
std::optional<FirstTouch> sweep(const MovingSegment& moving, double close, SeparationOf&& separation_of) {
  FirstTouch out;
  const auto see = [&](double t) {
    const Vec3 p = moving.at.p + t * moving.p_by, q = moving.at.q + t * moving.q_by;
    const Separation now = separation_of(p, q);
    out = {t, now.normal, place_along(p, q, now.on_line)};
    return Separation{now.distance - moving.at.radius, now.normal, {}};
  };
  const auto approach = [&](Vec3 n) { return -std::min(dot(n, moving.p_by), dot(n, moving.q_by)); };
  if (!advance(close, see, approach)) return std::nullopt;
  return out;
}

/// Finds the first touch with a triangle, which has no inside.
std::optional<FirstTouch> sweep(const MovingSegment& moving, const Triangle& triangle, double close);

/// Finds the first touch with a convex shape.
std::optional<FirstTouch> sweep(const MovingSegment& moving, const Convex& shape, double close);

/// Finds the first touch with any triangle of a mesh that is not touched at the start. Triangles that another
/// one shields do not count, nor those of an outward mesh from inside. Of equal times that with the lowest
/// number counts.
std::optional<FirstTouch> sweep(const MovingSegment& moving, const TriangleMesh& mesh, double close);

/// Says when and how two segments touch each other first.
struct FirstPairTouch {
  double time = 0;      ///< share of the way, 0 to 1
  Vec3 normal{};        ///< unit vector from the second one to the first
  double a = 0, b = 0;  ///< places along them, from 0 to 1
};

/// Finds the first touch of two segments that both move.
std::optional<FirstPairTouch> sweep(const MovingSegment& a, const MovingSegment& b, double close);

/// This is a hull whose vertices move straight on within some time.
struct MovingHull {
  Convex at;                 ///< where it starts
  std::span<const Vec3> by;  ///< m, by vertex
  std::span<Vec3> there;     ///< room for its vertices
};

/// Returns a box around all that something passes through.
Bounds bounds_of(const MovingSegment& moving);
Bounds bounds_of(const MovingHull& moving);

/// Says when and where a hull touches first.
struct FirstHullTouch {
  double time = 0;  ///< share of the way, 0 to 1
  Vec3 normal{};    ///< unit vector from what stands still
  Vec3 on_hull{};   ///< m, at that time
};

/// Finds the first touch of a hull with a convex shape, or with any triangle of a mesh that it does not touch
/// at the start. The rules are those of sweep() for segments.
std::optional<FirstHullTouch> sweep(const MovingHull& moving, const Convex& shape, double close);
std::optional<FirstHullTouch> sweep(const MovingHull& moving, const TriangleMesh& mesh, double close);

}  // namespace plumb::detail
