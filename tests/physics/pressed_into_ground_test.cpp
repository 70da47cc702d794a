// Ropes and limbs that lie on ground, and what is a hundred times as heavy that falls on them. Sweeps give
// nearly all of such a blow to what is light: before ground had the last word, its middle went through.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double radius = 0.02, ball_radius = 0.1;

enum class Ground { plane, box, open_mesh, solid_mesh, sphere };
constexpr Ground all_grounds[] = {Ground::plane, Ground::box, Ground::open_mesh, Ground::solid_mesh,
                                  Ground::sphere};
/// The sphere is so large that the rope is above it by at most 10 mm.
constexpr double sphere_radius = 20;

/// A level square of two triangles, or a box of twelve below it, 6 m to all sides.
GroundMesh mesh(bool solid) {
  constexpr double side = 6;
  GroundMesh out;
  for (int i = 0; i < 8; ++i)
    out.vertices.push_back({i & 1 ? side : -side, i & 2 ? 0.0 : -1.0, i & 4 ? side : -side});
  out.triangles = {{2, 6, 7}, {2, 7, 3}};
  if (!solid) return out;
  out.solid = true;
  for (const auto& each :
       {std::array{0u, 1u, 5u, 4u}, {0u, 2u, 3u, 1u}, {4u, 5u, 7u, 6u}, {0u, 4u, 6u, 2u}, {1u, 3u, 7u, 5u}}) {
    out.triangles.push_back({each[0], each[1], each[2]});
    out.triangles.push_back({each[0], each[2], each[3]});
  }
  return out;
}

void add_ground(Scene& scene, Ground ground) {
  if (ground == Ground::plane) scene.planes.push_back({});
  if (ground == Ground::box) scene.boxes.push_back({.center = {0, -0.5, 0}, .half_size = {6, 0.5, 6}});
  if (ground == Ground::open_mesh || ground == Ground::solid_mesh)
    scene.meshes.push_back(mesh(ground == Ground::solid_mesh));
  const Vec3 middle{0, -sphere_radius, 0};
  if (ground == Ground::sphere)
    scene.ground_capsules.push_back({.a = middle, .b = middle, .radius = sphere_radius});
}

double height_above(Ground ground, Vec3 at) {
  return ground == Ground::sphere ? norm(at - Vec3{0, -sphere_radius, 0}) - sphere_radius : at.y;
}

/// A rope of 13 particles of 50 g along x.
void add_rope(Scene& scene) {
  for (std::uint32_t i = 0; i <= 12; ++i) {
    scene.particles.push_back({.position = {0.1 * i - 0.6, radius, 0}, .mass = 0.05});
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = radius});
  }
}

void add_ball(Scene& scene, double mass, Vec3 center) {
  MassProperties ball = solid_sphere(mass, ball_radius);
  ball.center = center;
  const std::uint32_t body = add_body(scene, ball);
  scene.capsules.push_back(sphere_at(point_on_body(scene, body, center), ball_radius));
}

/// Steps of two seconds, and how deep (m) the surface of what is light was in ground, at most and at last.
struct Fall {
  StepReport total;
  double deepest = 0, last = 0;
};

template <class Depth>
Fall let_fall(const Scene& scene, Precision precision, Depth&& depth) {
  World world(scene, {.method = Method::relax, .precision = precision, .threads = 1});
  Fall out;
  for (int i = 0; i < 120; ++i) {
    out.total += world.step(test::frame);
    out.last = depth(world);
    out.deepest = std::max(out.deepest, out.last);
  }
  return out;
}

/// What a substep leaves of a depth is a twentieth of the radius, and the next one takes a tenth of all
/// beyond the slop back. The depth at which both are alike is the most.
constexpr double most_deep(double of) {
  return 0.5e-3 + 0.5 * of;
}

// A rope lay with its middle below ground in 23 of 24 such runs, and up to 0.9 m below an open mesh.
TEST(PressedIntoGround, ARopeStaysOnIt) {
  for (const Precision precision : {Precision::double_, Precision::single})
    for (const Ground ground : all_grounds)
      for (const double mass : {1.0, 5.0, 30.0})
        for (int k = 0; k < 8; ++k) {
          SCOPED_TRACE(std::to_string(static_cast<int>(ground)) + ", kg " + std::to_string(mass) + ", run " +
                       std::to_string(k));
          Scene scene;
          add_ground(scene, ground);
          add_rope(scene);
          add_ball(scene, mass, {0.09 * k - 0.3, 1.2, 0.009 * k});
          const Fall fallen = let_fall(scene, precision, [&](const World& world) {
            double most = 0;
            for (std::uint32_t i = 0; i <= 12; ++i)
              most = std::max(most, radius - height_above(ground, world.position(i)));
            return most;
          });
          EXPECT_LT(fallen.deepest, most_deep(radius));
          EXPECT_EQ(fallen.total.missed_contacts, 0u);
        }
}

// The ends of limbs lie on bodies. What throws them into a plane within a substep does so from where they
// were not near it.
TEST(PressedIntoGround, LightLimbsStayOnAPlane) {
  constexpr double thick = 0.03;
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    Scene scene;
    scene.joint_drag = 3;
    scene.planes.push_back({});
    const auto add_limb = [&](Vec3 from, Vec3 to, double mass, double radius_of) {
      const std::uint32_t body = add_body(scene, solid_cylinder(mass, radius_of, from, to));
      scene.capsules.push_back(
          {.a = point_on_body(scene, body, from), .b = point_on_body(scene, body, to), .radius = radius_of});
      return body;
    };
    for (std::uint32_t i = 0; i < 5; ++i) {
      const double x = 0.2 * i - 0.5;
      const std::uint32_t body = add_limb({x, thick, 0}, {x + 0.16, thick, 0}, 0.1, thick);
      const Vec3 joint{x - 0.02, thick, 0};
      if (i > 0)
        add_spherical(scene, point_on_body(scene, body - 1, joint), point_on_body(scene, body, joint));
    }
    add_limb({0.05 * k - 0.4, 1.2, -0.1}, {0.05 * k, 1.25, 0.1}, 30, 0.08);
    const Fall fallen = let_fall(scene, Precision::double_, [&](const World& world) {
      double most = 0;
      for (std::uint32_t i = 0; i < 5; ++i) most = std::max(most, thick - world.pose(i).position.y);
      return most;
    });
    EXPECT_LT(fallen.deepest, most_deep(thick));
    EXPECT_EQ(fallen.total.missed_contacts, 0u);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
