// This file cuts out the islands that fell apart, came together or are made anew by order.

#include <algorithm>
#include <array>
#include <iterator>

#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/bends/rod_table.hpp"
#include "scene/scene_graph.hpp"
#include "step/breaks/breaks.hpp"
#include "step/breaks/ids.hpp"

namespace plumb::detail {

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

/// Returns whether others move an island of a cutout: some of it is theirs, or they know it, and it is to
/// have more than particles and rigid rods. `bends` says whether it has some.
bool Breaks::is_held(const Cutout& of, const layouts::Islands& islands, std::uint32_t part,
                     bool bends) const {
  bool is_to_be_plain = false;
  for (const std::uint32_t k : islands.vertices(part)) {
    const std::uint32_t particle = of.particles[k], whole = whole_[particle];
    if (fixed_[particle] != 0) continue;
    if (whole == none ? std::count(held_freed_.begin(), held_freed_.end(), particle) > 0
                      : wholes_[whole].is_held || wholes_[whole].is_to_be_held)
      return true;
    is_to_be_plain = is_to_be_plain || (whole != none && wholes_[whole].is_to_be_plain);
  }
  const auto rods = islands.edges(part);
  return is_to_be_plain && (bends || !std::all_of(rods.begin(), rods.end(), [&](std::uint32_t rod) {
                              return is_plain_rod(of.scene.rods[rod]);
                            }));
}

/// Returns whether an island of a cutout has something that others, who are to move it, did not: a rod that
/// joins, a particle that is freed, or what a solver of particles and rods has moved.
bool Breaks::is_new(const Cutout& of, const layouts::Islands& islands, std::uint32_t part) const {
  const auto rods = islands.edges(part), particles = islands.vertices(part);
  return std::any_of(particles.begin(), particles.end(),
                     [&](std::uint32_t each) {
                       const std::uint32_t particle = of.particles[each], whole = whole_[particle];
                       return fixed_[particle] == 0 && (whole == none || !wholes_[whole].is_held);
                     }) ||
         (!joined_.empty() && std::any_of(rods.begin(), rods.end(), [&](std::uint32_t each) {
           return std::count(joined_.begin(), joined_.end(), of.rods[each]) > 0;
         }));
}

/// Returns the islands of a cutout that are parts of a larger one, which nothing holds together, or that are
/// made anew by order.
Breaks::Parts Breaks::leaving_parts(const Cutout& of, const layouts::Islands& islands) {
  const IslandElements elements(of.scene, islands);
  const auto whole = [&](std::uint32_t part) { return whole_[of.particles[islands.vertices(part).front()]]; };
  for (std::uint32_t part = 0; part < islands.count(); ++part) {
    if (whole(part) == none) continue;  // it was freed
    Whole& of_part = wholes_[whole(part)];
    ++of_part.parts;
    of_part.stays = of_part.stays || !elements.twists_of(part).empty() || !elements.reels_of(part).empty();
  }
  Parts out;
  for (std::uint32_t part = 0; part < islands.count(); ++part)
    if (whole(part) == none || wholes_[whole(part)].leaves())
      (is_held(of, islands, part, !elements.bends_of(part).empty()) ? out.held : out.homes).push_back(part);
  return out;
}

/// Gives islands that leave numbers of their own. What stays loses the elements that ended.
void Breaks::renumber(const Cutout& of, const layouts::Islands& islands, const Parts& parts) {
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
    whole.is_to_be_plain = whole.is_to_be_held = false;
    whole.parts = 0;
  }
  for (const std::uint32_t particle : of.particles)
    if (fixed_[particle] != 0) whole_[particle] = none;
  const IslandElements elements(of.scene, islands);
  const auto begin = [&](std::uint32_t part, bool is_held) {
    const std::uint32_t number = spare_whole();
    Whole& whole = wholes_[number];
    whole.is_held = is_held;
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
  };
  for (const std::uint32_t part : parts.homes) begin(part, false);
  for (const std::uint32_t part : parts.held) begin(part, true);
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

/// Copies islands of a cutout to a scene, one after the other, and appends their numbers. Fixed particles
/// come once.
class Breaks::Copy {
 public:
  Copy(const Cutout& from, const layouts::Islands& islands, const IslandElements& elements, Scene& to)
      : from_(from), islands_(islands), elements_(elements), to_(to) {
    place_.assign(from.particles.size(), none);
    to.drag = from.scene.drag;
  }

  void copy(std::uint32_t island, Ids& particles, Ids& rods, Ids& bends, Ids& tackles) {
    for (const std::uint32_t particle : islands_.vertices(island)) {
      if (place_[particle] != none) continue;
      place_[particle] = static_cast<std::uint32_t>(to_.particles.size());
      particles.push_back(from_.particles[particle]);
      to_.particles.push_back(from_.scene.particles[particle]);
    }
    const auto copy_all = [&](std::span<const std::uint32_t> own, const auto& list, auto& to,
                              const Ids& numbers, Ids& names) {
      for (const std::uint32_t each : own) {
        auto& made = to.emplace_back(list[each]);
        for_particles(made, [&](std::uint32_t& particle) { particle = place_[particle]; });
        names.push_back(numbers[each]);
      }
    };
    copy_all(islands_.edges(island), from_.scene.rods, to_.rods, from_.rods, rods);
    copy_all(elements_.bends_of(island), from_.scene.bends, to_.bends, from_.bends, bends);
    copy_all(elements_.tackles_of(island), from_.scene.tackles, to_.tackles, from_.tackles, tackles);
  }

 private:
  const Cutout& from_;
  const layouts::Islands& islands_;
  const IslandElements& elements_;
  Scene& to_;
  Ids place_;
};

Fallen Breaks::cut_out(const Cutout& from, const layouts::Islands& islands, const Parts& parts) const {
  Fallen out;
  out.touched = from.particles;
  for (Ids* const list : {&out.leaving, &out.particles}) list->reserve(from.particles.size());
  out.rods.reserve(from.rods.size());
  out.scene.particles.reserve(from.particles.size());
  out.scene.rods.reserve(from.rods.size());
  const auto leaves = [&](std::uint32_t whole) {
    return whole != none && wholes_[whole].leaves() && !wholes_[whole].is_held;
  };
  for (const std::uint32_t particle : from.particles)
    if (leaves(whole_[particle])) out.leaving.push_back(particle);
  Ids bends;
  const IslandElements elements(from.scene, islands);
  Copy homes(from, islands, elements, out.scene), held(from, islands, elements, out.held.scene);
  for (const std::uint32_t part : parts.homes) homes.copy(part, out.particles, out.rods, bends, out.tackles);
  Names& names = out.held.names;
  for (const std::uint32_t part : parts.held)
    if (is_new(from, islands, part)) held.copy(part, names.particles, names.rods, names.bends, names.tackles);
  Ids made = out.rods;
  sort_once(made);
  for (const std::uint32_t rod : from.rods)
    if (leaves(whole_at(rod)) && !std::binary_search(made.begin(), made.end(), rod))
      out.leaving_rods.push_back(rod);
  return out;
}

}  // namespace plumb::detail
