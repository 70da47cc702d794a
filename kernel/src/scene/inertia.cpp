#include "plumb/inertia.hpp"

#include <algorithm>
#include <cmath>

#include "scene/refuse.hpp"
#include "scene/second_moments.hpp"

namespace plumb {
namespace {

using detail::refuse;

void add_point(Inertia& to, double mass, Vec3 r) {
  to.xx += mass * (r.y * r.y + r.z * r.z);
  to.yy += mass * (r.x * r.x + r.z * r.z);
  to.zz += mass * (r.x * r.x + r.y * r.y);
  to.xy -= mass * r.x * r.y;
  to.xz -= mass * r.x * r.z;
  to.yz -= mass * r.y * r.z;
}

void require_mass(double mass) {
  if (!(mass >= 0 && std::isfinite(mass))) refuse("mass must be finite and not negative, got ", mass, " kg");
}
void require_size(const char* name, double size) {
  if (!(size > 0 && std::isfinite(size))) refuse(name, " must be positive and finite, got ", size, " m");
}

/// Returns what is symmetric about x and centred on the origin, turned so that its axis leads from a to b.
MassProperties along(Vec3 a, Vec3 b, const MassProperties& solid) {
  const Vec3 axis = (1 / norm(b - a)) * (b - a);
  const double across = solid.inertia.yy, more = solid.inertia.xx - across;
  return {.mass = solid.mass,
          .center = 0.5 * (a + b),
          .inertia = {.xx = across + more * axis.x * axis.x,
                      .yy = across + more * axis.y * axis.y,
                      .zz = across + more * axis.z * axis.z,
                      .xy = more * axis.x * axis.y,
                      .xz = more * axis.x * axis.z,
                      .yz = more * axis.y * axis.z}};
}

}  // namespace

MassProperties mass_properties(std::span<const PointMass> points) {
  MassProperties out;
  Vec3 moment;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [position, mass] = points[i];
    if (!is_finite(position)) refuse("point ", i, ": position is not finite");
    if (!(mass >= 0 && std::isfinite(mass)))
      refuse("point ", i, ": mass must be finite and not negative, got ", mass, " kg");
    out.mass += mass;
    moment += mass * position;
  }
  if (out.mass > 0) out.center = (1 / out.mass) * moment;
  for (const auto& [position, mass] : points) add_point(out.inertia, mass, position - out.center);
  return out;
}

MassProperties solid_cylinder(double mass, double radius, double length) {
  require_mass(mass);
  require_size("radius", radius);
  require_size("length", length);
  const double across = mass * (radius * radius / 4 + length * length / 12);
  return {.mass = mass, .inertia = {.xx = mass * radius * radius / 2, .yy = across, .zz = across}};
}

MassProperties solid_box(double mass, Vec3 size) {
  require_mass(mass);
  require_size("width", size.x);
  require_size("height", size.y);
  require_size("depth", size.z);
  const Vec3 s{size.x * size.x, size.y * size.y, size.z * size.z};
  return {.mass = mass,
          .inertia = {
              .xx = mass * (s.y + s.z) / 12, .yy = mass * (s.x + s.z) / 12, .zz = mass * (s.x + s.y) / 12}};
}

MassProperties solid_sphere(double mass, double radius) {
  require_mass(mass);
  require_size("radius", radius);
  const double all = 0.4 * mass * radius * radius;
  return {.mass = mass, .inertia = {.xx = all, .yy = all, .zz = all}};
}

MassProperties solid_capsule(double mass, double radius, double length) {
  require_mass(mass);
  require_size("radius", radius);
  require_size("length", length);
  // The mass is divided in proportion to volume: pi r^2 L of the cylinder, 4/3 pi r^3 of the two caps
  // together.
  const double caps = mass * (4 * radius / 3) / (length + 4 * radius / 3);
  const MassProperties cylinder = solid_cylinder(mass - caps, radius, length);
  const MassProperties sphere = solid_sphere(caps, radius);
  // A cap's centre of mass is 3r/8 from its flat side. Its inertia about that side's middle is half the
  // sphere's.
  const double to_cap = length / 2 + 3 * radius / 8;
  const double across = cylinder.inertia.yy + sphere.inertia.yy +
                        caps * (to_cap * to_cap - (3 * radius / 8) * (3 * radius / 8));
  return {.mass = mass,
          .inertia = {.xx = cylinder.inertia.xx + sphere.inertia.xx, .yy = across, .zz = across}};
}

MassProperties solid_cylinder(double mass, double radius, Vec3 a, Vec3 b) {
  return along(a, b, solid_cylinder(mass, radius, norm(b - a)));
}

MassProperties solid_capsule(double mass, double radius, Vec3 a, Vec3 b) {
  return along(a, b, solid_capsule(mass, radius, norm(b - a)));
}

Inertia inertia_about(const MassProperties& body, Vec3 offset) {
  Inertia out = body.inertia;
  add_point(out, body.mass, offset);
  return out;
}

std::array<PointMass, 4> four_points(const MassProperties& body) {
  if (!(body.mass > 0 && std::isfinite(body.mass)))
    refuse("mass must be positive and finite, got ", body.mass, " kg");
  if (!is_finite(body.center)) refuse("center of mass is not finite");
  if (!detail::is_finite(body.inertia)) refuse("inertia is not finite");
  const detail::Principal second = detail::principal_axes(detail::second_moments(body.inertia));
  if (second.moment[0] < -1e-12 * std::abs(second.moment[2])) {
    refuse("inertia is that of no body: a second moment of its mass is negative (", second.moment[0],
           " kg m^2)");
  }
  std::array<Vec3, 3> reach;  // standard deviation of the mass along each axis, m
  for (std::size_t k = 0; k < 3; ++k)
    reach[k] = std::sqrt(std::max(second.moment[k], 0.0) / body.mass) * second.axis[k];
  const auto corner = [&](double x, double y, double z) {
    return PointMass{body.center + x * reach[0] + y * reach[1] + z * reach[2], body.mass / 4};
  };
  return {corner(1, 1, 1), corner(1, -1, -1), corner(-1, 1, -1), corner(-1, -1, 1)};
}

}  // namespace plumb
