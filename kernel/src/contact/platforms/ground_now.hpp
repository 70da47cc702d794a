#pragma once

#include <span>

#include "contact/surroundings.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Knows where all ground is at an instant within a step, and how fast it moves there.
class GroundNow {
 public:
  /// Finds where ground is `time` (s) after the step's start. The surroundings must stay as they are until it
  /// is called again.
  void find(const Surroundings& surroundings, double time);

  std::span<const Plane> planes() const { return planes_; }
  std::span<const Surroundings::Solid> boxes() const { return boxes_; }
  /// Returns the middles of shapes on anchors.
  std::span<const Segment> segments() const { return segments_; }
  std::span<const Linkage::Shape> shapes() const { return shapes_; }
  /// Returns a box on a platform, or a shape on anchors, as a solid. It stands until find() is called.
  Convex solid_of_box(std::size_t i) const {
    const std::size_t corners = cube_->vertices().size(), faces = cube_->parts().faces();
    return {std::span(corners_).subspan(i * corners, corners), std::span(normals_).subspan(i * faces, faces),
            &cube_->parts()};
  }
  Convex solid_of_segment(std::size_t i) const {
    const std::span<const Vec3> line = std::span(ends_).subspan(2 * i, 2);
    return {.vertices = line.first(line[0] == line[1] ? 1 : 2), .normals = {}, .radius = segments_[i].radius};
  }
  /// These return null for what stands still.
  const GroundRate* rate_of_plane(std::size_t i) const { return moving(plane_rates_, i); }
  const GroundRate* rate_of_box(std::size_t i) const { return moving(box_rates_, i); }
  const GroundRate* rate_of_segment(std::size_t i) const { return moving(segment_rates_, i); }

 private:
  static const GroundRate* moving(const Array<GroundRate>& rates, std::size_t i) {
    return i < rates.size() && rates[i].moves() ? &rates[i] : nullptr;
  }
  template <class Ground>
  void pose(std::span<const Ground> ground, Array<Ground>& there, Array<GroundRate>& rates) const;
  void find_corners();

  std::span<const Plane> planes_;
  std::span<const Surroundings::Solid> boxes_;
  std::span<const Linkage::Shape> shapes_;
  // Of scenes where some ground may move:
  Array<PlatformPose> poses_;
  Array<Plane> moved_planes_;
  Array<Surroundings::Solid> moved_boxes_;
  Array<Segment> segments_;
  Array<Vec3> anchors_;            ///< m, by particle
  Array<Vec3> corners_, normals_;  ///< by box, of those on platforms
  Array<Vec3> ends_;               ///< m, of the middles of shapes on anchors
  const ConvexHull* cube_ = nullptr;
  Array<GroundRate> plane_rates_, box_rates_, segment_rates_;
};

/// Returns the greatest speed (m/s) of ground within a box, but for its belts, in the next `dt` (s). That of
/// null is 0.
double fastest(const GroundRate* rate, const Bounds& bounds, double dt);

}  // namespace plumb::detail
