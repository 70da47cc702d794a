#include "scenes/shots/targets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plumb/joints.hpp"
#include "scenes/basics/triangles.hpp"
#include "scenes/humanoid/humanoid.hpp"

namespace plumb::scenes {
namespace {

constexpr std::array targets = {Target::sheet,      Target::box,        Target::boxes,
                                Target::hull,       Target::solid_mesh, Target::height_field,
                                Target::rope,       Target::net,        Target::flying_rope,
                                Target::flying_net, Target::figure,     Target::flying_box};
constexpr std::array<std::string_view, targets.size()> names = {
    "sheet", "box", "boxes",       "hull",       "solid mesh", "height field",
    "rope",  "net", "flying rope", "flying net", "figure",     "flying box"};

/// A level sheet of triangles. Vertices are shuffled along it, so that triangles have all kinds of edges.
GroundMesh sheet(Random& random) {
  constexpr std::uint32_t cells = 20;
  constexpr double size = 2 * wall_reach / cells;
  GroundMesh out;
  for (std::uint32_t k = 0; k <= cells; ++k)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double x = random.between(-0.2, 0.2), z = random.between(-0.2, 0.2);
      out.vertices.push_back({size * (i + x) - wall_reach, 0, size * (k + z) - wall_reach});
    }
  out.triangles = grid_triangles(cells);
  return out;
}

void add_wall(Scene& scene, Target target, const Surface& surface, Random& random) {
  const Box box{.half_size = {wall_reach, wall_thickness, wall_reach}, .surface = surface};
  const std::vector<Vec3> corners = box_on_body(0, box).points;
  switch (target) {
    case Target::sheet:
      scene.meshes.push_back(sheet(random));
      scene.meshes.back().surface = surface;
      break;
    case Target::box:
      scene.boxes.push_back(box);
      break;
    case Target::boxes:
      for (int i = -4; i < 4; ++i)
        for (int k = -4; k < 4; ++k)
          scene.boxes.push_back({.center = {wall_reach / 4 * (i + 0.5), 0, wall_reach / 4 * (k + 0.5)},
                                 .half_size = {wall_reach / 8, wall_thickness, wall_reach / 8},
                                 .surface = surface});
      break;
    case Target::hull:
      scene.ground_hulls.push_back({.points = corners, .surface = surface});
      break;
    case Target::solid_mesh:
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
    default:
      scene.height_fields.push_back({.corner = {-wall_reach, wall_thickness, -wall_reach},
                                     .cell_x = wall_reach / 5,
                                     .cell_z = wall_reach / 8,
                                     .columns = 11,
                                     .heights = std::vector<double>(11 * 17),
                                     .surface = surface});
  }
}

void add_link(Scene& scene, std::uint32_t a, std::uint32_t b, double radius, const Surface& surface) {
  if (scene.particles[a].fixed && scene.particles[b].fixed) return;
  scene.rods.push_back({.a = a, .b = b});
  scene.capsules.push_back({point_at(a), point_at(b), radius, surface});
}

/// Returns how far neighbours are off a line, across it, if the way along it is 1 and they are longer than
/// that.
double random_fold(Random& random) {
  const double longer = 1 + random.between(0.02, 0.15);
  return std::sqrt(longer * longer - 1);
}

void add_rope(Scene& scene, bool held, const Surface& surface, Random& random) {
  constexpr std::uint32_t links = 16;
  constexpr double way = 0.25;  // m
  const double radius = random.scaled(0.005, 0.05), fold = way * random_fold(random);
  const double mass = random.scaled(0.02, 0.5);
  for (std::uint32_t i = 0; i <= links; ++i) {
    const bool fixed = held && (i == 0 || i == links);
    scene.particles.push_back({.position = {way * i - way * links / 2, 0, i % 2 == 0 ? 0 : fold},
                               .mass = fixed ? 0 : mass,
                               .fixed = fixed});
    if (i > 0) add_link(scene, i - 1, i, radius, surface);
  }
}

/// Meshes are narrower than the missile is thick.
std::uint32_t add_net(Scene& scene, bool held, double missile, const Surface& surface, Random& random) {
  const double radius = std::max(0.005, random.between(0.1, 0.3) * missile);
  const double spacing = 1.2 * (missile + radius), fold = spacing * random_fold(random);
  const std::uint32_t side = random.count(5, 7);
  const double mass = random.scaled(0.3, 3) / (side * side);
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column) {
      const std::uint32_t here = row * side + column;
      const bool is_border = row == 0 || column == 0 || row + 1 == side || column + 1 == side;
      const bool fixed = held && is_border;
      const double middle = 0.5 * (side - 1), high = (row + column) % 2 == 0 ? -0.5 : 0.5;
      scene.particles.push_back(
          {.position = {spacing * (column - middle), fold * high, spacing * (row - middle)},
           .mass = fixed ? 0 : mass,
           .fixed = fixed});
      if (column > 0) add_link(scene, here - 1, here, radius, surface);
      if (row > 0) add_link(scene, here - side, here, radius, surface);
    }
  return side;
}

void add_figure(Scene& scene, const Surface& surface, Random& random) {
  constexpr std::array builds = {BodyType::thin, BodyType::medium, BodyType::wide};
  scene = make_humanoid({.body = builds[random.count(0, 2)], .arms = random.count(0, 1)});
  scene.gravity = {};
  scene.planes.clear();
  for (Particle& each : scene.particles) each.asleep = false;
  for (Capsule& each : scene.capsules) each.surface = surface;
}

void add_flying_box(Scene& scene, const Surface& surface, Random& random) {
  const Vec3 half{random.scaled(0.02, 0.5), random.scaled(0.02, 0.5), random.scaled(0.02, 0.5)};
  const std::uint32_t body = add_body(scene, solid_box(random.scaled(0.1, 10), 2.0 * half));
  scene.hulls.push_back(box_on_body(body, {.half_size = half, .surface = surface}));
}

}  // namespace

std::span<const Target> all_targets() {
  return targets;
}

std::string_view to_string(Target target) {
  return names[static_cast<std::size_t>(target)];
}

bool is_wall(Target target) {
  return target <= Target::height_field;
}

std::uint32_t add_target(Scene& scene, Target target, double radius, const Surface& surface, Random& random) {
  if (is_wall(target))
    add_wall(scene, target, surface, random);
  else if (target == Target::rope || target == Target::flying_rope)
    add_rope(scene, target == Target::rope, surface, random);
  else if (target == Target::net || target == Target::flying_net)
    return add_net(scene, target == Target::net, radius, surface, random);
  else if (target == Target::figure)
    add_figure(scene, surface, random);
  else
    add_flying_box(scene, surface, random);
  return 0;
}

}  // namespace plumb::scenes
