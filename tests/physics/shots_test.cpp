// Random shots at thin walls: whatever flies, however it is moved, none comes through.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "plumb/shapes/ground.hpp"
#include "support/bodies.hpp"
#include "support/meshes.hpp"

namespace plumb {
namespace {

constexpr double reach = 8;         ///< m, half the width of a wall
constexpr double thickness = 0.01;  ///< m, half of it, of walls that are solid

/// A wall about y = 0: a sheet of triangles, a box, many boxes, a hull, a solid mesh or a height field.
void add_wall(Scene& scene, std::uint64_t kind, const Surface& surface, test::Random& random) {
  const Box box{.half_size = {reach, thickness, reach}, .surface = surface};
  switch (kind) {
    case 0: {
      const test::Mesh sheet = test::shuffled_floor(20, 2 * reach / 20, random);
      scene.meshes.push_back({sheet.vertices, sheet.triangles, false, surface});
      break;
    }
    case 1:
      scene.boxes.push_back(box);
      break;
    case 2:
      for (int i = -4; i < 4; ++i)
        for (int k = -4; k < 4; ++k)
          scene.boxes.push_back({.center = {reach / 4 * (i + 0.5), 0, reach / 4 * (k + 0.5)},
                                 .half_size = {reach / 8, thickness, reach / 8},
                                 .surface = surface});
      break;
    case 3:
      scene.ground_hulls.push_back({.points = box_on_body(0, box).points, .surface = surface});
      break;
    case 4: {
      const std::vector<Vec3> corners = box_on_body(0, box).points;  // x, then y, then z change slowest
      scene.meshes.push_back({corners,
                              {{0, 1, 3},
                               {0, 3, 2},
                               {4, 7, 5},
                               {4, 6, 7},
                               {0, 5, 1},
                               {0, 4, 5},
                               {2, 3, 7},
                               {2, 7, 6},
                               {0, 2, 6},
                               {0, 6, 4},
                               {1, 5, 7},
                               {1, 7, 3}},
                              true,
                              surface});
      break;
    }
    default:
      scene.height_fields.push_back({.corner = {-reach, thickness, -reach},
                                     .cell_x = reach / 5,
                                     .cell_z = reach / 8,
                                     .columns = 11,
                                     .heights = std::vector<double>(11 * 17),
                                     .surface = surface});
  }
}

constexpr std::uint64_t walls = 6, height_field = 5;

/// From 0 to 1.
double share(test::Random& random) {
  return std::abs(test::signed_unit(random));
}

/// What flies at the wall: a ball, a capsule, a rope or a box.
struct Shot {
  std::uint64_t kind;
  Vec3 from;  ///< m, where its end or the middle of its lower side is
  double radius;
  Surface surface;
};
void add_shot(Scene& scene, const Shot& shot, test::Random& random) {
  const auto& [kind, from, radius, surface] = shot;
  Vec3 along = test::random_vector(random);
  along.y = std::copysign(along.y, from.y);
  if (kind == 0) {
    test::add_ball(scene, from, radius, 1, {}, surface);
  } else if (kind == 1) {
    test::add_capsule_rod(scene, from, from + along, 1, radius, surface);
  } else if (kind == 2) {
    for (std::uint32_t i = 0; i <= 6; ++i) {
      scene.particles.push_back(test::movable(from + (0.2 * i) * along, 0.1));
      if (i == 0) continue;
      scene.rods.push_back({.a = i - 1, .b = i});
      scene.capsules.push_back({point_at(i - 1), point_at(i), radius, surface});
    }
  } else {
    const Vec3 half{radius + 0.1 * share(random), radius, radius + 0.2 * share(random)};
    MassProperties box = solid_box(1, 2.0 * half);
    box.center = from + Vec3{0, std::copysign(norm(half), from.y), 0};
    const Vec3 axis = test::random_vector(random);
    const double angle = 3 * share(random), c = std::cos(angle), s = std::sin(angle) / norm(axis);
    scene.hulls.push_back(
        box_on_body(add_body(scene, box), {.center = box.center,
                                           .half_size = half,
                                           .orientation = {c, s * axis.x, s * axis.y, s * axis.z},
                                           .surface = surface}));
  }
}

/// How far (m) all centres, lines and corners are beyond the wall's middle; negative: all on their side. It
/// is infinite if something may be past the wall's edge.
double beyond(const Scene& scene, const World& world, double side) {
  double most = -INFINITY;
  const auto see = [&](Vec3 p) {
    most = std::max(most, std::max(std::abs(p.x), std::abs(p.z)) < 0.8 * reach ? -side * p.y : INFINITY);
  };
  for (const Capsule& each : scene.capsules)
    for (const Point& end : {each.a, each.b}) see(test::place_of(world, end));
  for (const Hull& each : scene.hulls)
    for (const Vec3 point : each.points) see(test::place_of(world, point_on_body(scene, each.body, point)));
  return most;
}

struct Way {
  const char* name;
  Settings settings;
  MassModel mass;
  double gain;  ///< what energy may gain by rounding, as a share
};
std::vector<Way> all_ways() {
  Settings relaxed{.method = Method::relax, .sleep = false, .threads = 1};
  relaxed.stop.sweeps = 10;
  Settings single = relaxed;
  single.precision = Precision::single;
  return {{"solved", test::body_settings(), MassModel::consistent, 1e-6},
          {"relaxed", relaxed, MassModel::lumped, 1e-6},
          {"relaxed, float", single, MassModel::lumped, 1e-4}};
}

// Radii are from 5 mm to 1 m, speeds up to 100 m/s and steps from 1/240 to 1/15 s. PLUMB_SHOTS says how many
// shots there are.
TEST(Shots, NoneComesThrough) {
  const char* const asked = std::getenv("PLUMB_SHOTS");
  const int shots = asked ? std::atoi(asked) : 480;
  int hits = 0, through = 0;
  for (int shot = 0; shot < shots; ++shot) {
    test::Random random(1000 + shot);
    for (const Way& way : all_ways()) {
      test::Random own = random;
      Scene scene;
      scene.gravity = {};
      const std::uint64_t wall = shot % walls, kind = shot / walls % 4;
      const Surface surface{.friction = 0.3, .restitution = shot / (4 * walls) % 2 == 0 ? 0.5 : 0};
      add_wall(scene, wall, surface, own);
      const double radius = 0.005 * std::pow(200, share(own));
      const double side = wall == height_field || test::below(own, 2) == 0 ? 1 : -1;
      const Vec3 from{test::signed_unit(own), side * (radius + thickness + 0.001 + share(own)),
                      test::signed_unit(own)};
      add_shot(scene, {kind, from, radius, surface}, own);
      const Vec3 aim = 0.7 * test::random_vector(own) - Vec3{0, side, 0};
      const Vec3 velocity = (100 * share(own) / norm(aim)) * aim;
      for (Particle& each : scene.particles) each.velocity = velocity;
      World world(scene, way.settings);
      const double dt = 1.0 / (15 + test::below(own, 226)), before = test::energy_of(scene, world, way.mass);
      SCOPED_TRACE("shot " + std::to_string(shot) + ", " + way.name);
      for (int i = 0; i < 8; ++i) {
        const StepReport report = world.step(dt);
        EXPECT_EQ(report.frozen_islands, 0u);
        const double depth = beyond(scene, world, side);
        if (depth == INFINITY) break;
        through += depth > 1e-3;
        EXPECT_LT(depth, 1e-3) << "step " << i;
        EXPECT_LT(test::energy_of(scene, world, way.mass), before * (1 + way.gain)) << "step " << i;
      }
      hits += norm(world.velocity(0) - velocity) > 1e-3;
    }
  }
  EXPECT_GT(hits, shots);
  EXPECT_EQ(through, 0);
}

}  // namespace
}  // namespace plumb
