#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/shapes/meshes/triangle_mesh.hpp"
#include "contact/spatial_hash.hpp"
#include "faller.hpp"

namespace plumb::bench {

/// Says how well ropes are kept out of the ground and of each other at an instant.
struct Depths {
  double in_ground = 0;       ///< m, the deepest particle's
  double in_ropes = 0;        ///< m, the deepest overlap of rods of two ropes
  std::uint32_t through = 0;  ///< particles whose centre is below the ground
  std::uint32_t lost = 0;     ///< particles beside the ground, which count nowhere else
};

/// Measures depths in the mesh of a scene and between its ropes.
class DepthMeter {
 public:
  explicit DepthMeter(const Scene& scene);
  Depths measure(std::span<const Vec3> positions);

 private:
  double overlap_of_ropes(std::span<const Vec3> positions);

  const Scene* scene_;
  double radius_;
  detail::TriangleMesh mesh_;
  std::vector<std::uint32_t> rope_of_;  ///< by capsule
  detail::SpatialHash hash_;
};

}  // namespace plumb::bench
