// This file lists what steps and programs change of a compiled scene.

#include <algorithm>

#include "interface/archive.hpp"
#include "step/step.hpp"

namespace plumb::detail {

void Step::archive_past(Archive& archive) {
  auto seats = static_cast<std::uint32_t>(seats_.size()), islands = contact_islands();
  log_.archive_entries(archive);
  archive(population_, seats, islands);
}

std::unique_ptr<Step> Step::restored_past(Archive& archive) {
  Array<Split> splits;
  Population population = population_;
  std::uint32_t seats = 0, islands = 0;
  archive(splits, population, seats, islands);
  if (log_.is_of(splits) && population == population_ && seats == seats_.size() &&
      islands == contact_islands())
    return {};
  auto out = std::make_unique<Step>(origin_.scene, origin_.settings);
  out->relive(std::move(splits), population, seats, islands);
  out->loads_.take_load(loads_);
  out->budget_ = budget_;
  out->zones_ = zones_;
  return out;
}

/// Does again all that a world of this scene and these settings did, with the seats of its solvers and the
/// numbers of contact's islands.
void Step::relive(Array<Split> splits, Population& population, std::uint32_t seats, std::uint32_t islands) {
  std::swap(population_, population);
  if (!(population_ == population)) {
    breaks_.begin();
    grow_tables();
  }
  for (Split& each : splits) repeat(std::move(each));
  seats_.resize(seats, Seat::free);
  compiled_.solvers.resize(seats);
  anchors_.resize(seats);
  sleep_.exchange(compiled_.solvers, seats_);
  if (compiled_.contact) compiled_.contact->resize_islands(islands);
}

/// Lists the rules that a program may change, and tells solvers if they are others than before.
void Step::archive_rules(Archive& archive) {
  StopRule stop = settings_.stop;
  Weights weights = settings_.weights;
  auto& [sweeps, tolerance, budget_us] = stop;
  archive(sweeps, tolerance, budget_us, weights, settings_.substeps, settings_.accuracy);
  if (!archive.restores()) return;
  const StopRule& now = settings_.stop;
  const bool stops = sweeps != now.sweeps || tolerance != now.tolerance || budget_us != now.budget_us;
  const bool weighs = weights != settings_.weights;
  for_solvers([&](Solver& solver) {
    if (stops) solver.set_stop_rule(stop);
    if (weighs) solver.set_weights(weights);
  });
  settings_.stop = stop;
  settings_.weights = weights;
  is_described_ = false;
}

/// The past is listed by archive_past(). What a step begins anew is left out.
void Step::archive(Archive& archive) {
  auto& [settings, thresholds, workers, compiled, anchors, lengths, reeled, twisted, loads, grabs, reactions,
         origin, breaks, edits, gravity, next_gravity, log, population, has_archive, is_described, has_broken,
         is_to_fit, seats, is_loose, rods, sleep, events, size, rules, budget, zones, stages, dt, reports,
         visited, active, last_dt] = *this;
  archive_rules(archive);
  Vec3 pulls = gravity;
  archive(pulls, next_gravity);
  if (!(pulls == gravity)) apply_gravity(pulls);
  if (archive.restores()) order(edits, false);
  archive(edits);
  if (archive.restores()) order(edits, true);
  archive(anchors, lengths, loads, reactions, has_broken, is_to_fit, sleep, size, dt);
  relate_errors();
  grabs.archive(archive, compiled.places, compiled.solvers);
  if (settings.events) archive(events);
  for_solvers([&](Solver& solver) { solver.archive(archive); });
}

}  // namespace plumb::detail
