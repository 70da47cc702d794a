#include "direct/displacements/elastic_rods.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "direct/laws/change_share.hpp"
#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "time/progress.hpp"

namespace plumb::detail {
namespace {

/// Elastic rods have the second compliance, in units of 2 L^2/mass. Where the search for the minimum fails,
/// it begins again with the first and goes down by hundreds; rounding may not keep it from the last.
constexpr double softest = 1e-2, next_stiffer = 1e-2, stiffest = 0.99e-8;
/// The search ends after a change this small, RMS over nodes relative to a rod. A step is cut down to this
/// share of Newton's at the least.
constexpr double elastic_change = 1e-9, least_scale = 1e-6;
constexpr int most_elastic_iterations = 40, most_stiffer_iterations = 16;
/// What converges slowly, since rods push, is near enough after a change this small.
constexpr double near_change = 1e-5;
/// Multipliers and displacements are sought together in so many iterations. A change is cut down to so many
/// rod lengths.
constexpr int most_joint_iterations = 24, elastic_patience = 9;
constexpr double most_change = 1;

/// Returns C of a rod at the present delta, in m^2.
double constraint_of(const LoopRod& rod, std::uint32_t k, const LoopWorkspace& work) {
  return constraint(at(work.d, k), at(work.delta, rod.a) - at(work.delta, rod.b), work.excess[k]);
}

/// Returns the multiplier and the energy of a rod at the present delta. Those that give do as their law says.
LawPull elastic_pull(const LoopState& state, std::uint32_t k, double soft, const LoopWorkspace& work) {
  const LoopRod& rod = state.topology->rods[k];
  const bool any = state.laws.any();
  if (any && !state.laws.is_rigid(k))
    return law_pull(state.laws, work.laws, k,
                    growth_of(at(work.d, k), at(work.delta, rod.a) - at(work.delta, rod.b)));
  double c = constraint_of(rod, k, work);
  if (any && state.laws.is_one_sided(k)) c = std::max(c, 0.0);
  const double give = softness(state, k, soft);
  return {-c / give, c * c / (2 * give)};
}

/// Returns delta . M delta / 2 - load . delta + sum of C^2/(2 softness).
double elastic_energy(const LoopState& state, double soft, const LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  double sum = 0;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) {
    const Vec3 delta = at(work.delta, i);
    sum += dot(delta, 0.5 * state.mass[i] * delta - at(work.load, i));
  }
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    sum += state.coupling[k] * dot(at(work.delta, a), at(work.delta, b)) +
           elastic_pull(state, k, soft, work).energy;
  }
  return sum + energy_of_bends(state, work) + energy_of_tackles(state, soft, work) +
         energy_of_twists(state, work);
}

/// Sets the multiplier of every rod, -C/softness where it is rigid, those of tackles and the torques of
/// twists.
void set_elastic_multipliers(LoopState& state, double soft, LoopWorkspace& work) {
  const std::size_t rods = state.topology->rods.size();
  for (std::uint32_t k = 0; k < rods; ++k) state.mu[k] = elastic_pull(state, k, soft, work).mu;
  set_elastic_tackles(state, soft, work);
  set_linear_torques(state, work);
}

/// Changes work.delta until the energy of rods of this softness is least. Returns whether it is.
bool minimize_elastic(LoopState& state, double soft, int most, LoopWorkspace& work, Tally& counters) {
  LoopWorkspace::Factor& factor = work.factor(true);
  double energy = elastic_energy(state, soft, work);
  double change = 0;
  for (int i = 0; i < most; ++i) {
    set_elastic_multipliers(state, soft, work);
    factorize_newton(state, 1, soft, work, factor);
    change = find_newton_change(state, 1, soft, work, factor);
    ++counters.newton;
    std::copy(work.delta.begin(), work.delta.end(), work.trial.begin());
    bool better = false;
    for (double scale = 1; !better && scale > least_scale; scale /= 2) {
      std::copy(work.trial.begin(), work.trial.end(), work.delta.begin());
      apply_change(state, scale, work, factor);
      const double now = elastic_energy(state, soft, work);
      better = now < energy;
      if (better) energy = now;
    }
    if (!better) std::copy(work.trial.begin(), work.trial.end(), work.delta.begin());
    // What no step along the direction makes better is a minimum, to rounding.
    if (change <= elastic_change || !better) return std::isfinite(energy);
  }
  return change <= near_change;
}

/// Iterates on displacements and multipliers together, as where rods are rigid. Multipliers are then those
/// that fit changes, and not those of what curved ways leave of lengths, which stiff rods would make large.
/// Returns whether it converges.
bool iterate_elastic(LoopState& state, double soft, LoopWorkspace& work, Tally& counters) {
  LoopWorkspace::Factor& factor = work.factor(true);
  double last = std::numeric_limits<double>::infinity();
  ChangeShare share;
  Progress progress(elastic_patience);
  for (int i = 0; i < most_joint_iterations; ++i) {
    factorize_newton(state, 1, soft, work, factor);
    const double change = find_newton_change(state, 1, soft, work, factor);
    ++counters.newton;
    if (!std::isfinite(change)) return false;
    if (!progress.goes_on(change)) break;
    const double made = state.laws.any() ? share.next(change / last) : 1;
    apply_change(state, made * std::min(1.0, most_change / change), work, factor);
    if (made == 1 && change <= elastic_change) return true;
    last = change;
  }
  return last <= near_change;
}

}  // namespace

bool let_rods_give(LoopState& state, LoopWorkspace& work, Tally& counters) {
  std::copy(work.delta.begin(), work.delta.end(), work.start.begin());
  if (iterate_elastic(state, stiffest, work, counters))
    return std::isfinite(elastic_energy(state, stiffest, work));
  std::copy(work.start.begin(), work.start.end(), work.delta.begin());
  // Stiff rods make the minimum a narrow, winding valley. Softer ones lead into it.
  double soft = softest;
  while (soft > stiffest &&
         minimize_elastic(state, soft, soft == softest ? most_elastic_iterations : most_stiffer_iterations,
                          work, counters))
    soft *= next_stiffer;
  if (soft == softest) ++counters.unsolved;
  return std::isfinite(elastic_energy(state, stiffest, work));
}

}  // namespace plumb::detail
