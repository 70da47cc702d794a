#pragma once

#include <cstdint>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/shapes/contact.hpp"

namespace plumb::detail {

/// Numbers all ground of a scene: planes, boxes, capsules on anchors, then ground capsules and what follows
/// them in ShapeKind.
class GroundNumbers {
 public:
  explicit GroundNumbers(const Scene& scene);

  std::uint32_t count() const { return static_cast<std::uint32_t>(ids_.size()); }
  std::uint32_t of_plane(std::uint32_t i) const { return i; }
  std::uint32_t of_box(std::uint32_t i) const { return boxes_ + i; }
  /// Numbers the capsules on anchors, and what neither they nor planes nor boxes are, by their places among
  /// themselves.
  std::uint32_t of_anchored(std::uint32_t i) const { return anchored_ + i; }
  std::uint32_t of_other(std::uint32_t i) const { return others_ + i; }
  /// Returns what the scene calls it.
  ShapeId id(std::uint32_t number) const { return ids_[number]; }
  /// Returns the number of ground that the scene has, but for capsules on anchors.
  std::uint32_t of(ShapeId id) const;

 private:
  Array<ShapeId> ids_;
  std::uint32_t boxes_ = 0, anchored_ = 0, others_ = 0;  ///< where these begin
};

}  // namespace plumb::detail
