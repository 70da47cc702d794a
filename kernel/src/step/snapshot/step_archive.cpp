// This file lists what steps and programs change of a compiled scene.

#include <algorithm>

#include "interface/archive.hpp"
#include "step/step.hpp"

namespace plumb::detail {

bool Step::has_archive() const {
  return std::all_of(compiled_.solvers.begin(), compiled_.solvers.end(),
                     [](const auto& solver) { return solver->has_archive(); });
}

std::unique_ptr<Step> Step::compiled_with(std::span<const Split> splits) {
  auto out = std::make_unique<Step>(origin_->scene, origin_->settings);
  for (const Split& each : splits) out->repeat(each);
  out->loads_.take_load(loads_);
  out->budget_ = budget_;
  out->zones_ = zones_;
  return out;
}

/// Lists the rules that a program may change, and tells solvers if they are others than before.
void Step::archive_rules(Archive& archive) {
  StopRule stop = settings_.stop;
  Weights weights = settings_.weights;
  auto& [sweeps, tolerance, budget_us] = stop;
  archive(sweeps, tolerance, budget_us, weights, settings_.substeps);
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
  if (weighs) describe();
  compiled_.info.parallel = uses_threads();
}

/// What broke or was edited is known by splits. What a step begins anew is left out.
void Step::archive(Archive& archive) {
  auto& [settings, thresholds, workers, compiled, anchors, lengths, reeled, twisted, loads, reactions, origin,
         breaks, edits, gravity, next_gravity, splits, has_broken, seats, rods, sleep, rules, budget, zones,
         stages, dt, reports, visited, active, last_dt] = *this;
  archive_rules(archive);
  Vec3 pulls = gravity;
  archive(pulls, next_gravity);
  if (!(pulls == gravity)) apply_gravity(pulls);
  if (archive.restores()) order(edits, false);
  archive(edits);
  if (archive.restores()) order(edits, true);
  archive(anchors, lengths, loads, reactions, has_broken, sleep, dt);
  for_solvers([&](Solver& solver) { solver.archive(archive); });
}

}  // namespace plumb::detail
