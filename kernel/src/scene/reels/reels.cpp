#include "scene/reels/reels.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scene/bends/bends.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

/// Says what a particle has to do with reels.
struct Use {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t reel = none;  ///< It may be wound there.
  std::size_t rods = 0;     ///< So many rods end there.
};

void validate_chain(const Scene& scene, std::size_t i) {
  const std::vector<std::uint32_t>& particles = scene.reels[i].particles;
  if (particles.size() < 2)
    refuse("reel ", i, ": needs a drum and one particle at least, got ", particles.size(), " particles");
  for (const std::uint32_t particle : particles)
    if (particle >= scene.particles.size())
      refuse("reel ", i, ": particle ", particle, " does not exist (the scene has ", scene.particles.size(),
             " particles)");
  std::vector<std::uint32_t> sorted = particles;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) refuse("reel ", i, ": has particle ", *twice, " twice");
  if (!scene.particles[particles.front()].fixed)
    refuse("reel ", i, ": its drum, particle ", particles.front(), ", is not fixed");
  for (std::size_t k = 1; k < particles.size(); ++k)
    if (scene.particles[particles[k]].fixed)
      refuse("reel ", i, ": particle ", particles[k], " is fixed, but only the drum may be");
}

void validate_rods(const Scene& scene, const RodTable& rods, std::size_t i) {
  const std::vector<std::uint32_t>& particles = scene.reels[i].particles;
  for (std::size_t k = 1; k < particles.size(); ++k) {
    const auto rod = rods.find(particles[k - 1], particles[k]);
    if (!rod) refuse("reel ", i, ": no rod joins particles ", particles[k - 1], " and ", particles[k]);
    if (scene.rods[*rod].mass != 0)
      refuse("reel ", i, ": rod ", *rod, " has mass, but a rope that is reeled has it in its particles");
    if (std::isfinite(scene.rods[*rod].law.strength))
      refuse("reel ", i, ": rod ", *rod, " has a strength, but rods that are reeled do not break");
  }
}

void validate_out(const Scene& scene, const RodTable& rods, std::size_t i) {
  const double out = scene.reels[i].out, whole = chain_length(scene, rods, scene.reels[i]);
  if (!(out >= 0 && std::isfinite(out)))
    refuse("reel ", i, ": what is out must be finite and not negative, got ", out, " m");
  if (exceeds_chain(out, whole))
    refuse("reel ", i, ": ", out, " m are out, but its chain is ", whole, " m long");
}

/// Refuses what holds a particle that may be wound, which stays outside of the drum.
void refuse_held(const Array<Use>& uses, std::uint32_t particle, const std::string& by) {
  if (uses[particle].reel != Use::none)
    refuse("reel ", uses[particle].reel, ": particle ", particle, " may be wound, but ", by, " holds it");
}

template <class List, class ParticlesOf>
void refuse_held_by(const Array<Use>& uses, const char* name, const List& list, ParticlesOf&& particles_of) {
  for (std::size_t i = 0; i < list.size(); ++i)
    for (const std::uint32_t particle : particles_of(list[i]))
      refuse_held(uses, particle, name + std::to_string(i));
}

void refuse_what_holds(const Scene& scene) {
  Array<Use> uses(scene.particles.size());
  for (std::size_t i = 0; i < scene.reels.size(); ++i) {
    const std::vector<std::uint32_t>& particles = scene.reels[i].particles;
    for (std::size_t k = 1; k + 1 < particles.size(); ++k) {
      refuse_held(uses, particles[k], "reel " + std::to_string(i));
      uses[particles[k]].reel = i;
    }
  }
  for (const Reel& reel : scene.reels) refuse_held(uses, reel.particles.back(), "another reel");
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    for (const std::uint32_t end : {scene.rods[i].a, scene.rods[i].b})
      if (++uses[end].rods > 2) refuse_held(uses, end, "rod " + std::to_string(i));
  refuse_held_by(uses, "bend ", scene.bends, [](const Bend& bend) { return particles_of(bend); });
  refuse_held_by(uses, "twist ", scene.twists, [](const Twist& twist) { return twist.particles; });
  refuse_held_by(uses, "tackle ", scene.tackles, [](const Tackle& tackle) { return tackle.particles; });
}

}  // namespace

void validate_reels(const Scene& scene) {
  if (scene.reels.empty()) return;
  const RodTable rods(scene);
  for (std::size_t i = 0; i < scene.reels.size(); ++i) {
    validate_chain(scene, i);
    validate_rods(scene, rods, i);
    validate_out(scene, rods, i);
  }
  refuse_what_holds(scene);
}

Array<std::uint32_t> rods_of(const RodTable& rods, const Reel& reel) {
  Array<std::uint32_t> out;
  for (std::size_t k = 1; k < reel.particles.size(); ++k)
    out.push_back(static_cast<std::uint32_t>(*rods.find(reel.particles[k - 1], reel.particles[k])));
  return out;
}

double chain_length(const Scene& scene, const RodTable& rods, const Reel& reel) {
  const Array<std::uint32_t> chain = rods_of(rods, reel);
  double sum = 0;  // from the end on, as start_of() adds it up
  for (std::size_t k = chain.size(); k-- > 0;) sum += rod_length(scene, chain[k]);
  return sum;
}

ReelStart start_of(const Scene& scene, const RodTable& rods, const Reel& reel) {
  const Array<std::uint32_t> chain = rods_of(rods, reel);
  ReelStart start{Array<double>(chain.size() + 1), reel.out, 1};
  for (std::size_t k = chain.size(); k-- > 0;)
    start.behind[k] = start.behind[k + 1] + rod_length(scene, chain[k]);
  if (reel.out == 0 || reel.out > start.behind.front()) start.out = start.behind.front();
  // A particle is free from half a rod before the drum on.
  while (start.first < chain.size() && start.leaving() < rod_length(scene, chain[start.first - 1]) / 2)
    ++start.first;
  return start;
}

Array<std::uint8_t> reeled_rods(const Scene& scene) {
  if (scene.reels.empty()) return {};
  const RodTable rods(scene);
  Array<std::uint8_t> out(scene.rods.size(), 0);
  for (const Reel& reel : scene.reels) mark_rods(rods, reel.particles, out);
  return out;
}

Array<std::uint8_t> rods_at_drums(const Scene& scene, std::span<const Vec3> positions) {
  if (scene.reels.empty()) return {};
  const RodTable rods(scene);
  Array<std::uint8_t> out(scene.rods.size(), 0);
  for (const Reel& reel : scene.reels) {
    const Array<std::uint32_t> chain = rods_of(rods, reel);
    const Vec3 drum = positions[reel.particles.front()];
    std::size_t k = 0;
    while (k + 1 < chain.size() && positions[reel.particles[k + 1]] == drum) out[chain[k++]] = 1;
    out[chain[k]] = 1;
    // Less than half a rod from the drum a particle is carried along the line to the next.
    const bool is_carried = norm(positions[reel.particles[k + 1]] - drum) < rod_length(scene, chain[k]) / 2;
    if (is_carried && k + 1 < chain.size()) out[chain[k + 1]] = 1;
  }
  return out;
}

}  // namespace plumb::detail
