#include "step/breaks/breaks.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/bends/rod_table.hpp"
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
  std::vector<Rows<std::uint32_t>::Entry> entries;
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

bool Breaks::is_plain(std::uint32_t rod, std::span<const std::uint32_t> cut) const {
  const bool is_cut = out_[rod] != State::in || std::find(cut.begin(), cut.end(), rod) != cut.end();
  return is_cut ? rod_mass(scene_now(), rod, model_).ab == 0 : is_plain_rod(scene_now().rods[rod]);
}

bool Breaks::is_plain_at(std::uint32_t particle, std::span<const std::uint32_t> cut) const {
  if (whole_[particle] == none) return true;
  const Whole& whole = wholes_[whole_[particle]];
  if (!whole.bends.empty() || !whole.tackles.empty() || !whole.twists.empty() || !whole.reels.empty())
    return false;
  return std::all_of(whole.rods.begin(), whole.rods.end(),
                     [&](std::uint32_t rod) { return is_plain(rod, cut); });
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
  const Ids parts = leaving_parts(changed, islands);
  Fallen out = cut_out(changed, islands, parts);
  for (const std::uint32_t whole : touched_)
    if (wholes_[whole].leaves()) append(out.leaving_twists, wholes_[whole].twists);
  renumber(changed, islands, parts);
  for (const std::uint32_t particle : changed.particles) place_[particle] = none;
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

/// Lets rods join particles. grow() has made room for their numbers.
void Breaks::join(const Edits& edits) {
  joined_.clear();
  for (const auto& [number, rod] : edits.joined) {
    grown_->rods[number] = rod;
    if (rod.law.strength < never) weak_.insert(std::lower_bound(weak_.begin(), weak_.end(), number), number);
    for (const std::uint32_t end : {rod.a, rod.b}) {
      Ids rods(rods_at(end).begin(), rods_at(end).end());
      rods.push_back(number);
      rods_at_.replace(end, rods);
      touch(whole_[end], true);
    }
    joined_.push_back(number);
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

// --- Islands

/// Lists what touched islands have, movable particles before fixed ones, which leaves little to sort.
void Breaks::list_touched(Cutout& out) const {
  Ids order = touched_;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return wholes_[a].particles.front() < wholes_[b].particles.front();
  });
  for (const bool is_fixed : {false, true})
    for (const std::uint32_t number : order)
      for (const std::uint32_t particle : wholes_[number].particles)
        if ((fixed_[particle] != 0) == is_fixed) out.particles.push_back(particle);
  for (const std::uint32_t number : order) {
    const Whole& whole = wholes_[number];
    append(out.rods, whole.rods);
    append(out.bends, whole.bends);
    append(out.tackles, whole.tackles);
    append(out.twists, whole.twists);
    append(out.reels, whole.reels);
  }
}

Breaks::Cutout Breaks::cutout() {
  Cutout out;
  list_touched(out);
  const auto add_rod = [&](std::uint32_t rod) {
    if (!joins_ends(rod)) return;
    out.rods.push_back(rod);
    append(out.particles, std::array{scene_now().rods[rod].a, scene_now().rods[rod].b});
  };
  for (const std::uint32_t rod : joined_) add_rod(rod);
  for (const std::uint32_t particle : freed_) {
    out.particles.push_back(particle);
    for (const std::uint32_t rod : rods_at(particle)) add_rod(rod);
  }
  for (Ids* const list : {&out.particles, &out.rods, &out.bends, &out.tackles, &out.twists, &out.reels})
    sort_once(*list);
  Scene& scene = out.scene;
  scene.drag = scene_now().drag;
  scene.particles.reserve(out.particles.size());
  scene.rods.reserve(out.rods.size());
  for (const std::uint32_t particle : out.particles) {
    place_[particle] = static_cast<std::uint32_t>(scene.particles.size());
    Particle& made = scene.particles.emplace_back(scene_now().particles[particle]);
    made.asleep = false;
    made.fixed = fixed_[particle] != 0;
    if (const auto mass = masses_.find(particle); mass != masses_.end())
      made.mass = mass->second.first + mass->second.second;
  }
  const auto place = [&](std::uint32_t& particle) { particle = place_[particle]; };
  for (const std::uint32_t rod : out.rods) {
    Rod& made = scene.rods.emplace_back(scene_now().rods[rod]);
    if (out_[rod] == State::taken) made.law = {.stiffness = 0};  // its mass alone is left
    place(made.a);
    place(made.b);
  }
  for (const std::uint32_t bend : out.bends) {
    Bend& made = scene.bends.emplace_back(scene_now().bends[bend]);
    for (std::uint32_t* const end : {&made.a, &made.b, &made.c}) place(*end);
  }
  const auto copy_chains = [&](const Ids& numbers, const auto& from, auto& to) {
    for (const std::uint32_t number : numbers)
      for (std::uint32_t& particle : to.emplace_back(from[number]).particles) place(particle);
  };
  copy_chains(out.tackles, scene_now().tackles, scene.tackles);
  copy_chains(out.twists, scene_now().twists, scene.twists);
  copy_chains(out.reels, scene_now().reels, scene.reels);
  end_elements(out);
  return out;
}

/// Ends the bends and twists that lack a rod, of which the mass may be left.
void Breaks::end_elements(Cutout& of) {
  Scene& scene = of.scene;
  if (scene.bends.empty() && scene.twists.empty()) return;
  const RodTable rods(scene, [&](std::size_t i) { return out_[of.rods[i]] != State::taken; });
  const Ids before = of.bends;
  erase_numbered(scene.bends, of.bends,
                 [&](const Bend& bend) { return lacks_rod(scene, rods, particles_of(bend)); });
  std::set_difference(before.begin(), before.end(), of.bends.begin(), of.bends.end(),
                      std::back_inserter(ended_));
  erase_numbered(scene.twists, of.twists,
                 [&](const Twist& twist) { return lacks_rod(scene, rods, twist.particles); });
}

/// Returns the islands of a cutout that are parts of a larger one, which nothing holds together, or that are
/// made anew by order.
Ids Breaks::leaving_parts(const Cutout& of, const layouts::Islands& islands) {
  const IslandElements elements(of.scene, islands);
  const auto whole = [&](std::uint32_t part) { return whole_[of.particles[islands.vertices(part).front()]]; };
  for (std::uint32_t part = 0; part < islands.count(); ++part) {
    if (whole(part) == none) continue;  // it was freed
    Whole& of_part = wholes_[whole(part)];
    ++of_part.parts;
    of_part.stays = of_part.stays || !elements.twists_of(part).empty() || !elements.reels_of(part).empty();
  }
  Ids out;
  for (std::uint32_t part = 0; part < islands.count(); ++part)
    if (whole(part) == none || wholes_[whole(part)].leaves()) out.push_back(part);
  return out;
}

/// Gives islands that leave numbers of their own. What stays loses the elements that ended.
void Breaks::renumber(const Cutout& of, const layouts::Islands& islands, const Ids& parts) {
  for (const std::uint32_t number : touched_) {
    Whole& whole = wholes_[number];
    if (whole.leaves()) {
      whole = {};
      spare_.push_back(number);
      continue;
    }
    const auto has_ended = [](const Ids& left) {
      return [&](std::uint32_t each) { return !std::binary_search(left.begin(), left.end(), each); };
    };
    std::erase_if(whole.bends, has_ended(of.bends));
    std::erase_if(whole.twists, has_ended(of.twists));
    whole.is_touched = whole.is_forced = whole.stays = false;
    whole.parts = 0;
  }
  for (const std::uint32_t particle : of.particles)
    if (fixed_[particle] != 0) whole_[particle] = none;
  const IslandElements elements(of.scene, islands);
  for (const std::uint32_t part : parts) {
    const std::uint32_t number = spare_whole();
    Whole& whole = wholes_[number];
    const auto list = [](Ids& to, std::span<const std::uint32_t> of_part, const Ids& numbers) {
      to.reserve(of_part.size());
      for (const std::uint32_t each : of_part) to.push_back(numbers[each]);
    };
    list(whole.particles, islands.vertices(part), of.particles);
    list(whole.rods, islands.edges(part), of.rods);
    list(whole.bends, elements.bends_of(part), of.bends);
    list(whole.tackles, elements.tackles_of(part), of.tackles);
    for (const std::uint32_t particle : whole.particles)
      if (fixed_[particle] == 0) whole_[particle] = number;
  }
}

/// Returns the number of a whole that is empty.
std::uint32_t Breaks::spare_whole() {
  if (spare_.empty()) {
    wholes_.emplace_back();
    return static_cast<std::uint32_t>(wholes_.size() - 1);
  }
  const std::uint32_t number = spare_.back();
  spare_.pop_back();
  return number;
}

Fallen Breaks::cut_out(const Cutout& from, const layouts::Islands& islands, const Ids& parts) const {
  Fallen out;
  out.touched = from.particles;
  for (Ids* const list : {&out.leaving, &out.particles}) list->reserve(from.particles.size());
  out.rods.reserve(from.rods.size());
  out.scene.particles.reserve(from.particles.size());
  out.scene.rods.reserve(from.rods.size());
  const auto leaves = [&](std::uint32_t whole) { return whole != none && wholes_[whole].leaves(); };
  for (const std::uint32_t particle : from.particles)
    if (leaves(whole_[particle])) out.leaving.push_back(particle);
  out.scene.drag = scene_now().drag;
  Ids place(from.particles.size(), none);
  std::vector<std::uint8_t> is_made(from.rods.size(), 0);
  const IslandElements elements(from.scene, islands);
  for (const std::uint32_t island : parts) {
    for (const std::uint32_t particle : islands.vertices(island)) {
      if (place[particle] != none) continue;
      place[particle] = static_cast<std::uint32_t>(out.particles.size());
      out.particles.push_back(from.particles[particle]);
      out.scene.particles.push_back(from.scene.particles[particle]);
    }
    for (const std::uint32_t rod : islands.edges(island)) {
      Rod& made = out.scene.rods.emplace_back(from.scene.rods[rod]);
      made.a = place[made.a];
      made.b = place[made.b];
      out.rods.push_back(from.rods[rod]);
      is_made[rod] = 1;
    }
    for (const std::uint32_t bend : elements.bends_of(island)) {
      Bend& made = out.scene.bends.emplace_back(from.scene.bends[bend]);
      for (std::uint32_t* const end : {&made.a, &made.b, &made.c}) *end = place[*end];
    }
    for (const std::uint32_t tackle : elements.tackles_of(island)) {
      Tackle& made = out.scene.tackles.emplace_back(from.scene.tackles[tackle]);
      for (std::uint32_t& particle : made.particles) particle = place[particle];
      out.tackles.push_back(from.tackles[tackle]);
    }
  }
  for (std::size_t rod = 0; rod < from.rods.size(); ++rod)
    if (is_made[rod] == 0 && leaves(whole_at(from.rods[rod]))) out.leaving_rods.push_back(from.rods[rod]);
  return out;
}

}  // namespace plumb::detail
