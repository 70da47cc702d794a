#include "scene/poses/body_poses.hpp"

#include <algorithm>
#include <cmath>

#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

/// Its rows.
using Matrix = std::array<Vec3, 3>;

/// Returns the matrix that takes directions of the scene to the change of `vectors` along them.
Matrix gradient_of(const std::array<Vec3, 4>& vectors, const std::array<Vec3, 4>& gradients) {
  Matrix out{};
  for (std::size_t i = 0; i < 4; ++i) {
    out[0] += vectors[i].x * gradients[i];
    out[1] += vectors[i].y * gradients[i];
    out[2] += vectors[i].z * gradients[i];
  }
  return out;
}

/// Returns the rotation nearest to a matrix that is nearly one, by Newton's iteration for the polar
/// decomposition (Higham, SIAM J. Sci. Stat. Comput. 7, 1986). An error of 1e-8 is rounding a step later.
Matrix nearest_rotation(Matrix a) {
  for (int i = 0; i < 16; ++i) {
    const Vec3 yz = cross(a[1], a[2]), zx = cross(a[2], a[0]), xy = cross(a[0], a[1]);
    const double over = 1 / dot(a[0], yz);
    const Matrix next = {0.5 * (a[0] + over * yz), 0.5 * (a[1] + over * zx), 0.5 * (a[2] + over * xy)};
    double change = 0;
    for (std::size_t row = 0; row < 3; ++row) change = std::max(change, norm(next[row] - a[row]));
    a = next;
    if (!(change > 1e-8)) break;
  }
  return a;
}

/// Returns the unit quaternion w, x, y, z of a rotation, by its largest component, which is positive.
std::array<double, 4> quaternion_of(const Matrix& r) {
  const double xx = r[0].x, yy = r[1].y, zz = r[2].z;
  const std::array<double, 4> squares = {1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz,
                                         1 - xx - yy + zz};
  const double wx = r[2].y - r[1].z, wy = r[0].z - r[2].x, wz = r[1].x - r[0].y;
  const double xy = r[1].x + r[0].y, yz = r[2].y + r[1].z, zx = r[0].z + r[2].x;
  const std::array<std::array<double, 4>, 4> rows = {{{squares[0], wx, wy, wz},
                                                      {wx, squares[1], xy, zx},
                                                      {wy, xy, squares[2], yz},
                                                      {wz, zx, yz, squares[3]}}};
  const auto largest =
      static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
  std::array<double, 4> out = rows[largest];
  const double over = 0.5 / std::sqrt(squares[largest]);
  for (double& component : out) component *= over;
  return out;
}

}  // namespace

BodyPoses::BodyPoses(const Scene& scene) {
  for (const Body& body : scene.bodies) {
    std::array<Vec3, 4> at{};
    for (std::size_t i = 0; i < 4; ++i) at[i] = scene.particles[body.particles[i]].position;
    const Barycentric weights(at);
    bodies_.push_back({body.particles, weights.weights(body.center), weights.gradients()});
  }
}

Pose BodyPoses::pose(std::uint32_t body, const std::array<Vec3, 4>& positions) const {
  const Reference& of = bodies_[body];
  return {weighted(of.center, positions),
          quaternion_of(nearest_rotation(gradient_of(positions, of.gradients)))};
}

/// The velocities of a turning body are G = W R, by directions of the scene, where W takes places to spin x
/// place.
BodyMotion BodyPoses::motion(std::uint32_t body, const std::array<Vec3, 4>& positions,
                             const std::array<Vec3, 4>& velocities) const {
  const Reference& of = bodies_[body];
  const Matrix r = nearest_rotation(gradient_of(positions, of.gradients));
  const Matrix g = gradient_of(velocities, of.gradients);
  const auto w = [&](std::size_t i, std::size_t j) { return dot(g[i], r[j]); };
  return {weighted(of.center, velocities),
          0.5 * Vec3{w(2, 1) - w(1, 2), w(0, 2) - w(2, 0), w(1, 0) - w(0, 1)}};
}

}  // namespace plumb::detail
