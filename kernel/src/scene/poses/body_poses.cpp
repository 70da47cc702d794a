#include "scene/poses/body_poses.hpp"

#include <algorithm>
#include <cmath>

#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

/// Holds a number of each of `count` bodies, which are found side by side: all do the same arithmetic, so
/// that compilers make vectors of it. One body alone is found by the same, to the same bits.
template <std::size_t count>
using Lanes = std::array<double, count>;
/// Holds nine numbers of each, row by row.
template <std::size_t count>
using Matrices = std::array<Lanes<count>, 9>;
/// Holds three numbers for each of the four particles of a body.
template <std::size_t count>
using Corners = std::array<Lanes<count>, 12>;

template <std::size_t count>
void put(std::array<Lanes<count>, 12>& of, std::size_t lane, std::size_t corner, Vec3 vector) {
  of[3 * corner][lane] = vector.x;
  of[3 * corner + 1][lane] = vector.y;
  of[3 * corner + 2][lane] = vector.z;
}

/// Returns the matrix that takes directions of the scene to the change of `vectors` along them.
template <std::size_t count>
Matrices<count> gradients_of(const Corners<count>& vectors, const Corners<count>& gradients) {
  Matrices<count> out{};
  for (std::size_t i = 0; i < 12; i += 3)
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t k = 0; k < count; ++k)
          out[3 * row + column][k] += vectors[i + row][k] * gradients[i + column][k];
  return out;
}

/// Makes of matrices that nearly are rotations the rotations nearest to them, by Newton's iteration for the
/// polar decomposition (Higham, SIAM J. Sci. Stat. Comput. 7, 1986). An error of 1e-8 is rounding a step
/// later, so that one step is enough but where sweeps left a strain.
template <std::size_t count>
void make_rotations(Matrices<count>& of) {
  const auto& [m0, m1, m2, m3, m4, m5, m6, m7, m8] = of;
  Matrices<count> next;
  Lanes<count> changes, squares;
  changes.fill(1);
  for (int step = 0; step < 16; ++step) {
    for (std::size_t k = 0; k < count; ++k) {
      const double xx = m0[k], xy = m1[k], xz = m2[k], yx = m3[k], yy = m4[k], yz = m5[k], zx = m6[k],
                   zy = m7[k], zz = m8[k];
      const double c0 = yy * zz - yz * zy, c1 = yz * zx - yx * zz, c2 = yx * zy - yy * zx;
      const double over = 1 / (xx * c0 + xy * c1 + xz * c2);
      const double n0 = 0.5 * (xx + over * c0), n1 = 0.5 * (xy + over * c1), n2 = 0.5 * (xz + over * c2);
      const double n3 = 0.5 * (yx + over * (zy * xz - zz * xy)), n4 = 0.5 * (yy + over * (zz * xx - zx * xz)),
                   n5 = 0.5 * (yz + over * (zx * xy - zy * xx));
      const double n6 = 0.5 * (zx + over * (xy * yz - xz * yy)), n7 = 0.5 * (zy + over * (xz * yx - xx * yz)),
                   n8 = 0.5 * (zz + over * (xx * yy - xy * yx));
      const auto square = [](double x, double y, double z) { return x * x + y * y + z * z; };
      const double first = square(n0 - xx, n1 - xy, n2 - xz), second = square(n3 - yx, n4 - yy, n5 - yz),
                   third = square(n6 - zx, n7 - zy, n8 - zz);
      const double larger = first < second ? second : first;
      squares[k] = larger < third ? third : larger;
      next[0][k] = n0;
      next[1][k] = n1;
      next[2][k] = n2;
      next[3][k] = n3;
      next[4][k] = n4;
      next[5][k] = n5;
      next[6][k] = n6;
      next[7][k] = n7;
      next[8][k] = n8;
    }
    bool is_done = true;
    for (std::size_t k = 0; k < count; ++k) {
      if (!(changes[k] > 1e-8)) continue;
      for (std::size_t i = 0; i < 9; ++i) of[i][k] = next[i][k];
      changes[k] = std::sqrt(squares[k]);
      is_done = is_done && !(changes[k] > 1e-8);
    }
    if (is_done) return;
  }
}

/// Returns the unit quaternions w, x, y, z of rotations, by their largest components, which are positive.
template <std::size_t count>
std::array<Lanes<count>, 4> quaternions_of(const Matrices<count>& r) {
  std::array<Lanes<count>, 4> out;
  for (std::size_t k = 0; k < count; ++k) {
    const double xx = r[0][k], yy = r[4][k], zz = r[8][k];
    const double wx = r[7][k] - r[5][k], wy = r[2][k] - r[6][k], wz = r[3][k] - r[1][k];
    const double xy = r[3][k] + r[1][k], yz = r[7][k] + r[5][k], zx = r[2][k] + r[6][k];
    const double ww = 1 + xx + yy + zz, x2 = 1 + xx - yy - zz, y2 = 1 - xx + yy - zz, z2 = 1 - xx - yy + zz;
    double largest = ww, w = ww, x = wx, y = wy, z = wz;
    const auto take = [&](double square, double ow, double ox, double oy, double oz) {
      const bool is_larger = largest < square;
      largest = is_larger ? square : largest;
      w = is_larger ? ow : w;
      x = is_larger ? ox : x;
      y = is_larger ? oy : y;
      z = is_larger ? oz : z;
    };
    take(x2, wx, x2, xy, zx);
    take(y2, wy, xy, y2, yz);
    take(z2, wz, zx, yz, z2);
    const double over = 0.5 / std::sqrt(largest);
    out[0][k] = w * over;
    out[1][k] = x * over;
    out[2][k] = y * over;
    out[3][k] = z * over;
  }
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

template <std::size_t count, class At>
void BodyPoses::find_poses(std::uint32_t first, At&& position, Pose* out) const {
  Corners<count> places, gradients;
  for (std::size_t k = 0; k < count; ++k) {
    const Reference& of = bodies_[first + k];
    std::array<Vec3, 4> at;
    for (std::size_t i = 0; i < 4; ++i) {
      at[i] = position(of.particles[i]);
      put<count>(places, k, i, at[i]);
      put<count>(gradients, k, i, of.gradients[i]);
    }
    out[k].position = weighted(of.center, at);
  }
  Matrices<count> matrices = gradients_of<count>(places, gradients);
  make_rotations<count>(matrices);
  const std::array<Lanes<count>, 4> quaternions = quaternions_of<count>(matrices);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < 4; ++i) out[k].orientation[i] = quaternions[i][k];
}

/// The velocities of a turning body are G = W R, by directions of the scene, where W takes places to spin x
/// place.
template <std::size_t count, class At, class Speed>
void BodyPoses::find_motions(std::uint32_t first, At&& position, Speed&& velocity, BodyMotion* out) const {
  Corners<count> places, velocities, gradients;
  for (std::size_t k = 0; k < count; ++k) {
    const Reference& of = bodies_[first + k];
    std::array<Vec3, 4> v;
    for (std::size_t i = 0; i < 4; ++i) {
      v[i] = velocity(of.particles[i]);
      put<count>(places, k, i, position(of.particles[i]));
      put<count>(velocities, k, i, v[i]);
      put<count>(gradients, k, i, of.gradients[i]);
    }
    out[k].velocity = weighted(of.center, v);
  }
  Matrices<count> r = gradients_of<count>(places, gradients);
  make_rotations<count>(r);
  const Matrices<count> g = gradients_of<count>(velocities, gradients);
  for (std::size_t k = 0; k < count; ++k) {
    const auto w = [&](std::size_t i, std::size_t j) {
      return g[3 * i][k] * r[3 * j][k] + g[3 * i + 1][k] * r[3 * j + 1][k] +
             g[3 * i + 2][k] * r[3 * j + 2][k];
    };
    out[k].spin = 0.5 * Vec3{w(2, 1) - w(1, 2), w(0, 2) - w(2, 0), w(1, 0) - w(0, 1)};
  }
}

Pose BodyPoses::pose(std::uint32_t body, const std::array<Vec3, 4>& positions) const {
  Pose out;
  find_poses<1>(
      body, [at = positions.begin()](std::uint32_t) mutable { return *at++; }, &out);
  return out;
}

BodyMotion BodyPoses::motion(std::uint32_t body, const std::array<Vec3, 4>& positions,
                             const std::array<Vec3, 4>& velocities) const {
  BodyMotion out;
  find_motions<1>(
      body, [at = positions.begin()](std::uint32_t) mutable { return *at++; },
      [at = velocities.begin()](std::uint32_t) mutable { return *at++; }, &out);
  return out;
}

void BodyPoses::copy_poses(std::span<const Vec3> positions, std::span<Pose> out) const {
  const auto position = [&](std::uint32_t particle) { return positions[particle]; };
  std::uint32_t i = 0;
  for (; i + side_by_side <= count(); i += side_by_side) find_poses<side_by_side>(i, position, &out[i]);
  for (; i < count(); ++i) find_poses<1>(i, position, &out[i]);
}

void BodyPoses::copy_motions(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                             std::span<BodyMotion> out) const {
  const auto position = [&](std::uint32_t particle) { return positions[particle]; };
  const auto velocity = [&](std::uint32_t particle) { return velocities[particle]; };
  std::uint32_t i = 0;
  for (; i + side_by_side <= count(); i += side_by_side)
    find_motions<side_by_side>(i, position, velocity, &out[i]);
  for (; i < count(); ++i) find_motions<1>(i, position, velocity, &out[i]);
}

}  // namespace plumb::detail
