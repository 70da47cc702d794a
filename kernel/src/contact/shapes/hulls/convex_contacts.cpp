#include <algorithm>
#include <cmath>

#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/touch.hpp"

namespace plumb::detail {
namespace {

/// A face is clipped if the normal has at least this cosine with its own. What is farther off touches at one
/// place.
constexpr double flatly = 0.9;
/// Where the cosine is smaller than this, edges cross, and shapes are also kept apart along the normal.
/// Pushes along a face's alone would let one edge slide through the other.
constexpr double along_face = 0.99;
/// Of faces with more corners than these, corners at even distances stand for all.
constexpr std::uint32_t most_corners = 48;
/// Of equally good faces that of a counts, unless the other is better by this much.
constexpr double better = 1e-3;
/// Places closer than this share of the size are one.
constexpr double same_place = 1e-6;
/// What is beyond a face by less than this share of its shortest edge is still over it, if both faces are
/// parallel to within this cosine. Boxes that are stacked exactly would else touch in other places in every
/// substep. What is farther beyond is cut nearer to the face, by this share of how much farther.
constexpr double overhang = 5e-4, parallel = 1 - 1e-5, fading = 0.1;

/// This is a convex polygon. Every corner has a key, by the corner or the edges that it comes from.
struct Polygon {
  std::array<Vec3, 2 * most_corners> at;
  std::array<std::uint64_t, 2 * most_corners> keys;
  std::uint32_t count = 0;

  void add(Vec3 p, std::uint64_t key) {
    if (count == at.size()) thin();
    at[count] = p;
    keys[count++] = key;
  }

 private:
  /// Keeps every second corner, so that what is left is about as wide all around.
  void thin() {
    for (std::uint32_t i = 0; 2 * i < count; ++i) {
      at[i] = at[2 * i];
      keys[i] = keys[2 * i];
    }
    count = (count + 1) / 2;
  }
};

/// Returns the key of a corner where the edge between two others is cut.
std::uint64_t key_of_cut(std::uint64_t from, std::uint64_t to, std::uint64_t number) {
  std::uint64_t mixed = from * 0x9e3779b97f4a7c15 ^ to;
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9 ^ number;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111eb;
  return std::uint64_t{1} << 63 | mixed >> 1;
}

struct Facing {
  std::uint32_t face = 0;
  double cosine = -2;
};

/// Finds the face that looks most along a unit vector.
Facing facing(const Convex& shape, Vec3 along) {
  Facing best;
  for (std::uint32_t i = 0; i < shape.normals.size(); ++i)
    if (const double cosine = dot(shape.normals[i], along); cosine > best.cosine) best = {i, cosine};
  return best;
}

Polygon polygon_of(const Convex& shape, Vec3 along) {
  Polygon out;
  if (shape.faces() == 0) {
    for (std::uint32_t i = 0; i < shape.vertices.size(); ++i) out.add(shape.vertices[i], i);
    return out;
  }
  const auto corners = shape.parts->face(facing(shape, along).face);
  const auto all = static_cast<std::uint32_t>(corners.size()), count = std::min(all, most_corners);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t corner = corners[std::size_t{i} * all / count];
    out.add(shape.vertices[corner], corner);
  }
  return out;
}

/// Cuts off what is beyond a plane, dot(normal, x) > offset, by more than the slack. What is so by a little
/// more is cut at the slack, and the farther it is, the nearer to the plane, so that no place jumps.
///
/// New corners have the keys of the first and the last one that is cut off, so that what slides over an edge
/// stays the same contact. Where one corner alone is cut off, the second new one has a key of the cut edge
/// and the plane's number.
Polygon cut(const Polygon& polygon, Vec3 normal, double offset, double slack, std::uint32_t number) {
  Polygon out;
  const std::uint32_t n = polygon.count;
  const auto beyond = [&](std::uint32_t i) { return dot(normal, polygon.at[i % n]) - offset; };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    const double here = beyond(i), there = beyond(next);
    const bool leaves = there > slack, returns = here > slack;
    if (!returns) out.add(polygon.at[i], polygon.keys[i]);
    if (leaves == returns || (n == 2 && i == 1)) continue;
    const bool is_second = returns && n > 2 && beyond(i + n - 1) <= slack;
    const std::uint64_t key = is_second ? key_of_cut(polygon.keys[i], polygon.keys[next], number)
                                        : polygon.keys[returns ? i : next];
    const auto [inner, outer] = std::minmax(here, there);
    const double where = std::max({0.0, inner, slack - fading * (outer - slack)});
    out.add(between(polygon.at[i], polygon.at[next], (here - where) / (here - there)), key);
  }
  return out;
}

/// Takes what of a polygon is over a face, or beyond its edges by no more than a share of the shortest.
Polygon clip(Polygon polygon, const Convex& shape, std::uint32_t face, double share) {
  const auto corners = shape.parts->face(face);
  const auto count = static_cast<std::uint32_t>(corners.size());
  double shortest = INFINITY;
  for (std::uint32_t i = 0; i < count; ++i)
    shortest =
        std::min(shortest, norm(shape.vertices[corners[(i + 1) % count]] - shape.vertices[corners[i]]));
  for (std::uint32_t i = 0; i < count && polygon.count > 0; ++i) {
    const Vec3 p = shape.vertices[corners[i]], q = shape.vertices[corners[(i + 1) % count]];
    const Vec3 out = cross(q - p, shape.normals[face]);
    polygon = cut(polygon, out, dot(out, p), share * shortest * norm(out), corners[i]);
  }
  return polygon;
}

}  // namespace

std::uint32_t spread(std::span<ConvexContact> list) {
  if (list.size() <= ConvexContacts::most) return static_cast<std::uint32_t>(list.size());
  const auto first = std::min_element(
      list.begin(), list.end(), [](const ConvexContact& a, const ConvexContact& b) { return a.gap < b.gap; });
  std::swap(*first, list[0]);
  constexpr std::size_t count = ConvexContacts::most;
  for (std::size_t kept = 1; kept < count; ++kept) {
    double most = -1;
    std::size_t farthest = kept;
    for (std::size_t i = kept; i < list.size(); ++i) {
      double least = INFINITY;
      for (std::size_t k = 0; k < kept; ++k) {
        const Vec3 apart = list[i].on_a - list[k].on_a;
        least = std::min(least, dot(apart, apart));
      }
      if (least > most) {
        most = least;
        farthest = i;
      }
    }
    std::swap(list[kept], list[farthest]);
  }
  std::sort(list.begin(), list.begin() + count,
            [](const ConvexContact& a, const ConvexContact& b) { return a.key < b.key; });
  return count;
}

ConvexContacts contacts_of(const Convex& a, const Convex& b, double reach) {
  ConvexContacts out;
  const double radii = a.radius + b.radius;
  const Nearness near = nearness(a, b);
  if (near.distance - radii > reach) return out;
  std::array<ConvexContact, 2 * most_corners> found;
  std::uint32_t count = 0;
  const Facing of_a = facing(a, -1.0 * near.normal), of_b = facing(b, near.normal);
  const bool over_b = of_b.cosine > of_a.cosine + better;
  const Convex &base = over_b ? b : a, &other = over_b ? a : b;
  const Facing face = over_b ? of_b : of_a;
  double narrowest = INFINITY;
  if (face.cosine >= flatly) {
    const Vec3 n = base.normals[face.face], from = base.vertices[base.parts->face(face.face)[0]];
    const bool is_parallel = facing(other, -1.0 * n).cosine > parallel;
    const Polygon polygon = clip(polygon_of(other, -1.0 * n), base, face.face, is_parallel ? overhang : 0);
    for (std::uint32_t i = 0; i < polygon.count; ++i) {
      const double distance = dot(n, polygon.at[i] - from);
      if (distance - radii > reach) continue;
      const Vec3 foot = polygon.at[i] - distance * n;
      narrowest = std::min(narrowest, distance);
      found[count++] = over_b
                           ? ConvexContact{distance - radii, n, polygon.at[i], foot, polygon.keys[i]}
                           : ConvexContact{distance - radii, -1.0 * n, foot, polygon.at[i], polygon.keys[i]};
    }
  }
  // The nearest places are among them where a face is met flatly. Elsewhere they come, too.
  const bool are_among =
      face.cosine >= along_face &&
      narrowest <= near.distance + same_place * norm(base.vertices[0] - base.vertices.back());
  if (!are_among && count < found.size())
    found[count++] = {near.distance - radii, near.normal, near.on_a, near.on_b, ~std::uint64_t{0}};
  out.count = spread({found.data(), count});
  std::copy_n(found.begin(), out.count, out.list.begin());
  return out;
}

}  // namespace plumb::detail
