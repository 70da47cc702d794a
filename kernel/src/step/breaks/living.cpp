// This file lets Breaks know islands that are added and removed.

#include <algorithm>

#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/scene_graph.hpp"
#include "step/breaks/breaks.hpp"
#include "step/breaks/ids.hpp"

namespace plumb::detail {
namespace {

template <class T>
void resize_to(std::vector<T>& list, std::uint32_t count, const T& with) {
  if (count > list.size()) list.resize(count, with);
}

/// Copies what islands are made of.
Scene parts_of(const Scene& scene) {
  return {.particles = scene.particles,
          .rods = scene.rods,
          .drag = scene.drag,
          .bends = scene.bends,
          .twists = scene.twists,
          .tackles = scene.tackles,
          .reels = scene.reels,
          .capsules = scene.capsules};
}

}  // namespace

void Breaks::grow(const Population& to) {
  if (!grown_) grown_ = parts_of(first_);
  resize_to(grown_->particles, to.particles.count(), {.fixed = true});
  resize_to(grown_->rods, to.rods.count(), {});
  resize_to(grown_->bends, to.bends.count(), {});
  resize_to(grown_->tackles, to.tackles.count(), {});
  resize_to(grown_->capsules, to.capsules.count(), {});
  resize_to<std::uint8_t>(fixed_, to.particles.count(), 1);
  for (Ids* const of : {&place_, &whole_}) resize_to(*of, to.particles.count(), none);
  resize_to(out_, to.rods.count(), State::in);
  rods_at_.grow(to.particles.count());
}

void Breaks::add(const Addition& what) {
  const auto& [particle0, rod0, bend0, tackle0, capsule0] = what.first;
  const Scene scene = what.scene({}, 0);
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    grown_->particles[particle0 + i] = scene.particles[i];
    fixed_[particle0 + i] = scene.particles[i].fixed ? 1 : 0;
  }
  std::vector<Rows<std::uint32_t>::Entry> entries;
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    Rod& rod = grown_->rods[rod0 + i] = scene.rods[i];
    for (const std::uint32_t end : {rod.a, rod.b}) entries.push_back({end, rod0 + i});
    rod.a += particle0;
    rod.b += particle0;
    if (rod.law.strength < RodLaw{}.strength)
      weak_.insert(std::lower_bound(weak_.begin(), weak_.end(), rod0 + i), rod0 + i);
  }
  const Rows<std::uint32_t> rods_at(static_cast<std::uint32_t>(scene.particles.size()), entries);
  for (std::uint32_t i = 0; i < rods_at.count(); ++i) rods_at_.replace(particle0 + i, rods_at.of(i));
  for (std::uint32_t i = 0; i < scene.bends.size(); ++i) {
    Bend& bend = grown_->bends[bend0 + i] = scene.bends[i];
    for (std::uint32_t* const end : {&bend.a, &bend.b, &bend.c}) *end += particle0;
  }
  for (std::uint32_t i = 0; i < scene.tackles.size(); ++i) {
    grown_->tackles[tackle0 + i] = scene.tackles[i];
    for (std::uint32_t& particle : grown_->tackles[tackle0 + i].particles) particle += particle0;
  }
  for (std::uint32_t i = 0; i < scene.capsules.size(); ++i) {
    Capsule& capsule = grown_->capsules[capsule0 + i] = scene.capsules[i];
    for (Point* const end : {&capsule.a, &capsule.b})
      for (std::uint32_t& particle : end->particles) particle += particle0;
  }

  const layouts::Islands islands = find_bent_islands(scene, SceneGraph(scene).view());
  const IslandElements elements(scene, islands);
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    const std::uint32_t number = spare_whole();
    Whole& whole = wholes_[number];
    const auto list = [](Ids& to, std::span<const std::uint32_t> of, std::uint32_t first) {
      for (const std::uint32_t each : of) to.push_back(first + each);
    };
    list(whole.particles, islands.vertices(i), particle0);
    list(whole.rods, islands.edges(i), rod0);
    list(whole.bends, elements.bends_of(i), bend0);
    list(whole.tackles, elements.tackles_of(i), tackle0);
    for (const std::uint32_t particle : whole.particles)
      if (fixed_[particle] == 0) whole_[particle] = number;
  }
}

Removed Breaks::island_to_remove(std::uint32_t particle) const {
  Removed out;
  if (whole_[particle] == none) {
    out.particles = {particle};
    const std::span<const std::uint32_t> rods = rods_at(particle);
    out.rods.assign(rods.begin(), rods.end());
    return out;
  }
  const Whole& whole = wholes_[whole_[particle]];
  out.particles = whole.particles;
  sort_once(out.particles);
  const auto has = [&](std::uint32_t each) { return whole_[each] == whole_[particle]; };
  for (const std::uint32_t each : out.particles)
    if (has(each)) out.rods.insert(out.rods.end(), rods_at(each).begin(), rods_at(each).end());
  sort_once(out.rods);
  out.bends = whole.bends;
  for (const std::uint32_t bend : ended_) {
    const auto of = particles_of(scene_now().bends[bend]);
    if (std::any_of(of.begin(), of.end(), has)) out.bends.push_back(bend);
  }
  sort_once(out.bends);
  out.tackles = whole.tackles;
  sort_once(out.tackles);
  return out;
}

void Breaks::remove(const Removed& what) {
  const auto is_listed = [](const Ids& list) {
    return [&](std::uint32_t each) { return std::binary_search(list.begin(), list.end(), each); };
  };
  for (const std::uint32_t particle : what.particles)
    if (const std::uint32_t number = whole_[particle]; number != none) {
      whole_[particle] = none;
      if (wholes_[number].particles.empty()) continue;
      wholes_[number] = {};
      spare_.push_back(number);
    }
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
  if (!weak_.empty()) std::erase_if(weak_, is_listed(what.rods));
  if (!ended_.empty()) std::erase_if(ended_, is_listed(what.bends));
}

}  // namespace plumb::detail
