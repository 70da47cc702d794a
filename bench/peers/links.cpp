#include "links.hpp"

#include <cmath>
#include <string>

#include "plumb/error.hpp"

namespace plumb::bench {
namespace {

/// A bead has this share of mass × length² as its inertia. On N5_r10 it moves the end by a little more than
/// this share of the diagonal. A larger value moves it more, a smaller one drowns in rounding.
constexpr double bead_share = 1e-10;

void refuse(const std::string& reason) {
  throw InputError("not a scene for other libraries: " + reason);
}

void require_plain(const Scene& scene) {
  if (scene.drag != 0) refuse("it has drag");
  for (const Rod& rod : scene.rods)
    if (rod.mass != 0) refuse("its rods have mass");
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Vec3 d = scene.particles[scene.rods[i].b].position - scene.particles[scene.rods[i].a].position;
    if (std::abs(norm(d) - rod_length(scene, i)) > 1e-12 * norm(d))
      refuse("its rods do not start at their length");
  }
  for (const Particle& particle : scene.particles)
    if (dot(particle.velocity, particle.velocity) != 0) refuse("it does not start from rest");
}

struct Neighbour {
  std::uint32_t particle, rod;
};

}  // namespace

std::vector<Link> find_links(const Scene& scene) {
  require_plain(scene);
  const std::size_t count = scene.particles.size();
  std::vector<std::vector<Neighbour>> neighbours(count);
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    neighbours[scene.rods[i].a].push_back({scene.rods[i].b, i});
    neighbours[scene.rods[i].b].push_back({scene.rods[i].a, i});
  }
  std::vector<Link> links;
  std::vector<bool> seen(count, false);
  const auto hang = [&](std::uint32_t from, std::int32_t parent, std::uint32_t root, std::uint32_t but) {
    for (const auto& [particle, rod] : neighbours[from]) {
      if (rod == but) continue;
      if (scene.particles[particle].fixed) refuse("it hangs from more than one fixed particle");
      if (seen[particle]) refuse("its rods close loops");
      seen[particle] = true;
      links.push_back({.particle = particle,
                       .from = from,
                       .parent = parent,
                       .root = root,
                       .offset = scene.particles[particle].position - scene.particles[from].position,
                       .mass = scene.particles[particle].mass});
    }
  };
  const auto rod_to = [&](const Link& link) {
    for (const auto& [particle, rod] : neighbours[link.particle])
      if (particle == link.from) return rod;
    return ~std::uint32_t{0};
  };
  for (std::uint32_t root = 0; root < count; ++root) {
    if (!scene.particles[root].fixed) continue;
    std::size_t next = links.size();
    hang(root, Link::none, root, ~std::uint32_t{0});
    for (; next < links.size(); ++next) {
      const Link link = links[next];
      hang(link.particle, static_cast<std::int32_t>(next), root, rod_to(link));
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!scene.particles[i].fixed && !seen[i]) refuse("it does not hang from a fixed particle");
  return links;
}

bool has_links(const Scene& scene) {
  try {
    find_links(scene);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

double bead_inertia(const Link& link) {
  return bead_share * link.mass * dot(link.offset, link.offset);
}

}  // namespace plumb::bench
