// This file adds islands to a compiled scene, and removes them, between two steps.

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "scene/refuse.hpp"
#include "step/breaks/ids.hpp"
#include "step/step.hpp"

namespace plumb::detail {
/// Returns what was added as a scene of its own, in this world's gravity and air.
Scene Step::scene_of(const Addition& of) const {
  Scene out = of.scene;
  out.gravity = gravity_;
  out.drag = drag();
  out.joint_drag = joint_drag();
  return out;
}

Compiled Step::compile_addition(const Scene& scene) const {
  return detail::compile_addition(scene, settings_of_now(), compiled_);
}

ByKind<std::uint32_t> Step::add(const Scene& scene) {
  breaks_.begin();
  const ByKind<std::uint32_t> sizes = sizes_of(scene);
  ByKind<std::uint32_t> first;
  for (std::size_t kind = 0; kind < first.kinds; ++kind)
    *first.all()[kind] = population_.all()[kind]->find(*sizes.all()[kind]);
  Split now;
  now.added.emplace_back(scene, first);
  Compiled made = compile_addition(scene_of(now.added.front()));
  measure_size(scene);
  for (std::size_t kind = 0; kind < first.kinds; ++kind)
    population_.all()[kind]->take(*first.all()[kind], *sizes.all()[kind]);
  grow_tables();
  put(now, std::move(made));
  list_arrivals(now.added.front());
  log_.push_addition(std::move(now));
  return first;
}

void Step::make_room(const ByKind<std::uint32_t>& more) {
  breaks_.begin();
  for (std::size_t kind = 0; kind < more.kinds; ++kind) population_.all()[kind]->reserve(*more.all()[kind]);
  grow_tables();
}

/// Takes as many particles and cords everywhere as there are numbers.
void Step::grow_tables() {
  const std::uint32_t particles = population_.particles.count(), rods = population_.rods.count();
  const std::size_t lines = first_scene().reels.size() + population_.tackles.count();
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
  const ByKind<std::uint32_t> sizes = sizes_of(of.scene);
  Names names;
  for (std::size_t kind = 0; kind < names.kinds; ++kind) {
    names.all()[kind]->resize(*sizes.all()[kind]);
    std::iota(names.all()[kind]->begin(), names.all()[kind]->end(), *of.first.all()[kind]);
  }
  tell_of(names);
  WorldInfo& info = compiled_.info;
  info.islands += made.info.islands;
  info.projected_velocity = std::max(info.projected_velocity, made.info.projected_velocity);
  info.projected_position = std::max(info.projected_position, made.info.projected_position);
  info.unprojected_islands += made.info.unprojected_islands;
  seat(std::move(made.solvers), now.seats, true);
  Fallen numbers;
  numbers.particles = names.particles;
  numbers.rods = names.rods;
  numbers.tackles = names.tackles;
  put_places(numbers, made, now.seats);
  if (made.needs_contact) put_in_contact(now, std::move(names));
}

/// Tells all that know particles, cords and bodies of those that are new.
void Step::tell_of(const Names& names) {
  const Scene& scene = breaks_.scene_now();
  for (const std::uint32_t i : names.particles) {
    const Particle& particle = scene.particles[i];
    anchors_.add(i, particle.fixed, particle.position);
    loads_.add(i, particle.fixed, particle.velocity);
  }
  for (const std::uint32_t i : names.rods) {
    const Rod& rod = scene.rods[i];
    lengths_.add(i, rod_length(scene, i));
    rods_.add(i, rod, anchors_.is_fixed(rod.a) ? rod.b : rod.a);
    if (settings_.tensions) reactions_.insert_rod(scene, mass_model_of(settings_), i, anchors_);
  }
  for (const std::uint32_t i : names.tackles) lengths_.add(tackle_cord(i), tackle_length(scene, i));
  if (settings_.tensions)
    for (const std::uint32_t i : names.bodies) reactions_.insert_body(scene, i, anchors_);
}

/// Lets the contact solver know islands with shapes, bodies, joints or air. Those of particles and rods are
/// at home.
void Step::put_in_contact(Split& now, Names names) {
  ContactSolver& contact = *compiled_.contact;
  const Array<std::uint32_t> particles = names.particles;
  NamedPart part{.scene = scene_of(now.added.front()), .names = std::move(names)};
  if (mass_model_of(settings_) == MassModel::lumped) lump_masses(part.scene);
  contact.numbers().give(now.islands);
  const Array<ContactSolver::Made> made = contact.add(part);
  put_parts(made);  // compiling has counted those without a home
  now.islands = contact.numbers().made();
  double& projected = compiled_.info.projected_velocity;
  for (const auto& [island, visits] : made)
    if (!contact.may_go_home(contact.first_slot(island)))
      projected = std::max(projected, contact.project_initial_velocities(island));
  find_heads(particles);
}

// --- Removing

Array<std::uint32_t> Step::remove(std::uint32_t particle) {
  breaks_.begin();
  if (anchors_.is_fixed(particle) && !compiled_.places.of(particle).empty())
    refuse("particle ", particle, ": is fixed, and something hangs from it, which goes first");
  if (anchors_.is_fixed(particle) && holds_ground(particle))
    refuse("particle ", particle, ": a shape is at it, and it stays");
  require_editable("particle", particle, particle);
  if (const auto twist = breaks_.twist_at(particle))
    refuse("particle ", particle, ": twist ", *twist, " is of its island, which stays");
  require_mass_without(list_island(particle));
  Split now;
  now.removed = {particle};
  Names gone = take_away(particle);
  for (std::size_t kind = 0; kind < gone.kinds; ++kind) population_.all()[kind]->give_back(*gone.all()[kind]);
  drop_edits(gone);
  log_.push_removal(std::move(now), gone.particles);
  return std::move(gone.particles);
}

/// Refuses to take away the mass of what is freed in the next step and stays, since others hang from it. What
/// is fixed may go, too, with the rods that lead on from it.
void Step::require_mass_without(const Names& going) const {
  Names all = going;
  for (const std::uint32_t particle : going.particles)
    if (anchors_.is_fixed(particle)) append(all.rods, breaks_.rods_at(particle));
  sort_once(all.rods);
  for (const auto& [particle, is_fixed] : edits_.fixed) {
    const auto rods = breaks_.rods_at(particle);
    const bool stays = std::any_of(rods.begin(), rods.end(), [&](std::uint32_t rod) {
      return !std::binary_search(going.rods.begin(), going.rods.end(), rod);
    });
    if (!is_fixed && stays) require_mass(particle, all);
  }
}

/// Takes an island out, with the fixed particles from which nothing hangs then. Returns what is gone.
Names Step::take_away(std::uint32_t particle) {
  Names out = list_island(particle);
  Array<std::uint32_t> leaving;
  for (const std::uint32_t each : out.particles)
    if (!anchors_.is_fixed(each)) leaving.push_back(each);
  for (const std::uint32_t number : take_grabs(leaving)) release(number);
  std::uint32_t islands = 0;
  const Array<std::uint32_t> solvers = remove_places(leaving, out.particles, islands);
  compiled_.places.find_runs(compiled_.solvers);
  compiled_.info.islands -= islands;
  std::erase_if(out.particles, [&](std::uint32_t each) {
    return anchors_.is_fixed(each) && (!compiled_.places.of(each).empty() || holds_ground(each));
  });
  for (const std::uint32_t each : out.particles)
    if (anchors_.is_fixed(each)) append(out.rods, breaks_.rods_at(each));
  sort_once(out.rods);
  free_seats(solvers);
  sleep_.exchange(compiled_.solvers, seats_);
  is_described_ = false;
  forget(out);
  return out;
}

/// Lists what an island has, with the fixed particles that it hangs from.
Names Step::list_island(std::uint32_t particle) const {
  const Place* const place = anchors_.is_fixed(particle) ? nullptr : contact_place(particle);
  if (!place) return breaks_.island_to_remove(particle, {});
  const std::uint32_t island = compiled_.contact->island_of(place->slot);
  Names out = breaks_.island_to_remove(particle, compiled_.contact->particles_of(island));
  const Names& names = compiled_.contact->names_of(island);  // of all but what is listed
  for (std::size_t kind = 0; kind < out.kinds; ++kind) {
    if (!names.all()[kind]->empty()) append(*out.all()[kind], *names.all()[kind]);
    sort_once(*out.all()[kind]);
  }
  return out;
}

/// Lets nobody know what is gone any more.
void Step::forget(const Names& gone) {
  const Scene& scene = breaks_.scene_now();
  if (compiled_.contact) compiled_.contact->end_contacts_of(gone);
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
  if (settings_.tensions && !gone.bodies.empty()) reactions_.remove_bodies_of(gone.particles);
  for (const std::uint32_t particle : gone.particles) {
    anchors_.remove(particle);
    loads_.remove(particle);
  }
  breaks_.remove(gone);
}

/// Takes back what was ordered of what is gone.
void Step::drop_edits(const Names& of) {
  const auto is_gone = [](const Array<std::uint32_t>& list, std::uint32_t number) {
    return std::binary_search(list.begin(), list.end(), number);
  };
  Names waiting;
  edits_.for_joined([&](std::size_t kind, std::uint32_t number, std::uint32_t particle) {
    if (is_gone(of.particles, particle)) waiting.all()[kind]->push_back(number);
  });
  take_back(std::move(waiting));
  std::erase_if(edits_.cut, [&](std::uint32_t rod) { return is_gone(of.rods, rod); });
  for (std::size_t kind = 0; kind < of.kinds; ++kind)
    std::erase_if(*edits_.severed.all()[kind],
                  [&](std::uint32_t number) { return is_gone(*of.all()[kind], number); });
  std::erase_if(edits_.side_by_side, [&](std::uint32_t each) { return is_gone(of.particles, each); });
  std::erase_if(edits_.masses, [&](const auto& each) { return is_gone(of.particles, each.first); });
  std::erase_if(edits_.fixed, [&](const auto& each) { return is_gone(of.particles, each.first); });
}

}  // namespace plumb::detail
