#pragma once

#include <algorithm>
#include <span>

#include "contact/linkage/linkage.hpp"
#include "contact/rows.hpp"
#include "contact/shapes/hulls/convex_hull.hpp"
#include "contact/shapes/sweep.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// This is a hull of a linkage that moves, with its four particles.
struct MovingHullShape {
  const Linkage::HullShape& shape;
  MovingHull hull;
  Linkage::HullShape::Vectors particles, by;  ///< m

  double moves() const {
    double most = 0;
    for (const Vec3 each : hull.by) most = std::max(most, norm(each));
    return most;
  }
};

/// Keeps where hulls are. Memory is kept when they are cleared.
class PlacedHulls {
 public:
  void clear() {
    places_.clear();
    corners_.clear();
    normals_.clear();
  }
  /// Adds a hull whose particles are in given places. The number of hulls before it is its own.
  void add(const Linkage::HullShape& shape, const Linkage::HullShape::Vectors& particles) {
    places_.push_back({&shape, corners_.size(), normals_.size(), particles});
    corners_.resize(corners_.size() + shape.corners.size());
    normals_.resize(normals_.size() + shape.parts.faces());
    moves_.resize(std::max(moves_.size(), corners_.size()));
    room_.resize(moves_.size());
    shape.find_corners(particles, of(corners_, places_.back()));
    find_normals(shape.parts, of(corners_, places_.back()), normals_of(places_.back()));
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(places_.size()); }
  const Linkage::HullShape& shape(std::uint32_t i) const { return *places_[i].shape; }
  const Linkage::HullShape::Vectors& particles(std::uint32_t i) const { return places_[i].particles; }
  Convex at(std::uint32_t i) {
    const Place& place = places_[i];
    return {of(corners_, place), normals_of(place), &place.shape->parts, place.shape->radius};
  }
  /// Returns a hull whose particles move by given vectors (m). It holds until the hull is moved again.
  MovingHullShape moving(std::uint32_t i, const Linkage::HullShape::Vectors& by) {
    const Place& place = places_[i];
    place.shape->find_corners(by, of(moves_, place));
    return {*place.shape, {at(i), of(moves_, place), of(room_, place)}, place.particles, by};
  }

 private:
  struct Place {
    const Linkage::HullShape* shape;
    std::size_t first_corner, first_normal;
    Linkage::HullShape::Vectors particles;
  };
  static std::span<Vec3> of(Array<Vec3>& vectors, const Place& place) {
    return std::span(vectors).subspan(place.first_corner, place.shape->corners.size());
  }
  std::span<Vec3> normals_of(const Place& place) {
    return std::span(normals_).subspan(place.first_normal, place.shape->parts.faces());
  }

  Array<Place> places_;
  Array<Vec3> corners_, normals_, moves_, room_;
};

/// This is a shape of an island where it is: the line of a capsule, or a hull.
struct PlacedShape {
  PlacedShape(const Linkage::Shape& shape, std::uint32_t its_number, Vec3 p, Vec3 q)
      : line(&shape), ends{p, q}, number(its_number), surface(&shape.surface) {}
  PlacedShape(PlacedHulls& hulls, std::uint32_t i)
      : hull(&hulls.shape(i)),
        hull_at(hulls.at(i)),
        particles(hulls.particles(i)),
        number(hull->number),
        surface(&hull->surface) {}

  Convex convex() const {
    if (hull) return hull_at;
    return {
        .vertices = std::span(ends).first(ends[0] == ends[1] ? 1 : 2), .normals = {}, .radius = line->radius};
  }
  Combination at(Vec3 place) const {
    return hull ? hull->at(particles, place) : blend(line->a, line->b, place_along(ends[0], ends[1], place));
  }
  Bounds bounds(double further) const {
    Bounds out = nowhere;
    const Convex shape = convex();
    for (const Vec3 v : shape.vertices) include(out, v, shape.radius + further);
    return out;
  }

  const Linkage::Shape* line = nullptr;
  std::array<Vec3, 2> ends{};  ///< m, of the line
  const Linkage::HullShape* hull = nullptr;
  Convex hull_at{};
  Linkage::HullShape::Vectors particles{};  ///< m, of the hull
  std::uint32_t number;
  const Surface* surface;
};

/// Calls add(key, at_a, at_b, touch) where two shapes, of which one is a hull, are to be kept apart.
/// `other_island` is that of b.
template <class Add>
void for_pair_touches(const PlacedShape& a, const PlacedShape& b, double reach, std::uint32_t other_island,
                      Add&& add) {
  if (!a.bounds(reach).overlaps(b.bounds(0))) return;
  for (const ConvexContact& each : contacts_of(a.convex(), b.convex(), reach))
    add(contact_key(KeyKind::hulls, std::uint64_t{a.number} << 32 | b.number, other_island, each.key),
        a.at(each.on_a), b.at(each.on_b), Touch{each.gap, each.normal});
}

/// Calls add(key, at, touch) where a hull is to be kept off ground that moves, which is solid there and has
/// the number `ground` among those of its kind.
template <class Add>
void for_touches_with_moving(const PlacedShape& hull, const Convex& solid, double reach, KeyKind kind,
                             std::uint32_t ground, Add&& add) {
  for (const ConvexContact& each : contacts_of(hull.convex(), solid, reach))
    add(contact_key(kind, hull.number, each.key + 1, ground), hull.at(each.on_a),
        Touch{each.gap, each.normal});
}

}  // namespace plumb::detail
