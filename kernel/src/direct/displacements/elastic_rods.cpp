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
/// What converges slowly, since rods push, is near enough after a change this small.
constexpr double near_change = 1e-5;
/// Softer rods only lead to stiffer ones. Those follow once a step of Newton's gains, for its share, no more
/// than this of the energy of motion or of what was gained before.
constexpr double least_gain = 1e-2;
/// Where frames are bounded they also follow once a whole step is as small as this. Where a step was cut down
/// to less than this share, multipliers that went along with displacements have led astray.
constexpr double near_softer = 1e-3, least_carried = 0.1;
/// Rods of all compliances together take so many iterations, and those after the softest so many each.
constexpr int most_soft_iterations = 28, most_stiffer_iterations = 16;
/// Multipliers and displacements are sought together in so many iterations. A change is cut down to so many
/// rod lengths. Where the first one is larger than `farthest` of them, that hardly ever converges.
constexpr int most_joint_iterations = 24, elastic_patience = 9, bounded_patience = 3;
constexpr double most_change = 1, farthest = 0.1;

/// Rods that gave are tried as rigid ones. The first change is at most so many rod lengths, and each falls so
/// fast, to the last one.
constexpr double most_hardened = 0.1, hardening_rate = 0.7, hardened_change = 1e-8;
/// That is tried in the end, and where changes as small as this fall more slowly than that, with rods of no
/// more than this softness. The next try needs a change that is so many times smaller.
/// Cables crawl until it is found which are taut.
constexpr double crawling_cables = 1e-4;
constexpr double crawling_change = 1e-2, crawling_rate = 0.3, hardest = 1.01e-6, next_hardening = 0.03;

/// Returns C of a rod at the present delta, in m^2.
double constraint_of(const LoopRod& rod, std::uint32_t k, const LoopWorkspace& work) {
  return constraint(at(work.d, k), at(work.delta, rod.a) - at(work.delta, rod.b), work.excess[k]);
}

/// Returns the multiplier and the energy of a rod at the present delta. Those that give do as their law says,
/// unless they are to be softer.
LawPull elastic_pull(const LoopState& state, std::uint32_t k, double soft, const LoopWorkspace& work) {
  const LoopRod& rod = state.topology->rods[k];
  const bool any = state.laws.any();
  const double give = softness(state, k, soft);
  if (any && !state.laws.is_rigid(k) && !is_softened(state, k, give, work))
    return law_pull(state.laws, work.laws, k,
                    growth_of(at(work.d, k), at(work.delta, rod.a) - at(work.delta, rod.b)));
  double c = constraint_of(rod, k, work);
  if (any && state.laws.is_one_sided(k)) c = std::max(c, 0.0);
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

/// Returns load . M^-1 load / 2, the energy that the substep would have if nothing held.
double energy_of_motion(const LoopState& state, const LoopWorkspace& work) {
  double sum = 0;
  for (std::uint32_t i = 0; i < state.topology->nodes; ++i)
    sum += dot(at(work.load, i), at(work.load, i)) / state.mass[i];
  return sum / 2;
}

/// Makes the largest of 1, 1/2, 1/4, ... times a change that lowers the energy, which becomes the new one.
/// Returns that share, or 0 if none does.
double descend(LoopState& state, double soft, double& energy, LoopWorkspace& work,
               const LoopWorkspace::Factor& factor) {
  std::copy(work.delta.begin(), work.delta.end(), work.trial.begin());
  apply_change(state, 1, work, factor);
  double scale = 1;
  while (scale > least_scale) {
    const double now = elastic_energy(state, soft, work);
    if (now < energy) {
      energy = now;
      return scale;
    }
    scale /= 2;
    apply_change(state, -scale, work, factor);
  }
  apply_change(state, -scale, work, factor);
  std::copy(work.trial.begin(), work.trial.end(), work.delta.begin());
  return 0;
}

/// Lets rods that gave be rigid again, where they fit together. Pushes are in the matrix then, so that it
/// converges fast where rods that give crawl. Returns whether it does; otherwise all is as it was.
bool harden(LoopState& state, LoopWorkspace& work, Tally& counters) {
  LoopWorkspace::Factor& factor = work.factor(true);
  std::copy(work.delta.begin(), work.delta.end(), work.trial.begin());
  std::copy(state.mu.begin(), state.mu.end(), work.mu_start.begin());
  for (double last = most_hardened; true;) {
    factorize_newton(state, 1, 0, work, factor);
    const double change = find_newton_change(state, 1, 0, work, factor);
    ++counters.newton;
    if (!(change <= hardening_rate * last)) break;
    apply_change(state, 1, work, factor);
    if (change <= hardened_change) {  // where rods do not fit, it stands still there
      if (largest_misfit(state, work, factor) <= hardened_change) return true;
      break;
    }
    last = change;
  }
  std::copy(work.trial.begin(), work.trial.end(), work.delta.begin());
  std::copy(work.mu_start.begin(), work.mu_start.end(), state.mu.begin());
  return false;
}

/// Rods give in the search for a substep.
class Search {
 public:
  Search(LoopState& state, bool bounded, LoopWorkspace& work, Tally& counters)
      : state_(state),
        work_(work),
        counters_(counters),
        bounded_(bounded),
        may_harden_(bounded && !state.topology->any()),
        least_crawling_(state.laws.any() ? crawling_cables : crawling_change) {}

  Given run() {
    std::copy(work_.delta.begin(), work_.delta.end(), work_.start.begin());
    if (bounded_) draw_cables();
    work_.draws_cables = bounded_;
    const bool converged = iterate();
    work_.draws_cables = false;
    if (converged) return end(true);
    if (is_rigid_) return Given::rigid;
    std::copy(work_.start.begin(), work_.start.end(), work_.delta.begin());
    // Stiff rods make the minimum a narrow, winding valley. Softer ones lead into it.
    const std::uint64_t before = counters_.newton;
    const auto left = [&] { return most_soft_iterations - static_cast<int>(counters_.newton - before); };
    double soft = softest;
    while (soft > stiffest &&
           minimize(soft, soft == softest ? left() : std::min(left(), most_stiffer_iterations)))
      soft *= next_stiffer;
    return is_rigid_ ? Given::rigid : end(soft < softest);
  }

 private:
  /// Cables that are hardly slack begin as taut ones, those that give by their law, too.
  void draw_cables() {
    if (!state_.laws.any()) return;
    for (std::uint32_t k = 0; k < state_.topology->rods.size(); ++k)
      if (state_.laws.is_one_sided(k)) state_.mu[k] = std::min(state_.mu[k], -drawn_cable);
  }

  Given end(bool found) {
    if (!found) ++counters_.unsolved;
    if (!std::isfinite(elastic_energy(state_, stiffest, work_))) return Given::nothing;
    if (found && may_harden_) is_rigid_ = harden(state_, work_, counters_);
    return is_rigid_ ? Given::rigid : Given::elastic;
  }

  /// Tries rigid rods after a small change that crawls after the one before.
  bool hardens(double change, double last) {
    if (!may_harden_ || change > least_crawling_ || change <= crawling_rate * last) return false;
    least_crawling_ = next_hardening * change;
    is_rigid_ = harden(state_, work_, counters_);
    return is_rigid_;
  }

  /// Iterates on displacements and multipliers together, as where rods are rigid. Multipliers are then those
  /// that fit changes, and not those of what curved ways leave of lengths, which stiff rods would make large.
  /// Returns whether it converges to rods that give.
  bool iterate() {
    LoopWorkspace::Factor& factor = work_.factor(true);
    double last = std::numeric_limits<double>::infinity();
    ChangeShare share;
    Progress progress(bounded_ ? bounded_patience : elastic_patience);
    for (int i = 0; i < most_joint_iterations; ++i) {
      factorize_newton(state_, 1, stiffest, work_, factor);
      const double change = find_newton_change(state_, 1, stiffest, work_, factor);
      ++counters_.newton;
      if (!std::isfinite(change) || (i == 0 && change > farthest)) return false;
      if (!progress.goes_on(change)) break;
      const double made = state_.laws.any() ? share.next(change / last) : 1;
      apply_change(state_, made * std::min(1.0, most_change / change), work_, factor);
      if (made == 1 && change <= elastic_change) return true;
      if (hardens(change, last)) return false;
      last = change;
    }
    return last <= near_change;
  }

  /// Changes displacements until the energy of rods of this softness is least, or near enough for stiffer
  /// ones to follow. Returns whether it is, with rods that give.
  ///
  /// Whatever the multipliers, Newton's change goes down: they are but in the matrix. Where rods have just
  /// become stiffer -C/softness is many times what they pull. So multipliers go along with displacements.
  bool minimize(double soft, int most) {
    LoopWorkspace::Factor& factor = work_.factor(true);
    const bool is_last = next_stiffer * soft <= stiffest;
    const double motion = energy_of_motion(state_, work_);
    const bool carries = state_.tackles.empty() && state_.twists.empty();
    const double first = elastic_energy(state_, soft, work_);
    double energy = first, made = 1;
    // Where softer rods came to rest, rigid ones are but a few iterations away.
    if (is_last && may_harden_ && last_change_ <= least_crawling_) {
      is_rigid_ = harden(state_, work_, counters_);
      if (is_rigid_) return false;
    }
    double& change = last_change_;
    change = std::numeric_limits<double>::infinity();
    for (int i = 0; i < most; ++i) {
      const bool is_lost = bounded_ && made < least_carried;
      if (!carries || is_lost || (i == 0 && soft == softest)) set_elastic_multipliers(state_, soft, work_);
      factorize_newton(state_, 1, soft, work_, factor);
      const double last = change;
      change = find_newton_change(state_, 1, soft, work_, factor);
      ++counters_.newton;
      const double before = energy;
      made = descend(state_, soft, energy, work_, factor);
      // What no step along the direction makes better is a minimum, to rounding.
      if (change <= elastic_change || made == 0) return std::isfinite(energy);
      const double least = least_gain * std::max(motion, first - energy);
      const bool is_near = bounded_ && made == 1 && change <= near_softer;
      if (!is_last && (is_near || before - energy <= made * least)) return true;
      if (soft <= hardest && hardens(change, last)) return false;
    }
    return change <= near_change;
  }

  LoopState& state_;
  LoopWorkspace& work_;
  Tally& counters_;
  bool bounded_;           ///< Frames are.
  bool may_harden_;        ///< Rigid rods may be tried.
  double least_crawling_;  ///< They are where changes crawl that are no larger.
  double last_change_ = std::numeric_limits<double>::infinity();  ///< The last search for a minimum made it.
  bool is_rigid_ = false;                                         ///< They were solved.
};

}  // namespace

Given let_rods_give(LoopState& state, bool bounded, LoopWorkspace& work, Tally& counters) {
  return Search(state, bounded, work, counters).run();
}

}  // namespace plumb::detail
