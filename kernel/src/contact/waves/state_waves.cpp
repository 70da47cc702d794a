// This file lets an island know which of its rods are taut, and what that adds to its matrix.

#include <algorithm>
#include <cmath>

#include "contact/linkage/linkage_state.hpp"

namespace plumb::detail {

void LinkageState::slow_waves(double h) {
  const auto slows = [&] {
    return std::any_of(wave_inertia.begin(), wave_inertia.end(), [](double each) { return each > 0; });
  };
  const bool had_any = slows();
  linkage->find_wave_inertia(stiffness, stiffness_before, h, wave_inertia);
  if (!had_any && !slows()) return;
  factored = false;
  wave_inertia_at.assign(x.size(), 0);
  linkage->gather_wave_inertia(wave_inertia, wave_inertia_at);
}

bool LinkageState::learn_tautness(std::span<const double> multipliers, double h) {
  if (knows_tautness || stiffness.empty()) return false;
  follow_tautness(multipliers, h);
  knows_tautness = false;
  for (double& each : stiffness)
    if (!std::isfinite(each)) each = 0;
  stiffness_before = stiffness;
  linkage->find_wave_inertia(stiffness, stiffness_before, h, wave_inertia);
  const bool slows =
      std::any_of(wave_inertia.begin(), wave_inertia.end(), [](double each) { return each > 0; });
  if (slows) factored = false;
  return slows;
}

double LinkageState::heaviest(Terms at) const {
  if (wave_inertia_at.empty()) return linkage->heaviest(at);
  double out = 0;
  for (const auto& [k, weight] : at)
    if (k < linkage->movable()) out = std::max(out, linkage->own_mass_of(k) + wave_inertia_at[k]);
  return out;
}

void LinkageState::free_waves() {
  for (double& each : wave_inertia) {
    if (each > 0) factored = false;
    each = 0;
  }
  std::fill(wave_inertia_at.begin(), wave_inertia_at.end(), 0.0);
  if (!turning.empty()) factored = false;
  turning.clear();
}

void LinkageState::follow_turning(std::span<const double> multipliers) {
  turning.resize(stiffness.size());
  linkage->find_tautness(multipliers, turning);
  for (double& each : turning) each = 0.5 * std::max(0.0, each);
}

void LinkageState::follow_tautness(std::span<const double> multipliers, double h) {
  if (stiffness.empty()) return;
  knows_tautness = true;
  stiffness.swap(stiffness_before);
  linkage->find_tautness(multipliers, stiffness);
  for (double& each : stiffness) each /= h * h;
  waves_before = wave_inertia;
}

void LinkageState::momenta(std::span<const Vec3> motions, std::span<Vec3> out) const {
  linkage->momenta(motions, out);
  linkage->add_wave_momenta(wave_inertia, wave_inertia, motions, out);
}

std::span<const double> LinkageState::waves_at_start() const {
  return is_driven() ? wave_inertia : waves_before;
}

void LinkageState::start_momenta(std::span<const Vec3> motions, std::span<Vec3> out) const {
  linkage->momenta(motions, out);
  linkage->add_wave_momenta(wave_inertia, waves_at_start(), motions, out);
}

double LinkageState::inertia_product(std::span<const Vec3> motions) const {
  return 2 * linkage->kinetic(motions) + linkage->wave_product(wave_inertia, motions);
}

}  // namespace plumb::detail
