#include "step/breaks/breaks.hpp"

#include <algorithm>
#include <numeric>

#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/bends/rod_table.hpp"
#include "scene/scene_graph.hpp"

namespace plumb::detail {
namespace {

constexpr std::uint32_t none = 0xffffffff;

/// Returns whether particles that follow each other in a chain, and are not both fixed, lack a rod.
template <class Particles>
bool lacks_rod(const Scene& scene, const RodTable& rods, const Particles& chain) {
  for (std::size_t k = 1; k < chain.size(); ++k)
    if (!(scene.particles[chain[k - 1]].fixed && scene.particles[chain[k]].fixed) &&
        !rods.find(chain[k - 1], chain[k]))
      return true;
  return false;
}

}  // namespace

Breaks::Breaks(const Scene& scene, const Settings& settings) : model_(mass_model_of(settings)) {
  if (std::none_of(scene.rods.begin(), scene.rods.end(),
                   [](const Rod& rod) { return rod.law.strength < never; }))
    return;
  scene_ = scene;
  numbers_.resize(scene.rods.size());
  std::iota(numbers_.begin(), numbers_.end(), 0u);
  is_leaving_.resize(scene.rods.size());
  broken_.assign(scene.rods.size(), 0);
  whole_.assign(scene.particles.size(), none);
  const layouts::Islands all = islands();
  for (; wholes_ < all.count(); ++wholes_)
    for (const std::uint32_t particle : all.vertices(wholes_)) whole_[particle] = wholes_;
}

layouts::Islands Breaks::islands() const {
  return find_bent_islands(scene_, SceneGraph(scene_).view());
}

Fallen Breaks::take_out_leaving() {
  remove_leaving();
  const layouts::Islands now = islands();
  const std::vector<std::uint32_t> parts = apart(now);
  for (const std::uint32_t part : parts) {
    for (const std::uint32_t particle : now.vertices(part)) whole_[particle] = wholes_;
    ++wholes_;
  }
  return cut_out(now, parts);
}

void Breaks::remove_leaving() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scene_.rods.size(); ++i) {
    Rod rod = scene_.rods[i];
    if (is_leaving_[i] != 0) {
      broken_[numbers_[i]] = 1;
      const RodMass mass = rod_mass(scene_, i, model_);
      rod.law = {.stiffness = 0};
      if (mass.ab == 0) {
        scene_.particles[rod.a].mass += mass.aa;
        scene_.particles[rod.b].mass += mass.bb;
        continue;
      }
    }
    numbers_[kept] = numbers_[i];
    scene_.rods[kept++] = rod;
  }
  scene_.rods.resize(kept);
  numbers_.resize(kept);
  is_leaving_.resize(kept);
  if (scene_.bends.empty() && scene_.twists.empty()) return;
  const RodTable rods(scene_);
  std::erase_if(scene_.bends, [&](const Bend& bend) { return lacks_rod(scene_, rods, particles_of(bend)); });
  std::erase_if(scene_.twists, [&](const Twist& twist) { return lacks_rod(scene_, rods, twist.particles); });
}

/// Returns the islands that are parts of a larger one, which nothing holds together.
std::vector<std::uint32_t> Breaks::apart(const layouts::Islands& islands) const {
  const IslandElements elements(scene_, islands);
  std::vector<std::uint32_t> parts(wholes_, 0);
  std::vector<std::uint8_t> stays(wholes_, 0);
  const auto whole = [&](std::uint32_t part) { return whole_[islands.vertices(part).front()]; };
  for (std::uint32_t part = 0; part < islands.count(); ++part) {
    ++parts[whole(part)];
    if (!elements.twists_of(part).empty() || !elements.reels_of(part).empty()) stays[whole(part)] = 1;
  }
  std::vector<std::uint32_t> out;
  for (std::uint32_t part = 0; part < islands.count(); ++part)
    if (parts[whole(part)] > 1 && stays[whole(part)] == 0) out.push_back(part);
  return out;
}

Fallen Breaks::cut_out(const layouts::Islands& islands, const std::vector<std::uint32_t>& numbers) const {
  Fallen out;
  out.scene.gravity = scene_.gravity;
  out.scene.drag = scene_.drag;
  std::vector<std::uint32_t> place(scene_.particles.size(), none);
  const IslandElements elements(scene_, islands);
  for (const std::uint32_t island : numbers) {
    for (const std::uint32_t particle : islands.vertices(island)) {
      if (place[particle] != none) continue;
      place[particle] = static_cast<std::uint32_t>(out.particles.size());
      out.particles.push_back(particle);
      out.scene.particles.push_back(scene_.particles[particle]);
      out.scene.particles.back().asleep = false;
    }
    for (const std::uint32_t rod : islands.edges(island)) {
      Rod& made = out.scene.rods.emplace_back(scene_.rods[rod]);
      made.a = place[made.a];
      made.b = place[made.b];
      out.rods.push_back(numbers_[rod]);
    }
    for (const std::uint32_t bend : elements.bends_of(island)) {
      Bend& made = out.scene.bends.emplace_back(scene_.bends[bend]);
      for (std::uint32_t* const end : {&made.a, &made.b, &made.c}) *end = place[*end];
    }
    for (const std::uint32_t tackle : elements.tackles_of(island)) {
      Tackle& made = out.scene.tackles.emplace_back(scene_.tackles[tackle]);
      for (std::uint32_t& particle : made.particles) particle = place[particle];
      out.tackles.push_back(tackle);
    }
  }
  return out;
}

}  // namespace plumb::detail
