// This file lets Breaks know islands that are added and removed.

#include <algorithm>
#include <utility>
#include <vector>

#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/scene_graph.hpp"
#include "step/breaks/breaks.hpp"
#include "step/breaks/ids.hpp"

namespace plumb::detail {
namespace {

template <class List>
void resize_to(List& list, std::uint32_t count, const typename List::value_type& with) {
  if (count > list.size()) list.resize(count, with);
}

auto is_listed_in(const Ids& list) {
  return [&](std::uint32_t each) { return std::binary_search(list.begin(), list.end(), each); };
}

/// Copies what islands are made of.
Scene parts_of(const Scene& scene) {
  Scene out;
  out.drag = scene.drag;
  out.twists = scene.twists;
  out.reels = scene.reels;
  for_lists([](std::size_t, auto& to, const auto& from) { to = from; }, out, scene);
  return out;
}

}  // namespace

void Breaks::grow(const Population& to) {
  if (!grown_) grown_ = parts_of(first_);
  resize_to(grown_->particles, to.particles.count(), {.fixed = true});
  for_lists([&](std::size_t kind, auto& list) { resize_to(list, to.all()[kind]->count(), {}); }, *grown_);
  resize_to(fixed_, to.particles.count(), 1);
  for (Ids* const of : {&place_, &whole_}) resize_to(*of, to.particles.count(), none);
  resize_to(out_, to.rods.count(), State::in);
  rods_at_.grow(to.particles.count());
}

void Breaks::add_capsule(std::uint32_t number, const Capsule& capsule) {
  if (!grown_) grown_ = parts_of(first_);
  resize_to(grown_->capsules, number + 1, {});
  grown_->capsules[number] = capsule;
}

void Breaks::add(const Addition& what) {
  const Scene& scene = what.scene;
  const ByKind<std::uint32_t>& first = what.first;
  for_lists(
      [&](std::size_t kind, auto& to, const auto& from) {
        for (std::size_t i = 0; i < from.size(); ++i) {
          auto& item = to[*first.all()[kind] + i] = from[i];
          for_particles(item, [&](std::uint32_t& particle) { particle += first.particles; });
        }
      },
      *grown_, scene);
  for (std::size_t i = 0; i < scene.hulls.size(); ++i) grown_->hulls[first.hulls + i].body += first.bodies;
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
    fixed_[first.particles + i] = scene.particles[i].fixed ? 1 : 0;
  Array<Rows<std::uint32_t>::Entry> entries;
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    const std::uint32_t number = first.rods + i;
    for (const std::uint32_t end : {scene.rods[i].a, scene.rods[i].b}) entries.push_back({end, number});
    if (scene.rods[i].law.strength < RodLaw{}.strength)
      weak_.insert(std::lower_bound(weak_.begin(), weak_.end(), number), number);
  }
  const Rows<std::uint32_t> rods_at(static_cast<std::uint32_t>(scene.particles.size()), entries);
  for (std::uint32_t i = 0; i < rods_at.count(); ++i) rods_at_.replace(first.particles + i, rods_at.of(i));

  const layouts::Islands islands = find_bent_islands(scene, SceneGraph(scene).view());
  const IslandElements elements(scene, islands);
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    const std::uint32_t number = spare_whole();
    Whole& whole = wholes_[number];
    const auto list = [](Ids& to, std::span<const std::uint32_t> of, std::uint32_t from) {
      for (const std::uint32_t each : of) to.push_back(from + each);
    };
    list(whole.particles, islands.vertices(i), first.particles);
    list(whole.rods, islands.edges(i), first.rods);
    list(whole.bends, elements.bends_of(i), first.bends);
    list(whole.tackles, elements.tackles_of(i), first.tackles);
    for (const std::uint32_t particle : whole.particles)
      if (fixed_[particle] == 0) whole_[particle] = number;
  }
}

Names Breaks::island_to_remove(std::uint32_t particle, std::span<const std::uint32_t> jointed) const {
  Names out;
  if (whole_[particle] == none) {
    out.particles = {particle};
    const std::span<const std::uint32_t> rods = rods_at(particle);
    out.rods.assign(rods.begin(), rods.end());
    return out;
  }
  const std::span<const std::uint32_t> particles =
      jointed.empty() ? std::span<const std::uint32_t>(wholes_[whole_[particle]].particles) : jointed;
  out.particles.assign(particles.begin(), particles.end());
  sort_once(out.particles);
  const auto has = [&](std::uint32_t each) {
    return fixed_[each] == 0 && std::binary_search(out.particles.begin(), out.particles.end(), each);
  };
  const auto has_any_of = [&](const auto& of) { return std::any_of(of.begin(), of.end(), has); };
  Ids wholes;
  for (const std::uint32_t each : out.particles) {
    if (fixed_[each] != 0) continue;
    append(out.rods, rods_at(each));
    if (wholes.empty() || wholes.back() != whole_[each]) wholes.push_back(whole_[each]);
  }
  sort_once(wholes);
  const std::vector<Bend>& bends = scene_now().bends;
  for (const std::uint32_t whole : wholes) {
    for (const std::uint32_t bend : wholes_[whole].bends)
      if (has_any_of(particles_of(bends[bend]))) out.bends.push_back(bend);
    append(out.tackles, wholes_[whole].tackles);
  }
  for (const std::uint32_t bend : ended_)
    if (has_any_of(particles_of(bends[bend]))) out.bends.push_back(bend);
  for (Ids* const list : {&out.rods, &out.bends, &out.tackles}) sort_once(*list);
  return out;
}

/// Lets wholes lose what is removed. Nothing is left of most; those that joints or shapes hold may have come
/// apart.
void Breaks::remove_from_wholes(const Names& what) {
  Ids wholes;
  for (const std::uint32_t particle : what.particles)
    if (const std::uint32_t number = std::exchange(whole_[particle], none); number != none)
      if (wholes.empty() || wholes.back() != number) wholes.push_back(number);
  sort_once(wholes);
  for (const std::uint32_t number : wholes) {
    Whole& whole = wholes_[number];
    const auto stays = [&](std::uint32_t particle) { return whole_[particle] == number; };
    if (std::none_of(whole.particles.begin(), whole.particles.end(), stays)) {
      whole = {};
      spare_.push_back(number);
      continue;
    }
    std::erase_if(whole.particles, is_listed_in(what.particles));
    std::erase_if(whole.rods, is_listed_in(what.rods));
    std::erase_if(whole.bends, is_listed_in(what.bends));
  }
}

void Breaks::remove(const Names& what) {
  remove_from_wholes(what);
  for (const std::uint32_t rod : what.rods) {
    for (const std::uint32_t end : {scene_now().rods[rod].a, scene_now().rods[rod].b}) {
      Ids left;
      for (const std::uint32_t each : rods_at(end))
        if (each != rod) left.push_back(each);
      rods_at_.replace(end, left);
    }
    out_[rod] = State::in;
  }
  for (const std::uint32_t particle : what.particles) {
    fixed_[particle] = 1;
    masses_.erase(particle);
  }
  if (!weak_.empty()) std::erase_if(weak_, is_listed_in(what.rods));
  if (!ended_.empty()) std::erase_if(ended_, is_listed_in(what.bends));
}

}  // namespace plumb::detail
