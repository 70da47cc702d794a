#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "contact/rows.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

/// Returns whether most contacts are new, and many. Sweeps from nothing first push what falls together
/// against each other, and friction turns that into a strain that takes hundreds of sweeps to go.
bool are_cold(std::span<const ClusterRows::Row> rows) {
  std::size_t all = 0, held = 0;
  for (const ClusterRows::Row& row : rows)
    if (row.kind == ClusterRows::Kind::normal) {
      ++all;
      held += row.held;
    }
  return all > few_touching && 2 * held < all;
}

}  // namespace

/// Sweeps positions until what is left is small, comes no closer or waits for corrections. Returns the
/// largest change that is left, in m or rad, and adds to `sweeps`.
double ClusterStepper::sweep(int correction, int& sweeps) {
  // A correction may have changed contacts too little to matter. Sweeping then would only disturb
  // constraints again.
  if (is_wide_) begin_free<&Row::p>();
  double left = correction == 0 && !rows_.empty() ? INFINITY : sweep_positions<Sweep::looks>();
  const bool is_late = correction >= most_turning_sweeps && (is_crowded() || turns());
  if (left <= (is_late ? left_by_sweeps : 1) * still_) return left;
  if (rounds_.is_over) return rounds_.left;
  const bool is_thorough = has_nets_ || !round_contacts_.empty();
  const int most = is_thorough && !is_crowded() ? most_sweeps_on_net : rounds_.most;
  if (is_wide_) return sweep_freely<&Row::p>(still_, rough, most, sweeps);
  if (correction == 0 && !has_nets_ && are_cold(rows_)) {
    friction_waits_ = true;
    sweep_on<&Row::p>(left_by_sweeps * still_, most_cold_sweeps, sweeps_alone, sweeps);
    friction_waits_ = false;
  }
  left = sweep_positions<Sweep::pushes>();
  const double till = std::max(still_, (is_thorough ? rough_on_net : rough) * left);
  ++sweeps;
  const bool are_many = rows_.size() > several_rows;
  const int alone = correction > 0 && are_many && !is_thorough ? 1 : sweeps_alone;
  if (left > till) left = sweep_on<&Row::p>(till, most - 1, alone, sweeps);
  if (left > till && are_many)
    rounds_.follow(most, left, (is_crowded() ? close_enough : 1) * settings_.tolerance);
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake || island.sides.empty()) continue;
    apply(island, island.d);
    island.ground.follow_change(island.d);
  }
  return left;
}

/// Moves an island by one of Newton's steps. Returns false if it cannot.
bool ClusterStepper::correct(Island& island, int correction, Progress& progress, Tally& report) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const bool on_ground = !island.ground.is_empty();
  for (std::size_t k = 0; k < state.x.size(); ++k) island.there[k] = state.x[k] + island.d[k];
  if (linkage.constraints() == 0 && state.laws.empty() && !on_ground) return true;
  const std::span<double> right = island.right();
  std::fill(right.begin(), right.end(), 0.0);
  double violation =
      std::max(linkage.violations(island.there, state.lengths.squares(), right), elastic_misfit(island));
  if (island.theta > 0) violation = std::max(violation, add_lag(island));
  const double wanted = island.theta == 0.5 ? exact_if_mid : state.laws.empty() ? exact : exact_if_elastic;
  progress.violation = std::max(progress.violation, violation);
  progress.to_do = std::max(progress.to_do, violation / wanted);
  if (on_ground) {
    if (correction < gaps_follow_for) island.ground.follow_gaps(state, island.there);
    island.ground.look(linkage, island.d, correction < bounds_follow_for);
  }
  const bool lacks = on_ground && island.ground.lack() > ground_enough;
  progress.lacks = progress.lacks || lacks;
  if (violation <= wanted && !lacks) return true;
  if (!std::isfinite(violation)) return false;
  ++report.newton;
  if (island.theta == 0.5 && violation > good_share * std::exchange(island.last_violation, violation))
    turn_anew(island);
  if (on_ground) {
    if (!correct_on_ground(island)) return false;
  } else {
    state.solve(island.unknowns);
    take_lag(island, 1);
    pull_elastics(island, 1);
    island.take_pulls(island.pulls, 1, 1);
    island.step.resize(linkage.movable());
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
      island.step[k] = linkage.taken(right, k);
      island.d[k] += island.step[k];
      island.there[k] = state.x[k] + island.d[k];
    }
    take_turning(island, island.step);
  }
  if (!island.sides.empty() && !is_wide_) see(island, island.d);
  return true;
}

namespace {

/// Sees whether what is left of something becomes less.
class Closing {
 public:
  /// Takes what is left after one more correction.
  void see(double left) {
    idle_ = left < much_better * least_ ? 0 : idle_ + 1;
    least_ = std::min(least_, left);
  }
  bool goes_on() const { return idle_ < most_idle; }

 private:
  double least_ = INFINITY;
  int idle_ = 0;  ///< corrections since it was much less
};

}  // namespace

/// Returns whether islands press each other, or what has loops presses ground, in so many places that they
/// are a crowd from now on. That is known from the first sweeps and from where nets would go without contact,
/// so that what falls together is not solved first.
bool ClusterStepper::presses_as_crowd() const {
  std::ptrdiff_t pressed = std::count_if(rows_.begin(), rows_.end(), [](const Row& row) {
    return row.kind == Kind::normal && row.p > 0 && kind_of(row.key) == KeyKind::island;
  });
  for (std::uint32_t i = 0; i < count_; ++i)
    if (const Island& island = islands_[i]; island.awake && island.state->linkage->has_loops())
      island.ground.for_all([&](const GroundContact& each) {
        pressed += each.gap + dot(each.normal, each.at.of(island.d)) < 0;
      });
  return static_cast<std::size_t>(pressed) > few_touching;
}

bool ClusterStepper::solve_positions(Tally& report) {
  bool any_ground = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.sides.empty() && !is_wide_) see(island, island.d);
    any_ground = any_ground || !island.ground.is_empty();
  }
  if (is_wide_) begin_free<&Row::p>();
  if (kept_of_overlaps_ < 1) find_yielding();
  push_held();
  if (is_wide_) end_free<&Row::p>();
  double last = INFINITY, last_to_do = INFINITY, first = 0;
  int sweeps = 0;
  const bool is_disturbed = any_ground || !round_contacts_.empty() || is_crowded() || kept_of_overlaps_ < 1;
  const int most = is_disturbed ? most_ground_corrections : most_corrections;
  Closing closing;
  bool is_patient = false;
  for (int correction = 0; correction < (is_patient ? most_patient_corrections : most); ++correction) {
    if (correction < gaps_follow_for) follow_gaps();
    if (correction <= 1) rounds_ = {.most = correction == 0 || is_wide_ ? most_sweeps : most_sweeps / 4};
    const double left = sweep(correction, sweeps);
    closing.see(left);
    is_patient = closing.goes_on() && last <= 10 * exact && correction + 1 < most_patient_corrections;
    found_crowd_ = correction == 0 && looks_for_crowd_ && presses_as_crowd();
    if (found_crowd_) return false;
    Progress now;
    for (std::uint32_t i = 0; i < count_; ++i)
      if (islands_[i].awake && !correct(islands_[i], correction, now, report)) return false;
    renew_responses();
    const bool is_finished = now.to_do <= 1 || now.to_do > 0.5 * last_to_do;
    if (now.violation <= exact && is_finished && !now.lacks &&
        (left <= left_by_sweeps * still_ || rounds_.is_over ||
         (correction + 1 >= most / 2 && !is_patient && left <= settings_.tolerance))) {
      report.block_sweeps += static_cast<std::uint64_t>(sweeps);
      swept_left_ = left;
      return true;
    }
    if (correction == 0) first = now.violation;
    // Contacts that come and go disturb constraints for a while.
    const bool gets_worse = is_disturbed
                                ? correction > 1 && now.violation > std::max(most_disturbed, 4 * first)
                                : correction > 3 && now.violation > std::max(exact, 0.9 * last);
    if (now.violation > 0.5 || gets_worse) return false;
    last = now.violation;
    last_to_do = now.to_do;
  }
  return false;
}

}  // namespace plumb::detail
