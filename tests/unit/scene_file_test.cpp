#include "scenes/files/scene_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/spec.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

std::string message_of(std::string_view json) {
  try {
    parse_scene(json, "f.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A scene file with one part replaced.
std::string with(const std::string& particle, const std::string& rod = R"({"a": 0, "b": 1})",
                 const std::string& top = "") {
  return R"({"plumb": 1, "particles": [{"position": [0, 0, 0], "fixed": true}, )" + particle +
         R"(], "rods": [)" + rod + "]" + top + "}";
}
const std::string sound = R"({"position": [1, 0, 0], "mass": 1})";

TEST(SceneFile, DefaultsAreThoseOfScene) {
  const Scene scene = parse_scene(with(sound), "f.json");
  EXPECT_EQ(scene.gravity, (Vec3{0, -9.81, 0}));
  EXPECT_EQ(scene.drag, 0);
  ASSERT_EQ(scene.particles.size(), 2u);
  EXPECT_TRUE(scene.particles[0].fixed);
  EXPECT_EQ(scene.particles[1].velocity, Vec3{});
  ASSERT_EQ(scene.rods.size(), 1u);
  EXPECT_EQ(scene.rods[0].mass, 0);
  EXPECT_EQ(rod_length(scene, 0), 1);
}

TEST(SceneFile, RoundTripKeepsEveryBit) {
  Scene scene = load_scene("graph:particles=50");
  scene.gravity = {0.1, -9.81, 1.0 / 3};
  scene.drag = 0.7;
  scene.particles[3].velocity = {1e-17, -1.0 / 7, 3e200};
  scene.rods[2].mass = 0.1 + 0.2;
  scene.rods[4].length = 0;  // the distance
  const Scene back = parse_scene(format_scene(scene), "f.json");
  EXPECT_EQ(back.gravity, scene.gravity);
  EXPECT_EQ(back.drag, scene.drag);
  ASSERT_EQ(back.particles.size(), scene.particles.size());
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    EXPECT_EQ(back.particles[i].position, scene.particles[i].position);
    EXPECT_EQ(back.particles[i].velocity, scene.particles[i].velocity);
    EXPECT_EQ(back.particles[i].mass, scene.particles[i].mass);
    EXPECT_EQ(back.particles[i].fixed, scene.particles[i].fixed);
  }
  ASSERT_EQ(back.rods.size(), scene.rods.size());
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    EXPECT_EQ(back.rods[i].a, scene.rods[i].a);
    EXPECT_EQ(back.rods[i].b, scene.rods[i].b);
    EXPECT_EQ(back.rods[i].length, scene.rods[i].length);
    EXPECT_EQ(back.rods[i].mass, scene.rods[i].mass);
  }
  EXPECT_EQ(format_scene(back), format_scene(scene));
}

/// One of everything that is not a particle or a rod, with numbers that need all their digits.
Scene bodies_and_joints() {
  Scene scene;
  add_body(scene, {.mass = 0.7, .center = {1.0 / 3, 0, 1}, .inertia = {1.1, 1.2, 1.3, 0.1 / 3, 0, -0.1}});
  add_body(scene, {.mass = 3, .center = {2, 0, 1}, .inertia = {.xx = 1, .yy = 1, .zz = 1}});
  add_body(scene, {.mass = 0.3, .center = {5, 1.0 / 3, 0}, .inertia = {.xx = 0.1, .yy = 0.2, .zz = 0.1}});
  scene.particles[2].asleep = true;
  scene.rods[1].mass = 0.2;
  scene.rods[1].linear_drag = 0.1;
  scene.rods[2].mass = 0.3;
  scene.rods[2].orthogonal_drag = 1.0 / 7;
  scene.rods[3].law = {.stiffness = 1e4 / 3, .damping = 0.1, .one_sided = true, .strength = 7e3 / 9};
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 0.1 / 3},
                 {.a = 3, .b = 2, .c = 1, .angle = 1.0 / 7, .damping = 1e-5 / 3}};
  scene.twists = {{.particles = {0, 1, 2}, .stiffness = 0.2 / 3, .angle = 10.0 / 7},
                  {.particles = {3, 2, 1, 0}, .stiffness = 2}};
  add_revolute(scene, 0, 1, {1, 0.1, 0.2}, {1, 2, 3});
  scene.alignments[1].value = 0.01;
  add_spherical(scene, point_at(1), point_on_rod(scene, 7, 0.3));
  const Direction u{point_at(0), point_at(1)}, v{point_at(4), point_on_rod(scene, 8, 2)};
  scene.angles = {{.u = u, .v = v},
                  {.u = v,
                   .v = u,
                   .lower = 0.1,
                   .upper = 2.0 / 3,
                   .friction = 0.3,
                   .target = 0.5,
                   .stiffness = 7,
                   .damping = 0.2}};
  scene.springs = {{.a = point_at(0), .b = point_at(5)},
                   {.a = point_at(1),
                    .b = point_on_rod(scene, 8, 0.2),
                    .length = 0.1 / 3,
                    .stiffness = 1e3 / 7,
                    .damping = 0.3,
                    .force = -1.0 / 3,
                    .one_sided = true}};
  scene.torsions = {{.axis = u, .u = v, .v = {point_at(4), point_at(2)}},
                    {.axis = v,
                     .u = u,
                     .v = {point_at(4), point_at(2)},
                     .angle = 50.0 / 7,
                     .stiffness = 0.1,
                     .damping = 0.7,
                     .torque = -0.2 / 3}};
  scene.capsules = {{.a = point_at(1), .b = point_at(1), .radius = 0.1},
                    {.a = point_at(1),
                     .b = point_on_rod(scene, 0, 0.5),
                     .radius = 0.2,
                     .surface = {.friction = 0.1, .restitution = 0.9}}};
  scene.planes = {{}, {.normal = {0.6, 0.8, 0}, .offset = -0.3, .surface = {.friction = 0}}};
  scene.boxes = {{.center = {1, 2, 3}, .half_size = {0.1, 0.2, 0.3}},
                 {.half_size = {1, 1, 1}, .orientation = {0.6, 0, 0.8, 0}, .surface = {.restitution = 1}}};
  const std::vector<Vec3> points{{0.1, 0, 0}, {1, 1.0 / 3, 0}, {0, 1, 0}, {0, 0, 1}};
  scene.hulls = {
      {.body = 0, .points = points, .radius = 0.01, .surface = {.friction = 0.7}, .filter = {.category = 6}}};
  scene.ground_capsules = {{{0, 1, 2}, {0, 1, 2}, 0.1, {}, {.mask = 5}},
                           {{0, 1, 2}, {3, 1, 2}, 0.1, {.friction = 0.1}, {}}};
  scene.ground_hulls = {{.points = points}, {.points = points, .radius = 0.2, .filter = {.group = -3}}};
  scene.meshes = {{points, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, true, {.restitution = 0.5}, {}},
                  {points, {{0, 2, 1}}, false, {}, {.category = 2}}};
  scene.height_fields = {{.corner = {-1, 2, 0},
                          .cell_x = 0.5,
                          .cell_z = 0.25,
                          .columns = 2,
                          .heights = {0, 0.1, 1.0 / 3, 0},
                          .filter = {.mask = 3}}};
  return scene;
}

void expect_same(const Point& a, const Point& b) {
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(a.weights[k], b.weights[k]);
    if (a.weights[k] != 0) {
      EXPECT_EQ(a.particles[k], b.particles[k]);
    }
  }
}
void expect_same(const Direction& a, const Direction& b) {
  expect_same(a.from, b.from);
  expect_same(a.to, b.to);
}
void expect_same(const Surface& a, const Surface& b) {
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.restitution, b.restitution);
}
void expect_same(const Bend& a, const Bend& b) {
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.b, b.b);
  EXPECT_EQ(a.c, b.c);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.angle, b.angle);
  EXPECT_EQ(a.damping, b.damping);
}
void expect_same(const Twist& a, const Twist& b) {
  EXPECT_EQ(a.particles, b.particles);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.angle, b.angle);
}
void expect_same(const Body& a, const Body& b) {
  EXPECT_EQ(a.particles, b.particles);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.center, b.center);
  EXPECT_EQ(a.inertia, b.inertia);
}
void expect_same(const Pin& a, const Pin& b) {
  expect_same(a.a, b.a);
  expect_same(a.b, b.b);
}
void expect_same(const Alignment& a, const Alignment& b) {
  expect_same(a.u, b.u);
  expect_same(a.v, b.v);
  EXPECT_EQ(a.value, b.value);
}
void expect_same(const AngleControl& a, const AngleControl& b) {
  expect_same(a.u, b.u);
  expect_same(a.v, b.v);
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.target, b.target);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.damping, b.damping);
}
void expect_same(const Spring& a, const Spring& b) {
  expect_same(a.a, b.a);
  expect_same(a.b, b.b);
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.damping, b.damping);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.one_sided, b.one_sided);
}
void expect_same(const Torsion& a, const Torsion& b) {
  expect_same(a.axis, b.axis);
  expect_same(a.u, b.u);
  expect_same(a.v, b.v);
  EXPECT_EQ(a.angle, b.angle);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.damping, b.damping);
  EXPECT_EQ(a.torque, b.torque);
}
void expect_same(const Capsule& a, const Capsule& b) {
  expect_same(a.a, b.a);
  expect_same(a.b, b.b);
  EXPECT_EQ(a.radius, b.radius);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const Plane& a, const Plane& b) {
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.offset, b.offset);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const Box& a, const Box& b) {
  EXPECT_EQ(a.center, b.center);
  EXPECT_EQ(a.half_size, b.half_size);
  EXPECT_EQ(a.orientation, b.orientation);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const Hull& a, const Hull& b) {
  EXPECT_EQ(a.body, b.body);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.radius, b.radius);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const GroundCapsule& a, const GroundCapsule& b) {
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.b, b.b);
  EXPECT_EQ(a.radius, b.radius);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const GroundHull& a, const GroundHull& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.radius, b.radius);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const GroundMesh& a, const GroundMesh& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.solid, b.solid);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
void expect_same(const HeightField& a, const HeightField& b) {
  EXPECT_EQ(a.corner, b.corner);
  EXPECT_EQ(a.cell_x, b.cell_x);
  EXPECT_EQ(a.cell_z, b.cell_z);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.heights, b.heights);
  expect_same(a.surface, b.surface);
  EXPECT_EQ(a.filter, b.filter);
}
template <class Item>
void expect_same(const std::vector<Item>& a, const std::vector<Item>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
}

TEST(SceneFile, RoundTripKeepsEveryBitOfBodiesAndJoints) {
  const Scene scene = bodies_and_joints();
  const Scene back = parse_scene(format_scene(scene), "f.json");
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    EXPECT_EQ(back.particles[i].asleep, scene.particles[i].asleep);
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    EXPECT_EQ(back.rods[i].linear_drag, scene.rods[i].linear_drag);
    EXPECT_EQ(back.rods[i].orthogonal_drag, scene.rods[i].orthogonal_drag);
    EXPECT_EQ(back.rods[i].law, scene.rods[i].law);
  }
  expect_same(back.bends, scene.bends);
  expect_same(back.twists, scene.twists);
  expect_same(back.bodies, scene.bodies);
  expect_same(back.pins, scene.pins);
  expect_same(back.alignments, scene.alignments);
  expect_same(back.angles, scene.angles);
  expect_same(back.springs, scene.springs);
  expect_same(back.torsions, scene.torsions);
  expect_same(back.capsules, scene.capsules);
  expect_same(back.planes, scene.planes);
  expect_same(back.boxes, scene.boxes);
  expect_same(back.hulls, scene.hulls);
  expect_same(back.ground_capsules, scene.ground_capsules);
  expect_same(back.ground_hulls, scene.ground_hulls);
  expect_same(back.meshes, scene.meshes);
  expect_same(back.height_fields, scene.height_fields);
  EXPECT_EQ(format_scene(back), format_scene(scene));
}

TEST(SceneFile, BodiesAndJointsHaveTheDefaultsOfScene) {
  const Scene scene = parse_scene(with(sound, R"({"a": 0, "b": 1})",
                                       R"(, "capsules": [{"a": 1, "radius": 0.5}],
                                            "planes": [{"normal": [0, 0, 1]}], "pins": [],
                                            "boxes": [{"center": [5, 0, 0], "half_size": [1, 2, 3]}])"),
                                  "f.json");
  Capsule ball{.a = point_at(1), .b = point_at(1), .radius = 0.5};
  expect_same(scene.capsules, {ball});
  expect_same(scene.planes, {Plane{.normal = {0, 0, 1}}});
  expect_same(scene.boxes, {Box{.center = {5, 0, 0}, .half_size = {1, 2, 3}}});
  EXPECT_TRUE(scene.pins.empty());
}

/// The message about a list added to a file that is sound.
std::string message_of_list(const std::string& list) {
  return message_of(with(sound, R"({"a": 0, "b": 1})", ", " + list));
}

TEST(SceneFile, WhatIsWrongWithBodiesAndJointsIsNamedWithItsPath) {
  EXPECT_EQ(message_of_list(R"("bodies": {})"), "f.json: bodies must be an array, not an object");
  EXPECT_EQ(message_of_list(R"("bodies": [{"particles": [0, 1]}])"),
            "f.json: bodies[0].particles must have 4 numbers, not 2");
  EXPECT_EQ(message_of_list(R"("bodies": [{"particles": [0, 1, 2, -3]}])"),
            "f.json: bodies[0].particles[3] must be the number of a particle, counted from 0, not -3");
  EXPECT_EQ(message_of_list(R"("bodies": [{"particles": [0, 1, 2, 3], "mass": 1, "center": [0, 0, 0],
                                           "inertia": {"xx": 1, "yy": 1}}])"),
            "f.json: bodies[0].inertia.zz is missing");
  EXPECT_EQ(message_of_list(R"("bends": [{"a": 0, "b": 1, "stiffness": 1}])"),
            "f.json: bends[0].c is missing");
  EXPECT_EQ(message_of_list(R"("bends": [{"a": 0, "b": 1, "c": 1, "twist": 1}])"),
            "f.json: bends[0].twist is not a known key; known are a, b, c, stiffness, angle, damping");
  EXPECT_EQ(message_of_list(R"("twists": [{"particles": [0, 1, 2]}])"),
            "f.json: twists[0].stiffness is missing");
  EXPECT_EQ(message_of_list(R"("twists": [{"particles": [0, "b"], "stiffness": 1}])"),
            "f.json: twists[0].particles[1] must be the number of a particle, counted from 0, not a string");
  EXPECT_EQ(message_of_list(R"("pins": [{"a": 0, "b": 1}, {"a": 1}])"), "f.json: pins[1].b is missing");
  EXPECT_EQ(message_of_list(R"("pins": [{"a": 0, "b": 1, "c": 2}])"),
            "f.json: pins[0].c is not a known key; known are a, b");
  EXPECT_EQ(message_of_list(R"("pins": [{"a": "tip", "b": 1}])"),
            "f.json: pins[0].a must be the number of a particle, counted from 0, not a string");
  EXPECT_EQ(message_of_list(R"("pins": [{"a": {"particles": [0, 1], "weights": [1]}, "b": 1}])"),
            "f.json: pins[0].a must have one to four particles and a weight for each, not 2 and 1");
  EXPECT_EQ(message_of_list(R"("pins": [{"a": {"particles": [0, 1], "weights": [1, "1"]}, "b": 1}])"),
            "f.json: pins[0].a.weights[1] must be a number, not a string");
  EXPECT_EQ(message_of_list(R"("alignments": [{"u": {"from": 0}}])"),
            "f.json: alignments[0].u.to is missing");
  EXPECT_EQ(message_of_list(R"("angles": [{"u": {"from": 0, "to": 1}, "w": 1}])"),
            "f.json: angles[0].w is not a known key; known are u, v, lower, upper, friction, target, "
            "stiffness, damping");
  EXPECT_EQ(message_of_list(R"("springs": [{"a": 0, "b": 1, "stiffness": -1}])"),
            "f.json: spring 0: stiffness must be finite and not negative, got -1 N/m");
  EXPECT_EQ(message_of_list(R"("torsions": [{"axis": {"from": 0, "to": 1}}])"),
            "f.json: torsions[0].u is missing");
  EXPECT_EQ(message_of_list(R"("capsules": [{"a": 1}])"), "f.json: capsules[0].radius is missing");
  EXPECT_EQ(message_of_list(R"("planes": [{"offset": 1}])"), "f.json: planes[0].normal is missing");
  EXPECT_EQ(message_of_list(
                R"("boxes": [{"center": [0, 0, 0], "half_size": [1, 1, 1], "orientation": [1, 0, 0]}])"),
            "f.json: boxes[0].orientation must have 4 numbers, not 3");
  EXPECT_EQ(message_of_list(R"("planes": [{"normal": [0, 2, 0]}])"),
            "f.json: plane 0: normal must be of length 1, not 2");
}

TEST(SceneFile, UnknownKeysAreNamedWithTheirPath) {
  EXPECT_EQ(message_of(with(R"({"position": [1, 0, 0], "mass": 1, "colour": 3})")),
            "f.json: particles[1].colour is not a known key; known are position, velocity, mass, fixed, "
            "asleep");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": 1, "color": 1})")),
            "f.json: rods[0].color is not a known key; known are a, b, length, mass, center, inertia, "
            "linear_drag, orthogonal_drag, stiffness, damping, one_sided, strength");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": 1})", R"(, "Gravity": [0, 0, 0])")),
            "f.json: Gravity is not a known key; known are plumb, gravity, drag, joint_drag, particles, "
            "rods, bends, twists, tackles, reels, bodies, pins, "
            "alignments, angles, springs, torsions, capsules, planes, boxes, platforms, "
            "hulls, ground_capsules, ground_hulls, meshes, height_fields. Did you mean gravity?");
}

TEST(SceneFile, MissingAndMistypedValuesAreNamedWithTheirPath) {
  EXPECT_EQ(message_of("[]"), "f.json: the scene must be an object, not an array");
  EXPECT_EQ(message_of("{}"), "f.json: the key 'plumb' (version of the format, 1) is missing");
  EXPECT_EQ(message_of(R"({"plumb": 2})"), "f.json: plumb is the version of the format and must be 1, not 2");
  EXPECT_EQ(message_of(R"({"plumb": 1})"), "f.json: particles is missing");
  EXPECT_EQ(message_of(R"({"plumb": 1, "particles": {}})"),
            "f.json: particles must be an array, not an object");
  EXPECT_EQ(message_of(with("7")), "f.json: particles[1] must be an object, not a number");
  EXPECT_EQ(message_of(with(R"({"mass": 1})")), "f.json: particles[1].position is missing");
  EXPECT_EQ(message_of(with(R"({"position": [1, 2]})")),
            "f.json: particles[1].position must be three numbers [x, y, z], not an array of 2");
  EXPECT_EQ(message_of(with(R"({"position": [1, "0", 2]})")),
            "f.json: particles[1].position[1] must be a number, not a string");
  EXPECT_EQ(message_of(with(R"({"position": [1, 0, 2], "fixed": 1})")),
            "f.json: particles[1].fixed must be true or false, not a number");
  EXPECT_EQ(message_of(with(R"({"position": [1, 0, 2], "mass": null})")),
            "f.json: particles[1].mass must be a number, not null");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0})")), "f.json: rods[0].b is missing");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": -1})")),
            "f.json: rods[0].b must be the number of a particle, counted from 0, not -1");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": 4294967296})")),
            "f.json: rods[0].b must be the number of a particle, counted from 0, not 4294967296");
  EXPECT_EQ(
      message_of(with(sound, R"({"a": 0, "b": 1, "length": 0})")),
      "f.json: rods[0].length must be positive; leave it out for the distance between the two particles");
}

TEST(SceneFile, WhatIsNotJsonIsRefusedWithItsLine) {
  const std::string message = message_of("{\n  \"plumb\": 1,\n  oops\n}");
  EXPECT_TRUE(message.starts_with("f.json: not JSON: parse error at line 3, column ")) << message;
  EXPECT_TRUE(message_of("").starts_with("f.json: not JSON: ")) << message_of("");
  EXPECT_TRUE(
      message_of(with(sound, "", R"(, "drag": 1e999)")).starts_with("f.json: not JSON: number overflow"));
  EXPECT_EQ(message_of(R"({"plumb": 1, "plumb": 1})"),
            "f.json: the key \"plumb\" appears twice in one object");
}

TEST(SceneFile, ScenesThatCannotBeSimulatedAreRefused) {
  const std::string message = message_of(with(sound, R"({"a": 0, "b": 9})"));
  EXPECT_TRUE(message.starts_with("f.json: ")) << message;
  EXPECT_NE(message.find("rod 0"), std::string::npos) << message;
}

TEST(SceneFile, FilesAreReadAndReplacedWhole) {
  const auto folder = std::filesystem::temp_directory_path() / "plumb_scene_file_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto path = folder / "chain.json";
  const Scene scene = load_scene("chain:links=3");
  write_scene(scene, path);
  EXPECT_EQ(format_scene(load_scene(path.string())), format_scene(scene));
  {
    OutputFile unfinished(path);
    unfinished.write("half a file");
  }
  EXPECT_EQ(read_file(path), format_scene(scene));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files += entry.is_regular_file();
  EXPECT_EQ(files, 1u);
  EXPECT_THROW(OutputFile(folder / "missing" / "file"), InputError);
  EXPECT_THROW(load_scene((folder / "missing.json").string()), InputError);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
