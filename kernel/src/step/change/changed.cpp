// This file makes a world anew under other settings, with its past, between two steps.

#include <algorithm>
#include <cstddef>
#include <utility>

#include "interface/archive.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/refuse.hpp"
#include "step/snapshot/fingerprint.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Returns whether worlds of one scene have the same solvers under both settings, which then go on from each
/// other's numbers.
bool are_alike(const Settings& one, Settings other) {
  other.substeps = one.substeps;
  other.most_work = one.most_work;
  other.stop = one.stop;
  other.weights = one.weights;
  other.omega = one.omega;
  other.contact = one.contact;
  other.sleep = one.sleep;
  other.sleep_time = one.sleep_time;
  return fingerprint_of({}, one).settings == fingerprint_of({}, other).settings;
}

void require_takeable(bool is, const Settings& settings, const char* which) {
  if (!is)
    refuse("settings: method ", to_string(settings.method), ", ", which,
           ", keeps a state of its own, which no other takes over; relax, direct and auto share theirs");
}

bool is_reference(Method method) {
  return method == Method::springs || method == Method::multipliers || method == Method::featherstone;
}

}  // namespace

std::unique_ptr<Step> Step::changed(const Settings& settings, const Make& make) const {
  require_takeable(has_archive(), settings_, "that of now");
  require_takeable(!is_reference(settings.method), settings, "the new one");
  const bool are_same = are_alike(origin_.settings, settings);
  if (!are_same)
    for (const auto& [what, count] :
         {std::pair("twist", first_scene().twists.size()), std::pair("reel", first_scene().reels.size())})
      if (count > 0)
        refuse("settings: ", what,
               " 0 has a past that islands keep for themselves: no more than substeps, most_work, stop, "
               "weights, omega, contact, sleep, sleep_time, isa, threads and executor can change");
  std::unique_ptr<Step> out = make(origin_.scene);
  require_takeable(out->has_archive(), settings, "the new one");
  if (are_same) {
    Population population = population_;
    out->relive(log_.splits(), population, static_cast<std::uint32_t>(seats_.size()), contact_islands());
    out->copy_state(*this);
  } else {
    out->relive_anew(*this);
    out->carry(*this);
  }
  if (!settings.sleep && out->compiled_.contact) out->compiled_.contact->wake_all();
  out->loads_ = loads_;
  out->budget_ = budget_;
  out->zones_ = zones_;
  return out;
}

/// Takes all that steps and programs changed of a world whose solvers are the same.
void Step::copy_state(const Step& from) {
  const Settings settings = settings_;
  copy_listed(from, *this);
  settings_ = settings;  // The rules of before came along.
  for_solvers([&](Solver& solver) {
    solver.set_stop_rule(settings.stop);
    solver.set_weights(settings.weights);
  });
  relate_errors();
  is_described_ = false;
}

/// Does again what a world of the same scene did. Solvers have other numbers here, and other rods may keep
/// their islands together.
void Step::relive_anew(const Step& from) {
  dt_ = from.dt_;
  if (!(from.population_ == population_)) {
    population_ = from.population_;
    breaks_.begin();
    grow_tables();
  }
  for (const Split& each : from.log_.splits()) redo(each, from);
  if (from.has_broken_)
    if (const Array<std::uint32_t> broken = from.broken_now(); !broken.empty()) redo({.rods = broken}, from);
  require_same_pieces(from);
}

/// Refuses to go on where a removal took other pieces than it did before.
void Step::require_same_pieces(const Step& from) const {
  const auto refuse_for = [this](const char* what, std::uint32_t number) {
    refuse("settings: ", what, " ", number, ": mass model ", to_string(mass_model_of(settings_)),
           " has it in another island than that which was removed");
  };
  for (std::uint32_t particle = 0; particle < population_.particles.count(); ++particle) {
    const bool has_place = !compiled_.places.of(particle).empty(),
               is_there = population_.particles.has(particle);
    if (is_there ? !has_place && !from.anchors_.is_fixed(particle) : has_place)
      refuse_for("particle", particle);
  }
  if (log_.is_empty()) return;  // Until something is done nobody knows rods by their ends.
  for (std::uint32_t rod = 0; rod < population_.rods.count(); ++rod) {
    if (!population_.rods.has(rod) || from.waits<Rod>(rod)) continue;
    const auto rods = breaks_.rods_at(breaks_.scene_now().rods[rod].a);
    if (std::find(rods.begin(), rods.end(), rod) == rods.end()) refuse_for("rod", rod);
  }
}

/// What is made anew begins where it is now, so far as it is still there, and as long.
void Step::redo(const Split& split, const Step& from) {
  breaks_.begin();
  Split now;
  if (!split.removed.empty()) {
    now.removed = split.removed;
    const Names gone = take_away(now.removed.front());
    return log_.push_removal(std::move(now), gone.particles);
  }
  if (!split.added.empty()) {
    now.added = split.added;
    put(now, compile_addition(scene_of(now.added.front())));
    return log_.push_addition(std::move(now));
  }
  now.rods = split.rods;
  now.edits = split.edits;
  now.spheres = split.spheres;
  require_simple_meeting("settings", now.edits);
  Fallen fallen = take_out(now);
  const Log::Group group = group_of(fallen, now);
  put_joined(now.edits);
  const Scene& scene = breaks_.scene_now();
  for (const std::uint32_t particle : fallen.particles)
    now.positions.push_back(from.population_.particles.has(particle) ? from.position(particle)
                                                                     : scene.particles[particle].position);
  now.velocities.resize(fallen.particles.size());
  const auto go_on_as_long = [&](const Array<std::uint32_t>& rods) {
    for (const std::uint32_t rod : rods) {
      now.lengths.push_back(from.population_.rods.has(rod) ? from.length(rod) : rod_length(scene, rod));
      lengths_.add(rod, now.lengths.back());
    }
  };
  go_on_as_long(fallen.rods);
  for (const std::uint32_t tackle : fallen.tackles) {
    const std::uint32_t cord = tackle_cord(tackle);
    now.lengths.push_back(from.population_.tackles.has(tackle) ? from.length(cord)
                                                               : tackle_length(scene, tackle));
    lengths_.add(cord, now.lengths.back());
  }
  go_on_as_long(fallen.held.names.rods);
  this->split(std::move(fallen), now);
  log_.push(std::move(now), group);
}

}  // namespace plumb::detail
