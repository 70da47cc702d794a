#include "step/breaks/breaks.hpp"

#include <algorithm>
#include <vector>

#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/scene_graph.hpp"
#include "step/breaks/ids.hpp"

namespace plumb::detail {
namespace {

constexpr double never = RodLaw{}.strength;

}  // namespace

Breaks::Breaks(const Scene& scene, const Settings& settings)
    : model_(mass_model_of(settings)), first_(scene) {
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i)
    if (scene.rods[i].law.strength < never) weak_.push_back(i);
  if (!weak_.empty()) begin();
}

void Breaks::begin() {
  if (has_begun_) return;
  has_begun_ = true;
  const std::size_t particles = scene_now().particles.size();
  for (const Particle& particle : scene_now().particles) fixed_.push_back(particle.fixed);
  out_.assign(scene_now().rods.size(), State::in);
  place_.assign(particles, none);
  whole_.assign(particles, none);
  Array<Rows<std::uint32_t>::Entry> entries;
  for (std::uint32_t i = 0; i < scene_now().rods.size(); ++i)
    for (const std::uint32_t end : {scene_now().rods[i].a, scene_now().rods[i].b})
      entries.push_back({end, i});
  rods_at_ = {static_cast<std::uint32_t>(particles), entries};

  const layouts::Islands islands = find_bent_islands(scene_now(), SceneGraph(scene_now()).view());
  const IslandElements elements(scene_now(), islands);
  wholes_.reserve(islands.count());
  const auto list = [](std::span<const std::uint32_t> of) { return Ids(of.begin(), of.end()); };
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    wholes_.push_back({.particles = list(islands.vertices(i)),
                       .rods = list(islands.edges(i)),
                       .bends = list(elements.bends_of(i)),
                       .tackles = list(elements.tackles_of(i)),
                       .twists = list(elements.twists_of(i)),
                       .reels = list(elements.reels_of(i))});
    for (const std::uint32_t particle : islands.vertices(i))
      if (!scene_now().particles[particle].fixed) whole_[particle] = i;
  }
}

std::uint32_t Breaks::whole_at(std::uint32_t rod) const {
  const auto [a, b] = std::pair{scene_now().rods[rod].a, scene_now().rods[rod].b};
  return whole_[a] != none ? whole_[a] : whole_[b];
}

std::uint32_t Breaks::head_of(const Whole& whole) const {
  const auto head = std::find_if(whole.particles.begin(), whole.particles.end(),
                                 [&](std::uint32_t each) { return whole_[each] != none; });
  return head == whole.particles.end() ? none : *head;
}

Array<std::uint32_t> Breaks::heads() const {
  Ids out;
  for (const Whole& whole : wholes_)
    if (const std::uint32_t head = head_of(whole); head != none) out.push_back(head);
  return out;
}

std::optional<std::uint32_t> Breaks::twist_beside(std::uint32_t rod) const {
  const std::uint32_t whole = whole_at(rod);
  if (whole == none) return {};
  const auto [a, b] = std::pair{scene_now().rods[rod].a, scene_now().rods[rod].b};
  for (const std::uint32_t twist : wholes_[whole].twists) {
    const auto& chain = scene_now().twists[twist].particles;
    bool has_rod = false;
    for (std::size_t k = 1; k < chain.size(); ++k)
      has_rod = has_rod || std::minmax(chain[k - 1], chain[k]) == std::minmax(a, b);
    if (!has_rod) return twist;
  }
  return {};
}

std::optional<std::uint32_t> Breaks::twist_at(std::uint32_t particle) const {
  const std::uint32_t whole = whole_[particle];
  if (whole == none || wholes_[whole].twists.empty()) return {};
  return wholes_[whole].twists.front();
}

std::optional<std::uint32_t> Breaks::reel_at(std::uint32_t particle) const {
  const std::uint32_t whole = whole_[particle];
  if (whole == none || wholes_[whole].reels.empty()) return {};
  return wholes_[whole].reels.front();
}

std::optional<std::uint32_t> Breaks::tackle_at(std::uint32_t particle) const {
  const std::uint32_t whole = whole_[particle];
  if (whole == none || wholes_[whole].tackles.empty()) return {};
  return wholes_[whole].tackles.front();
}

Array<std::uint32_t> Breaks::bends_at(std::uint32_t particle) const {
  Ids out;
  const std::vector<Bend>& bends = scene_now().bends;
  for (std::uint32_t i = 0; i < bends.size(); ++i) {
    const auto particles = particles_of(bends[i]);
    if (std::count(particles.begin(), particles.end(), particle) == 0) continue;
    const auto movable = std::find_if(particles.begin(), particles.end(),
                                      [&](std::uint32_t each) { return whole_[each] != none; });
    if (movable == particles.end()) continue;
    const Ids& of = wholes_[whole_[*movable]].bends;
    if (std::count(of.begin(), of.end(), i) > 0) out.push_back(i);
  }
  return out;
}

// --- Changes

bool Breaks::joins_ends(std::uint32_t rod) const {
  return out_[rod] != State::taken || rod_mass(scene_now(), rod, model_).ab != 0;
}

Fallen Breaks::take_out(std::span<const std::uint32_t> broken, const Edits& edits) {
  touched_.clear();
  freed_.clear();
  join(edits);
  for (const std::uint32_t particle : along_) touch(whole_[particle], true);
  along_.clear();
  for (const std::uint32_t rod : broken) touch_rod(rod, false);
  for (const std::uint32_t rod : edits.cut) touch_rod(rod, true);
  for (const std::uint32_t rod : broken) take_rod(rod);
  for (const std::uint32_t rod : edits.cut) take_rod(rod);
  edit(edits);
  const Cutout changed = cutout();
  const layouts::Islands islands = find_bent_islands(changed.scene, SceneGraph(changed.scene).view());
  const Parts parts = leaving_parts(changed, islands);
  Fallen out = cut_out(changed, islands, parts);
  for (const std::uint32_t whole : touched_)
    if (wholes_[whole].leaves()) append(out.leaving_twists, wholes_[whole].twists);
  renumber(changed, islands, parts);
  for (const std::uint32_t particle : changed.particles) place_[particle] = none;
  held_freed_.clear();
  return out;
}

void Breaks::touch(std::uint32_t whole, bool is_forced) {
  if (whole == none) return;
  wholes_[whole].is_forced = wholes_[whole].is_forced || is_forced;
  if (wholes_[whole].is_touched) return;
  wholes_[whole].is_touched = true;
  touched_.push_back(whole);
}

void Breaks::touch_rod(std::uint32_t rod, bool is_forced) {
  if (out_[rod] != State::taken) touch(whole_at(rod), is_forced);
}

/// Takes a rod out. It goes on as one that pulls nothing if its mass joins its ends.
void Breaks::take_rod(std::uint32_t number) {
  if (out_[number] == State::taken) return;
  out_[number] = State::taken;
  const Rod& rod = scene_now().rods[number];
  const RodMass mass = rod_mass(scene_now(), number, model_);
  if (mass.ab != 0) return;
  const std::uint32_t whole = whole_at(number);
  if (whole != none) std::erase(wholes_[whole].rods, number);
  if (mass.aa == 0 && mass.bb == 0) return;
  mass_at(rod.a).second += mass.aa;
  mass_at(rod.b).second += mass.bb;
}

/// Returns a particle's own mass and what it took of rods, which may be changed from now on.
std::pair<double, double>& Breaks::mass_at(std::uint32_t particle) {
  return masses_.try_emplace(particle, scene_now().particles[particle].mass, 0.0).first->second;
}

/// Lets rods and joints join particles. grow() has made room for their numbers.
void Breaks::join(const Edits& edits) {
  const Scene& scene = edits.joined.scene;
  const Names& names = edits.joined.names;
  if (lists_any(names))
    for_lists(
        [&](std::size_t kind, auto& all, const auto& list) {
          for (std::size_t k = 0; k < list.size(); ++k) all[(*names.all()[kind])[k]] = list[k];
        },
        *grown_, scene);
  joined_ = names.rods;
  for (std::size_t k = 0; k < names.rods.size(); ++k) {
    const std::uint32_t number = names.rods[k];
    const Rod& rod = scene.rods[k];
    if (rod.law.strength < never) weak_.insert(std::lower_bound(weak_.begin(), weak_.end(), number), number);
    for (const std::uint32_t end : {rod.a, rod.b}) {
      Ids rods(rods_at(end).begin(), rods_at(end).end());
      rods.push_back(number);
      rods_at_.replace(end, rods);
      touch(whole_[end], true);
    }
  }
}

/// Does what is ordered of particles.
void Breaks::edit(const Edits& edits) {
  for (const auto& [particle, mass] : edits.masses) {
    mass_at(particle).first = mass;
    touch(whole_[particle], true);
  }
  for (const auto& [particle, is_fixed] : edits.fixed) {
    if ((fixed_[particle] != 0) == is_fixed) continue;
    fixed_[particle] = is_fixed ? 1 : 0;
    touch(whole_[particle], true);
    if (is_fixed) continue;
    freed_.push_back(particle);
    for (const std::uint32_t rod : rods_at(particle))
      if (joins_ends(rod)) touch(whole_at(rod), true);
  }
}

}  // namespace plumb::detail
