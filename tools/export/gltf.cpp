#include "export/gltf.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "export/gltf_model.hpp"
#include "plumb/error.hpp"

namespace plumb::tools {
namespace {

using Quaternion = std::array<double, 4>;  // A quaternion holds x, y, z, w.
using scenes::Limb;

/// Returns the shortest turn from one direction to another. Both have length one.
Quaternion turn_between(Vec3 from, Vec3 to) {
  const double w = 1 + dot(from, to);
  Vec3 axis = cross(from, to);
  if (w < 1e-12) {  // The directions are opposite, so any axis at right angles to them does.
    axis = cross(from, std::abs(from.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    const double length = norm(axis);
    return {axis.x / length, axis.y / length, axis.z / length, 0};
  }
  const double length = std::sqrt(dot(axis, axis) + w * w);
  return {axis.x / length, axis.y / length, axis.z / length, w / length};
}

/// Turns first by b, then by a. The result has length one again.
Quaternion product(const Quaternion& a, const Quaternion& b) {
  Quaternion q = {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
                  a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
                  a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
                  a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= length;
  return q;
}

void append(std::vector<float>& out, std::initializer_list<double> numbers) {
  for (const double number : numbers) out.push_back(static_cast<float>(number));
}

std::vector<double> list(Vec3 v) {
  return {v.x, v.y, v.z};
}

double mean_length(const std::vector<Limb>& limbs, const Scene& scene) {
  double sum = 0;
  std::size_t count = 0;
  for (const Limb& limb : limbs) {
    if (!limb.rod) continue;
    sum += rod_length(scene, *limb.rod);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

std::string name_of(const Limb& limb, std::size_t number) {
  if (limb.radius > 0) return (limb.is_ball() ? "ball " : "limb ") + std::to_string(number);
  if (limb.rod) return "rod " + std::to_string(*limb.rod);
  return "particle " + std::to_string(limb.particle.value_or(0));
}

/// Adds the meshes that nodes share.
struct Meshes {
  int cylinder, ball, cube, square;
};

Meshes add_meshes(GltfModel& model) {
  const int limb = model.add_material("limb", 0.12, 0.37, 0.66);
  const int ball = model.add_material("ball", 0.82, 0.29, 0.36);
  const int ground = model.add_material("ground", 0.8, 0.8, 0.8);
  return {add_cylinder(model, limb), add_ball(model, ball), add_cube(model, ground),
          add_square(model, ground)};
}

/// Adds a capsule's straight part, and a ball at either end.
void add_capsule_parts(GltfModel& model, int node, double radius, double length, const Meshes& meshes) {
  const int straight = model.add_node("", meshes.cylinder, node);
  model.node(straight).scale = {radius, length, radius};
  for (const double end : {-0.5, 0.5}) {
    const int cap = model.add_node("", meshes.ball, node);
    model.node(cap).translation = {0, end * length, 0};
    model.node(cap).scale = {radius, radius, radius};
  }
}

void add_ground(GltfModel& model, const Scene& scene, const Meshes& meshes) {
  const double size = std::max(1.0, 10 * bounding_diagonal(scene));
  for (const Plane& plane : scene.planes) {
    const int node = model.add_node("plane", meshes.square);
    const Quaternion turn = turn_between({0, 1, 0}, plane.normal);
    model.node(node).translation = list(plane.offset * plane.normal);
    model.node(node).rotation.assign(turn.begin(), turn.end());
    model.node(node).scale = {size, 1, size};
  }
  for (const Box& box : scene.boxes) {
    const int node = model.add_node("box", meshes.cube);
    const auto& [w, x, y, z] = box.orientation;
    model.node(node).translation = list(box.center);
    model.node(node).rotation = {x, y, z, w};
    model.node(node).scale = list(box.half_size);
  }
}

}  // namespace

GltfAnimation::GltfAnimation(const Scene& scene)
    : scene_(scene), limbs_(scenes::list_limbs(scene)), tracks_(limbs_.size()) {
  if (const double length = mean_length(limbs_, scene); length > 0) thin_ = length / 20;
}

void GltfAnimation::add(const Frame& frame) {
  times_.push_back(static_cast<float>(frame.t));
  for (std::size_t i = 0; i < limbs_.size(); ++i) {
    const Vec3 a = scenes::place_of(limbs_[i].a, frame.positions);
    const Vec3 b = scenes::place_of(limbs_[i].b, frame.positions);
    const Vec3 middle = 0.5 * (a + b);
    Track& track = tracks_[i];
    append(track.translations, {middle.x, middle.y, middle.z});
    if (limbs_[i].is_ball()) continue;
    const double length = norm(b - a);
    if (length > 0) {
      // The turn goes on from the last frame's rotation, so that a limb that swings past an axis does not
      // spin about itself.
      const Vec3 axis = (1 / length) * (b - a);
      track.turn = product(turn_between(track.axis, axis), track.turn);
      track.axis = axis;
    }
    append(track.rotations, {track.turn[0], track.turn[1], track.turn[2], track.turn[3]});
    if (limbs_[i].radius == 0) append(track.scales, {thin_, length, thin_});
  }
}

std::string GltfAnimation::to_text(bool binary) const {
  if (times_.empty()) throw InputError("an animation needs at least one frame");
  std::size_t floats = 0;
  for (const Track& track : tracks_)
    floats += track.translations.size() + track.rotations.size() + track.scales.size();
  if (floats > std::numeric_limits<std::int32_t>::max() / sizeof(float))
    throw InputError("the animation is too long for a glTF file: " + std::to_string(times_.size()) +
                     " frames of " + std::to_string(limbs_.size()) + " limbs; save fewer frames");
  std::vector<Vec3> start;
  for (const Particle& particle : scene_.particles) start.push_back(particle.position);
  GltfModel model;
  const Meshes meshes = add_meshes(model);
  add_ground(model, scene_, meshes);
  const int times = model.add_floats(times_, 1, true);
  for (std::size_t i = 0; i < limbs_.size(); ++i) {
    const Limb& limb = limbs_[i];
    const Track& track = tracks_[i];
    const double radius = limb.radius > 0 ? limb.radius : thin_;
    const bool capsule = limb.radius > 0 && !limb.is_ball();
    const int node = model.add_node(name_of(limb, i), capsule          ? -1
                                                      : limb.is_ball() ? meshes.ball
                                                                       : meshes.cylinder);
    if (limb.is_ball()) model.node(node).scale = {radius, radius, radius};
    if (capsule) {
      const double length = norm(scenes::place_of(limb.b, start) - scenes::place_of(limb.a, start));
      add_capsule_parts(model, node, radius, length, meshes);
    }
    model.animate(node, "translation", times, model.add_floats(track.translations, 3));
    if (!track.rotations.empty())
      model.animate(node, "rotation", times, model.add_floats(track.rotations, 4));
    if (!track.scales.empty()) model.animate(node, "scale", times, model.add_floats(track.scales, 3));
  }
  return model.to_text(binary);
}

}  // namespace plumb::tools
