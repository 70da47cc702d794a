#include "plumb/joints.hpp"

#include <algorithm>
#include <cmath>

#include "scene/barycentric.hpp"
#include "scene/flat/flat_bodies.hpp"
#include "scene/refuse.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb {
namespace {

using detail::refuse;

void require_body(const Scene& scene, std::uint32_t body) {
  if (body < scene.bodies.size()) return;
  refuse("body ", body, " does not exist (the scene has ", scene.bodies.size(), " bodies)");
}

void require_joint(const Scene& scene, std::uint32_t a, std::uint32_t b, Vec3 position) {
  require_body(scene, a);
  require_body(scene, b);
  if (a == b) refuse("body ", a, ": a joint needs two bodies");
  if (!is_finite(position)) refuse("joint of bodies ", a, " and ", b, ": position is not finite");
}

Vec3 unit_axis(Vec3 axis, const char* name) {
  const double length = norm(axis);
  if (!(length > 0 && std::isfinite(length))) refuse(name, " must be finite and of a length above zero");
  return (1 / length) * axis;
}

/// Holds three unit vectors at right angles, of which x is given.
struct Axes {
  Vec3 x, y, z;
};
Axes axes_along(Vec3 x) {
  const double least = std::min({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  const Vec3 other = least == std::abs(x.x)   ? Vec3{1, 0, 0}
                     : least == std::abs(x.y) ? Vec3{0, 1, 0}
                                              : Vec3{0, 0, 1};
  const Vec3 across = cross(x, other);
  const Vec3 y = (1 / norm(across)) * across;
  return {x, y, cross(x, y)};
}

/// Returns a direction on a body, as long as its radius of gyration (m). That length is lost neither beside
/// the body's places nor beside its size.
Direction direction_on_body(const Scene& scene, std::uint32_t body, Vec3 position, Vec3 unit) {
  const auto& [particles, mass, center, inertia] = scene.bodies[body];
  const double size = std::sqrt((inertia.xx + inertia.yy + inertia.zz) / (2 * mass));
  return {point_on_body(scene, body, position), point_on_body(scene, body, position + size * unit)};
}

std::uint32_t push_body(Scene& scene, const std::array<std::uint32_t, 4>& particles,
                        const MassProperties& properties) {
  scene.bodies.push_back({particles, properties.mass, properties.center, properties.inertia});
  return static_cast<std::uint32_t>(scene.bodies.size() - 1);
}

void push_rod(Scene& scene, std::uint32_t a, std::uint32_t b) {
  scene.rods.push_back(
      {.a = a, .b = b, .length = norm(scene.particles[b].position - scene.particles[a].position)});
}

bool has_rod(const Scene& scene, std::uint32_t a, std::uint32_t b) {
  return std::any_of(scene.rods.begin(), scene.rods.end(), [&](const Rod& rod) {
    return (rod.a == a && rod.b == b) || (rod.a == b && rod.b == a);
  });
}

}  // namespace

Point point_at(std::uint32_t particle) {
  return {.particles = {particle}, .weights = {1}};
}

Point point_on_rod(const Scene& scene, std::uint32_t rod, double fraction) {
  if (rod >= scene.rods.size())
    refuse("rod ", rod, " does not exist (the scene has ", scene.rods.size(), " rods)");
  if (!std::isfinite(fraction)) refuse("rod ", rod, ": fraction is not finite: ", fraction);
  return {.particles = {scene.rods[rod].a, scene.rods[rod].b}, .weights = {1 - fraction, fraction}};
}

Point point_on_body(const Scene& scene, std::uint32_t body, Vec3 position) {
  require_body(scene, body);
  if (!is_finite(position)) refuse("body ", body, ": position is not finite");
  const auto& particles = scene.bodies[body].particles;
  detail::require_particles(scene, body, particles);
  const std::array<Vec3, 4> corners = detail::positions_of(scene, particles);
  detail::require_volume(body, corners);
  return {.particles = particles, .weights = detail::Barycentric(corners).weights(position)};
}

Capsule sphere_at(const Point& center, double radius) {
  return {.a = center, .b = center, .radius = radius};
}

Vec3 position_of(const Scene& scene, const Point& point) {
  Vec3 position;
  for (std::size_t k = 0; k < 4; ++k)
    if (point.weights[k] != 0) position += point.weights[k] * scene.particles[point.particles[k]].position;
  return position;
}

std::uint32_t add_body(Scene& scene, const MassProperties& properties) {
  const std::size_t number = scene.bodies.size();
  detail::require_solid(number, properties);
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (const Vec3 place : detail::body_points(properties)) scene.particles.push_back({.position = place});
  for (std::uint32_t j = 0; j < 4; ++j)
    for (std::uint32_t k = 0; k < j; ++k) push_rod(scene, first + k, first + j);
  return push_body(scene, {first, first + 1, first + 2, first + 3}, properties);
}

std::uint32_t add_body(Scene& scene, const std::array<std::uint32_t, 4>& particles,
                       const MassProperties& properties) {
  const std::size_t number = scene.bodies.size();
  detail::require_particles(scene, number, particles);
  detail::require_volume(number, detail::positions_of(scene, particles));
  detail::require_solid(number, properties);
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < j; ++k) {
      const std::uint32_t a = particles[k], b = particles[j];
      const bool held = scene.particles[a].fixed && scene.particles[b].fixed;
      if (!held && !has_rod(scene, a, b)) push_rod(scene, a, b);
    }
  return push_body(scene, particles, properties);
}

std::array<Vec3, 3> axes_of(const std::array<double, 4>& orientation) {
  const auto [w, x, y, z] = orientation;
  return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
}

Hull box_on_body(std::uint32_t body, const Box& box) {
  const std::array<Vec3, 3> axes = axes_of(box.orientation);
  const Vec3 half = box.half_size, u = axes[0], v = axes[1], n = cross(u, v);
  Hull out{.body = body, .surface = box.surface, .filter = box.filter};
  for (const double i : {-half.x, half.x})
    for (const double j : {-half.y, half.y})
      for (const double k : {-half.z, half.z}) out.points.push_back(box.center + i * u + j * v + k * n);
  return out;
}

void add_spherical(Scene& scene, const Point& a, const Point& b) {
  scene.pins.push_back({a, b});
}

void add_revolute(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position, Vec3 axis) {
  require_joint(scene, body_a, body_b, position);
  const Axes axes = axes_along(unit_axis(axis, "axis"));
  const Pin pin{point_on_body(scene, body_a, position), point_on_body(scene, body_b, position)};
  const Direction along = direction_on_body(scene, body_a, position, axes.x);
  scene.pins.push_back(pin);
  for (const Vec3 across : {axes.y, axes.z})
    scene.alignments.push_back({along, direction_on_body(scene, body_b, position, across)});
}

void add_universal(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position, Vec3 axis_a,
                   Vec3 axis_b) {
  require_joint(scene, body_a, body_b, position);
  const Vec3 a = unit_axis(axis_a, "axis_a"), b = unit_axis(axis_b, "axis_b");
  if (!(std::abs(dot(a, b)) <= 1e-6)) {
    refuse("joint of bodies ", body_a, " and ", body_b, ": axes must be at right angles, their cosine is ",
           dot(a, b));
  }
  const Pin pin{point_on_body(scene, body_a, position), point_on_body(scene, body_b, position)};
  scene.pins.push_back(pin);
  scene.alignments.push_back(
      {direction_on_body(scene, body_a, position, a), direction_on_body(scene, body_b, position, b)});
}

void add_prismatic(Scene& scene, std::uint32_t body_a, std::uint32_t body_b, Vec3 position, Vec3 axis) {
  require_joint(scene, body_a, body_b, position);
  const auto [x, y, z] = axes_along(unit_axis(axis, "axis"));
  const Direction slide{point_on_body(scene, body_a, position), point_on_body(scene, body_b, position)};
  const auto on_a = [&](Vec3 unit) { return direction_on_body(scene, body_a, position, unit); };
  const auto on_b = [&](Vec3 unit) { return direction_on_body(scene, body_b, position, unit); };
  const Direction across_y = on_a(y), across_z = on_a(z);
  for (const Direction& across : {across_y, across_z}) scene.alignments.push_back({slide, across});
  scene.alignments.push_back({on_a(x), on_b(y)});
  scene.alignments.push_back({across_y, on_b(z)});
  scene.alignments.push_back({across_z, on_b(x)});
}

}  // namespace plumb
