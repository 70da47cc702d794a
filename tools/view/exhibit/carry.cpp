#include "view/exhibit/carry.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

namespace plumb::view {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;
using Matrix = std::array<Vec3, 3>;  // rows

Pair pair_of(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

Matrix rotation(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
          Vec3{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
          Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

Vec3 times(const Matrix& m, Vec3 v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

Inertia turned(const Matrix& r, const Inertia& i) {
  const Matrix rows{Vec3{i.xx, i.xy, i.xz}, Vec3{i.xy, i.yy, i.yz}, Vec3{i.xz, i.yz, i.zz}};
  const auto entry = [&](int a, int b) { return dot(r[a], times(rows, r[b])); };
  return {.xx = entry(0, 0),
          .yy = entry(1, 1),
          .zz = entry(2, 2),
          .xy = entry(0, 1),
          .xz = entry(0, 2),
          .yz = entry(1, 2)};
}

void carry_bodies(const Scene& before, const World& world, Scene& out) {
  std::vector<Pose> poses(out.bodies.size());
  world.copy_poses(poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Body& body = before.bodies[i];
    const Matrix r = rotation(poses[i].orientation);
    out.bodies[i].center = poses[i].position;
    out.bodies[i].inertia = turned(r, body.inertia);
    // Sweeps leave particles a little off, and a body's mass lies in particles only where they stand as it
    // does.
    for (const std::uint32_t particle : body.particles)
      if (const Particle& was = before.particles[particle]; !was.fixed)
        out.particles[particle].position = poses[i].position + times(r, was.position - body.center);
  }
  for (Hull& hull : out.hulls) {
    const Matrix r = rotation(poses[hull.body].orientation);
    for (Vec3& point : hull.points)
      point = poses[hull.body].position + times(r, point - before.bodies[hull.body].center);
  }
}

/// Leaves out bends and twists along rods that are gone.
void drop_what_ended(const Scene& before, const Remains& remains, Scene& out) {
  std::set<Pair> gone;
  for (std::size_t i = 0; i < before.rods.size(); ++i)
    if (remains.rod_numbers[i] == no_rod) gone.insert(pair_of(before.rods[i].a, before.rods[i].b));
  if (gone.empty()) return;
  const auto is_gone = [&](std::uint32_t a, std::uint32_t b) { return gone.contains(pair_of(a, b)); };
  std::erase_if(out.bends,
                [&](const Bend& bend) { return is_gone(bend.a, bend.b) || is_gone(bend.b, bend.c); });
  std::erase_if(out.twists, [&](const Twist& twist) {
    for (std::size_t i = 1; i < twist.particles.size(); ++i)
      if (is_gone(twist.particles[i - 1], twist.particles[i])) return true;
    return false;
  });
}

class Sets {
 public:
  explicit Sets(const Scene& scene) : scene_(scene), parent_(scene.particles.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  void tie(std::uint32_t a, std::uint32_t b) {
    if (scene_.particles[a].fixed || scene_.particles[b].fixed) return;
    const std::uint32_t from = find(a), to = find(b);
    parent_[std::max(from, to)] = std::min(from, to);
  }
  std::uint32_t find(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }

 private:
  const Scene& scene_;
  std::vector<std::uint32_t> parent_;
};

/// Ties the movable particles of places and directions together.
void tie_places(Sets& sets, const Scene& scene, std::initializer_list<const Point*> places) {
  std::uint32_t first = no_island;
  for (const Point* place : places)
    for (std::size_t i = 0; i < place->particles.size(); ++i) {
      const std::uint32_t particle = place->particles[i];
      if (place->weights[i] == 0 || scene.particles[particle].fixed) continue;
      if (first == no_island) first = particle;
      sets.tie(first, particle);
    }
}

void tie_joints(Sets& sets, const Scene& scene) {
  for (const Pin& pin : scene.pins) tie_places(sets, scene, {&pin.a, &pin.b});
  for (const Alignment& each : scene.alignments)
    tie_places(sets, scene, {&each.u.from, &each.u.to, &each.v.from, &each.v.to});
  for (const AngleControl& each : scene.angles)
    tie_places(sets, scene, {&each.u.from, &each.u.to, &each.v.from, &each.v.to});
  for (const Spring& each : scene.springs) tie_places(sets, scene, {&each.a, &each.b});
  for (const Torsion& each : scene.torsions)
    tie_places(sets, scene, {&each.u.from, &each.u.to, &each.v.from, &each.v.to});
}

}  // namespace

Carried carry(const Scene& scene, const World& world, const Remains& remains) {
  Carried out{.scene = scene, .rod_numbers = std::vector<std::uint32_t>(scene.rods.size(), no_rod)};
  const std::size_t n = world.info().particles;
  std::vector<Vec3> positions(n), velocities(n);
  world.copy_positions(positions);
  world.copy_velocities(velocities);
  for (std::size_t i = 0; i < n; ++i) {
    Particle& particle = out.scene.particles[i];
    particle.position = positions[i];
    particle.velocity = particle.fixed ? Vec3{} : velocities[i];
    particle.asleep = remains.asleep[i] != 0;
  }
  out.scene.rods.clear();
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    if (remains.rod_numbers[i] == no_rod) continue;
    out.rod_numbers[i] = static_cast<std::uint32_t>(out.scene.rods.size());
    out.scene.rods.push_back(scene.rods[i]);
  }
  for (std::uint32_t i = 0; i < scene.twists.size(); ++i) out.scene.twists[i].angle = world.twist(i);
  for (std::uint32_t i = 0; i < scene.reels.size(); ++i) out.scene.reels[i].out = world.reel_out(i);
  carry_bodies(scene, world, out.scene);
  drop_what_ended(scene, remains, out.scene);
  return out;
}

std::vector<std::uint32_t> find_islands(const Scene& scene, const std::vector<std::uint32_t>& rod_numbers) {
  Sets sets(scene);
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    if (rod_numbers[i] != no_rod) sets.tie(scene.rods[i].a, scene.rods[i].b);
  for (const Tackle& tackle : scene.tackles) {
    std::uint32_t last = no_island;
    for (const std::uint32_t particle : tackle.particles) {
      if (scene.particles[particle].fixed) continue;
      if (last != no_island) sets.tie(last, particle);
      last = particle;
    }
  }
  for (const Body& body : scene.bodies)
    for (const std::uint32_t particle : body.particles) sets.tie(body.particles[0], particle);
  tie_joints(sets, scene);
  std::vector<std::uint32_t> out(scene.particles.size(), no_island);
  for (std::uint32_t i = 0; i < out.size(); ++i)
    if (!scene.particles[i].fixed) out[i] = sets.find(i);
  return out;
}

}  // namespace plumb::view
