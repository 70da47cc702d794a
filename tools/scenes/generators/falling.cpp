#include "scenes/generators/falling.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "plumb/joints.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/basics/triangles.hpp"

namespace plumb::scenes {
namespace {

constexpr double ripple = 1e-3;  // m

struct Link {
  double length, mass, radius;
  Surface surface;
};

template <class Shape>
Link link_of(const Shape& shape) {
  require_at_least(shape.links, 1, "links");
  require_positive(shape.length, "length");
  require_positive(shape.mass, "mass");
  require_positive(shape.radius, "radius");
  return {shape.length, shape.mass, shape.radius, {.friction = require_friction(shape.friction)}};
}

void add_capsule(Scene& scene, std::uint32_t a, std::uint32_t b, const Link& link) {
  scene.rods.push_back({.a = a, .b = b});
  scene.capsules.push_back(
      {.a = point_at(a), .b = point_at(b), .radius = link.radius, .surface = link.surface});
}

/// Adds links + 1 particles at where(0), where(1), ..., with rods between them.
template <class Where>
void add_rope(Scene& scene, std::uint32_t links, const Link& link, Where&& where) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= links; ++i) {
    scene.particles.push_back({.position = where(i), .mass = link.mass});
    if (i > 0) add_capsule(scene, first + i - 1, first + i, link);
  }
}

/// Adds a rope whose middle is at a place, level but for ripples.
void add_level_rope(Scene& scene, std::uint32_t links, const Link& link, Vec3 middle, double angle) {
  const Vec3 along = link.length * Vec3{std::cos(angle), 0, std::sin(angle)};
  add_rope(scene, links, link, [&](std::uint32_t i) {
    return middle + (i - 0.5 * links) * along + Vec3{0, ripple * std::sin(i), 0};
  });
}

/// Returns how high a hill is at a place, from -1 to 1. Hills are about 3 m apart.
double hill_at(double x, double z) {
  return 0.6 * std::sin(1.1 * x + 0.4 * z) * std::sin(0.3 * x - 1.3 * z) +
         0.4 * std::sin(2.3 * x + z) * std::sin(2.9 * z - 0.7 * x);
}

/// Makes a square of hilly ground around the origin.
GroundMesh hilly_ground(std::uint32_t triangles, double side, double hills) {
  const auto cells = static_cast<std::uint32_t>(std::ceil(std::sqrt(0.5 * triangles)));
  GroundMesh ground;
  for (std::uint32_t row = 0; row <= cells; ++row)
    for (std::uint32_t column = 0; column <= cells; ++column) {
      const double x = side * (column / static_cast<double>(cells) - 0.5),
                   z = side * (row / static_cast<double>(cells) - 0.5);
      ground.vertices.push_back({x, hills * hill_at(x, z), z});
    }
  ground.triangles = grid_triangles(cells);
  return ground;
}

/// Weighs a box as it is turned: the sum of its principal moments times the squares of its axes.
MassProperties mass_of(const Box& box, double mass) {
  const Inertia own = solid_box(mass, 2.0 * box.half_size).inertia;
  const std::array<Vec3, 3> axes = axes_of(box.orientation);
  const std::array<double, 3> moments = {own.xx, own.yy, own.zz};
  MassProperties out{.mass = mass, .center = box.center};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 u = axes[i];
    const Vec3 scaled = moments[i] * u;
    out.inertia.xx += scaled.x * u.x;
    out.inertia.yy += scaled.y * u.y;
    out.inertia.zz += scaled.z * u.z;
    out.inertia.xy += scaled.x * u.y;
    out.inertia.xz += scaled.x * u.z;
    out.inertia.yz += scaled.y * u.z;
  }
  return out;
}

}  // namespace

Scene make_rope(const RopeShape& shape) {
  const Link link = link_of(shape);
  require_not_negative(shape.height, "height");
  require_not_negative(shape.coil, "coil");
  require_not_negative(shape.pitch, "pitch");
  if (shape.coil > 0 && !(2 * shape.coil > shape.length)) throw InputError("coil must be wider than a rod");
  if (shape.pitch > 0 && shape.coil == 0) throw InputError("pitch is that of a coil");
  Scene scene;
  const double low = shape.radius + shape.height;
  // A turn that climbs by three radii is open.
  const double pitch = shape.pitch > 0 ? shape.pitch : 3 * shape.radius;
  const double climb = shape.coil > 0 ? pitch * shape.length / (2 * std::numbers::pi * shape.coil) : 0;
  if (!(climb < shape.length)) throw InputError("a rod of the coil must be longer than it climbs");
  const double turn =
      shape.coil > 0
          ? 2 * std::asin(std::sqrt(shape.length * shape.length - climb * climb) / (2 * shape.coil))
          : 0;
  scene.particles.reserve(shape.links + std::size_t{1});
  scene.rods.reserve(shape.links);
  scene.capsules.reserve(shape.links);
  add_rope(scene, shape.links, link, [&](std::uint32_t i) {
    if (shape.coil == 0)
      return Vec3{shape.length * i, low + ripple * std::sin(0.7 * i), ripple * std::cos(1.3 * i)};
    return Vec3{shape.coil * std::cos(turn * i), low + climb * i, shape.coil * std::sin(turn * i)};
  });
  for (Capsule& capsule : scene.capsules) capsule.filter.own_island = shape.coil > 0;
  scene.planes.push_back({.surface = link.surface});
  return scene;
}

Scene make_heap(const HeapShape& shape) {
  const Link link = link_of(shape);
  require_at_least(shape.ropes, 1, "ropes");
  require_positive(shape.spacing, "spacing");
  if (!(shape.spacing > 2 * shape.radius)) throw InputError("spacing must be more than two radii");
  require_countable(std::uint64_t{shape.ropes} * (shape.links + std::uint64_t{1}));
  std::mt19937_64 random(shape.seed);
  const double aside = 0.1 * shape.length * shape.links;
  Scene scene;
  for (std::uint32_t rope = 0; rope < shape.ropes; ++rope) {
    const double angle = std::numbers::pi * unit_double(random);
    const double x = aside * (2 * unit_double(random) - 1), z = aside * (2 * unit_double(random) - 1);
    const Vec3 middle{x, shape.radius + shape.spacing * (rope + 1), z};
    add_level_rope(scene, shape.links, link, middle, angle);
  }
  scene.planes.push_back({.surface = link.surface});
  return scene;
}

Scene make_drape(const DrapeShape& shape) {
  require_at_least(shape.size, 2, "size");
  require_positive(shape.spacing, "spacing");
  require_positive(shape.mass, "mass");
  require_positive(shape.radius, "radius");
  require_not_negative(shape.height, "height");
  require_countable(std::uint64_t{shape.size} * shape.size);
  const Link link{shape.spacing, shape.mass, shape.radius, {.friction = require_friction(shape.friction)}};
  const double side = shape.spacing * (shape.size - 1), quarter = side / 4;
  const double top = shape.box == 0 && shape.sphere == 0 ? 0 : 2 * quarter;
  Scene scene;
  for (std::uint32_t row = 0; row < shape.size; ++row)
    for (std::uint32_t column = 0; column < shape.size; ++column) {
      const std::uint32_t here = row * shape.size + column;
      const Vec3 at{shape.spacing * column - side / 2,
                    top + shape.radius + shape.height + ripple * std::sin(1.1 * column + 0.7 * row),
                    shape.spacing * row - side / 2};
      scene.particles.push_back({.position = at, .mass = shape.mass});
      if (column > 0) add_capsule(scene, here - 1, here, link);
      if (row > 0) add_capsule(scene, here - shape.size, here, link);
    }
  scene.planes.push_back({.surface = link.surface});
  const Vec3 middle{0, top / 2, 0};
  if (shape.sphere != 0)
    scene.ground_capsules.push_back({.a = middle, .b = middle, .radius = quarter, .surface = link.surface});
  else if (shape.box != 0)
    scene.boxes.push_back(
        {.center = middle, .half_size = {quarter, top / 2, quarter}, .surface = link.surface});
  return scene;
}

Scene make_terrain(const TerrainShape& shape) {
  const Link link = link_of(shape);
  require_at_least(shape.ropes, 1, "ropes");
  require_at_least(shape.stack, 1, "stack");
  require_at_least(shape.triangles, 2, "triangles");
  require_positive(shape.spacing, "spacing");
  require_not_negative(shape.hills, "hills");
  if (!(shape.spacing > 2 * shape.radius)) throw InputError("spacing must be more than two radii");
  require_countable(std::uint64_t{shape.ropes} * (shape.links + std::uint64_t{1}));
  require_countable(shape.triangles);
  const std::uint32_t stacks = (shape.ropes - 1) / shape.stack + 1;
  const auto across = static_cast<std::uint32_t>(std::ceil(std::sqrt(stacks)));
  // Ropes of stacks side by side have room to turn, and ground reaches beyond them by half a rope.
  const double between = 1.05 * shape.length * shape.links;
  Random random(shape.seed);
  Scene scene;
  for (std::uint32_t rope = 0; rope < shape.ropes; ++rope) {
    const std::uint32_t at = rope % stacks, level = rope / stacks;
    const double x = between * (at % across - 0.5 * (across - 1)),
                 z = between * (at / across - 0.5 * (across - 1));
    const double height = shape.hills + shape.radius + shape.spacing * (level + 1);
    add_level_rope(scene, shape.links, link, {x, height, z}, random.between(0, std::numbers::pi));
  }
  scene.meshes.push_back(hilly_ground(shape.triangles, between * (across + 1), shape.hills));
  scene.meshes.back().surface = link.surface;
  return scene;
}

Scene make_boxes(const BoxesShape& shape) {
  require_at_least(shape.boxes, 1, "boxes");
  require_positive(shape.size, "size");
  require_positive(shape.mass, "mass");
  require_not_negative(shape.height, "height");
  require_countable(4 * std::uint64_t{shape.boxes});
  const Surface surface{.friction = require_friction(shape.friction)};
  Random random(shape.seed);
  Scene scene;
  scene.planes.push_back({.surface = surface});
  double top = 0;
  for (std::uint32_t i = 0; i < shape.boxes; ++i) {
    const auto half_side = [&] { return 0.5 * shape.size * random.between(0.7, 1.3); };
    const double x = half_side(), y = half_side(), z = half_side();
    const double reach = norm(Vec3{x, y, z});
    const Vec3 axis = random.in_cube();
    const double angle = random.between(0, 1.5), c = std::cos(angle), s = std::sin(angle) / norm(axis);
    const Box box{.center = {0.3 * shape.size * random.between(-1, 1), top + shape.height + reach,
                             0.3 * shape.size * random.between(-1, 1)},
                  .half_size = {x, y, z},
                  .orientation = {c, s * axis.x, s * axis.y, s * axis.z},
                  .surface = surface};
    top = box.center.y + reach;
    scene.hulls.push_back(box_on_body(add_body(scene, mass_of(box, shape.mass)), box));
  }
  return scene;
}

}  // namespace plumb::scenes
