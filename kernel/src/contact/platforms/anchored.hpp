#pragma once

#include <cstdint>
#include <span>

#include "contact/linkage/linkage.hpp"
#include "contact/platforms/ground_rate.hpp"
#include "contact/shapes/bounds.hpp"
#include "contact/shapes/touch.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Knows shapes on fixed particles alone, which are ground that goes where its anchors go.
class Anchored {
 public:
  explicit Anchored(const Scene& scene);

  /// Returns the shapes. Their sums name particles by the scene's numbers.
  std::span<const Linkage::Shape> shapes() const { return shapes_; }
  /// Returns the scene's numbers of the anchors that hold them.
  std::span<const std::uint32_t> anchors() const { return anchors_; }
  /// Sets where an anchor is (m) at the step's start, and its velocity (m/s) in it.
  void set(std::uint32_t anchor, Vec3 position, Vec3 velocity) {
    x_[anchor] = position;
    v_[anchor] = velocity;
  }
  /// Puts one elsewhere between two steps.
  void put(std::uint32_t anchor, Vec3 position) {
    if (anchor < x_.size()) x_[anchor] = position;
  }
  /// Returns whether a shape that one of `anchors` holds, and shapes with such filters may touch, reaches
  /// into a box.
  bool reach_into(const Bounds& box, std::span<const std::uint32_t> anchors,
                  std::span<const Filter> filters) const;
  /// Returns where particles are (m) at the step's start. Those of anchors() are known.
  std::span<const Vec3> positions() const { return x_; }
  /// Finds where anchors are `t` (s) later.
  void find_positions(double t, Array<Vec3>& x) const;
  /// Returns a shape's middle with anchors at `x`, and how the shape moves there.
  Segment segment(std::size_t shape, std::span<const Vec3> x) const;
  GroundRate rate(std::size_t shape, std::span<const Vec3> x) const;
  /// Returns the box around a shape at the step's start.
  Bounds bounds(std::size_t shape) const;
  template <class Archive>
  void archive(Archive& archive) {
    auto& [places, shapes, anchors, x, v] = *this;
    archive(x, v);
  }
  /// Returns whether some anchor moves in this step.
  bool any_moves() const;

 private:
  TermPool places_;  ///< of shapes
  Array<Linkage::Shape> shapes_;
  Array<std::uint32_t> anchors_;
  Array<Vec3> x_, v_;  ///< by particle, m and m/s; none if there are no shapes
};

/// Returns whether all particles that hold a capsule are fixed.
bool is_anchored(const Scene& scene, const Capsule& capsule);

}  // namespace plumb::detail
