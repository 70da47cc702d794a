#include "contact/ground/ground_numbers.hpp"

#include <algorithm>

#include "contact/platforms/anchored.hpp"

namespace plumb::detail {

GroundNumbers::GroundNumbers(const Scene& scene) {
  const auto add = [&](ShapeKind kind, std::size_t count) {
    for (std::uint32_t i = 0; i < count; ++i) ids_.push_back({kind, i});
    return this->count();
  };
  boxes_ = add(ShapeKind::plane, scene.planes.size());
  anchored_ = add(ShapeKind::box, scene.boxes.size());
  for (std::uint32_t i = 0; i < scene.capsules.size(); ++i)
    if (is_anchored(scene, scene.capsules[i])) ids_.push_back({ShapeKind::capsule, i});
  others_ = count();
  add(ShapeKind::ground_capsule, scene.ground_capsules.size());
  add(ShapeKind::ground_hull, scene.ground_hulls.size());
  add(ShapeKind::mesh, scene.meshes.size());
  add(ShapeKind::height_field, scene.height_fields.size());
}

std::uint32_t GroundNumbers::of(ShapeId id) const {
  const auto is_first = [&](const ShapeId& each) { return each.kind == id.kind; };
  return static_cast<std::uint32_t>(std::find_if(ids_.begin(), ids_.end(), is_first) - ids_.begin()) +
         id.number;
}

}  // namespace plumb::detail
