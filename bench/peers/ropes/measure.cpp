#include "measure.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contact/shapes/touch.hpp"

namespace plumb::bench {

std::vector<Rope> ropes_of(const Scene& scene) {
  std::vector<Rope> out;
  if (scene.capsules.size() != scene.rods.size() || scene.meshes.size() != 1)
    throw std::invalid_argument("the scene is not one of ropes with a capsule around every rod on one mesh");
  for (const Rod& rod : scene.rods) {
    if (rod.b != rod.a + 1) throw std::invalid_argument("a rod is not from a particle to the next one");
    if (out.empty() || rod.a != out.back().first + out.back().links) out.push_back({rod.a, 0});
    ++out.back().links;
  }
  return out;
}

DepthMeter::DepthMeter(const Scene& scene)
    : scene_(&scene),
      radius_(scene.capsules.at(0).radius),
      mesh_(scene.meshes.at(0).vertices, scene.meshes[0].triangles, detail::MeshSides::outward) {
  const std::vector<Rope> ropes = ropes_of(scene);
  for (std::uint32_t i = 0; i < ropes.size(); ++i) rope_of_.insert(rope_of_.end(), ropes[i].links, i);
}

Depths DepthMeter::measure(std::span<const Vec3> positions) {
  Depths out;
  const detail::Bounds around = mesh_.bounds();
  for (const Vec3 at : positions) {
    if (!(at.x > around.low.x && at.x < around.high.x && at.z > around.low.z && at.z < around.high.z)) {
      ++out.lost;
      continue;
    }
    // What is far below is through.
    if (at.y > around.high.y + radius_) continue;
    const detail::TriangleMesh::Nearest near = mesh_.nearest(at, norm(around.high - around.low));
    const detail::MeshPart part = mesh_.part(near.triangle, near.place.part);
    const bool is_below = dot(mesh_.outward(part), at - near.place.at) < 0;
    out.through += is_below;
    out.in_ground = std::max(out.in_ground, radius_ - (is_below ? -near.distance : near.distance));
  }
  out.in_ropes = overlap_of_ropes(positions);
  return out;
}

double DepthMeter::overlap_of_ropes(std::span<const Vec3> positions) {
  double deepest = 0;
  const auto segment = [&](std::uint32_t i) {
    const Rod& rod = scene_->rods[i];
    return detail::Segment{positions[rod.a], positions[rod.b], radius_};
  };
  const auto count = static_cast<std::uint32_t>(scene_->rods.size());
  hash_.start(norm(positions[scene_->rods[0].b] - positions[scene_->rods[0].a]) + 2 * radius_, 4 * count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const detail::Segment own = segment(i);
    detail::Bounds around = detail::nowhere;
    include(around, own.p, radius_);
    include(around, own.q, radius_);
    hash_.find_and_insert(i, around, [&](std::uint32_t j) {
      if (rope_of_[i] != rope_of_[j]) deepest = std::max(deepest, -touch(own, segment(j)).gap);
    });
  }
  return deepest;
}

}  // namespace plumb::bench
