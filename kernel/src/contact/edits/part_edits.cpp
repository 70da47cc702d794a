#include "contact/edits/part_edits.hpp"

#include <algorithm>
#include <map>

#include "contact/linkage/scene_parts.hpp"
#include "contact/platforms/anchored.hpp"

namespace plumb::detail {
namespace {

/// Returns the particles that places have a share of, ascending.
std::vector<std::uint32_t> particles_of(const Capsule& capsule) {
  std::vector<std::uint32_t> out;
  for (const Point* const point : {&capsule.a, &capsule.b})
    for (std::size_t k = 0; k < point->particles.size(); ++k)
      if (point->weights[k] != 0) out.push_back(point->particles[k]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Returns by particle the island that all but shapes hold together, and one that none has for fixed ones.
std::vector<std::uint32_t> bare_islands(Scene scene) {
  scene.capsules.clear();
  scene.hulls.clear();
  const SceneParts parts(scene);
  std::vector<std::uint32_t> out(scene.particles.size(), parts.count());
  for (std::uint32_t p = 0; p < parts.count(); ++p)
    for (const std::uint32_t particle : parts.particles(p))
      if (!scene.particles[particle].fixed) out[particle] = p;
  return out;
}

/// Returns whether a capsule has movable particles of several islands.
bool joins_islands(const Scene& scene, const std::vector<std::uint32_t>& islands, const Capsule& capsule) {
  std::vector<std::uint32_t> of;
  for (const std::uint32_t particle : particles_of(capsule))
    if (!scene.particles[particle].fixed) of.push_back(islands[particle]);
  return std::any_of(of.begin(), of.end(), [&](std::uint32_t island) { return island != of.front(); });
}

}  // namespace

void NamedPart::cut(std::uint32_t number) {
  const auto at = std::find(names.rods.begin(), names.rods.end(), number);
  if (at == names.rods.end()) return;
  const auto index = static_cast<std::size_t>(at - names.rods.begin());
  Rod& rod = scene.rods[index];
  const RodMass mass = rod_mass(scene, index, MassModel::consistent);
  const auto [a, b] = std::minmax(rod.a, rod.b);
  const std::vector<std::uint32_t> ends{a, b};
  const auto is_along = [&](std::uint32_t one, std::uint32_t two) {
    return std::min(one, two) == ends[0] && std::max(one, two) == ends[1];
  };
  std::erase_if(scene.bends,
                [&](const Bend& bend) { return is_along(bend.a, bend.b) || is_along(bend.b, bend.c); });
  erase_numbered(scene.capsules, names.capsules,
                 [&](const Capsule& capsule) { return particles_of(capsule) == ends; });
  if (mass.ab != 0) {
    rod.law = {.stiffness = 0};
    return;
  }
  scene.particles[rod.a].mass += mass.aa;
  scene.particles[rod.b].mass += mass.bb;
  erase_rod(index);
}

void NamedPart::take_capsules(std::span<const NamedPart> from) {
  std::map<std::uint32_t, std::uint32_t> here;
  for (std::uint32_t k = 0; k < names.particles.size(); ++k) here[names.particles[k]] = k;
  std::map<std::uint32_t, Capsule> taken;
  for (const NamedPart& part : from)
    for (std::size_t i = 0; i < part.names.capsules.size(); ++i) {
      Capsule& capsule = taken[part.names.capsules[i]] = part.scene.capsules[i];
      for (Point* const point : {&capsule.a, &capsule.b})
        for (std::size_t k = 0; k < point->particles.size(); ++k)
          if (point->weights[k] != 0) {
            const std::uint32_t own = point->particles[k], number = part.names.particles[own];
            const auto [at, is_new] =
                here.try_emplace(number, static_cast<std::uint32_t>(names.particles.size()));
            if (is_new) {
              names.particles.push_back(number);
              scene.particles.push_back(part.scene.particles[own]);
            }
            point->particles[k] = at->second;
          }
    }
  for (const auto& [number, capsule] : taken) {
    names.capsules.push_back(number);
    scene.capsules.push_back(capsule);
  }
}

void NamedPart::erase_rod(std::size_t index) {
  const auto at = static_cast<std::ptrdiff_t>(index);
  scene.rods.erase(scene.rods.begin() + at);
  names.rods.erase(names.rods.begin() + at);
  rods_were.erase(rods_were.begin() + at);
}

void NamedPart::end_fixed() {
  const auto is_held = [&](const Rod& rod) {
    return scene.particles[rod.a].fixed && scene.particles[rod.b].fixed;
  };
  for (std::size_t i = scene.rods.size(); i-- > 0;)
    if (is_held(scene.rods[i])) erase_rod(i);
  erase_numbered(scene.capsules, names.capsules,
                 [&](const Capsule& capsule) { return is_anchored(scene, capsule); });
}

void NamedPart::end_torn_capsules(const Scene* before) {
  if (scene.capsules.empty()) return;
  const std::vector<std::uint32_t> are = bare_islands(scene);
  const std::vector<std::uint32_t> were = before ? bare_islands(*before) : std::vector<std::uint32_t>{};
  erase_numbered(scene.capsules, names.capsules, [&](const Capsule& capsule) {
    return joins_islands(scene, are, capsule) && !(before && joins_islands(*before, were, capsule));
  });
}

}  // namespace plumb::detail
