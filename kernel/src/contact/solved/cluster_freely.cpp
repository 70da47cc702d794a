// This file finds pushes where contacts are too many for the responses of each to all others.
//
// A push first moves particles as though they were free, by Jcᵀ p / m. A sweep over contacts that does so
// takes time in proportion to them. One solve then says what the island makes of these pushes. No island
// gives way to a push by more than free particles do, P <= M⁻¹. So this is a proximal gradient method, in the
// metric of free particles, and Nesterov's extrapolation speeds it up (Beck and Teboulle 2009). It starts
// anew where pushes turn back (O'Donoghue and Candès 2015).

#include <algorithm>
#include <cmath>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Returns whether some island touches in so many places that pushes are found freely. Elastics and bodies
/// keep a cluster from that: what they couple has no free masses.
bool ClusterStepper::is_wide() const {
  bool any = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (island.sides.empty()) continue;
    if (!island.state->laws.empty() || !island.state->linkage->has_free_masses()) return false;
    any = any || island.sides.size() > most_responses;
  }
  return any;
}

double ClusterStepper::see_freely(const Row& row) const {
  double out = 0;
  for (std::uint32_t k = row.first_term; k < row.end_term; ++k)
    out += dot(free_terms_[k].along[row.axis], *free_terms_[k].motion);
  return out;
}

void ClusterStepper::push_freely(const Row& row, double by) {
  for (std::uint32_t k = row.first_term; k < row.end_term; ++k)
    *free_terms_[k].motion += (by * free_terms_[k].over_mass) * free_terms_[k].along[row.axis];
}

void ClusterStepper::push_freely(const Row& first, double by0, double by1, double by2) {
  for (std::uint32_t k = first.first_term; k < first.end_term; ++k) {
    const FreeTerm& term = free_terms_[k];
    *term.motion += term.over_mass * (by0 * term.along[0] + by1 * term.along[1] + by2 * term.along[2]);
  }
}

/// Lists the particles that the rows of a contact, or one other row, act on.
void ClusterStepper::add_free_terms(std::size_t r) {
  const auto first = static_cast<std::uint32_t>(free_terms_.size());
  const std::uint32_t axes = rows_[r].kind == Kind::normal ? 3 : 1;
  for (std::uint32_t axis = 0; axis < axes; ++axis) {
    Row& row = rows_[r + axis];
    row.axis = axis;
    for (std::uint32_t i = 0; i < row.ends; ++i) {
      Island& island = islands_[row.island[i]];
      const Linkage& linkage = *island.state->linkage;
      const auto add = [&](Sum sum, Vec3 along) {
        for (std::uint32_t k = sum.first; k < sum.end; ++k) {
          const auto [particle, weight] = island.terms[k];
          Vec3* const motion = &island.free[particle];
          auto same = std::find_if(free_terms_.begin() + first, free_terms_.end(),
                                   [&](const FreeTerm& term) { return term.motion == motion; });
          if (same == free_terms_.end()) {
            const double over = particle < linkage.movable() ? 1 / linkage.free_mass_of(particle) : 0;
            same = free_terms_.insert(same, FreeTerm{motion, over});
          }
          same->along[axis] += weight * along;
        }
      };
      const Side& side = island.sides[row.side[i]];
      add(side.a, side.along_a);
      add(side.b, side.along_b);
    }
  }
  for (std::uint32_t axis = 0; axis < axes; ++axis) {
    rows_[r + axis].first_term = first;
    rows_[r + axis].end_term = static_cast<std::uint32_t>(free_terms_.size());
  }
}

/// Finds what rows answer to a push of one where particles are free.
void ClusterStepper::find_free_responses() {
  free_terms_.clear();
  for (std::uint32_t i = 0; i < count_; ++i)
    if (!islands_[i].sides.empty()) islands_[i].free.resize(islands_[i].d.size());
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (rows_[r].kind != Kind::sliding) add_free_terms(r);
  const auto response = [&](const Row& row, std::uint32_t to) {
    double out = 0;
    for (std::uint32_t k = row.first_term; k < row.end_term; ++k)
      out += free_terms_[k].over_mass * dot(free_terms_[k].along[row.axis], free_terms_[k].along[to]);
    return out;
  };
  for (std::size_t r = rows_.size(); r-- > 0;) {
    Row& row = rows_[r];
    row.own = response(row, row.axis);
    row.over = row.own > 0 ? 1 / row.own : 0;
    for (std::uint32_t axis = 0; row.kind == Kind::normal && axis < 2; ++axis)
      row.across[axis] = rows_[r + 1 + axis].over * response(row, 1 + axis);
  }
}

/// Lays the pushes of rows on velocities on the sides of islands.
void ClusterStepper::lay_pushes() {
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].push.assign(islands_[i].batches(), Lanes{});
  for (const Row& row : rows_)
    for (std::uint32_t i = 0; i < row.ends; ++i)
      islands_[row.island[i]].push[row.side[i] / simd::kkt_lanes].of[row.side[i] % simd::kkt_lanes] += row.q;
}

/// Lets islands make of pushes on free particles what they do, and adds that to their motion.
template <double ClusterStepper::Row::*of>
void ClusterStepper::follow_free(Island& island, Array<Vec3>& motion) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = island.right();
  std::fill(right.begin(), right.end(), 0.0);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
    const Vec3 by = linkage.free_mass_of(k) * (island.free[k] - motion[k]);
    double* const at = &right[linkage.slot(k)];
    at[0] = by.x;
    at[1] = by.y;
    at[2] = by.z;
  }
  if (of == &Row::p) island.ground.keep_slopes();
  linkage.plan().solve(state.factors, island.unknowns);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) motion[k] += linkage.taken(right, k);
  if (of == &Row::p) {
    island.take_pulls(island.pulls, 1, 1);
    island.ground.follow_change(motion);
  }
}

template <double ClusterStepper::Row::*of>
Array<Vec3>& ClusterStepper::motion_of(Island& island) {
  if constexpr (of == &Row::p) return island.d;
  return island.v;
}

/// Goes on along the last change of pushes and motions by `share` of it.
template <double ClusterStepper::Row::*of>
void ClusterStepper::extrapolate(double share) {
  push_on<of>(share);
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake || island.sides.empty()) continue;
    const auto go_on = [&](auto& values, auto& last) {
      for (std::size_t k = 0; k < values.size(); ++k) Momentum::go_on(share, values[k], last[k]);
    };
    go_on(motion_of<of>(island), island.last_motion);
    if (of != &Row::p) continue;
    go_on(island.pulls, island.last_pulls);
    island.ground.follow_change(island.d);
  }
}

template <double ClusterStepper::Row::*of>
void ClusterStepper::keep_last() {
  keep_pushes<of>(last_pushes_);
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake || island.sides.empty()) continue;
    island.last_motion = motion_of<of>(island);
    island.last_pulls = island.pulls;
  }
}

template <double ClusterStepper::Row::*of>
void ClusterStepper::begin_free() {
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake && !islands_[i].sides.empty()) islands_[i].free = motion_of<of>(islands_[i]);
}

template <double ClusterStepper::Row::*of>
void ClusterStepper::end_free() {
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake && !islands_[i].sides.empty())
      follow_free<of>(islands_[i], motion_of<of>(islands_[i]));
}

/// Sweeps until a sweep of what islands make of the last one changes no more than `share` of the first one's
/// change, or than `enough`. Returns the last change, in m or m/s, and adds to `sweeps`.
template <double ClusterStepper::Row::*of>
double ClusterStepper::sweep_freely(double enough, double share, int most, int& sweeps) {
  keep_last<of>();
  double left = INFINITY, till = enough;
  Momentum momentum;
  for (int taken = 0; taken < most && left > till; ++taken) {
    if (taken > 0) extrapolate<of>(momentum.share());
    begin_free<of>();
    keep_pushes<of>(swept_from_);
    left = sweep<of>();
    for (int again = 1; again < free_passes; ++again) sweep<of>();
    end_free<of>();
    if (turn_back<of>()) momentum.begin_anew();
    if (taken == 0) till = std::max(enough, share * left);
    ++sweeps;
  }
  return left;
}

template double ClusterStepper::sweep_freely<&ClusterStepper::Row::p>(double, double, int, int&);
template double ClusterStepper::sweep_freely<&ClusterStepper::Row::q>(double, double, int, int&);
template void ClusterStepper::begin_free<&ClusterStepper::Row::p>();
template void ClusterStepper::end_free<&ClusterStepper::Row::p>();

}  // namespace plumb::detail
