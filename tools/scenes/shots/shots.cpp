#include "scenes/shots/shots.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plumb/joints.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::scenes {
namespace {

constexpr std::array<std::string_view, 4> missile_names = {"ball", "rod", "rope", "box"};

/// Turns what leads towards the target away from it.
Vec3 turned_out(Vec3 way, Vec3 out) {
  const double along = dot(way, out);
  return along < 0 ? way - (2 * along) * out : way;
}

void add_capsule(Scene& scene, std::uint32_t a, std::uint32_t b, double radius, const Surface& surface) {
  scene.capsules.push_back({point_at(a), point_at(b), radius, surface});
}

/// Adds a missile whose near end, or the middle of its lower side, is at the origin.
void add_missile(Shot& shot, double size, const Surface& surface, Random& random) {
  Scene& scene = shot.scene;
  const std::uint32_t first = shot.first;
  const double radius = shot.radius;
  const Vec3 along = size * turned_out(random.in_cube(), shot.out);
  if (shot.missile == Missile::ball) {
    scene.particles.push_back({.mass = 1});
    add_capsule(scene, first, first, radius, surface);
  } else if (shot.missile == Missile::rod) {
    scene.particles.insert(scene.particles.end(), {{}, {.position = along}});
    scene.rods.push_back({.a = first, .b = first + 1, .mass = 1});
    add_capsule(scene, first, first + 1, radius, surface);
  } else if (shot.missile == Missile::rope) {
    for (std::uint32_t i = 0; i <= 6; ++i) {
      scene.particles.push_back({.position = (0.2 * i) * along, .mass = 0.1});
      if (i == 0) continue;
      scene.rods.push_back({.a = first + i - 1, .b = first + i});
      add_capsule(scene, first + i - 1, first + i, radius, surface);
    }
  } else {
    const Vec3 half{radius + size * random.between(0, 0.1), radius, radius + size * random.between(0, 0.2)};
    MassProperties box = solid_box(1, 2.0 * half);
    box.center = norm(half) * shot.out;
    const Vec3 axis = random.in_cube();
    const double angle = random.between(0, 3), c = std::cos(angle), s = std::sin(angle) / norm(axis);
    const std::array<double, 4> orientation = {c, s * axis.x, s * axis.y, s * axis.z};
    scene.hulls.push_back(box_on_body(
        add_body(scene, box),
        {.center = box.center, .half_size = half, .orientation = orientation, .surface = surface}));
  }
}

void move_missile(Shot& shot, Vec3 way) {
  for (std::size_t i = shot.first; i < shot.scene.particles.size(); ++i)
    shot.scene.particles[i].position += way;
  if (shot.missile != Missile::box) return;
  shot.scene.bodies.back().center += way;
  for (Vec3& corner : shot.scene.hulls.back().points) corner += way;
}

/// Returns where the target is aimed at: not near a border, where it would be passed by.
Vec3 random_aim(const Shot& shot, Random& random) {
  const Scene& scene = shot.scene;
  const auto inner = [&](std::uint32_t side) { return random.count(side / 4, side - 1 - side / 4); };
  if (shot.net > 0) {
    const std::uint32_t row = inner(shot.net);
    return scene.particles[row * shot.net + inner(shot.net)].position;
  }
  if (shot.target == Target::rope || shot.target == Target::flying_rope)
    return scene.particles[inner(shot.first)].position;
  const std::vector<Vec3> positions = start_of(scene);
  const Core& core = shot.targets[random.count(0, static_cast<std::uint32_t>(shot.targets.size()) - 1)];
  const double share = random.between(0, 1);
  return (1 - share) * place_of(core.a, positions) + share * place_of(core.b, positions);
}

/// Returns from which direction the target is shot at.
Vec3 random_out(Target target, Random& random) {
  const double side = target == Target::height_field || random.chance(0.5) ? 1 : -1;
  if (is_wall(target) || target == Target::net || target == Target::flying_net) return {0, side, 0};
  Vec3 out = random.in_cube();
  if (target == Target::rope || target == Target::flying_rope) out.x *= 0.3;
  return out = (1 / norm(out)) * out;
}

/// Moves the missile out of the target until a gap is left.
void back_off(Shot& shot, Vec3 aim, double gap) {
  const std::vector<Vec3> positions = start_of(shot.scene);
  double way = 0;
  for (int i = 0; i < 1000; ++i) {
    const double left = clearance(shot.targets, shot.missiles, positions, aim + way * shot.out);
    if (left >= gap) break;
    way += gap - left + 1e-4;
  }
  move_missile(shot, aim + way * shot.out);
}

}  // namespace

std::string_view to_string(Missile missile) {
  return missile_names[static_cast<std::size_t>(missile)];
}

std::string Shot::text() const {
  return std::string(to_string(missile)) + " of " + short_number(1e3 * radius, 3) + " mm at a " +
         std::string(to_string(target)) + ", " + short_number(norm(approach), 3) + " m/s, " +
         std::to_string(steps) + " steps of 1/" + short_number(1 / dt, 4) + " s";
}

std::vector<Vec3> start_of(const Scene& scene) {
  std::vector<Vec3> out;
  for (const Particle& each : scene.particles) out.push_back(each.position);
  return out;
}

Shot make_shot(const ShotShape& shape) {
  Random random(shape.seed << 32 ^ shape.number);
  const std::uint64_t kinds = all_targets().size(), missiles = missile_names.size();
  Shot shot;
  shot.scene.gravity = {};
  shot.target = all_targets()[shape.number % kinds];
  shot.missile = static_cast<Missile>(shape.number / kinds % missiles);
  const bool bounces = shape.number / (kinds * missiles) % 2 == 0;
  const Surface surface{.friction = 0.3, .restitution = bounces ? 0.5 : 0};
  shot.radius = random.scaled(0.005, 1);
  shot.out = random_out(shot.target, random);
  shot.net = add_target(shot.scene, shot.target, shot.radius, surface, random);
  append_cores(shot.scene, 0, 0, shot.targets);
  shot.first = static_cast<std::uint32_t>(shot.scene.particles.size());
  const std::size_t capsules = shot.scene.capsules.size(), hulls = shot.scene.hulls.size();
  const double size = shot.net > 0 ? std::min(1.0, 2 * shot.radius) : 1;
  add_missile(shot, size, surface, random);
  append_cores(shot.scene, capsules, hulls, shot.missiles);
  Vec3 velocity{};
  if (is_wall(shot.target)) {
    const double high = shot.radius + wall_thickness + 0.001 + random.between(0, 1);
    move_missile(shot, {random.between(-1, 1), high * shot.out.y, random.between(-1, 1)});
  } else {
    if (shot.target >= Target::flying_rope) velocity = 10.0 * random.in_cube();
    const Vec3 aim = random_aim(shot, random);
    back_off(shot, aim, 0.001 + random.between(0, std::min(0.3, 4 * shot.radius)));
  }
  const Vec3 way = (is_wall(shot.target) ? 0.7 : 0.2) * random.in_cube() - shot.out;
  shot.approach = (random.between(0, 100) / norm(way)) * way;
  for (std::size_t i = 0; i < shot.scene.particles.size(); ++i)
    if (Particle& each = shot.scene.particles[i]; !each.fixed)
      each.velocity = velocity + (i < shot.first ? Vec3{} : shot.approach);
  shot.dt = 1 / random.between(15, 240);
  for (std::size_t i = capsules; i < shot.scene.capsules.size(); ++i)
    for (const Point& end : {shot.scene.capsules[i].a, shot.scene.capsules[i].b})
      shot.outermost.push_back(end);
  for (std::size_t i = hulls; i < shot.scene.hulls.size(); ++i)
    for (const Vec3 corner : shot.scene.hulls[i].points)
      shot.outermost.push_back(point_on_body(shot.scene, shot.scene.hulls[i].body, corner));
  return shot;
}

Scene make_shot_scene(const ShotShape& shape) {
  return make_shot(shape).scene;
}

}  // namespace plumb::scenes
