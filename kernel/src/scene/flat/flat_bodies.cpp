#include "scene/flat/flat_bodies.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "scene/second_moments.hpp"

namespace plumb::detail {
namespace {

/// A body is thin along an axis if it reaches less far there than this share of its length. A tetrahedron
/// that is flatter is hard to keep in shape: on that of four_points() a top, whose disc is 1 mm thick and
/// 20 cm wide, errs by 0.1 mm however short steps are.
constexpr double thin = 1e-2;
/// A mass matrix whose moments differ by more than this factor would lose four digits of a solve.
constexpr double singular = 1e-4;

}  // namespace

std::array<Vec3, 4> body_points(const MassProperties& body) {
  const Principal second = principal_axes(second_moments(body.inertia));
  std::array<double, 3> reach;  // standard deviation of the mass along each axis, m
  for (std::size_t k = 0; k < 3; ++k) reach[k] = std::sqrt(std::max(second.moment[k], 0.0) / body.mass);
  const double length = reach[2];
  if (!(reach[0] < thin * length)) {
    const std::array<PointMass, 4> points = four_points(body);
    return {points[0].position, points[1].position, points[2].position, points[3].position};
  }
  // One place stands off the triangle of the others, at the height at which it would weigh a quarter if the
  // body were as thick as `stand_in` says. One corner of that triangle likewise stands off the other two, at
  // the height at which it would weigh a third of the rest.
  const auto stand_in = [&](double of) { return of < thin * length ? length : of; };
  const double up = std::sqrt(3) * stand_in(reach[0]);
  const double over_rest = reach[0] * reach[0] / (up * up);  // its mass over that of the rest
  const double rest = 1 / (1 + over_rest);                   // that of the rest over the body's
  const double across = reach[1] / std::sqrt(rest);
  const double out = std::sqrt(2) * stand_in(reach[1]);
  const double over_pair = across * across / (out * out);
  const double pair = rest / (1 + over_pair);
  const double along = reach[2] / std::sqrt(pair);
  const auto place = [&](double x, double y, double z) {
    return body.center + x * second.axis[0] + y * second.axis[1] + z * second.axis[2];
  };
  const double down = -over_rest * up, in = -over_pair * out;
  return {place(up, 0, 0), place(down, out, 0), place(down, in, along), place(down, in, -along)};
}

bool has_singular_mass(const Scene& scene, std::size_t body) {
  const auto mass = body_mass(scene, body);
  std::array<std::size_t, 4> movable{};
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (!scene.particles[scene.bodies[body].particles[k]].fixed)
      movable[static_cast<std::size_t>(count++)] = k;
  if (count == 0) return false;
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index j = 0; j < count; ++j)
    for (Eigen::Index k = 0; k < count; ++k)
      matrix(j, k) = mass[movable[static_cast<std::size_t>(j)]][movable[static_cast<std::size_t>(k)]];
  const Eigen::VectorXd moments =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  return !(moments[0] > singular * moments[count - 1]);
}

}  // namespace plumb::detail
