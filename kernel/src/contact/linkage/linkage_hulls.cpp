// This file has the hulls of a linkage: shapes that move with bodies.

#include <algorithm>

#include "contact/linkage/linkage.hpp"
#include "contact/shapes/hulls/convex_hull.hpp"
#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

/// Returns half of a hull's least width, in m.
double half_width(const Convex& hull) {
  double least = INFINITY;
  for (std::uint32_t i = 0; i < hull.faces(); ++i) {
    double most = 0;
    for (const Vec3 v : hull.vertices)
      most = std::max(most, dot(hull.normals[i], hull.vertices[hull.parts->face(i)[0]] - v));
    least = std::min(least, most);
  }
  return 0.5 * least;
}

}  // namespace

void Linkage::HullShape::find_corners(const Vectors& from, std::span<Vec3> out) const {
  for (std::size_t i = 0; i < corners.size(); ++i) out[i] = weighted(corners[i], from);
}

std::array<double, 4> Linkage::HullShape::weights(const Vectors& from, Vec3 place) {
  return Barycentric(from).weights(place);
}

Combination Linkage::HullShape::sum(const std::array<double, 4>& weights) const {
  Combination out;
  for (std::size_t k = 0; k < 4; ++k) out.add(particles[k], weights[k]);
  return out;
}

void Linkage::add_hulls(const Scene& part, std::span<const Vec3> x) {
  for (const Hull& each : part.hulls) {
    const ConvexHull hull(each.points);
    const Convex shape = hull.shape(each.radius);
    HullShape& out = hulls_.emplace_back();
    out.filter = each.filter;
    add_filter(out.filter);
    out.particles = part.bodies[each.body].particles;
    out.parts = hull.parts();
    out.radius = each.radius;
    out.surface = each.surface;
    out.number = static_cast<std::uint32_t>(shapes_.size() + hulls_.size() - 1);
    out.half_width = half_width(shape) + each.radius;
    for (const Vec3 v : hull.vertices()) {
      out.corners.push_back(out.weights(out.of(x), v));
      balls_.push_back(
          {places_.keep(out.sum(out.corners.back())), each.radius, each.surface, out.number, each.filter});
      size_ = std::max(size_, norm(v - hull.vertices()[0]) + 2 * each.radius);
    }
  }
}

}  // namespace plumb::detail
