// A ragdoll sits and is struck on the chest. Its muscles, which are drives of its hinges, go limp for a
// moment and then bring it back to its pose.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <span>
#include <vector>

namespace {

constexpr plumb::Vec3 up{0, 0.2, 0}, across{0, 0, 0.2};

/// Adds a limb between two places, and returns its body.
std::uint32_t add_limb(plumb::Scene& scene, plumb::Vec3 from, plumb::Vec3 to, double mass, double radius) {
  return plumb::add_body(scene, plumb::solid_cylinder(mass, radius, from, to));
}

/// Joins two limbs by a hinge across the sagittal plane, with a drive that seeks the pose of now.
void join(plumb::Scene& scene, std::uint32_t a, std::uint32_t b, plumb::Vec3 place) {
  plumb::add_revolute(scene, a, b, place, across);
  const auto way = [&](std::uint32_t body, plumb::Vec3 along) {
    return plumb::Direction{plumb::point_on_body(scene, body, place),
                            plumb::point_on_body(scene, body, place + along)};
  };
  scene.torsions.push_back({.axis = way(a, across), .u = way(a, up), .v = way(b, up)});
}

}  // namespace

int main() {
  plumb::Scene scene;  // a pelvis that sits fast
  for (const plumb::Vec3 at : {plumb::Vec3{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}})
    scene.particles.push_back({.position = at, .fixed = true});
  const std::uint32_t pelvis = plumb::add_body(scene, {0, 1, 2, 3}, plumb::solid_sphere(10, 0.1));
  const std::uint32_t torso = add_limb(scene, {0, 0, 0}, {0, 0.5, 0}, 30, 0.12);
  const std::uint32_t head = add_limb(scene, {0, 0.55, 0}, {0, 0.75, 0}, 5, 0.1);
  join(scene, pelvis, torso, {0, 0, 0});
  join(scene, torso, head, {0, 0.55, 0});
  for (const double side : {-0.2, 0.2}) {
    const plumb::Vec3 shoulder{0, 0.45, side}, elbow{0, 0.15, side}, hand{0.3, 0.15, side};
    const std::uint32_t upper = add_limb(scene, shoulder, elbow, 2, 0.04);
    join(scene, torso, upper, shoulder);
    join(scene, upper, add_limb(scene, elbow, hand, 1.5, 0.03), elbow);
  }

  plumb::World world(scene, {.substeps = 4});
  const plumb::Point chest = plumb::point_on_body(scene, torso, {0, 0.4, 0});
  constexpr double blow = 2, limp = 0.4;  // s
  world.set_load([&](const plumb::LoadState& state, std::span<plumb::Vec3> forces) {
    if (state.time > blow && state.time < blow + 0.05) plumb::add_force(chest, {-2000, 0, 0}, forces);
  });
  const auto farthest = [&] {
    double out = 0;
    for (std::uint32_t i = 0; i < scene.torsions.size(); ++i)
      out = std::max(out, std::abs(world.torsion_angle(i)));
    return out;
  };
  double before = 0, most = 0;
  while (world.time() < 8) {
    // What a muscle can is by what it carries: hip, neck, and shoulders and elbows on both sides.
    constexpr std::array<double, 6> strength{4000, 400, 300, 150, 300, 150};  // N m/rad
    const bool is_limp = world.time() > blow && world.time() < blow + limp;
    for (std::uint32_t i = 0; i < strength.size(); ++i) {
      const double stiffness = (is_limp ? 0.05 : 1) * strength[i];
      world.set_torsion(i, {.stiffness = stiffness, .damping = 0.1 * stiffness});
    }
    world.step(1.0 / 60);
    if (world.time() < blow) before = farthest();
    most = std::max(most, farthest());
  }
  std::printf("at rest %.2f rad from its pose; struck, up to %.2f rad; brought back to %.2f rad\n", before,
              most, farthest());
}
