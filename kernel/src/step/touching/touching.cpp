// This file makes islands anew that the contact solver knows: those with joints or springs, and those with
// shapes.

#include <algorithm>
#include <utility>
#include <vector>

#include "contact/linkage/scene_parts.hpp"
#include "step/breaks/ids.hpp"
#include "step/methods.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Returns what holds of orders for particles: of several the last.
template <class What>
std::vector<std::pair<std::uint32_t, What>> last_orders(std::vector<std::pair<std::uint32_t, What>> orders) {
  std::stable_sort(orders.begin(), orders.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<std::pair<std::uint32_t, What>> out;
  for (const auto& order : orders) {
    if (!out.empty() && out.back().first == order.first) out.pop_back();
    out.push_back(order);
  }
  return out;
}

}  // namespace

/// Returns where the contact solver has a particle, or null.
const Place* Step::contact_place(std::uint32_t particle) const {
  const auto places = compiled_.places.of(particle);
  return !places.empty() && &solver(places.back()) == compiled_.contact ? &places.back() : nullptr;
}

/// An island that a broken rod has left whole still hangs from the rod's fixed end. It does not any more
/// where that is freed.
void Step::take_along(const Edits& edits) {
  const auto hangs_from = [&](std::uint32_t particle, std::uint32_t anchor) {
    const Place& home = compiled_.places.of(particle).front();
    const auto places = compiled_.places.of(anchor);
    return std::any_of(places.begin(), places.end(), [&](const Place& place) {
      return place.solver == home.solver &&
             solver(place).island_of(place.slot) == solver(home).island_of(home.slot);
    });
  };
  for (const auto& [anchor, is_fixed] : edits.fixed) {
    if (is_fixed || !anchors_.is_fixed(anchor)) continue;
    for (const std::uint32_t rod : breaks_.rods_at(anchor)) {
      const Rod& of = breaks_.scene_now().rods[rod];
      const std::uint32_t other = of.a == anchor ? of.b : of.a;
      if (!breaks_.joins_ends(rod) && !anchors_.is_fixed(other) && hangs_from(other, anchor))
        breaks_.take_along(other);
    }
  }
}

/// Lists what is done to the contact solver's islands. Appends particles of theirs: those of islands that are
/// made anew, and those of islands that may come together.
PartEdits Step::list_part_edits(const Edits& edits, Ids& touched, Ids& meeting) const {
  PartEdits out;
  for (const Joined& each : edits.joined) meeting.insert(meeting.end(), {each.rod.a, each.rod.b});
  for (const std::uint32_t rod : edits.cut) {
    touched.push_back(rods_.end(rod));
    out.cut.push_back(rod);
  }
  for (const auto& [particle, mass] : last_orders(edits.masses)) {
    touched.push_back(particle);
    out.heavier.emplace_back(particle, mass - breaks_.own_mass(particle));
  }
  for (const auto& [particle, is_fixed] : last_orders(edits.fixed)) {
    if (anchors_.is_fixed(particle) == is_fixed) continue;
    if (is_fixed) {
      touched.push_back(particle);
      out.fixed.push_back(particle);
    } else {
      append_neighbours(particle, meeting);
    }
  }
  return out;
}

/// Takes out what broke and what was cut, and does other edits, with the contact solver's islands.
Fallen Step::take_out(const Split& now) {
  Ids parts, linkages, touched, meeting;
  PartEdits edits = list_part_edits(now.edits, touched, meeting);
  const auto touch = [&](std::uint32_t particle) {
    const Place* const place = anchors_.is_fixed(particle) ? nullptr : contact_place(particle);
    if (!place) return false;
    const std::uint32_t part = compiled_.contact->island_of(place->slot);
    parts.push_back(part);
    if (compiled_.contact->may_go_home(place->slot)) return true;
    linkages.push_back(part);
    breaks_.hold(particle);
    return true;
  };
  for (const std::uint32_t particle : touched) touch(particle);
  bool meets = false;
  for (const std::uint32_t particle : meeting) meets = touch(particle) || meets;
  sort_once(parts);
  sort_once(linkages);
  take_along(now.edits);
  Fallen out = breaks_.take_out(now.rods, now.edits);
  if (parts.empty()) return out;
  for (const std::uint32_t part : parts) {
    const auto particles = compiled_.contact->particles_of(part);
    out.touched.insert(out.touched.end(), particles.begin(), particles.end());
    if (!std::binary_search(linkages.begin(), linkages.end(), part)) continue;
    const auto movable = particles.first(compiled_.contact->movable_of(part));
    out.of_linkages.insert(out.of_linkages.end(), movable.begin(), movable.end());
  }
  sort_once(out.touched);
  out.leaving.insert(out.leaving.end(), out.of_linkages.begin(), out.of_linkages.end());
  out.parts = std::move(parts);
  out.part_edits = std::move(edits);
  out.meets = meets;
  return out;
}

/// Returns what is made anew without what has a home alone, where it is now.
MetIslands Step::met_islands(const Fallen& fallen) const {
  MetIslands out{.particles = fallen.particles, .rods = fallen.rods};
  out.scene.gravity = fallen.scene.gravity;
  out.scene.drag = fallen.scene.drag;
  out.scene.particles = fallen.scene.particles;
  out.scene.rods = fallen.scene.rods;
  if (mass_model_of(settings_) == MassModel::lumped) lump_masses(out.scene);
  return out;
}

/// Makes the contact solver's islands anew. Those that may have come together are looked at as one scene.
std::vector<ContactSolver::Made> Step::make_parts(const Fallen& fallen) const {
  ContactSolver& contact = *compiled_.contact;
  if (!fallen.meets) return contact.make_anew(fallen.parts, fallen.part_edits);
  Ids met, others;
  for (const std::uint32_t part : fallen.parts)
    (contact.may_go_home(contact.first_slot(part)) ? met : others).push_back(part);
  std::vector<ContactSolver::Made> out = contact.make_anew(others, fallen.part_edits);
  const auto made = contact.make_met(met, fallen.part_edits, met_islands(fallen));
  out.insert(out.end(), made.begin(), made.end());
  return out;
}

/// Leads from particles to where the contact solver has their new islands, and from those to their homes.
void Step::put_parts(std::span<const ContactSolver::Made> made) {
  ContactSolver& contact = *compiled_.contact;
  const auto number = static_cast<std::uint32_t>(
      std::find_if(compiled_.solvers.begin(), compiled_.solvers.end(),
                   [&](const auto& each) { return each.get() == compiled_.contact; }) -
      compiled_.solvers.begin());
  std::vector<Place> places;
  for (const auto& [island, visits] : made) {
    const auto particles = contact.particles_of(island);
    const Slot first = contact.first_slot(island);
    if (contact.may_go_home(first)) {
      std::vector<Slot> at_home;
      for (const std::uint32_t particle : particles.first(contact.movable_of(island)))
        at_home.push_back(compiled_.places.of(particle).front().slot);
      const std::uint32_t home = compiled_.places.of(particles.front()).front().solver;
      contact.set_home(island, *compiled_.solvers[home], home, std::move(at_home));
      if (visits) contact.stay_away(island);
    } else {
      ++compiled_.info.islands;
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
}

}  // namespace plumb::detail
