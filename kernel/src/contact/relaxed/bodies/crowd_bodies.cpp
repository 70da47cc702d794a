#include "contact/relaxed/bodies/crowd_bodies.hpp"

#include "contact/relaxed/blows/rigid_velocities.hpp"
#include "math/nearest_rotation.hpp"
#include "plumb/joints.hpp"
#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

/// A body is turned inside out where it has less than this share of its volume.
constexpr double least_volume = 0.2;
/// Fixed particles weigh so much more than a body that it turns about them.
constexpr double fixed_weight = 1e6;

Vec3 middle(const std::array<Vec3, 4>& x, const std::array<double, 4>& mass) {
  Vec3 sum{};
  double all = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += mass[i] * x[i];
    all += mass[i];
  }
  return (1 / all) * sum;
}

/// Returns whether anything but elastics holds bodies of an island, each of which is six rods.
bool are_held(const LinkageState& state) {
  const Linkage& linkage = *state.linkage;
  bool out = !state.angle_rules.empty();
  linkage.for_pins([&](const Combination& apart) { out = out || apart.count > 0; });
  linkage.for_alignments([&](const Combination&, const Combination&, double) { out = true; });
  return out || linkage.rods() - linkage.giving_rods() > 6 * linkage.bodies().size();
}

}  // namespace

template <class T>
auto CrowdBodies<T>::made(std::uint32_t island, const BodyShape& shape, const Crowd<T>& crowd) -> Body {
  Body out;
  out.island = island;
  out.particles = shape.particles;
  double all = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double inverse = crowd.inverse_mass(island, shape.particles[i]);
    out.at[i] = crowd.number_of(island, shape.particles[i]);
    out.moves[i] = inverse > 0;
    out.mass[i] = out.moves[i] ? 1 / inverse : 0;
    all += out.mass[i];
  }
  for (std::size_t i = 0; i < 4; ++i)
    if (!out.moves[i]) out.mass[i] = fixed_weight * all;
  const Vec3 center = middle(shape.places, out.mass);
  for (std::size_t i = 0; i < 4; ++i) out.offsets[i] = shape.places[i] - center;
  out.over_volume = 1 / signed_volume(out.offsets);
  return out;
}

template <class T>
void CrowdBodies<T>::gather(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) {
  if (layout_ == crowd.layout()) return;
  layout_ = crowd.layout();
  bodies_.clear();
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (!crowd.is_moving(i)) continue;
    const bool is_held = are_held(*cluster[i]);
    for (const BodyShape& shape : cluster[i]->linkage->bodies()) {
      bodies_.push_back(made(i, shape, crowd));
      bodies_.back().is_held = is_held;
    }
  }
}

template <class T>
void CrowdBodies<T>::right(Crowd<T>& crowd) const {
  for (const Body& body : bodies_) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = crowd.position(body.at[i]) + crowd.moved(body.at[i]);
    if (signed_volume(x) * body.over_volume > least_volume) continue;
    const Vec3 center = middle(x, body.mass);
    std::array<Vec3, 3> columns{};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 by = body.mass[i] * (x[i] - center);
      columns[0] += body.offsets[i].x * by;
      columns[1] += body.offsets[i].y * by;
      columns[2] += body.offsets[i].z * by;
    }
    const std::array<Vec3, 3> axes = axes_of(nearest_rotation(columns));
    for (std::size_t i = 0; i < 4; ++i) {
      if (!body.moves[i]) continue;
      const Vec3 r = body.offsets[i];
      crowd.push(body.at[i], center + r.x * axes[0] + r.y * axes[1] + r.z * axes[2] - x[i]);
    }
  }
}

template <class T>
void CrowdBodies<T>::begin_rigidly(Crowd<T>& crowd) const {
  for (const Body& each : bodies_)
    if (!each.is_held) move_rigidly(crowd, each.island, each.particles);
}

template class CrowdBodies<float>;
template class CrowdBodies<double>;

}  // namespace plumb::detail
