#include "scene/validate_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumb/joints.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/barycentric.hpp"
#include "scene/flat/flat_bodies.hpp"
#include "scene/ground/validate_ground.hpp"
#include "scene/refuse.hpp"
#include "scene/second_moments.hpp"
#include "scene/springs/springs.hpp"
#include "scene/springs/turn.hpp"

namespace plumb::detail {
namespace {

/// Sums that must be one, and lengths that must be one, may be off by this much. A larger value accepts
/// scenes whose joints start with larger errors.
constexpr double rounding = 1e-9;
/// What rigid rods keep as it is may be off what a joint asks by this share.
constexpr double same = same_place;
/// Second moments count as nothing below this share of the largest, which rounding may leave of it.
constexpr double flat = 1e-12;

bool is_amount(double value) {
  return value >= 0 && std::isfinite(value);
}

std::uint64_t pair_of(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return std::uint64_t{low} << 32 | high;
}

/// Returns the ends of the rods that are wanted, in ascending order.
template <class IsWanted>
Array<std::uint64_t> sorted_pairs(const std::vector<Rod>& rods, IsWanted&& is_wanted) {
  Array<std::uint64_t> pairs;
  pairs.reserve(rods.size());
  for (const Rod& rod : rods)
    if (is_wanted(rod)) pairs.push_back(pair_of(rod.a, rod.b));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void require_rods(const Scene& scene, std::size_t i, const Array<std::uint64_t>& pairs) {
  const auto& ids = scene.bodies[i].particles;
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < j; ++k) {
      if (scene.particles[ids[j]].fixed && scene.particles[ids[k]].fixed) continue;
      if (std::binary_search(pairs.begin(), pairs.end(), pair_of(ids[j], ids[k]))) continue;
      refuse("body ", i, ": no rod keeps its particles ", ids[k], " and ", ids[j], " apart");
    }
}

/// A flat body has no inertia against some motions of its four particles, and only rigid rods forbid these.
void require_rigid_rods(const Scene& scene, std::size_t i, const Array<std::uint64_t>& giving) {
  const auto& ids = scene.bodies[i].particles;
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < j; ++k)
      if (std::binary_search(giving.begin(), giving.end(), pair_of(ids[j], ids[k])) &&
          has_singular_mass(scene, i))
        refuse("body ", i, ": the rod between its particles ", ids[k], " and ", ids[j],
               " must be rigid, because the body is flat or thin");
}

/// Returns the size (m) of the solid that rigid rods make of all particles of some points, or 0 if they make
/// none. `rigid` has the ends of these rods. What the points are to each other never changes there.
double size_of_solid(const Scene& scene, const Array<std::uint64_t>& rigid,
                     std::initializer_list<Point> points) {
  std::array<std::uint32_t, 16> particles;
  std::size_t count = 0;
  for (const Point& point : points)
    for (std::size_t k = 0; k < 4; ++k)
      if (point.weights[k] != 0) particles[count++] = point.particles[k];
  double size = 0;
  for (std::size_t j = count; j-- > 1;)  // from the last to the first, which most joints have on two solids
    for (std::size_t k = 0; k < j; ++k) {
      const Particle &a = scene.particles[particles[j]], &b = scene.particles[particles[k]];
      if (&a == &b) continue;
      if (!(a.fixed && b.fixed) &&
          !std::binary_search(rigid.begin(), rigid.end(), pair_of(particles[j], particles[k])))
        return 0;
      size = std::max(size, norm(b.position - a.position));
    }
  return size;
}

void validate_pin(const Scene& scene, std::size_t i, const Array<std::uint64_t>& rigid) {
  const Pin& pin = scene.pins[i];
  const std::string name = "pin " + std::to_string(i);
  validate_point(scene, pin.a, name + ", point a");
  validate_point(scene, pin.b, name + ", point b");
  if (pin.a.particles == pin.b.particles && pin.a.weights == pin.b.weights)
    refuse(name, ": both points are the same");
  if (!moves(scene, pin.a) && !moves(scene, pin.b)) refuse(name, ": all its particles are fixed");
  const double apart = norm(position_of(scene, pin.b) - position_of(scene, pin.a));
  if (const double size = size_of_solid(scene, rigid, {pin.a, pin.b}); size > 0 && apart > same * size)
    refuse(name, ": its places are ", apart, " m apart, and rigid rods keep them so");
}

void validate_alignment(const Scene& scene, std::size_t i, const Array<std::uint64_t>& rigid) {
  const auto& [u, v, value] = scene.alignments[i];
  const std::string name = "alignment " + std::to_string(i);
  const double u_length = validate_direction(scene, u, name + ", u");
  const double v_length = validate_direction(scene, v, name + ", v");
  if (u_length == 0 && v_length == 0) refuse(name, ": both directions are of length zero");
  if (!moves(scene, u) && !moves(scene, v)) refuse(name, ": all its particles are fixed");
  if (!value) return;
  if (!std::isfinite(*value)) refuse(name, ": value is not finite: ", *value);
  const double now = dot(along(scene, u), along(scene, v));
  if (const double size = size_of_solid(scene, rigid, {u.from, u.to, v.from, v.to});
      size > 0 && std::abs(now - *value) > same * size * size)
    refuse(name, ": its value is ", *value, " m^2, but ", now, " m^2 as rigid rods keep it");
}

void validate_angle(const Scene& scene, std::size_t i, const Array<std::uint64_t>& rigid) {
  const AngleControl& angle = scene.angles[i];
  const std::string name = "angle " + std::to_string(i);
  if (validate_direction(scene, angle.u, name + ", u") == 0) refuse(name, ", u: is of length zero");
  if (validate_direction(scene, angle.v, name + ", v") == 0) refuse(name, ", v: is of length zero");
  require_sound(angle, i);
  const Vec3 u = along(scene, angle.u), v = along(scene, angle.v);
  const double now = angle_of(dot(u, v), norm(cross(u, v)));
  if ((now < angle.lower - same || now > angle.upper + same) &&
      size_of_solid(scene, rigid, {angle.u.from, angle.u.to, angle.v.from, angle.v.to}) > 0)
    refuse(name, ": is ", now, " rad, beyond its limits, and rigid rods keep it so");
}

void validate_motion(const Scene& scene, const GroundMotion& motion, const std::string& name) {
  if (motion.platform && *motion.platform >= scene.platforms.size())
    refuse(name, ": platform ", *motion.platform, " does not exist (the scene has ", scene.platforms.size(),
           " platforms)");
  if (!is_finite(motion.belt)) refuse(name, ": belt is not finite");
}

void require_unit(const std::array<double, 4>& quaternion, const std::string& name) {
  const auto [w, x, y, z] = quaternion;
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(std::abs(length - 1) <= rounding))
    refuse(name, ": orientation must be a quaternion of length 1, not ", length);
}

void validate_capsule(const Scene& scene, std::size_t i) {
  const Capsule& capsule = scene.capsules[i];
  const std::string name = "capsule " + std::to_string(i);
  validate_point(scene, capsule.a, name + ", point a");
  if (capsule.b.weights == std::array<double, 4>{})
    refuse(name,
           ", point b: has no weights; those of a sphere are those of point a, as sphere_at() has them");
  validate_point(scene, capsule.b, name + ", point b");
  if (!is_amount(capsule.radius))
    refuse(name, ": radius must be finite and not negative, got ", capsule.radius, " m");
  validate_surface(capsule.surface, name);
}

void validate_plane(const Scene& scene, std::size_t i) {
  const Plane& plane = scene.planes[i];
  const std::string name = "plane " + std::to_string(i);
  const double length = norm(plane.normal);
  if (!(std::abs(length - 1) <= rounding)) refuse(name, ": normal must be of length 1, not ", length);
  if (!std::isfinite(plane.offset)) refuse(name, ": offset is not finite: ", plane.offset);
  validate_touch(plane, name);
  validate_motion(scene, plane.motion, name);
}

void validate_box(const Scene& scene, std::size_t i) {
  const Box& box = scene.boxes[i];
  const std::string name = "box " + std::to_string(i);
  if (!is_finite(box.center)) refuse(name, ": center is not finite");
  for (const double half : {box.half_size.x, box.half_size.y, box.half_size.z})
    if (!(half > 0 && std::isfinite(half)))
      refuse(name, ": half size must be positive and finite, got ", half, " m");
  require_unit(box.orientation, name);
  validate_touch(box, name);
  validate_motion(scene, box.motion, name);
}

}  // namespace

void validate_pose(const Pose& pose, std::size_t i) {
  const std::string name = "platform " + std::to_string(i);
  if (!is_finite(pose.position)) refuse(name, ": position is not finite");
  require_unit(pose.orientation, name);
}

void validate_point(const Scene& scene, const Point& point, const std::string& name) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double weight = point.weights[k];
    if (weight == 0) continue;
    if (!std::isfinite(weight)) refuse(name, ": weight is not finite: ", weight);
    if (point.particles[k] >= scene.particles.size()) {
      refuse(name, ": particle ", point.particles[k], " does not exist (the scene has ",
             scene.particles.size(), " particles)");
    }
    sum += weight;
  }
  if (!(std::abs(sum - 1) <= rounding)) refuse(name, ": weights must add up to 1, not ", sum);
}

bool moves(const Scene& scene, const Point& point) {
  for (std::size_t k = 0; k < 4; ++k)
    if (point.weights[k] != 0 && !scene.particles[point.particles[k]].fixed) return true;
  return false;
}
bool moves(const Scene& scene, const Direction& d) {
  return moves(scene, d.from) || moves(scene, d.to);
}

double validate_direction(const Scene& scene, const Direction& direction, const std::string& name) {
  validate_point(scene, direction.from, name + ".from");
  validate_point(scene, direction.to, name + ".to");
  return norm(along(scene, direction));
}

Vec3 along(const Scene& scene, const Direction& direction) {
  return position_of(scene, direction.to) - position_of(scene, direction.from);
}

std::array<Vec3, 4> positions_of(const Scene& scene, const std::array<std::uint32_t, 4>& particles) {
  std::array<Vec3, 4> positions;
  for (std::size_t k = 0; k < 4; ++k) positions[k] = scene.particles[particles[k]].position;
  return positions;
}

void require_particles(const Scene& scene, std::size_t i, const std::array<std::uint32_t, 4>& particles) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (particles[k] >= scene.particles.size()) {
      refuse("body ", i, ": particle ", particles[k], " does not exist (the scene has ",
             scene.particles.size(), " particles)");
    }
    for (std::size_t j = 0; j < k; ++j)
      if (particles[j] == particles[k]) refuse("body ", i, ": particle ", particles[k], " is there twice");
  }
}

void require_volume(std::size_t i, const std::array<Vec3, 4>& positions) {
  if (!(relative_volume(positions) > 1e-9)) refuse("body ", i, ": its particles lie in one plane");
}

void require_solid(std::size_t i, const MassProperties& properties) {
  const auto& [mass, center, inertia] = properties;
  if (!(mass > 0 && std::isfinite(mass)))
    refuse("body ", i, ": mass must be positive and finite, got ", mass, " kg");
  if (!is_finite(center)) refuse("body ", i, ": center of mass is not finite");
  if (!is_finite(inertia)) refuse("body ", i, ": inertia is not finite");
  const auto moment = principal_axes(second_moments(inertia)).moment;
  if (!(moment[2] > 0 && moment[0] >= -flat * moment[2])) {
    refuse("body ", i, ": inertia is not that of a solid: a second moment of its mass is negative (",
           moment[0], " kg m^2)");
  }
  if (!(moment[0] + moment[1] > flat * moment[2])) {
    refuse("body ", i, ": inertia is that of a line, which nothing keeps from spinning about itself: a body ",
           "needs a thickness of more than 1e-6 of its length, and a rod with mass needs none");
  }
}

void validate_bodies(const Scene& scene) {
  if (scene.bodies.empty()) return;
  const Array<std::uint64_t> pairs = sorted_pairs(scene.rods, [](const Rod&) { return true; });
  const Array<std::uint64_t> giving =
      sorted_pairs(scene.rods, [](const Rod& rod) { return !rod.law.is_rigid(); });
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    require_particles(scene, i, body.particles);
    require_volume(i, positions_of(scene, body.particles));
    require_solid(i, {body.mass, body.center, body.inertia});
    require_rods(scene, i, pairs);
    require_rigid_rods(scene, i, giving);
  }
}

void validate_joints(const Scene& scene) {
  Array<std::uint64_t> rigid;
  if (!scene.pins.empty() || !scene.alignments.empty() || !scene.angles.empty())
    rigid = sorted_pairs(scene.rods, [](const Rod& rod) { return rod.law.is_rigid(); });
  for (std::size_t i = 0; i < scene.pins.size(); ++i) validate_pin(scene, i, rigid);
  for (std::size_t i = 0; i < scene.alignments.size(); ++i) validate_alignment(scene, i, rigid);
  for (std::size_t i = 0; i < scene.angles.size(); ++i) validate_angle(scene, i, rigid);
}

void validate_shapes(const Scene& scene) {
  for (std::size_t i = 0; i < scene.capsules.size(); ++i) validate_capsule(scene, i);
  for (std::size_t i = 0; i < scene.planes.size(); ++i) validate_plane(scene, i);
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) validate_box(scene, i);
  for (std::size_t i = 0; i < scene.platforms.size(); ++i) validate_pose(scene.platforms[i], i);
  validate_hulls(scene);
  validate_ground(scene);
}

}  // namespace plumb::detail
