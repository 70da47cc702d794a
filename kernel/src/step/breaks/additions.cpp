// This file adds islands to a compiled scene, and removes them, between two steps.

#include <algorithm>
#include <numeric>
#include <utility>

#include "scene/refuse.hpp"
#include "step/breaks/ids.hpp"
#include "step/step.hpp"

namespace plumb::detail {

Scene Step::scene_of(const Addition& of) const {
  return of.scene(gravity_, origin_->scene.drag);
}

Compiled Step::compile_addition(const Scene& scene) const {
  return detail::compile_addition(scene, settings_of_now(), compiled_);
}

Added Step::add(const Scene& scene) {
  breaks_.begin();
  const auto size = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  auto& [particles, rods, bends, tackles, capsules] = population_;
  const Added first{particles.find(size(scene.particles)), rods.find(size(scene.rods)),
                    bends.find(size(scene.bends)), tackles.find(size(scene.tackles)),
                    capsules.find(size(scene.capsules))};
  Split now;
  now.added.emplace_back(scene, first);
  Compiled made = compile_addition(scene_of(now.added.front()));
  measure_size(scene);
  particles.take(first.particle, size(scene.particles));
  rods.take(first.rod, size(scene.rods));
  bends.take(first.bend, size(scene.bends));
  tackles.take(first.tackle, size(scene.tackles));
  capsules.take(first.capsule, size(scene.capsules));
  grow_tables();
  put(now, std::move(made));
  log_.push(std::move(now));
  return first;
}

/// Takes as many particles and cords everywhere as there are numbers.
void Step::grow_tables() {
  const std::uint32_t particles = population_.particles.count(), rods = population_.rods.count();
  const std::size_t lines = origin_->scene.reels.size() + population_.tackles.count();
  compiled_.places.grow(particles);
  compiled_.cords.rods.grow(rods);
  compiled_.cords.lines.grow(static_cast<std::uint32_t>(lines));
  anchors_.grow(particles);
  lengths_.grow(rods, lines);
  loads_.grow(particles);
  rods_.grow(rods);
  if (!reeled_.empty()) reeled_.resize(rods, 0);
  if (!twisted_.empty()) twisted_.resize(rods, 0);
  breaks_.grow(population_);
  compiled_.places.find_runs(compiled_.solvers);
  compiled_.info.particles = particles;
  compiled_.info.rods = rods;
}

/// Lets new solvers move what is added, and all know its numbers.
void Step::put(Split& now, Compiled made) {
  const Addition& of = now.added.front();
  breaks_.add(of);
  Fallen numbers;
  const auto list = [](std::vector<std::uint32_t>& to, std::uint32_t first, std::size_t count) {
    to.resize(count);
    std::iota(to.begin(), to.end(), first);
  };
  list(numbers.particles, of.first.particle, of.particles.size());
  list(numbers.rods, of.first.rod, of.rods.size());
  list(numbers.tackles, of.first.tackle, of.tackles.size());
  const Scene& scene = breaks_.scene_now();
  for (const std::uint32_t i : numbers.particles) {
    const Particle& particle = scene.particles[i];
    anchors_.add(i, particle.fixed, particle.position);
    loads_.add(i, particle.fixed, particle.velocity);
  }
  for (const std::uint32_t i : numbers.rods) {
    const Rod& rod = scene.rods[i];
    lengths_.add(i, rod_length(scene, i));
    rods_.add(i, rod, anchors_.is_fixed(rod.a) ? rod.b : rod.a);
    if (settings_.tensions) reactions_.insert_rod(scene, mass_model_of(settings_), i, anchors_);
  }
  for (const std::uint32_t i : numbers.tackles) lengths_.add(tackle_cord(i), tackle_length(scene, i));
  WorldInfo& info = compiled_.info;
  info.islands += made.info.islands;
  info.projected_velocity = std::max(info.projected_velocity, made.info.projected_velocity);
  info.projected_position = std::max(info.projected_position, made.info.projected_position);
  info.unprojected_islands += made.info.unprojected_islands;
  seat(std::move(made.solvers), now.seats);
  put_places(numbers, made, now.seats);
  if (!of.capsules.empty()) put_shapes(now, numbers);
}

/// Lets the contact solver know islands with capsules, which are at home.
void Step::put_shapes(Split& now, const Fallen& numbers) {
  const Addition& of = now.added.front();
  ContactSolver& contact = *compiled_.contact;
  NamedPart part{.scene = scene_of(of), .particles = numbers.particles, .rods = numbers.rods};
  for (std::uint32_t i = 0; i < of.capsules.size(); ++i)
    part.capsules.push_back(contact.number_of({ShapeKind::capsule, of.first.capsule + i}));
  if (mass_model_of(settings_) == MassModel::lumped) lump_masses(part.scene);
  contact.numbers().give(now.islands);
  put_parts(contact.add(std::move(part)));
  now.islands = contact.numbers().made();
}

// --- Removing

std::vector<std::uint32_t> Step::remove(std::uint32_t particle) {
  breaks_.begin();
  if (anchors_.is_fixed(particle) && !compiled_.places.of(particle).empty())
    refuse("particle ", particle, ": is fixed, and something hangs from it, which goes first");
  if (anchors_.is_fixed(particle) && holds_ground(particle))
    refuse("particle ", particle, ": a shape is at it, and it stays");
  require_editable("particle", particle, particle);
  require_no_joints("particle", particle, particle);
  if (const auto twist = breaks_.twist_at(particle))
    refuse("particle ", particle, ": twist ", *twist, " is of its island, which stays");
  Split now;
  now.removed = {particle};
  Removed gone = take_away(particle);
  population_.particles.give_back(gone.particles);
  population_.rods.give_back(gone.rods);
  population_.bends.give_back(gone.bends);
  population_.tackles.give_back(gone.tackles);
  population_.capsules.give_back(gone.capsules);
  drop_edits(gone);
  log_.push_removal(std::move(now), gone.particles);
  return std::move(gone.particles);
}

/// Takes an island out, with the fixed particles from which nothing hangs then. Returns what is gone.
Removed Step::take_away(std::uint32_t particle) {
  Removed out = breaks_.island_to_remove(particle);
  std::vector<std::uint32_t> leaving;
  for (const std::uint32_t each : out.particles)
    if (!anchors_.is_fixed(each)) leaving.push_back(each);
  for (const std::uint32_t number : take_grabs(leaving)) release(number);
  if (const Place* const place = leaving.empty() ? nullptr : contact_place(leaving.front())) {
    ContactSolver& contact = *compiled_.contact;
    out.capsules = contact.capsules_of(contact.island_of(place->slot));
    contact.end_plain(contact.island_of(place->slot), out.rods);
  }
  std::uint32_t islands = 0;
  const std::vector<std::uint32_t> solvers = remove_places(leaving, out.particles, islands);
  compiled_.places.find_runs(compiled_.solvers);
  compiled_.info.islands -= islands;
  std::erase_if(out.particles, [&](std::uint32_t each) {
    return anchors_.is_fixed(each) && (!compiled_.places.of(each).empty() || holds_ground(each));
  });
  for (const std::uint32_t each : out.particles)
    if (anchors_.is_fixed(each))
      for (const std::uint32_t rod : breaks_.rods_at(each)) out.rods.push_back(rod);
  sort_once(out.rods);
  free_seats(solvers);
  sleep_.exchange(compiled_.solvers, seats_);
  is_described_ = false;
  forget(out);
  return out;
}

/// Lets nobody know what is gone any more.
void Step::forget(const Removed& gone) {
  const Scene& scene = breaks_.scene_now();
  for (const std::uint32_t rod : gone.rods) {
    if (settings_.tensions)
      for (const std::uint32_t end : {scene.rods[rod].a, scene.rods[rod].b})
        reactions_.remove(end, gone.rods);
    compiled_.cords.replace(rod, {});
    lengths_.remove(rod);
    rods_.remove(rod);
  }
  for (const std::uint32_t tackle : gone.tackles) {
    compiled_.cords.replace(tackle_cord(tackle), {});
    lengths_.remove(tackle_cord(tackle));
  }
  for (const std::uint32_t particle : gone.particles) {
    anchors_.remove(particle);
    loads_.remove(particle);
  }
  breaks_.remove(gone);
}

/// Takes back what was ordered of what is gone.
void Step::drop_edits(const Removed& of) {
  const auto is_gone = [](const std::vector<std::uint32_t>& list, std::uint32_t number) {
    return std::binary_search(list.begin(), list.end(), number);
  };
  std::vector<std::uint32_t> waiting;
  for (const auto& [number, rod] : edits_.joined)
    if (is_gone(of.particles, rod.a) || is_gone(of.particles, rod.b)) waiting.push_back(number);
  take_back(waiting);
  std::erase_if(edits_.cut, [&](std::uint32_t rod) { return is_gone(of.rods, rod); });
  std::erase_if(edits_.masses, [&](const auto& each) { return is_gone(of.particles, each.first); });
  std::erase_if(edits_.fixed, [&](const auto& each) { return is_gone(of.particles, each.first); });
}

}  // namespace plumb::detail
