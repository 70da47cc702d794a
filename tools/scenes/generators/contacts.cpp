#include "scenes/generators/contacts.hpp"

#include <cmath>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"
#include "scenes/basics/require.hpp"

namespace plumb::scenes {
namespace {

Surface surface_of(double friction, double restitution) {
  require_not_negative(friction, "friction");
  if (!(restitution >= 0 && restitution <= 1)) throw InputError("restitution must be from 0 to 1");
  return {.friction = friction, .restitution = restitution};
}

}  // namespace

Scene make_stick_box(const StickBoxShape& shape) {
  require_positive(shape.length, "length");
  require_positive(shape.size, "size");
  if (!(shape.length < shape.size)) throw InputError("length must be below the box's size");
  if (!std::isfinite(shape.speed)) throw InputError("speed must be finite");
  if (!std::isfinite(shape.spin)) throw InputError("spin must be finite");
  const Surface surface = surface_of(shape.friction, shape.restitution);
  const double radius = shape.length / 100;
  const double middle = shape.size / 2;
  const Vec3 half{shape.length / 2, 0, 0};
  const Vec3 velocity = (shape.speed / 3) * Vec3{2, 1, 2};
  const Vec3 turning = cross({0, 0, shape.spin}, half);
  Scene scene;
  for (const double sign : {-1.0, 1.0})
    scene.particles.push_back({.position = Vec3{middle, middle, middle} + sign * half,
                               .velocity = velocity + sign * turning,
                               .mass = 1});
  scene.rods.push_back({.a = 0, .b = 1, .length = shape.length});
  scene.capsules.push_back({.a = point_at(0), .b = point_at(1), .radius = radius, .surface = surface});
  // Walls stand back by the stick's radius, so that its particles stay between 0 and the size.
  for (const Vec3 normal : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    scene.planes.push_back({.normal = normal, .offset = -radius, .surface = surface});
    scene.planes.push_back({.normal = -1.0 * normal, .offset = -(shape.size + radius), .surface = surface});
  }
  return scene;
}

Scene make_drop(const DropShape& shape) {
  require_not_negative(shape.height, "height");
  require_positive(shape.radius, "radius");
  require_positive(shape.mass, "mass");
  const Surface surface = surface_of(shape.friction, shape.restitution);
  Scene scene;
  scene.particles.push_back({.position = {0, shape.height + shape.radius, 0}, .mass = shape.mass});
  scene.capsules.push_back({.a = point_at(0), .b = point_at(0), .radius = shape.radius, .surface = surface});
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0, .surface = surface});
  return scene;
}

}  // namespace plumb::scenes
