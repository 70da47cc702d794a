// This file makes islands anew that the contact solver knows: those with joints or springs, and those with
// shapes.

#include <algorithm>
#include <iterator>
#include <utility>

#include "contact/linkage/scene_parts.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/bends/bends.hpp"
#include "step/breaks/ids.hpp"
#include "step/methods.hpp"
#include "step/step.hpp"

namespace plumb::detail {
/// Returns where the contact solver has a particle, or null.
const Place* Step::contact_place(std::uint32_t particle) const {
  const auto places = compiled_.places.of(particle);
  return !places.empty() && &solver(places.back()) == compiled_.contact ? &places.back() : nullptr;
}

/// An island that a broken rod has left whole, or leaves so now, still hangs from the rod's fixed end. It
/// does not any more where that is freed. A bend brings its particles together with one that is freed.
void Step::take_along(const Split& now) {
  const auto hangs_from = [&](std::uint32_t particle, std::uint32_t anchor) {
    const Place& home = compiled_.places.of(particle).front();
    const auto places = compiled_.places.of(anchor);
    return std::any_of(places.begin(), places.end(), [&](const Place& place) {
      return place.solver == home.solver &&
             solver(place).island_of(place.slot) == solver(home).island_of(home.slot);
    });
  };
  const auto is_out = [&](std::uint32_t rod) {
    return !breaks_.joins_ends(rod) || std::count(now.rods.begin(), now.rods.end(), rod) > 0;
  };
  for (const auto& [anchor, is_fixed] : now.edits.fixed) {
    if (is_fixed || !anchors_.is_fixed(anchor)) continue;
    for (const std::uint32_t rod : breaks_.rods_at(anchor)) {
      const Rod& of = breaks_.scene_now().rods[rod];
      const std::uint32_t other = of.a == anchor ? of.b : of.a;
      if (is_out(rod) && !anchors_.is_fixed(other) && hangs_from(other, anchor)) breaks_.take_along(other);
    }
    for (const std::uint32_t other : bent_with(anchor))
      if (!anchors_.is_fixed(other)) breaks_.take_along(other);
    // What a capsule alone holds at it comes together with it in the contact solver, and gets a new home.
    for (const Place& place : compiled_.places.of(anchor))
      if (&solver(place) == compiled_.contact && compiled_.contact->may_go_home(place.slot))
        breaks_.take_along(compiled_.contact->particles_of(compiled_.contact->island_of(place.slot)).front());
  }
}

/// Returns the particles of a particle's bends.
Ids Step::bent_with(std::uint32_t particle) const {
  Ids out;
  for (const std::uint32_t bend : breaks_.bends_at(particle))
    append(out, particles_of(breaks_.scene_now().bends[bend]));
  return out;
}

/// Lists what is done to the contact solver's islands. Appends particles of theirs: those of islands that are
/// made anew.
PartEdits Step::list_part_edits(const Edits& edits, Ids& touched) const {
  PartEdits out;
  for (const std::uint32_t rod : edits.cut) {
    touched.push_back(rods_.end(rod));
    out.cut.push_back(rod);
  }
  out.severed = edits.severed;
  for (std::size_t kind = 0; compiled_.contact && kind < out.severed.kinds; ++kind)
    for (const std::uint32_t number : *out.severed.all()[kind])
      if (const auto mover = compiled_.contact->mover_of(kind, number)) touched.push_back(*mover);
  for (const auto& [particle, mass] : edits.masses) {
    touched.push_back(particle);
    out.heavier.emplace_back(particle, mass - breaks_.own_mass(particle));
  }
  for (const auto& [particle, is_fixed] : edits.fixed)
    if (is_fixed) {
      touched.push_back(particle);
      out.fixed.push_back(particle);
    } else {
      out.freed.push_back(particle);
    }
  return out;
}

/// Returns the movable particles of what is joined, and what hangs from particles that are freed: all islands
/// that come together have some.
Ids Step::meeting(const Edits& edits) const {
  Ids out;
  edits.for_joined([&](std::size_t, std::uint32_t, std::uint32_t each) { out.push_back(each); });
  for (const auto& [particle, is_fixed] : edits.fixed) {
    if (is_fixed) continue;
    for (const std::uint32_t rod : breaks_.rods_at(particle))
      if (breaks_.joins_ends(rod)) out.push_back(breaks_.other_end(rod, particle));
    append(out, bent_with(particle));
    for (const Place& place : compiled_.places.of(particle))
      if (&solver(place) == compiled_.contact)
        out.push_back(compiled_.contact->particles_of(compiled_.contact->island_of(place.slot)).front());
  }
  std::erase_if(out, [&](std::uint32_t each) { return anchors_.is_fixed(each); });
  return out;
}

/// Returns whether an island without a home hangs from a fixed particle.
bool Step::holds_linkage(std::uint32_t particle) const {
  const auto places = compiled_.places.of(particle);
  return anchors_.is_fixed(particle) && std::any_of(places.begin(), places.end(), [&](const Place& place) {
           return &solver(place) == compiled_.contact && !compiled_.contact->may_go_home(place.slot);
         });
}

/// Takes out what broke and what was cut, and does other edits, with the contact solver's islands.
Fallen Step::take_out(const Split& now) {
  Ids parts, linkages, met, touched;
  PartEdits edits = list_part_edits(now.edits, touched);
  const auto touch = [&](std::uint32_t particle, Ids& to) {
    const Place* const place = anchors_.is_fixed(particle) ? nullptr : contact_place(particle);
    if (!place) return;
    const std::uint32_t part = compiled_.contact->island_of(place->slot);
    to.push_back(part);
    if (compiled_.contact->may_go_home(place->slot)) return;
    linkages.push_back(part);
    breaks_.hold(particle);
  };
  for (const auto& [particle, is_fixed] : now.edits.fixed)
    if (!is_fixed && holds_linkage(particle)) breaks_.hold(particle);
  for (const std::uint32_t particle : now.edits.side_by_side) {
    touch(particle, parts);
    breaks_.take_along(particle);
  }
  for (const std::uint32_t particle : touched) touch(particle, parts);
  Ids meet = meeting(now.edits);
  for (const std::uint32_t rod : now.edits.cut)
    if (joins_by_mass(rod)) meet.push_back(rods_.end(rod));
  now.edits.for_joined([&](std::size_t kind, std::uint32_t, std::uint32_t particle) {
    if (kind != kind_of<Rod>()) breaks_.hand_over(particle);
  });
  for (const std::uint32_t particle : meet) {
    touch(particle, met);
    if (contact_place(particle)) breaks_.hold_unless_plain(particle);
  }
  parts.insert(parts.end(), met.begin(), met.end());
  sort_once(met);
  sort_once(parts);
  sort_once(linkages);
  take_along(now);
  Fallen out = breaks_.take_out(now.rods, now.edits);
  out.joints = now.edits.joints();
  if (parts.empty() && !out.meets()) return out;
  for (const std::uint32_t part : parts) {
    const auto particles = compiled_.contact->particles_of(part);
    out.touched.insert(out.touched.end(), particles.begin(), particles.end());
    if (!std::binary_search(linkages.begin(), linkages.end(), part)) continue;
    const auto movable = particles.first(compiled_.contact->movable_of(part));
    out.of_linkages.insert(out.of_linkages.end(), movable.begin(), movable.end());
  }
  sort_once(out.touched);
  sort_once(out.of_linkages);
  out.leaving.insert(out.leaving.end(), out.of_linkages.begin(), out.of_linkages.end());
  for (std::size_t k = 0; k < out.held.names.particles.size(); ++k)
    if (!out.held.scene.particles[k].fixed) out.of_linkages.push_back(out.held.names.particles[k]);
  sort_once(out.of_linkages);
  out.parts = std::move(parts);
  out.part_edits = std::move(edits);
  out.met = std::move(met);
  return out;
}

/// Makes the contact solver's islands anew. Those that come together are looked at as one scene, as it is
/// now.
Array<ContactSolver::Made> Step::make_parts(const Fallen& fallen) const {
  ContactSolver& contact = *compiled_.contact;
  Ids apart;
  std::set_difference(fallen.parts.begin(), fallen.parts.end(), fallen.met.begin(), fallen.met.end(),
                      std::back_inserter(apart));
  Array<ContactSolver::Made> out = contact.make_anew(apart, fallen.part_edits);
  if (!fallen.meets()) return out;
  NamedPart joints = fallen.joints.with_particles(breaks_.scene_now().particles);
  for (std::size_t k = 0; k < joints.names.particles.size(); ++k) {
    const std::uint32_t particle = joints.names.particles[k];
    const bool is_fixed = joints.scene.particles[k].fixed = anchors_.is_fixed(particle);
    if (!is_fixed) continue;
    joints.scene.particles[k].position = anchors_.position(particle);
    joints.scene.particles[k].velocity = anchors_.last_velocity(particle);
  }
  NamedPart homes, others = fallen.held;
  homes.names.particles = fallen.particles;
  homes.names.rods = fallen.rods;
  homes.scene.particles = fallen.scene.particles;
  homes.scene.rods = fallen.scene.rods;
  for (Scene* const scene : {&homes.scene, &others.scene}) {
    scene->gravity = gravity_;
    scene->drag = drag();
    scene->joint_drag = joint_drag();
    if (mass_model_of(settings_) == MassModel::lumped) lump_masses(*scene);
  }
  const Array<ContactSolver::Made> made =
      contact.make_met({fallen.met, fallen.part_edits, std::move(homes), std::move(others), std::move(joints),
                        breaks_.scene_now()});
  out.insert(out.end(), made.begin(), made.end());
  return out;
}

/// Makes them with the numbers that islands and spheres had, if it was done before, and else says which.
Array<ContactSolver::Made> Step::make_numbered_parts(Fallen& fallen, Split& now) {
  ContactSolver& contact = *compiled_.contact;
  contact.numbers().give(now.islands);
  std::size_t spheres = 0;
  fallen.part_edits.number_of_sphere = [&] {
    if (spheres == now.spheres.size()) {
      now.spheres.push_back(population_.capsules.find(1));
      population_.capsules.take(now.spheres.back(), 1);
    }
    return now.spheres[spheres++];
  };
  Array<ContactSolver::Made> out = make_parts(fallen);
  fallen.part_edits.number_of_sphere = nullptr;
  now.islands = contact.numbers().made();
  for (const std::uint32_t number : now.spheres)
    if (contact.middle_of(number)) breaks_.add_capsule(number, contact.sphere(number));
  return out;
}

/// Lets what was moved elsewhere, or came together, go on in the contact solver as it went.
void Step::go_on_in_contact(const Fallen& fallen, std::span<const ContactSolver::Made> made) {
  for (const std::uint32_t particle : fallen.held.names.particles)
    if (const Place* const place = contact_place(particle); place && !anchors_.is_fixed(particle))
      if (const Vec3 force = loads_.force(particle); force != Vec3{})
        compiled_.contact->set_force(place->slot, force);
  const Ids& rods = fallen.held.names.rods;
  for (const std::uint32_t cord : lengths_.moving())
    if (std::find(rods.begin(), rods.end(), cord) != rods.end())
      tell_length(cord, lengths_.length(cord), lengths_.rate(cord));
  if (!fallen.meets() && fallen.part_edits.fixed.empty()) return;
  for (const auto& [island, visits] : made)
    if (!compiled_.contact->may_go_home(compiled_.contact->first_slot(island)))
      compiled_.contact->project_edited_velocities(island);
}

/// Leads from particles to where the contact solver has their new islands, and from those to their homes.
/// Returns how many have none.
std::uint32_t Step::put_parts(std::span<const ContactSolver::Made> made) {
  ContactSolver& contact = *compiled_.contact;
  const auto number = static_cast<std::uint32_t>(
      std::find_if(compiled_.solvers.begin(), compiled_.solvers.end(),
                   [&](const auto& each) { return each.get() == compiled_.contact; }) -
      compiled_.solvers.begin());
  Array<Place> places;
  std::uint32_t homeless = 0;
  for (const auto& [island, visits] : made) {
    const auto particles = contact.particles_of(island);
    const Slot first = contact.first_slot(island);
    if (contact.may_go_home(first)) {
      Array<Slot> at_home;
      for (const std::uint32_t particle : particles.first(contact.movable_of(island)))
        at_home.push_back(compiled_.places.of(particle).front().slot);
      const std::uint32_t home = compiled_.places.of(particles.front()).front().solver;
      contact.set_home(island, *compiled_.solvers[home], home, std::move(at_home));
      if (visits) contact.stay_away(island);
    } else {
      ++homeless;
    }
    for (std::uint32_t k = 0; k < particles.size(); ++k) {
      const auto others = compiled_.places.of(particles[k]);
      places.assign(others.begin(), others.end());
      places.push_back({number, first + k});
      compiled_.places.replace(particles[k], places);
      // The contact solver does not follow what is at home.
      if (anchors_.is_fixed(particles[k])) contact.place_anchor(first + k, anchors_.position(particles[k]));
    }
  }
  compiled_.places.find_runs(compiled_.solvers);
  return homeless;
}

}  // namespace plumb::detail
