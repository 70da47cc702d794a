#include "golden/contact_scenes.hpp"

#include "plumb/joints.hpp"
#include "support/bodies.hpp"

namespace plumb::golden {
namespace {

constexpr Surface rough{.friction = 0.5, .restitution = 0.1};

/// A solid block with a ball of 1 cm at each of its eight corners, which are what touches.
std::uint32_t add_block(Scene& scene, Vec3 center, Vec3 size, double mass) {
  MassProperties block = solid_box(mass, size);
  block.center = center;
  const std::uint32_t body = add_body(scene, block);
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int bit, double extent) {
      return (corner >> bit & 1) != 0 ? extent / 2 : -extent / 2;
    };
    const Point at =
        point_on_body(scene, body, center + Vec3{side(0, size.x), side(1, size.y), side(2, size.z)});
    scene.capsules.push_back({.a = at, .b = at, .radius = 0.01, .surface = rough});
  }
  return body;
}

/// A bar along the middle of a block's top, for the block above to stand on.
void add_bar(Scene& scene, std::uint32_t body, Vec3 center, Vec3 size) {
  const Vec3 half{size.x / 2, 0, 0}, top = center + Vec3{0, size.y / 2, 0};
  for (const double z : {-size.z / 2, size.z / 2}) {
    const Vec3 edge = top + Vec3{0, 0, z};
    scene.capsules.push_back({.a = point_on_body(scene, body, edge - half),
                              .b = point_on_body(scene, body, edge + half),
                              .radius = 0.01,
                              .surface = rough});
  }
}

}  // namespace

Scene make_tower() {
  Scene scene;
  scene.planes.push_back({.surface = rough});
  const Vec3 size{0.5, 0.2, 0.4};
  double bottom = 0.01;
  for (int i = 0; i < 3; ++i) {
    // Each is set a little aside, so that nothing is symmetric.
    const Vec3 center{0.03 * i, bottom + size.y / 2, -0.01 * i};
    add_bar(scene, add_block(scene, center, size, 2.0 + i), center, size);
    bottom += size.y + 0.03;
  }
  return scene;
}

Scene make_slide() {
  Scene scene;
  // The slope is 3 in 4: its normal has the sides of a triangle of 3, 4 and 5.
  scene.planes.push_back({.normal = {0.6, 0.8, 0}, .offset = 0, .surface = {.friction = 0.3}});
  scene.boxes.push_back({.center = {0.7, -0.5, 0}, .half_size = {0.2, 0.3, 1}, .surface = rough});
  add_block(scene, {0.05, 0.2, 0.1}, {0.2, 0.1, 0.15}, 1.5);
  return scene;
}

Scene make_rollers() {
  Scene scene;
  const Surface grippy{.friction = 0.7, .restitution = 0.2, .rolling = 1e-3, .spinning = 2e-3};
  scene.platforms = {{.position = {1, 0, 0}}};
  scene.planes.push_back({.surface = rough, .motion = {.belt = {0.5, 0, -0.25}}});
  scene.boxes.push_back(
      {.center = {1, 0.1, 0}, .half_size = {0.5, 0.1, 0.5}, .surface = grippy, .motion = {.platform = 0}});
  test::add_fixed_body(scene);
  scene.capsules.push_back({.a = point_on_body(scene, 0, {-1, 0.25, -1}),
                            .b = point_on_body(scene, 0, {-1, 0.25, 1}),
                            .radius = 0.25,
                            .surface = grippy});
  for (int i = 0; i < 6; ++i) {
    const bool is_ball = i % 2 == 0;
    MassProperties solid = is_ball ? solid_sphere(1 + i, 0.1) : solid_capsule(1 + i, 0.1, 0.25);
    solid.center = {0.5 * i - 1, 0.4 + 0.125 * (i % 3), 0.25 - 0.0625 * i};
    const std::uint32_t body = add_body(scene, solid);
    const Vec3 half{is_ball ? 0 : 0.125, 0, 0};
    scene.capsules.push_back({.a = point_on_body(scene, body, solid.center - half),
                              .b = point_on_body(scene, body, solid.center + half),
                              .radius = 0.1,
                              .surface = i < 3 ? rough : grippy,
                              .filter = {.group = i == 4 ? -1 : 0}});
    test::set_motion(scene, body, {0.25 * i, 0, 0.5}, {0, 4, 2.0 * i});
  }
  add_block(scene, {1, 0.4, 0.25}, {0.2, 0.1, 0.15}, 1.5);
  return scene;
}

Scene make_mechanism() {
  Scene scene;
  const Vec3 along = (1 / 3.0) * Vec3{2, 1, 2}, across = (1 / 3.0) * Vec3{1, 2, -2};
  const Vec3 reach{0.5, -0.1, 0.2};  // m, from joint to joint
  std::uint32_t above = test::add_fixed_body(scene);
  Vec3 joint{};
  for (int i = 0; i < 5; ++i) {
    MassProperties block = solid_box(1 + 0.5 * i, {0.3, 0.4, 0.5});
    block.center = joint + 0.5 * reach;
    const std::uint32_t body = add_body(scene, block);
    if (i == 0 || i == 4)
      add_spherical(scene, point_on_body(scene, above, joint), point_on_body(scene, body, joint));
    if (i == 1) add_revolute(scene, above, body, joint, along);
    if (i == 2) add_universal(scene, above, body, joint, along, across);
    if (i == 3) add_prismatic(scene, above, body, joint, across);
    if (i != 3) {
      const auto direction = [&](std::uint32_t of, Vec3 way) {
        return Direction{point_on_body(scene, of, joint), point_on_body(scene, of, joint + way)};
      };
      AngleControl angle{.u = direction(above, along), .v = direction(body, across)};
      if (i == 0) angle.lower = 1.4, angle.upper = 1.7;
      if (i == 1) angle.friction = 0.8;
      if (i == 2) angle.target = 1.2, angle.stiffness = 30, angle.damping = 2;
      if (i == 4) angle.lower = 1.5, angle.friction = 0.2, angle.damping = 0.1;
      scene.angles.push_back(angle);
    }
    above = body;
    joint += reach;
  }
  return scene;
}

Scene make_springs() {
  Scene scene = make_mechanism();
  const auto on = [&](std::uint32_t body, Vec3 by) {
    return point_on_body(scene, body, scene.bodies[body].center + by);
  };
  const auto way = [&](std::uint32_t body, Vec3 along) { return Direction{on(body, {}), on(body, along)}; };
  scene.springs = {
      {.a = on(1, {}), .b = on(3, {0.1, 0, 0}), .length = 0.5, .stiffness = 200, .damping = 1, .force = 3},
      {.a = on(2, {}), .b = on(5, {}), .stiffness = 30, .damping = 0.5},
      {.a = on(0, {1, 0, 0}), .b = on(5, {0, 0.1, 0}), .length = 1.5, .stiffness = 1e6, .one_sided = true}};
  scene.torsions = {{.axis = way(1, {0, 0, 1}),
                     .u = way(1, {1, 0, 0}),
                     .v = way(2, {0, 1, 0}),
                     .angle = 7,
                     .stiffness = 4,
                     .damping = 0.2,
                     .torque = -1}};
  const auto load = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(test::movable({2, -1, 0.5}, 1));
  scene.rods.push_back({.a = scene.bodies[5].particles[0], .b = load, .law = {.stiffness = 300}});
  return scene;
}

Scene make_pool() {
  Scene scene;
  scene.planes.push_back({.surface = rough});
  for (const double x : {0.5, 0.9, 1.3}) test::add_ball(scene, {x, 0.1, 0.02 * x}, 0.1, 1, {}, rough);
  test::add_capsule_rod(scene, {1.6, 0.05, -0.5}, {1.6, 0.05, 0.5}, 2, 0.05, rough);
  for (Particle& particle : scene.particles) particle.asleep = true;
  test::add_ball(scene, {0, 0.1, 0}, 0.1, 2, {5, 0, 0}, {.friction = 0.2, .restitution = 0.9});
  return scene;
}

Scene make_draped_rope() {
  constexpr std::uint32_t links = 12;
  constexpr double length = 0.12;  // m, of a link
  Scene scene;
  scene.planes.push_back({.surface = rough});
  scene.boxes.push_back({.center = {0.1, 0.25, 0}, .half_size = {0.2, 0.25, 0.5}, .surface = rough});
  for (std::uint32_t i = 0; i <= links; ++i)
    scene.particles.push_back(test::movable({i * length - 0.6, 0.56 + 0.01 * (i % 2), 0.02 * i}, 0.1));
  for (std::uint32_t i = 0; i < links; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1, .mass = 0.2});
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.03, .surface = rough});
  }
  return scene;
}

/// A box, a rope and a ball fall on a landscape with a pole, a pyramid and a sheet of triangles in it.
Scene make_hilly() {
  Scene scene;
  HeightField field{.corner = {-2, 0, -2}, .cell_x = 0.25, .cell_z = 0.25, .columns = 17, .surface = rough};
  for (int k = 0; k < 17; ++k)
    for (int i = 0; i < 17; ++i) field.heights.push_back(0.01 * ((5 * i + 7 * k + i * k) % 11));
  scene.height_fields.push_back(field);
  scene.ground_capsules.push_back({{-1, 0.3, 0}, {1, 0.35, 0.1}, 0.05, rough});
  scene.ground_hulls.push_back({.points = {{0, 0, 0.5}, {0.5, 0, 0.5}, {0.25, 0, 1}, {0.25, 0.4, 0.7}},
                                .radius = 0.02,
                                .surface = rough});
  scene.meshes.push_back({{{-0.5, 0.4, -1}, {0.5, 0.4, -1}, {0.5, 0.2, -0.3}, {-0.5, 0.2, -0.3}},
                          {{0, 2, 1}, {0, 3, 2}},
                          false,
                          rough});
  const Vec3 size{0.3, 0.2, 0.25}, center{0.1, 0.8, 0.05};
  MassProperties box = solid_box(2, size);
  box.center = center;
  scene.hulls.push_back(box_on_body(
      add_body(scene, box),
      {.center = center, .half_size = 0.5 * size, .orientation = {0.8, 0.36, 0.48, 0}, .surface = rough}));
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= 8; ++i) {
    scene.particles.push_back(test::movable({-0.5 + 0.11 * i, 0.7, -0.7 + 0.02 * i}, 0.1));
    if (i == 0) continue;
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
    scene.capsules.push_back(
        {.a = point_at(first + i - 1), .b = point_at(first + i), .radius = 0.02, .surface = rough});
  }
  test::add_ball(scene, {0.3, 1, 0.6}, 0.1, 1, {0.2, -8, 0}, rough);
  return scene;
}

/// A wire that is bent a little at rest, in its middle part, falls on the floor. Its last rods are damped.
Scene make_fallen_wire() {
  constexpr std::uint32_t rods = 24;
  Scene scene;
  scene.planes.push_back({.surface = rough});
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back(test::movable({0.03 * i, 0.1 + 0.04 * i, 0.0005 * i * i}, 0.01 * (1 + i % 3)));
  for (std::uint32_t i = 0; i < rods; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.01, .surface = rough});
  }
  for (std::uint32_t i = 0; i + 2 <= rods; ++i)
    scene.bends.push_back({.a = i,
                           .b = i + 1,
                           .c = i + 2,
                           .stiffness = 0.1,
                           .angle = i > 8 && i < 16 ? 0.2 : 0.0,
                           .damping = i > 18 ? 1e-3 : 0.0});
  return scene;
}

/// A rope that is wound up falls on the floor and on itself, with a link that touches nothing of it.
Scene make_knot() {
  Scene scene;
  scene.planes.push_back({.surface = rough});
  for (std::uint32_t i = 0; i <= 30; ++i) {
    // A helix of polygons, without a sine whose bits would be the library's own.
    constexpr double x[] = {0, 0.06, 0.06, 0, -0.06, -0.06},
                     z[] = {0.07, 0.035, -0.035, -0.07, -0.035, 0.035};
    scene.particles.push_back(test::movable({x[i % 6], 0.1 + 0.012 * i, z[i % 6]}, 0.02));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.015, .surface = rough});
    scene.capsules.back().filter.own_island = i != 11;
  }
  return scene;
}

/// Planks on cables and rigid rods that break under a ball.
Scene make_bridge() {
  Scene scene;
  scene.planes.push_back({.offset = -1, .surface = rough});
  for (std::uint32_t i = 0; i <= 10; ++i) {
    const Vec3 at{0.3 * i, -0.02 * i * (10.0 - i), 0};
    scene.particles.push_back(i % 10 == 0 ? test::fixed(at) : test::movable(at, 0.5));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.rods.back().law = i % 3 == 0   ? RodLaw{.strength = 150}
                            : i % 3 == 1 ? RodLaw{.stiffness = 2e4, .damping = 10, .strength = 250}
                                         : RodLaw{.stiffness = 1e5, .one_sided = true, .strength = 350};
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.04, .surface = rough});
  }
  test::add_ball(scene, {1.6, 0, 0.02}, 0.2, 20, {0.3, -5, 0}, rough);
  return scene;
}

}  // namespace plumb::golden
