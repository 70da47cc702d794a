#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/shapes/queries.hpp"
#include "queries/things.hpp"
#include "step/breaks/numbers.hpp"

namespace plumb::detail {

/// Lists what of a world the scene of queries does not tell: the rods and particles that no shape and no body
/// shows, and the capsules and hulls that were added since.
class Bare {
 public:
  Bare(const Scene& scene, const QuerySettings& settings);

  using HasShape = std::function<bool(ShapeId)>;
  /// Takes those that are there, in the scene as it is now.
  void find(const Scene& now, const Population& population, const HasShape& has_shape);

  std::span<const BareRod> rods() const { return rods_; }
  std::span<const std::uint32_t> particles() const { return particles_; }
  std::span<const AddedShape> shapes() const { return shapes_; }

 private:
  void find_added(const Scene& now, const Population& population, const HasShape& has_shape);

  bool finds_rods_, finds_particles_;
  Array<std::uint8_t> shown_rods_, shown_particles_;  ///< of the scene
  Array<BareRod> rods_;
  Array<std::uint32_t> particles_;
  ByKind<std::uint32_t> first_;  ///< how many the scene has
  Array<AddedShape> shapes_;
  Array<std::pair<std::uint32_t, std::uint32_t>> added_pairs_;  ///< particles that those join, ascending
  Array<std::uint32_t> added_at_;                               ///< particles that they are at, ascending
};

}  // namespace plumb::detail
