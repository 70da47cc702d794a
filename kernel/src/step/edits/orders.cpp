// This file takes orders for edits that make islands anew. The next step carries them out (split.cpp).

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/bends/bends.hpp"
#include "scene/refuse.hpp"
#include "step/breaks/ids.hpp"
#include "step/methods.hpp"
#include "step/step.hpp"

namespace plumb::detail {

/// Refuses an edit of a rod or a particle whose island cannot be made anew from the numbers of a scene.
/// `particle` is a movable one of the island, if it has any.
void Step::require_editable(const char* what, std::uint32_t number, std::uint32_t particle) const {
  if (!has_archive())
    refuse(what, " ", number, ": method ", to_string(settings_.method),
           " edits no world; relax, direct and auto do");
  if (const auto reel = breaks_.reel_at(particle))
    refuse(what, " ", number, ": reel ", *reel, " is of its island, which stays one");
}

/// Returns whether edits bring islands together that have shapes or joints then. `ends` are of these islands.
bool Step::meets_in_contact(const Edits& edits, std::span<const std::uint32_t> ends) const {
  const auto is_known = [&](std::uint32_t each) { return contact_place(each) != nullptr; };
  return lists_any(edits.joints().names) || std::any_of(ends.begin(), ends.end(), is_known);
}

/// Refuses edits of one step that would bring islands with shapes or joints together with tackles, twists or
/// reels, which the contact solver does not know. The message begins with `what`.
void Step::require_simple_meeting(const std::string& what, const Edits& edits) const {
  if (!compiled_.contact) return;
  const Ids ends = meeting(edits);
  if (!meets_in_contact(edits, ends)) return;
  const auto require_none = [&](const char* of, const std::optional<std::uint32_t>& number) {
    if (number) refuse(what, ": islands with shapes or joints would come together with ", of, " ", *number);
  };
  for (const std::uint32_t each : ends) {
    require_none("tackle", breaks_.tackle_at(each));
    require_none("twist", breaks_.twist_at(each));
    require_none("reel", breaks_.reel_at(each));
  }
  for (const std::uint32_t cord : lengths_.moving())
    if (lengths_.will_change(cord) && meets_as_no_winch(cord, ends))
      refuse(what, ": rod ", cord, " would change its length in the next step and give, bend or drag, ",
             "where its island has joints or shapes");
}

/// Returns whether a rod would come together with joints or shapes in the next step, and is one that cannot
/// change its length there. `ends` are of islands that do.
bool Step::meets_as_no_winch(std::uint32_t cord, const Array<std::uint32_t>& ends) const {
  if (is_line(cord) || is_in_contact(cord) || is_broken(cord)) return false;
  const Rod& rod = breaks_.scene_now().rods[cord];
  const std::uint32_t end = rods_.end(cord);
  const auto has_end = [&](std::uint32_t bend) {
    const auto particles = particles_of(breaks_.scene_now().bends[bend]);
    return std::count(particles.begin(), particles.end(), rod.a == end ? rod.b : rod.a) > 0;
  };
  const Ids bends = breaks_.bends_at(end);
  if (is_plain_rod(rod) && std::none_of(bends.begin(), bends.end(), has_end)) return false;
  const auto island = breaks_.island_at(end);
  return std::any_of(ends.begin(), ends.end(),
                     [&](std::uint32_t each) { return breaks_.island_at(each).data() == island.data(); });
}

void Step::cut(std::uint32_t rod) {
  breaks_.begin();
  if (waits<Rod>(rod)) return take_back({.rods = {rod}});
  if (is_broken(rod)) return;
  require_editable("rod", rod, rods_.end(rod));
  if (const auto twist = breaks_.twist_beside(rod))
    refuse("rod ", rod, ": twist ", *twist, " is of its island, which stays one");
  if (is_of_body(rod)) refuse("rod ", rod, ": is of a body, which stays whole");
  order_cut(rod);
}

void Step::cut(std::size_t kind, const char* what, std::uint32_t number) {
  breaks_.begin();
  Names one;
  *one.all()[kind] = {number};
  if (waits(kind, number)) return take_back(std::move(one));
  const auto mover = compiled_.contact ? compiled_.contact->mover_of(kind, number) : std::nullopt;
  require_editable(what, number, mover.value_or(0));
  Ids& ordered = *edits_.severed.all()[kind];
  const auto at = std::lower_bound(ordered.begin(), ordered.end(), number);
  if (at == ordered.end() || *at != number) ordered.insert(at, number);
}

void Step::order_cut(std::uint32_t rod) {
  edits_.cut.push_back(rod);
  breaks_.order(rod, true);
}

/// Orders cuts of what broke in islands of the contact solver, so that shapes along it end and what falls
/// apart collides. Such islands have no twists nor reels.
void Step::cut_broken() {
  if (!compiled_.contact || !has_archive()) return;
  for (const std::uint32_t rod : breaks_.weak())
    if (!breaks_.is_out(rod) && is_known_to_contact(rod) && compiled_.contact->has_broken(rod) &&
        !is_of_body(rod))
      order_cut(rod);
}

/// Returns whether a body has both ends of a rod. Nothing moves one while they are fixed.
bool Step::is_of_body(std::uint32_t rod) const {
  if (is_in_contact(rod)) return compiled_.contact->is_of_body(rod);
  if (!anchors_.is_fixed(rods_.end(rod))) return false;
  const Rod& of = breaks_.scene_now().rods[rod];
  const Ids one = bodies_at(of.a), other = bodies_at(of.b);
  return std::any_of(one.begin(), one.end(),
                     [&](std::uint32_t body) { return std::count(other.begin(), other.end(), body) > 0; });
}

/// Returns whether the mass of a rod would join its ends after a cut, in an island that may go home from
/// contact.
bool Step::joins_by_mass(std::uint32_t rod) const {
  const Place* const place = contact_place(rods_.end(rod));
  return place && !anchors_.is_fixed(rods_.end(rod)) && compiled_.contact->may_go_home(place->slot) &&
         rod_mass(breaks_.scene_now(), rod, mass_model_of(settings_)).ab != 0;
}

/// Returns the bodies that have a particle.
Array<std::uint32_t> Step::bodies_at(std::uint32_t particle) const {
  Array<std::uint32_t> out;
  const std::vector<Body>& bodies = breaks_.scene_now().bodies;
  for (std::uint32_t i = 0; i < bodies.size(); ++i)
    if (population_.bodies.has(i) &&
        std::count(bodies[i].particles.begin(), bodies[i].particles.end(), particle) > 0)
      out.push_back(i);
  return out;
}

/// Refuses to fix or free a particle of elements that need it as it is.
void Step::require_refixable(std::uint32_t particle, bool is_fixed) const {
  const Scene& scene = breaks_.scene_now();
  const auto require_none = [&](const char* what, const auto& list, const Numbers* numbers = nullptr) {
    for (std::uint32_t i = 0; i < list.size(); ++i)
      if ((!numbers || numbers->has(i)) &&
          std::count(list[i].particles.begin(), list[i].particles.end(), particle) > 0)
        refuse("particle ", particle, ": is of ", what, " ", i, ", and stays fixed or free");
  };
  require_none("tackle", scene.tackles, &population_.tackles);
  require_none("reel", scene.reels);
  require_none("twist", scene.twists);
  const auto stands = [&](std::uint32_t each) { return each == particle || will_be_fixed(each); };
  if (is_fixed) {
    for (const std::uint32_t i : breaks_.bends_at(particle)) {
      const Bend& bend = scene.bends[i];
      if (stands(bend.b) && (stands(bend.a) || stands(bend.c)))
        refuse("particle ", particle, ": cannot be fixed, since both ends of a rod of bend ", i, " would be");
    }
    const auto require_mover = [&](const std::string& held) {
      if (!held.empty())
        refuse("particle ", particle, ": cannot be fixed, since nothing of ", held, " could move then");
    };
    NamedPart joints = edits_.joints().with_particles(scene.particles);
    for (std::size_t k = 0; k < joints.names.particles.size(); ++k)
      joints.scene.particles[k].fixed = stands(joints.names.particles[k]);
    require_mover(joints.held());
    if (const Place* const place = contact_place(particle))
      require_mover(compiled_.contact->held_by(place->slot, anchors_.will_be_fixed()));
  } else {
    for (const std::uint32_t i : bodies_at(particle))
      if (!compiled_.contact->has_body(i))
        refuse("particle ", particle, ": is of body ", i, ", which is ground");
  }
}

/// Refuses to fix a particle where a rod to another fixed one is to change its length in the same step.
/// Nobody could follow that, and the rod would be off its length when an end is freed.
void Step::require_kept_between_fixed(std::uint32_t rod, std::uint32_t particle) const {
  const auto [a, b] = std::pair{breaks_.scene_now().rods[rod].a, breaks_.scene_now().rods[rod].b};
  if (will_be_fixed(a == particle ? b : a) && lengths_.will_change(rod) && !is_broken(rod))
    refuse("particle ", particle, ": cannot be fixed, since rod ", rod,
           " changes its length in the next step, and its other end is fixed");
}

/// Refuses to free a particle that has no mass to move with, neither its own nor from rods and bodies.
/// `without` lists some that go before.
void Step::require_mass(std::uint32_t particle, const Names& without) const {
  double own = breaks_.own_mass(particle);
  for (const auto& [of, ordered] : edits_.masses)
    if (of == particle) own = ordered;
  const Scene& scene = breaks_.scene_now();
  const auto goes = [](const Ids& list, std::uint32_t each) {
    return std::binary_search(list.begin(), list.end(), each);
  };
  double mass = own + breaks_.taken_mass(particle);
  for (const std::uint32_t rod : breaks_.rods_at(particle)) {
    if (!breaks_.joins_ends(rod) || goes(without.rods, rod)) continue;
    const RodMass of = rod_mass(scene, rod, MassModel::lumped);
    mass += scene.rods[rod].a == particle ? of.aa : of.bb;
  }
  for (const std::uint32_t body : bodies_at(particle))
    if (!goes(without.bodies, body)) mass += scene.bodies[body].mass;
  if (!(mass > 0 && std::isfinite(mass)))
    refuse("particle ", particle, ": has no mass to be free with, but ", mass,
           " kg; set_mass() gives it one");
}

void Step::fix(std::uint32_t particle, bool is_fixed) {
  if (will_be_fixed(particle) == is_fixed) return;
  breaks_.begin();
  require_refixable(particle, is_fixed);
  require_editable("particle", particle, particle);
  for (const std::uint32_t rod : breaks_.rods_at(particle)) {
    if (is_fixed) require_kept_between_fixed(rod, particle);
    require_editable("particle", particle, rods_.end(rod));
    if (const auto twist = breaks_.twist_at(rods_.end(rod)))
      refuse("particle ", particle, ": twist ", *twist, " is of its island, which stays one");
  }
  if (!is_fixed) require_mass(particle);
  if (!is_fixed && holds_ground(particle))
    refuse("particle ", particle, ": a capsule of the ground is at it, and it stays");
  if (!is_fixed) require_fit_of_fixed(particle);
  Edits then = edits_;
  std::erase_if(then.fixed, [&](const auto& each) { return each.first == particle; });
  if (anchors_.is_fixed(particle) != is_fixed) then.fixed.emplace_back(particle, is_fixed);
  require_simple_meeting("particle " + std::to_string(particle), then);
  edits_ = std::move(then);
  anchors_.order(particle, is_fixed);
}

void Step::set_mass(std::uint32_t particle, double mass) {
  breaks_.begin();
  require_editable("particle", particle, particle);
  if (const auto twist = breaks_.twist_at(particle))
    refuse("particle ", particle, ": twist ", *twist, " is of its island, which stays one");
  std::erase_if(edits_.masses, [&](const auto& each) { return each.first == particle; });
  edits_.masses.emplace_back(particle, mass);
}

void Step::pack() {
  if (!has_archive())
    refuse("method ", to_string(settings_.method), " packs no world; relax, direct and auto do");
  breaks_.begin();
  edits_.packs = true;
}

/// Tells all that know which particles are fixed of new ones. They are where their solvers still have them.
void Step::refix(const Edits& edits) {
  for (const auto& [particle, is_fixed] : edits.fixed) {
    if (anchors_.is_fixed(particle) == is_fixed) continue;
    if (is_fixed)
      anchors_.fix(particle, position(particle), velocity(particle), dt_);
    else
      anchors_.free(particle);
    loads_.fix(particle, is_fixed);
    Array<std::uint32_t> rods;
    for (const std::uint32_t rod : breaks_.rods_at(particle)) {
      if (breaks_.joins_ends(rod)) rods.push_back(rod);
      const auto [a, b] = std::pair{breaks_.scene_now().rods[rod].a, breaks_.scene_now().rods[rod].b};
      rods_.set_end(rod, anchors_.is_fixed(a) ? b : a);
    }
    if (settings_.tensions && !is_fixed) reactions_.end(particle);
    if (settings_.tensions) reactions_.refix(breaks_.scene_now(), mass_model_of(settings_), rods, anchors_);
  }
  if (!settings_.tensions || edits.fixed.empty() || !compiled_.contact) return;
  // Those of now: what is done again for a snapshot has the population of its end.
  const auto is_there = [&](std::uint32_t body) { return compiled_.contact->has_body(body); };
  reactions_.refix_bodies(breaks_.scene_now(), is_there, anchors_);
}

/// Lets gravity be what was ordered. All wake, since all fall otherwise.
void Step::change_gravity() {
  sleep_.wake_all(compiled_.solvers);
  apply_gravity(next_gravity_);
}

void Step::apply_gravity(Vec3 gravity) {
  const Vec3 change = gravity - gravity_;
  gravity_ = gravity;
  reactions_.set_gravity(gravity);
  for_solvers([&](Solver& solver) { solver.set_gravity(gravity, change); });
  loads_.for_forces([&](std::uint32_t particle, Vec3 force) {
    for (const Place& place : compiled_.places.of(particle)) solver(place).set_force(place.slot, force);
  });
}

/// Lets what is ordered be read as if it was done, or takes that back.
void Step::order(const Edits& edits, bool is_ordered) {
  if (edits.any()) breaks_.begin();
  for (const std::uint32_t rod : edits.cut) breaks_.order(rod, is_ordered);
  for (const auto& [particle, is_fixed] : edits.fixed)
    anchors_.order(particle, is_ordered ? is_fixed : anchors_.is_fixed(particle));
}

}  // namespace plumb::detail
