#pragma once

#include <array>
#include <span>

#include "contact/linkage/linkage.hpp"

namespace plumb::detail {

/// This is the way from a shape's middle to where it is touched. Friction acts there and turns the shape.
///
/// A shape on a body is touched at a place of the body, a sum of its four particles. A shape along a line
/// turns as the line does and has no spin about it. A ball on one particle does not turn.
class Lever {
 public:
  /// `at` is the place on the shape's middle, and `arm` (m) leads from there to the surface, with particles
  /// at `x`.
  Lever(const Linkage::Shape& shape, Terms at, Vec3 arm, std::span<const Vec3> x);

  /// Returns whether the shape turns.
  bool turns() const { return kind_ != Linkage::Shape::Turning::none; }

  /// This is a velocity (m/s or 1/s): that of one sum of particles along a direction, and of another.
  struct Rate {
    Combination a{}, b{};
    Vec3 along_a{}, along_b{};
  };
  /// Returns how fast the surface moves along the unit vector `t`.
  Rate sliding(Vec3 t) const;
  /// Returns how fast the shape turns about the unit vector `axis`.
  Rate turning(Vec3 axis) const;

 private:
  Linkage::Shape::Turning kind_;
  Combination place_{}, line_{};
  std::array<std::uint32_t, 4> particles_{};
  std::array<Vec3, 4> gradients_{};  ///< 1/m, of the weights of a body's place
  Vec3 arm_, direction_{};           ///< the line's direction, a unit vector
  double over_ = 0;                  ///< 1/m, the line's length
};

/// Returns two unit vectors at right angles to each other and to the unit vector n.
std::array<Vec3, 2> across(Vec3 n);

}  // namespace plumb::detail
