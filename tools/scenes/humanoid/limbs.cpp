#include "scenes/humanoid/limbs.hpp"

#include <algorithm>
#include <utility>

#include "plumb/joints.hpp"

namespace plumb::scenes {
namespace {

/// Returns the particle that a place is, if it is one.
std::optional<std::uint32_t> particle_of(const Point& point) {
  std::optional<std::uint32_t> found;
  for (std::size_t i = 0; i < 4; ++i) {
    if (point.weights[i] == 0) continue;
    if (point.weights[i] != 1 || found) return {};
    found = point.particles[i];
  }
  return found;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;

Pair ordered(std::uint32_t a, std::uint32_t b) {
  return std::minmax(a, b);
}

template <class Use>
void visit_particles(const Point& point, Use use) {
  for (std::size_t i = 0; i < 4; ++i)
    if (point.weights[i] != 0) use(point.particles[i]);
}

}  // namespace

bool Limb::is_ball() const {
  return a.particles == b.particles && a.weights == b.weights;
}

Vec3 place_of(const Point& point, std::span<const Vec3> positions) {
  Vec3 sum{};
  for (std::size_t i = 0; i < 4; ++i)
    if (point.weights[i] != 0) sum += point.weights[i] * positions[point.particles[i]];
  return sum;
}

std::vector<Limb> list_limbs(const Scene& scene) {
  std::vector<Limb> limbs;
  std::vector<bool> seen(scene.particles.size(), false);
  std::vector<Pair> covered;
  for (const Capsule& capsule : scene.capsules) {
    limbs.push_back({.a = capsule.a, .b = capsule.b, .radius = capsule.radius});
    if (limbs.back().is_ball()) limbs.back().particle = particle_of(capsule.a);
    std::vector<std::uint32_t> used;
    for (const Point* point : {&capsule.a, &capsule.b})
      visit_particles(*point, [&](std::uint32_t particle) {
        seen[particle] = true;
        used.push_back(particle);
      });
    const auto a = particle_of(capsule.a), b = particle_of(capsule.b);
    if (a && b) {
      covered.push_back(ordered(*a, *b));
    } else {  // Places on a body or along a rod lie inside these.
      for (const std::uint32_t p : used)
        for (const std::uint32_t q : used)
          if (p < q) covered.push_back({p, q});
    }
  }
  std::sort(covered.begin(), covered.end());
  // The rod that a capsule is around gives it its number.
  std::vector<std::pair<Pair, std::uint32_t>> rods;
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i)
    rods.emplace_back(ordered(scene.rods[i].a, scene.rods[i].b), i);
  std::sort(rods.begin(), rods.end());
  for (Limb& limb : limbs) {
    const auto a = particle_of(limb.a), b = particle_of(limb.b);
    if (!a || !b) continue;
    const Pair pair = ordered(*a, *b);
    const auto it = std::lower_bound(rods.begin(), rods.end(), std::pair{pair, std::uint32_t{0}});
    if (it != rods.end() && it->first == pair) limb.rod = it->second;
  }
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    if (std::binary_search(covered.begin(), covered.end(), ordered(rod.a, rod.b))) continue;
    limbs.push_back({.a = point_at(rod.a), .b = point_at(rod.b), .rod = i});
  }
  for (const Rod& rod : scene.rods) seen[rod.a] = seen[rod.b] = true;
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
    if (!seen[i]) limbs.push_back({.a = point_at(i), .b = point_at(i), .particle = i});
  return limbs;
}

}  // namespace plumb::scenes
