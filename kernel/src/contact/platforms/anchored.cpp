#include "contact/platforms/anchored.hpp"

#include <algorithm>

#include "contact/levers/lever.hpp"
#include "contact/levers/shape_maker.hpp"
#include "contact/surroundings.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb::detail {

namespace {

/// Calls f(anchor) for the fixed particles that hold a shape.
template <class F>
void for_anchors(const Linkage::Shape& shape, F&& f) {
  for (const Terms place : {shape.a, shape.b})
    for (const auto& [anchor, weight] : place) f(anchor);
  if (shape.turning == Linkage::Shape::Turning::body)
    for (const std::uint32_t anchor : shape.turners) f(anchor);
}

}  // namespace

bool is_anchored(const Scene& scene, const Capsule& capsule) {
  return !moves(scene, capsule.a) && !moves(scene, capsule.b);
}

Anchored::Anchored(const Scene& scene) {
  if (std::none_of(scene.capsules.begin(), scene.capsules.end(),
                   [&](const Capsule& capsule) { return is_anchored(scene, capsule); }))
    return;
  const ShapeMaker maker(scene);
  for (const Capsule& capsule : scene.capsules) {
    if (!is_anchored(scene, capsule)) continue;
    for_anchors(shapes_.emplace_back(maker.make(capsule, places_)),
                [&](std::uint32_t anchor) { anchors_.push_back(anchor); });
  }
  std::sort(anchors_.begin(), anchors_.end());
  anchors_.erase(std::unique(anchors_.begin(), anchors_.end()), anchors_.end());
  x_.resize(scene.particles.size());
  v_.resize(scene.particles.size());
  for (const std::uint32_t anchor : anchors_) x_[anchor] = scene.particles[anchor].position;
}

bool Anchored::reach_into(const Bounds& box, std::span<const std::uint32_t> anchors,
                          std::span<const Filter> filters) const {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    bool is_held = false;
    for_anchors(shapes_[i], [&](std::uint32_t anchor) {
      is_held = is_held || std::find(anchors.begin(), anchors.end(), anchor) != anchors.end();
    });
    if (is_held && may_touch(filters, shapes_[i].filter) && bounds(i).overlaps(box)) return true;
  }
  return false;
}

void Anchored::find_positions(double t, Array<Vec3>& x) const {
  x.resize(x_.size());
  for (const std::uint32_t anchor : anchors_) x[anchor] = x_[anchor] + t * v_[anchor];
}

Segment Anchored::segment(std::size_t shape, std::span<const Vec3> x) const {
  const Linkage::Shape& of = shapes_[shape];
  return {of.a.of(x), of.b.of(x), of.radius};
}

Bounds Anchored::bounds(std::size_t shape) const {
  const Segment there = segment(shape, x_);
  return grown(box_around(there.p, there.q), there.radius);
}

GroundRate Anchored::rate(std::size_t shape, std::span<const Vec3> x) const {
  const Linkage::Shape& of = shapes_[shape];
  GroundRate out{.center = of.a.of(x), .velocity = of.a.of(v_)};
  const Lever lever(of, of.a, {}, x);
  if (!lever.turns()) return out;
  const auto about = [&](Vec3 axis) {
    const Lever::Rate turning = lever.turning(axis);
    return dot(turning.along_a, turning.a.of(v_)) + dot(turning.along_b, turning.b.of(v_));
  };
  out.spin = {about({1, 0, 0}), about({0, 1, 0}), about({0, 0, 1})};
  return out;
}

bool Anchored::any_moves() const {
  return std::any_of(anchors_.begin(), anchors_.end(),
                     [&](std::uint32_t anchor) { return v_[anchor] != Vec3{}; });
}

}  // namespace plumb::detail
