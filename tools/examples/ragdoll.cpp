// A ragdoll falls on the ground. Its bodies have the inertia of cylinders, ball joints between them, and
// capsules to touch with. It sleeps when all of it lies still.
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

namespace {

/// Adds a limb from one place to the other with its shape. Returns its body.
std::uint32_t add_limb(plumb::Scene& scene, plumb::Vec3 from, plumb::Vec3 to, double mass, double radius) {
  const std::uint32_t body = plumb::add_body(scene, plumb::solid_cylinder(mass, radius, from, to));
  scene.capsules.push_back({.a = plumb::point_on_body(scene, body, from),
                            .b = plumb::point_on_body(scene, body, to),
                            .radius = radius});
  return body;
}

/// Adds a ball joint between two bodies at `place`.
void join(plumb::Scene& scene, std::uint32_t a, std::uint32_t b, plumb::Vec3 place) {
  plumb::add_spherical(scene, plumb::point_on_body(scene, a, place), plumb::point_on_body(scene, b, place));
}

}  // namespace

int main() {
  plumb::Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  scene.joint_drag = 3;  // The unit is 1/s. Joints that nothing brakes swing for ever.
  const std::uint32_t torso = add_limb(scene, {0, 1, 0}, {0.5, 1, 0}, 30, 0.12);
  join(scene, torso, add_limb(scene, {0.65, 1, 0}, {0.8, 1, 0}, 4, 0.1), {0.6, 1, 0});
  for (const double side : {-1.0, 1.0}) {
    const plumb::Vec3 hip{-0.1, 1, 0.1 * side}, knee{-0.5, 1, 0.1 * side}, foot{-0.9, 1, 0.1 * side};
    const plumb::Vec3 shoulder{0.45, 1, 0.15 * side}, hand{0.45, 1, 0.7 * side};
    const std::uint32_t thigh = add_limb(scene, hip, knee, 8, 0.07);
    join(scene, torso, thigh, hip);
    join(scene, thigh, add_limb(scene, knee, foot, 5, 0.05), knee);
    join(scene, torso, add_limb(scene, shoulder, hand, 4, 0.05), shoulder);
  }

  // Method automatic solves bodies and what touches, or relaxes large heaps.
  plumb::World world(scene, {.method = plumb::Method::automatic, .substeps = 4});
  bool awake = true;
  while (awake && world.time() < 20) awake = world.step(1.0 / 60).awake_islands > 0;

  const plumb::Point& place = scene.capsules[0].a;  // It is one end of the torso.
  double height = 0;
  for (std::size_t k = 0; k < 4; ++k) height += place.weights[k] * world.position(place.particles[k]).y;
  std::printf("the torso lies %.2f m above the ground; asleep: %s\n", height, awake ? "no" : "yes");
}
