// This file finds the convex hull of points by quickhull (Barber, Dobkin, Huhdanpaa 1996). Of the points
// outside a face the furthest goes first, which keeps the faces fat. Points that are outside by no more than
// a given thickness count as inside.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plumb/reference/bounding.hpp"
#include "scene/require_points.hpp"

namespace plumb {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct Face {
  Triangle corner{};
  Vec3 normal{};      ///< Unit vector outwards.
  double offset = 0;  ///< Distance of its plane from the origin along it, in m.
  std::vector<std::uint32_t> outside{};

  double height(Vec3 p) const { return dot(normal, p) - offset; }
};

/// Returns the number of the point for which f is largest, and f there.
template <class F>
std::pair<std::uint32_t, double> furthest(std::span<const Vec3> points, F&& f) {
  std::pair<std::uint32_t, double> best{0, -std::numeric_limits<double>::infinity()};
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (const double value = f(points[i]); value > best.second) best = {i, value};
  return best;
}

class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) : points_(points) {
    add_tetrahedron();
    for (std::size_t f = 0; f < faces_.size();) {
      if (faces_[f].outside.empty()) {
        ++f;
      } else {
        add_point(furthest_outside(faces_[f]));
        f = 0;  // faces have moved in the list, so that the walk begins again
      }
    }
  }

  ConvexMesh mesh() const {
    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(points_.size(), unused);
    for (const Face& face : faces_)
      for (const std::uint32_t corner : face.corner) number[corner] = 0;
    ConvexMesh out;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (number[i] == unused) continue;
      number[i] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(points_[i]);
    }
    for (const Face& face : faces_)
      out.faces.push_back({number[face.corner[0]], number[face.corner[1]], number[face.corner[2]]});
    return out;
  }

 private:
  Face face(Triangle corner) const {
    const Vec3 p = points_[corner[0]];
    const Vec3 normal = cross(points_[corner[1]] - p, points_[corner[2]] - p);
    const Vec3 unit = (1 / norm(normal)) * normal;
    return {.corner = corner, .normal = unit, .offset = dot(unit, p)};
  }

  /// Starts with a tetrahedron of points that are far apart.
  void add_tetrahedron() {
    const auto a = furthest(points_, [](Vec3 p) { return -p.x; }).first;
    const Vec3 origin = points_[a];
    const auto [b, length] = furthest(points_, [&](Vec3 p) { return norm(p - origin); });
    const Vec3 along = (1 / length) * (points_[b] - origin);
    const auto [c, width] = furthest(points_, [&](Vec3 p) { return norm(cross(along, p - origin)); });
    const Vec3 across = (1 / width) * cross(along, points_[c] - origin);
    const auto height = [&](Vec3 p) { return dot(across, p - origin); };
    const auto [d, thickness] = furthest(points_, [&](Vec3 p) { return std::abs(height(p)); });
    if (!(width > 1e-9 * length && thickness > 1e-9 * length))
      detail::refuse("a convex mesh needs points that do not lie in one plane");
    fat_ = 1e-10 * length;
    const auto [low, high] = height(points_[d]) > 0 ? std::pair{b, c} : std::pair{c, b};
    faces_ = {face({a, high, low}), face({a, low, d}), face({low, high, d}), face({high, a, d})};
    std::vector<std::uint32_t> all(points_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    share_out(all, 0);
  }

  std::uint32_t furthest_outside(const Face& face) const {
    return *std::max_element(face.outside.begin(), face.outside.end(), [&](auto i, auto j) {
      return face.height(points_[i]) < face.height(points_[j]);
    });
  }

  /// Gives each point to a face that it is outside of, from number `first` on, if there is one.
  void share_out(const std::vector<std::uint32_t>& points, std::size_t first) {
    for (const std::uint32_t i : points) {
      const auto begin = faces_.begin() + static_cast<std::ptrdiff_t>(first);
      const auto above =
          std::find_if(begin, faces_.end(), [&](const Face& f) { return f.height(points_[i]) > fat_; });
      if (above != faces_.end()) above->outside.push_back(i);
    }
  }

  /// Replaces the faces that a point sees by those from it to the edge of what it sees.
  void add_point(std::uint32_t i) {
    const auto seen = std::stable_partition(faces_.begin(), faces_.end(),
                                            [&](const Face& f) { return !(f.height(points_[i]) > fat_); });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<std::uint32_t> left;
    for (auto f = seen; f != faces_.end(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(f->corner[k], f->corner[(k + 1) % 3]);
      left.insert(left.end(), f->outside.begin(), f->outside.end());
    }
    std::sort(edges.begin(), edges.end());
    faces_.erase(seen, faces_.end());
    const std::size_t first = faces_.size();
    for (const auto& [a, b] : edges) {
      const bool inner = std::binary_search(edges.begin(), edges.end(), std::pair{b, a});
      if (!inner) faces_.push_back(face({a, b, i}));
    }
    std::erase(left, i);
    share_out(left, first);
  }

  std::span<const Vec3> points_;
  double fat_ = 0;  ///< Thickness of faces, in m: points outside by less count as inside.
  std::vector<Face> faces_;
};

}  // namespace

ConvexMesh convex_mesh_of(std::span<const Vec3> points) {
  detail::require_points(points);
  return Hull(points).mesh();
}

}  // namespace plumb
