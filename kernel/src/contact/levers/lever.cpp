#include "contact/levers/lever.hpp"

#include <cmath>

#include "scene/barycentric.hpp"

namespace plumb::detail {

std::array<Vec3, 2> across(Vec3 n) {
  const Vec3 other = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 t = cross(n, other);
  const Vec3 first = (1 / norm(t)) * t;
  return {first, cross(n, first)};
}

Lever::Lever(const Linkage::Shape& shape, Terms at, Vec3 arm, std::span<const Vec3> x)
    : kind_(shape.turning), place_(at), line_(shape.line()), particles_(shape.turners), arm_(arm) {
  if (kind_ == Linkage::Shape::Turning::line) {
    const Vec3 line = line_.of(x);
    const double length = norm(line);
    over_ = length > 0 ? 1 / length : 0;
    direction_ = over_ * line;
  } else if (kind_ == Linkage::Shape::Turning::body) {
    const Barycentric body({x[particles_[0]], x[particles_[1]], x[particles_[2]], x[particles_[3]]});
    gradients_ = body.gradients();
    const std::array<double, 4> weights = body.weights(at.of(x) + arm);
    place_.count = 4;
    for (std::uint32_t i = 0; i < 4; ++i) place_.terms[i] = {particles_[i], weights[i]};
  }
}

Lever::Rate Lever::sliding(Vec3 t) const {
  if (kind_ != Linkage::Shape::Turning::line) return {.a = place_, .along_a = t};
  // The line turns at u x w with w = line'/length, which moves the surface by (u x w) x arm.
  return {.a = place_,
          .b = line_,
          .along_a = t,
          .along_b = over_ * (dot(direction_, arm_) * t - dot(t, direction_) * arm_)};
}

Lever::Rate Lever::turning(Vec3 axis) const {
  if (kind_ != Linkage::Shape::Turning::body) return {.a = line_, .along_a = over_ * cross(axis, direction_)};
  // A field of velocities that is linear in space turns at half its curl.
  Rate out;
  const auto [u, v] = across(axis);
  out.along_a = u;
  out.along_b = v;
  out.a.count = out.b.count = 4;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Vec3 along = 0.5 * cross(axis, gradients_[i]);
    out.a.terms[i] = {particles_[i], dot(along, u)};
    out.b.terms[i] = {particles_[i], dot(along, v)};
  }
  return out;
}

}  // namespace plumb::detail
