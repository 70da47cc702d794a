#include "contact/shapes/hulls/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

/// Points nearer to a face than this share of the size lie on it.
constexpr double on_face = 1e-10;

using Ids = std::array<std::uint32_t, 3>;
/// This is a side of a triangle, from one point to the next.
using Side = std::pair<std::uint32_t, std::uint32_t>;
using Sides = std::map<Side, std::uint32_t>;  ///< the face of each

Side side(const Ids& corners, std::size_t k) {
  return {corners[k], corners[(k + 1) % 3]};
}

[[noreturn]] void refuse_open(std::size_t points) {
  refuse("a hull of ", points,
         " points: rounding leaves its surface open, as some are within 1e-10 of its size "
         "of each other or of planes through others");
}

/// Returns what is on the other side of a triangle's side.
std::uint32_t beyond(const Sides& sides, Side side, std::size_t points) {
  const auto found = sides.find({side.second, side.first});
  if (found == sides.end()) refuse_open(points);
  return found->second;
}

/// Grows a hull of triangles from a tetrahedron, by one corner at a time (Barber et al. 1996). Of points that
/// are equally far that with the largest x, then y, then z is taken, which is a corner of the hull.
class Quickhull {
 public:
  struct Face {
    Ids corners;
    Vec3 normal;
    double offset;
    Array<std::uint32_t> beyond{};  ///< points that it sees
    bool is_gone = false;
  };

  explicit Quickhull(std::span<const Vec3> points) : points_(points) {
    Bounds box = nowhere;
    for (const Vec3 p : points) include(box, p, 0);
    size_ = points.empty() ? 0 : norm(box.high - box.low);
    if (!start()) return;
    // Points that lose their faces go to new ones, which come last.
    for (std::uint32_t i = 0; i < faces_.size(); ++i)
      if (!faces_[i].is_gone && !faces_[i].beyond.empty()) grow(i);
  }

  const Array<Face>& faces() const { return faces_; }
  double size() const { return size_; }

 private:
  bool is_greater(std::uint32_t i, std::uint32_t k) const {
    const auto key = [&](std::uint32_t n) { return std::tuple(points_[n].x, points_[n].y, points_[n].z); };
    return key(i) > key(k);
  }

  /// Returns the point for which `of(point)` is largest, to rounding.
  template <class Of>
  std::uint32_t best(std::span<const std::uint32_t> among, double rounding, Of of) const {
    double most = -INFINITY;
    for (const std::uint32_t i : among) most = std::max(most, of(points_[i]));
    std::uint32_t out = among[0];
    bool any = false;
    for (const std::uint32_t i : among)
      if (of(points_[i]) >= most - rounding && (!any || is_greater(i, out))) {
        out = i;
        any = true;
      }
    return out;
  }

  bool start() {
    if (points_.size() < 4 || !(size_ > 0)) return false;
    Array<std::uint32_t> all(points_.size());
    std::iota(all.begin(), all.end(), 0u);
    const double rounding = on_face * size_;
    const std::uint32_t a = best(all, 0, [](Vec3) { return 0.0; });
    const std::uint32_t b = best(all, rounding, [&](Vec3 p) { return norm(p - points_[a]); });
    const Vec3 along = points_[b] - points_[a];
    const std::uint32_t c =
        best(all, rounding, [&](Vec3 p) { return norm(cross(p - points_[a], along)) / norm(along); });
    const Vec3 across = cross(along, points_[c] - points_[a]);
    if (!(norm(across) > ConvexHull::flat * size_ * norm(along))) return false;
    const Vec3 normal = (1 / norm(across)) * across;
    const std::uint32_t d =
        best(all, rounding, [&](Vec3 p) { return std::abs(dot(normal, p - points_[a])); });
    const double height = dot(normal, points_[d] - points_[a]);
    if (!(std::abs(height) > ConvexHull::flat * size_)) return false;
    const Ids base = height < 0 ? Ids{a, b, c} : Ids{a, c, b};
    const auto [p, q, r] = base;
    for (const Ids corners : {base, Ids{q, p, d}, Ids{r, q, d}, Ids{p, r, d}}) add(corners);
    hand_out(all, 0);
    return true;
  }

  void add(const Ids& corners) {
    const Vec3 p = points_[corners[0]];
    Vec3 normal = cross(points_[corners[1]] - p, points_[corners[2]] - p);
    normal = (1 / norm(normal)) * normal;
    for (std::size_t k = 0; k < 3; ++k)
      face_at_[side(corners, k)] = static_cast<std::uint32_t>(faces_.size());
    faces_.push_back({corners, normal, dot(normal, p)});
  }

  double height(const Face& face, std::uint32_t i) const {
    return dot(face.normal, points_[i]) - face.offset;
  }

  /// Gives each point to the first face from `first` on that sees it. Others are within the hull.
  void hand_out(std::span<const std::uint32_t> points, std::size_t first) {
    for (const std::uint32_t i : points)
      for (std::size_t f = first; f < faces_.size(); ++f)
        if (!faces_[f].is_gone && height(faces_[f], i) > on_face * size_) {
          faces_[f].beyond.push_back(i);
          break;
        }
  }

  /// Replaces all faces that the farthest point beyond a face sees and that hang together with that one. So
  /// the surface stays closed where rounding leaves others in sight.
  void grow(std::uint32_t at) {
    const Face& face = faces_[at];
    const std::uint32_t top =
        best(face.beyond, on_face * size_, [&](Vec3 p) { return dot(face.normal, p) - face.offset; });
    Array<std::uint32_t> seen{at}, loose;
    std::set<Side> border;
    faces_[at].is_gone = true;
    for (std::size_t n = 0; n < seen.size(); ++n)
      for (std::size_t k = 0; k < 3; ++k) {
        const Side own = side(faces_[seen[n]].corners, k);
        const std::uint32_t next = beyond(face_at_, own, points_.size());
        if (!faces_[next].is_gone && height(faces_[next], top) > on_face * size_) {
          faces_[next].is_gone = true;
          seen.push_back(next);
        }
        border.insert(own);
      }
    for (const std::uint32_t i : seen) {
      loose.insert(loose.end(), faces_[i].beyond.begin(), faces_[i].beyond.end());
      for (std::size_t k = 0; k < 3; ++k) {
        const Side own = side(faces_[i].corners, k);
        if (faces_[beyond(face_at_, own, points_.size())].is_gone) border.erase(own);
      }
    }
    const std::size_t first = faces_.size();
    for (const Side& each : border) add({each.first, each.second, top});
    std::sort(loose.begin(), loose.end());
    std::erase(loose, top);
    hand_out(loose, first);
  }

  std::span<const Vec3> points_;
  double size_ = 0;
  Array<Face> faces_;
  Sides face_at_;
};

/// Joins triangles in one plane. Returns the number of each one's group.
Array<std::uint32_t> join_flat(std::span<const Quickhull::Face> faces, const Sides& sides,
                               std::span<const Vec3> points, double rounding) {
  Array<std::uint32_t> group(faces.size());
  std::iota(group.begin(), group.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const auto& [side, face] : sides) {
    const std::uint32_t other = beyond(sides, side, points.size());
    double most = 0;
    for (const std::uint32_t corner : faces[other].corners)
      most = std::max(most, std::abs(dot(faces[face].normal, points[corner]) - faces[face].offset));
    for (const std::uint32_t corner : faces[face].corners)
      most = std::max(most, std::abs(dot(faces[other].normal, points[corner]) - faces[other].offset));
    if (most > rounding) continue;
    const std::uint32_t a = root(face), b = root(other);
    group[std::max(a, b)] = std::min(a, b);
  }
  for (std::uint32_t i = 0; i < group.size(); ++i) group[i] = root(i);
  return group;
}

}  // namespace

void find_normals(const ConvexParts& parts, std::span<const Vec3> vertices, std::span<Vec3> normals) {
  for (std::uint32_t i = 0; i < parts.faces(); ++i) {
    const auto corners = parts.face(i);
    Vec3 sum{};
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      sum +=
          cross(vertices[corners[k]] - vertices[corners[0]], vertices[corners[k + 1]] - vertices[corners[0]]);
    normals[i] = (1 / norm(sum)) * sum;
  }
}

ConvexHull::ConvexHull(std::span<const Vec3> points) {
  const Quickhull grown(points);
  Array<Quickhull::Face> faces;
  for (const Quickhull::Face& face : grown.faces())
    if (!face.is_gone) faces.push_back(face);
  if (faces.empty()) return;
  Sides sides;
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) sides[{faces[i].corners[k], faces[i].corners[(k + 1) % 3]}] = i;
  const Array<std::uint32_t> group = join_flat(faces, sides, points, 10 * on_face * grown.size());
  // The border of each group is a face. Its sides follow each other by their corners.
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> borders;
  for (const auto& [side, face] : sides)
    if (group[beyond(sides, side, points.size())] != group[face])
      borders[group[face]][side.first] = side.second;
  std::map<std::uint32_t, std::uint32_t> number;  // of corners by point
  for (const auto& [face, border] : borders)
    for (const auto& [from, to] : border) number.try_emplace(from, 0);
  for (auto& [point, corner] : number) {
    corner = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(points[point]);
    numbers_.push_back(point);
  }
  Sides face_of;
  for (const auto& [face, border] : borders) {
    std::uint32_t at = border.begin()->first;
    for (std::size_t k = 0; k < border.size(); ++k) {
      const auto next = border.find(at);
      // It goes round once if it ends where it began, and not before.
      if (next == border.end() || (next->second == border.begin()->first) != (k + 1 == border.size()))
        refuse_open(points.size());
      parts_.corners.push_back(number.at(at));
      face_of[{number.at(at), number.at(next->second)}] = parts_.faces();
      at = next->second;
    }
    parts_.first_of.push_back(static_cast<std::uint32_t>(parts_.corners.size()));
  }
  for (const auto& [side, face] : face_of)
    if (side.first < side.second)
      parts_.edges.push_back({side.first, side.second, face, beyond(face_of, side, points.size())});
  if (vertices_.size() + parts_.faces() != parts_.edges.size() + 2) refuse_open(points.size());  // Euler
  normals_.resize(parts_.faces());
  find_normals(parts_, vertices_, normals_);
}

ConvexHull ConvexHull::moved_to(std::span<const Vec3> corners) const {
  ConvexHull out = *this;
  std::copy(corners.begin(), corners.end(), out.vertices_.begin());
  find_normals(parts_, out.vertices_, out.normals_);
  return out;
}

Bounds ConvexHull::bounds() const {
  Bounds out = nowhere;
  for (const Vec3 v : vertices_) include(out, v, 0);
  return out;
}

}  // namespace plumb::detail
