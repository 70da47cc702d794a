#include "scene/poses/body_poses.hpp"

#include <algorithm>
#include <cmath>

#include "math/nearest_rotation.hpp"
#include "plumb/joints.hpp"
#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

template <std::size_t count>
void put(Corners<count>& of, std::size_t lane, std::size_t corner, Vec3 vector) {
  of[3 * corner][lane] = vector.x;
  of[3 * corner + 1][lane] = vector.y;
  of[3 * corner + 2][lane] = vector.z;
}

/// Returns the matrix that takes directions of the scene to the change of `vectors` along them.
template <std::size_t count>
Matrices<count> gradients_of(const Corners<count>& vectors, const Corners<count>& gradients) {
  Matrices<count> out;
  for (std::size_t k = 0; k < count; ++k) {
    const auto put_row = [&](std::size_t row) {
      double x = 0, y = 0, z = 0;
      for (std::size_t i = 0; i < 12; i += 3) {
        x += vectors[i + row][k] * gradients[i][k];
        y += vectors[i + row][k] * gradients[i + 1][k];
        z += vectors[i + row][k] * gradients[i + 2][k];
      }
      out[3 * row][k] = x;
      out[3 * row + 1][k] = y;
      out[3 * row + 2][k] = z;
    };
    put_row(0);
    put_row(1);
    put_row(2);
  }
  return out;
}

/// Returns where the centres are, or how fast they move.
template <std::size_t count>
std::array<Lanes<count>, 3> centers_of(const Corners<count>& vectors,
                                       const std::array<Lanes<count>, 4>& weights) {
  std::array<Lanes<count>, 3> out;
  for (std::size_t k = 0; k < count; ++k) {
    double x = 0, y = 0, z = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      x += vectors[3 * i][k] * weights[i][k];
      y += vectors[3 * i + 1][k] * weights[i][k];
      z += vectors[3 * i + 2][k] * weights[i][k];
    }
    out[0][k] = x;
    out[1][k] = y;
    out[2][k] = z;
  }
  return out;
}

/// Makes rotations of those matrices that mirror by their volumes, or nearly so, as bodies that are relaxed
/// may for a moment. Newton's iteration would end at a reflection. Returns whether there are any.
template <std::size_t count>
bool right(Matrices<count>& of, const Lanes<count>& volumes) {
  constexpr double least_volume = 1e-3;
  bool any = false;
  for (const double volume : volumes) any = any | (volume <= least_volume);
  for (std::size_t k = 0; any && k < count; ++k) {
    if (!(volumes[k] <= least_volume)) continue;
    const auto column = [&](std::size_t i) { return Vec3{of[i][k], of[i + 3][k], of[i + 6][k]}; };
    const auto axes = axes_of(nearest_rotation({column(0), column(1), column(2)}));
    for (std::size_t i = 0; i < 3; ++i) {
      of[i][k] = axes[i].x;
      of[i + 3][k] = axes[i].y;
      of[i + 6][k] = axes[i].z;
    }
  }
  return any;
}

/// Makes of matrices that nearly are rotations the rotations nearest to them, by Newton's iteration for the
/// polar decomposition (Higham, SIAM J. Sci. Stat. Comput. 7, 1986). An error of 1e-8 is rounding a step
/// later, so that one step is enough but where sweeps left a strain.
template <std::size_t count>
void make_rotations(Matrices<count>& of) {
  // No square has a root above 1e-8 that is not above this. So no root need be taken.
  constexpr double least_change = 1e-8 * 1e-8;
  const auto& [m0, m1, m2, m3, m4, m5, m6, m7, m8] = of;
  Matrices<count> next;
  Lanes<count> changes, squares, volumes;
  changes.fill(1);
  for (int step = 0; step < 16; ++step) {
    for (std::size_t k = 0; k < count; ++k) {
      const double xx = m0[k], xy = m1[k], xz = m2[k], yx = m3[k], yy = m4[k], yz = m5[k], zx = m6[k],
                   zy = m7[k], zz = m8[k];
      const double c0 = yy * zz - yz * zy, c1 = yz * zx - yx * zz, c2 = yx * zy - yy * zx;
      volumes[k] = xx * c0 + xy * c1 + xz * c2;
      const double over = 1 / volumes[k];
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
    if (right<count>(of, volumes)) continue;
    bool is_done = true;
    for (std::size_t k = 0; k < count; ++k) {
      const bool goes_on = changes[k] > least_change;
      for (std::size_t i = 0; i < 9; ++i) of[i][k] = goes_on ? next[i][k] : of[i][k];
      changes[k] = goes_on ? squares[k] : changes[k];
      is_done = is_done & !(changes[k] > least_change);
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
  groups_.reserve((scene.bodies.size() + side_by_side - 1) / side_by_side);
  for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) take(scene, body);
}

void BodyPoses::take(const Scene& scene, std::uint32_t body) {
  count_ = std::max(count_, body + 1);
  if (const std::size_t groups = body / side_by_side + std::size_t{1}; groups > groups_.size())
    groups_.resize(groups);
  const std::array<std::uint32_t, 4>& particles = scene.bodies[body].particles;
  std::array<Vec3, 4> at{};
  for (std::size_t i = 0; i < 4; ++i) at[i] = scene.particles[particles[i]].position;
  const Barycentric weights(at);
  const std::array<double, 4> center = weights.weights(scene.bodies[body].center);
  const std::array<Vec3, 4> gradients = weights.gradients();
  Group& group = groups_[body / side_by_side];
  const std::size_t lane = body % side_by_side;
  group.particles[lane] = particles;
  for (std::size_t i = 0; i < 4; ++i) {
    group.weights.center[i][lane] = center[i];
    put<side_by_side>(group.weights.gradients, lane, i, gradients[i]);
  }
}

/// Returns the weights of the bodies side by side with a body, or of it alone, which is put to `one`.
template <std::size_t count>
const BodyPoses::Weights<count>& BodyPoses::weights_from(std::uint32_t first, Weights<1>& one) const {
  const Weights<side_by_side>& all = groups_[first / side_by_side].weights;
  if constexpr (count == side_by_side) {
    return all;
  } else {
    const std::size_t lane = first % side_by_side;
    for (std::size_t i = 0; i < 4; ++i) one.center[i][0] = all.center[i][lane];
    for (std::size_t i = 0; i < 12; ++i) one.gradients[i][0] = all.gradients[i][lane];
    return one;
  }
}

template <std::size_t count, class At>
void BodyPoses::find_poses(std::uint32_t first, At&& position, Pose* out) const {
  Weights<1> one;
  const Weights<count>& weights = weights_from<count>(first, one);
  Corners<count> places;
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < 4; ++i)
      put<count>(places, k, i, position(particles(first + static_cast<std::uint32_t>(k))[i]));
  const std::array<Lanes<count>, 3> centers = centers_of<count>(places, weights.center);
  Matrices<count> matrices = gradients_of<count>(places, weights.gradients);
  make_rotations<count>(matrices);
  const std::array<Lanes<count>, 4> quaternions = quaternions_of<count>(matrices);
  for (std::size_t k = 0; k < count; ++k) {
    out[k].position = {centers[0][k], centers[1][k], centers[2][k]};
    for (std::size_t i = 0; i < 4; ++i) out[k].orientation[i] = quaternions[i][k];
  }
}

/// The velocities of a turning body are G = W R, by directions of the scene, where W takes places to spin x
/// place.
template <std::size_t count, class At, class Speed>
void BodyPoses::find_motions(std::uint32_t first, At&& position, Speed&& velocity, BodyMotion* out) const {
  Weights<1> one;
  const Weights<count>& weights = weights_from<count>(first, one);
  Corners<count> places, velocities;
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t particle = particles(first + static_cast<std::uint32_t>(k))[i];
      put<count>(places, k, i, position(particle));
      put<count>(velocities, k, i, velocity(particle));
    }
  const std::array<Lanes<count>, 3> centers = centers_of<count>(velocities, weights.center);
  Matrices<count> r = gradients_of<count>(places, weights.gradients);
  make_rotations<count>(r);
  const Matrices<count> g = gradients_of<count>(velocities, weights.gradients);
  for (std::size_t k = 0; k < count; ++k) {
    const auto w = [&](std::size_t i, std::size_t j) {
      return g[3 * i][k] * r[3 * j][k] + g[3 * i + 1][k] * r[3 * j + 1][k] +
             g[3 * i + 2][k] * r[3 * j + 2][k];
    };
    out[k].velocity = {centers[0][k], centers[1][k], centers[2][k]};
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
