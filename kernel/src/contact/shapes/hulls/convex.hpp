#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Says how the vertices of a convex solid make faces and edges. It stays as it is when the solid moves.
struct ConvexParts {
  struct Edge {
    std::uint32_t a, b;         ///< vertices
    std::uint32_t left, right;  ///< faces; from outside, `left` has b after a
  };
  Array<std::uint32_t> corners;      ///< of one face after the other, counterclockwise from outside
  Array<std::uint32_t> first_of{0};  ///< where each face begins among the corners, and the end
  Array<Edge> edges;

  std::uint32_t faces() const { return static_cast<std::uint32_t>(first_of.size() - 1); }
  std::span<const std::uint32_t> face(std::uint32_t i) const {
    return {corners.data() + first_of[i], first_of[i + 1] - first_of[i]};
  }
};

/// This is a rounded convex shape where it is now: all within `radius` (m) of the hull of its vertices. A
/// point has one vertex and a segment two; neither has faces.
struct Convex {
  std::span<const Vec3> vertices;
  std::span<const Vec3> normals;       ///< by face, unit vectors outward
  const ConvexParts* parts = nullptr;  ///< none of points and segments
  double radius = 0;

  std::uint32_t faces() const { return parts ? parts->faces() : 0; }
};

/// Says where two convex shapes are nearest, without their radii, or how to part them on the shortest way.
struct Nearness {
  double distance = 0;  ///< m; if negative, they overlap by as much
  Vec3 normal{};        ///< unit vector from b to a
  Vec3 on_a{}, on_b{};  ///< the nearest places, m
};

/// Finds where two convex shapes are nearest (Gilbert, Johnson and Keerthi 1988). If they overlap, the
/// direction in which they do least is that of a face or across two edges (Gottschalk et al. 1996).
Nearness nearness(const Convex& a, const Convex& b);

/// This is a place where two convex shapes are kept apart.
struct ConvexContact {
  double gap = 0;         ///< m, between the surfaces; if negative, they overlap
  Vec3 normal{};          ///< unit vector from b to a
  Vec3 on_a{}, on_b{};    ///< places on the hulls of vertices, m
  std::uint64_t key = 0;  ///< stays the same while the same corners and edges touch
};

/// Holds the contacts of a pair. While the same parts touch they keep their order.
struct ConvexContacts {
  static constexpr std::uint32_t most = 16;
  std::array<ConvexContact, most> list;
  std::uint32_t count = 0;

  const ConvexContact* begin() const { return list.data(); }
  const ConvexContact* end() const { return list.data() + count; }
};

/// Brings the contacts to keep to the front of a list that is too long: that of least gap, then always the
/// one that is farthest from those kept. Returns how many are kept, at most ConvexContacts::most.
std::uint32_t spread(std::span<ConvexContact> list);

/// Lists where two convex shapes are to be kept apart, as far as the gap `reach` (m). Faces that meet flatly
/// do so at the corners of what they have in common. Of more than sixteen, those are left out that are
/// closest to others.
ConvexContacts contacts_of(const Convex& a, const Convex& b, double reach);

}  // namespace plumb::detail
