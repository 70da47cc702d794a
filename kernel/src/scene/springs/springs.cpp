#include "scene/springs/springs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "plumb/joints.hpp"
#include "scene/refuse.hpp"
#include "scene/springs/turn.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb::detail {
namespace {

/// A direction of a torsion must be off its axis by at least this share of itself.
constexpr double least_across = 1e-6;

void require_amount(const std::string& name, const char* what, double value, const char* unit) {
  if (!(value >= 0 && std::isfinite(value)))
    refuse(name, ": ", what, " must be finite and not negative, got ", value, ' ', unit);
}
void require_finite(const std::string& name, const char* what, double value, const char* unit) {
  if (!std::isfinite(value)) refuse(name, ": ", what, " must be finite, got ", value, ' ', unit);
}
std::string name_of(const char* what, std::size_t i) {
  return std::string(what) + ' ' + std::to_string(i);
}

void validate_spring(const Scene& scene, std::size_t i) {
  const Spring& spring = scene.springs[i];
  const std::string name = name_of("spring", i);
  validate_point(scene, spring.a, name + ", point a");
  validate_point(scene, spring.b, name + ", point b");
  if (spring.a.particles == spring.b.particles && spring.a.weights == spring.b.weights)
    refuse(name, ": both points are the same");
  if (!moves(scene, spring.a) && !moves(scene, spring.b)) refuse(name, ": all its particles are fixed");
  require_sound(spring, i);
}

void validate_torsion(const Scene& scene, std::size_t i) {
  const Torsion& torsion = scene.torsions[i];
  const std::string name = name_of("torsion", i);
  if (validate_direction(scene, torsion.axis, name + ", axis") == 0)
    refuse(name, ", axis: is of length zero");
  const double u = validate_direction(scene, torsion.u, name + ", u");
  const double v = validate_direction(scene, torsion.v, name + ", v");
  const auto along = [&](const Direction& d) {
    return position_of(scene, d.to) - position_of(scene, d.from);
  };
  const Across across(along(torsion.axis), along(torsion.u), along(torsion.v));
  if (!(norm(across.u) > least_across * u)) refuse(name, ", u: lies along the axis, or is of length zero");
  if (!(norm(across.v) > least_across * v)) refuse(name, ", v: lies along the axis, or is of length zero");
  if (!moves(scene, torsion.axis) && !moves(scene, torsion.u) && !moves(scene, torsion.v))
    refuse(name, ": all its particles are fixed");
  require_sound(torsion, i);
}

}  // namespace

void validate_springs(const Scene& scene) {
  for (std::size_t i = 0; i < scene.springs.size(); ++i) validate_spring(scene, i);
  for (std::size_t i = 0; i < scene.torsions.size(); ++i) validate_torsion(scene, i);
}

void require_sound(const Spring& spring, std::size_t i) {
  const std::string name = name_of("spring", i);
  require_amount(name, "length", spring.length, "m");
  require_amount(name, "stiffness", spring.stiffness, "N/m");
  require_amount(name, "damping", spring.damping, "N s/m");
  require_finite(name, "force", spring.force, "N");
}

void require_sound(const Torsion& torsion, std::size_t i) {
  const std::string name = name_of("torsion", i);
  require_finite(name, "angle", torsion.angle, "rad");
  require_amount(name, "stiffness", torsion.stiffness, "N m/rad");
  require_amount(name, "damping", torsion.damping, "N m s/rad");
  require_finite(name, "torque", torsion.torque, "N m");
}

void require_sound(const AngleControl& angle, std::size_t i) {
  const std::string name = name_of("angle", i);
  if (!(angle.lower >= 0 && angle.upper <= std::numbers::pi && angle.lower < angle.upper)) {
    refuse(name, ": limits must be within 0 and pi, the lower below the upper, got ", angle.lower, " and ",
           angle.upper, " rad");
  }
  if (!(angle.target >= 0 && angle.target <= std::numbers::pi))
    refuse(name, ": target must be within 0 and pi, got ", angle.target, " rad");
  require_amount(name, "friction", angle.friction, "N m");
  require_amount(name, "stiffness", angle.stiffness, "N m/rad");
  require_amount(name, "damping", angle.damping, "N m s/rad");
}

double spring_energy(const Scene& scene, std::span<const Vec3> positions) {
  const auto place = [&](const Point& point) {
    Vec3 sum{};
    for (std::size_t k = 0; k < 4; ++k)
      if (point.weights[k] != 0) sum += point.weights[k] * positions[point.particles[k]];
    return sum;
  };
  const auto along = [&](const Direction& d) { return place(d.to) - place(d.from); };
  double sum = 0;
  for (const Spring& spring : scene.springs) {
    const double off = norm(place(spring.b) - place(spring.a)) - spring.length;
    if (!(spring.one_sided && off < 0)) sum += 0.5 * spring.stiffness * off * off;
  }
  for (const Torsion& torsion : scene.torsions) {
    const double turn = Across(along(torsion.axis), along(torsion.u), along(torsion.v)).turn();
    sum += 0.5 * torsion.stiffness * (turn - torsion.angle) * (turn - torsion.angle);
  }
  for (const AngleControl& angle : scene.angles) {
    if (angle.stiffness == 0) continue;
    const Vec3 u = along(angle.u), v = along(angle.v);
    const double off = angle_of(dot(u, v), norm(cross(u, v))) - angle.target;
    sum += 0.5 * angle.stiffness * off * off;
  }
  return sum;
}

}  // namespace plumb::detail
