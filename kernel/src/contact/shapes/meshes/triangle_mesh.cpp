#include "contact/shapes/meshes/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "math/elementary.hpp"
#include "scene/ground/weld.hpp"

namespace plumb::detail {
namespace {

/// A direction leans towards a triangle if its cosine with it is above this. A larger value turns what slides
/// over edges by as much.
constexpr double leaning = 1e-8;
/// Two triangles lie in one plane if the sine of the angle between them is below this (rad). A capsule of
/// length l may then dip by l/4 of it where they meet.
constexpr double flat = 1e-4;

Vec3 unit(Vec3 v) {
  return (1 / norm(v)) * v;
}

}  // namespace

TriangleMesh::TriangleMesh(std::span<const Vec3> vertices, std::span<const Corners> triangles,
                           MeshSides sides)
    : sides_(sides) {
  vertices_.assign(vertices.begin(), vertices.end());
  triangles_.assign(triangles.begin(), triangles.end());
  const Array<std::uint32_t> first = weld(vertices);
  for (Corners& corners : triangles_)
    for (std::uint32_t& corner : corners) corner = first[corner];
  Array<Bounds> boxes;
  boxes.reserve(triangles_.size());
  for (std::uint32_t i = 0; i < size(); ++i) {
    const Triangle t = triangle(i);
    normals_.push_back(unit(cross(t[1] - t[0], t[2] - t[0])));
    Bounds& box = boxes.emplace_back(nowhere);
    for (const Vec3 corner : t) include(box, corner, 0);
  }
  connect();
  weigh();
  tree_ = BoundsTree(boxes);
}

/// Finds the edges and which triangles meet there.
void TriangleMesh::connect() {
  struct Side {
    std::uint32_t low, high, triangle, place;
  };
  Array<Side> sides;
  sides.reserve(3 * triangles_.size());
  for (std::uint32_t i = 0; i < size(); ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles_[i][k], triangles_[i][(k + 1) % 3]);
      sides.push_back({low, high, i, k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle, a.place) < std::tie(b.low, b.high, b.triangle, b.place);
  });
  edges_of_.resize(triangles_.size());
  const auto inward = [&](const Side& side) {
    const Vec3 a = vertices_[side.low], along = unit(vertices_[side.high] - a);
    const Vec3 to = vertices_[triangles_[side.triangle][(side.place + 2) % 3]] - a;
    return unit(to - dot(to, along) * along);
  };
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Side& side = sides[k];
    if (edges_.empty() || edges_.back().a != side.low || edges_.back().b != side.high ||
        edges_.back().triangle[1] != none) {
      edges_.push_back({side.low, side.high, {side.triangle, none}, {inward(side), {}}, false});
    } else {
      Edge& edge = edges_.back();
      edge.triangle[1] = side.triangle;
      edge.inward[1] = inward(side);
      edge.is_flat = norm(edge.inward[0] + edge.inward[1]) < flat;
    }
    edges_of_[side.triangle][side.place] = static_cast<std::uint32_t>(edges_.size() - 1);
  }
}

/// Finds the spokes and the weighted normals of vertices.
void TriangleMesh::weigh() {
  const std::size_t count = vertices_.size();
  first_spoke_.assign(count + 1, 0);
  outward_.assign(count, Vec3{});
  owners_.assign(count, none);
  on_border_.assign(count, 0);
  is_flat_.assign(count, 1);
  for (const Edge& edge : edges_) {
    ++first_spoke_[edge.a + 1];
    ++first_spoke_[edge.b + 1];
    if (edge.triangle[1] == none) on_border_[edge.a] = on_border_[edge.b] = 1;
    if (!edge.is_flat) is_flat_[edge.a] = is_flat_[edge.b] = 0;
  }
  std::partial_sum(first_spoke_.begin(), first_spoke_.end(), first_spoke_.begin());
  spokes_.resize(first_spoke_.back());
  Array<std::uint32_t> next(first_spoke_.begin(), first_spoke_.end() - 1);
  for (const Edge& edge : edges_) {
    const Vec3 along = unit(vertices_[edge.b] - vertices_[edge.a]);
    spokes_[next[edge.a]++] = along;
    spokes_[next[edge.b]++] = -1.0 * along;
  }
  for (std::uint32_t i = 0; i < size(); ++i) {
    const Triangle t = triangle(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = unit(t[(k + 1) % 3] - t[k]), v = unit(t[(k + 2) % 3] - t[k]);
      const std::uint32_t vertex = triangles_[i][k];
      outward_[vertex] += acos(std::clamp(dot(u, v), -1.0, 1.0)) * normals_[i];
      owners_[vertex] = std::min(owners_[vertex], i);
    }
  }
}

MeshPart TriangleMesh::part(std::uint32_t triangle, TrianglePart of) const {
  using enum MeshPart::Kind;
  const auto k = static_cast<std::size_t>(of);
  if (k < 3) return {vertex, triangles_[triangle][k]};
  return k < 6 ? MeshPart{edge, edges_of_[triangle][k - 3]} : MeshPart{face, triangle};
}

bool TriangleMesh::is_peak(std::uint32_t vertex, Vec3 n) const {
  for (std::uint32_t k = first_spoke_[vertex]; k < first_spoke_[vertex + 1]; ++k)
    if (dot(spokes_[k], n) > leaning) return false;
  return true;
}

bool TriangleMesh::faces(MeshPart part, Vec3 n) const {
  if (part.kind == MeshPart::Kind::face) return true;
  if (part.kind == MeshPart::Kind::vertex) return is_peak(part.number, n);
  const Edge& edge = edges_[part.number];
  return dot(edge.inward[0], n) <= leaning && dot(edge.inward[1], n) <= leaning;
}

Vec3 TriangleMesh::outward(MeshPart part) const {
  if (part.kind == MeshPart::Kind::face) return normals_[part.number];
  if (part.kind == MeshPart::Kind::vertex) return outward_[part.number];
  const Edge& edge = edges_[part.number];
  return normals_[edge.triangle[0]] + (edge.triangle[1] == none ? Vec3{} : normals_[edge.triangle[1]]);
}

bool TriangleMesh::leads_inside(MeshPart part, Vec3 n) const {
  if (sides_ == MeshSides::both) return false;
  const bool border = part.kind == MeshPart::Kind::edge     ? edges_[part.number].triangle[1] == none
                      : part.kind == MeshPart::Kind::vertex ? on_border_[part.number] != 0
                                                            : false;
  return !border && dot(outward(part), n) < 0;
}

auto TriangleMesh::nearest(Vec3 p, double most) const -> Nearest {
  Nearest out;
  double least = std::nextafter(most * most, INFINITY);
  tree_.find_nearest(p, least, [&](std::uint32_t i) {
    const TrianglePlace place = nearest_on(triangle(i), p);
    const Vec3 apart = p - place.at;
    const double square = dot(apart, apart);
    if (square < least) {
      least = square;
      out = {i, place, 0};
    }
    return square;
  });
  if (out.triangle != none) out.distance = norm(p - out.place.at);
  return out;
}

}  // namespace plumb::detail
