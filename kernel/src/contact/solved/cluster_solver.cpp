#include <algorithm>
#include <cmath>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

void ClusterStepper::see(Island& island, std::span<const Vec3> motion) {
  double* const speed = island.speed.front().of;
  Vec3 a{}, b{};
  Sum of_a{}, of_b{};
  for (std::size_t s = 0; s < island.sides.size(); ++s) {
    const Side& side = island.sides[s];
    // Rows of a contact share sums of particles, which are computed once.
    if (side.a != of_a) a = island.of(of_a = side.a, motion);
    if (side.b != of_b) b = island.of(of_b = side.b, motion);
    speed[s] = dot(side.along_a, a) + dot(side.along_b, b);
  }
}

double ClusterStepper::see(const Row& row) {
  if (is_wide_) return see_freely(row);
  double out = row.end[0].speed[row.end[0].side];
  if (row.ends == 2) out += row.end[1].speed[row.end[1].side];
  return out;
}

template <double ClusterStepper::Row::*of>
double ClusterStepper::slide(const Row& row) {
  return see(row) - (of == &Row::p ? row.given : row.given_at_end);
}

/// Returns whether no push parts a contact that stays closed, since rods hold it along the normal.
bool ClusterStepper::is_held_in_ground(const Row& row) {
  return row.kind == Kind::normal && row.over == 0 && row.gap + slide<&Row::p>(row) < -settings_.tolerance;
}

void ClusterStepper::push(const Row& row, double by) {
  if (by == 0) return;
  if (is_wide_) return push_freely(row, by);
  for (std::uint32_t i = 0; i < row.ends; ++i) {
    const End& end = row.end[i];
    kernels_->add_three(end.speed, {by, end.coupling}, {0, end.coupling}, {0, end.coupling}, end.padded);
    end.push[end.side] += by;
  }
}

void ClusterStepper::push(const Row& first, double by0, double by1, double by2) {
  if (is_wide_) return push_freely(first, by0, by1, by2);
  for (std::uint32_t i = 0; i < first.ends; ++i) {
    const End& end = first.end[i];
    kernels_->add_three(end.speed, {by0, end.coupling}, {by1, end.coupling + end.padded},
                        {by2, end.coupling + 2 * end.padded}, end.padded);
    end.push[end.side] += by0;
    end.push[end.side + 1] += by1;
    end.push[end.side + 2] += by2;
  }
}

/// Starts with the pushes of the last substep, the three rows of a contact at once. New contacts start with
/// nothing.
void ClusterStepper::push_held() {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    if (row.kind != Kind::normal) {
      push(row, row.p);
      continue;
    }
    if (row.held) push(row, row.p, rows_[r + 1].p, rows_[r + 2].p);
    r += 2;
  }
}

namespace {

/// Scales (a, b) down to the length `most` if it is longer.
void into_disk(double& a, double& b, double most) {
  const double square = a * a + b * b;
  if (square <= most * most) return;
  const double by = most / std::sqrt(square);
  a *= by;
  b *= by;
}

}  // namespace

template <double ClusterStepper::Row::*of, ClusterStepper::Sweep sweep>
double ClusterStepper::set(Row& row, double value) {
  const double by = value - row.*of;
  if constexpr (sweep == Sweep::pushes) {
    row.*of = value;
    push(row, by);
  }
  return std::abs(by) * row.own;
}

/// Sets the normal push of the contact whose rows start at `r`, and the pushes against sliding, to what the
/// normal row asks for alone, or to a part of the way. `kept` is the share of all that stays.
///
/// What slides is pushed along the edge of Coulomb's cone: more normal push brings more friction. Where that
/// moves the place by e along the normal for each that the normal push does, a whole step overshoots by e.
/// Beyond 1 steps go back and forth for ever.
template <double ClusterStepper::Row::*of, ClusterStepper::Sweep sweep>
double ClusterStepper::contact(std::size_t r, double normal, double kept) {
  Row &n = rows_[r], &s = rows_[r + 1], &t = rows_[r + 2];
  double by0 = normal - n.*of;
  // The normal push also moves the other two rows. What does not depend on it is computed first, so that the
  // processor need not wait.
  const double first_alone = s.*of - s.over * slide<of>(s), second_alone = t.*of - t.over * slide<of>(t);
  const double square = first_alone * first_alone + second_alone * second_alone;
  const double most_now = n.bound * n.*of;
  if (square > most_now * most_now) {
    const double along = n.across[0] * s.own * first_alone + n.across[1] * t.own * second_alone;
    const double overshoot = n.bound * along / std::sqrt(square);
    if (overshoot > most_overshoot * n.own) {
      by0 *= n.own / (n.own + overshoot);
      normal = n.*of + by0;
    }
  }
  double first = kept * (first_alone - n.across[0] * by0), second = kept * (second_alone - n.across[1] * by0);
  into_disk(first, second, n.bound * normal);
  const double by1 = first - s.*of, by2 = second - t.*of;
  if constexpr (sweep == Sweep::pushes) {
    n.*of = normal;
    s.*of = first;
    t.*of = second;
    push(n, by0, by1, by2);
  }
  return std::max({std::abs(by0) * n.own, std::abs(by1) * s.own, std::abs(by2) * t.own});
}

/// Sets the two pushes against rolling whose rows start at `r`, no longer together than `most`.
template <double ClusterStepper::Row::*of, ClusterStepper::Sweep sweep>
double ClusterStepper::roll(std::size_t r, double most) {
  Row &s = rows_[r], &t = rows_[r + 1];
  double first = s.*of - s.over * see(s), second = t.*of - t.over * see(t);
  into_disk(first, second, most);
  const double worst = set<of, sweep>(s, first);
  return std::max(worst, set<of, sweep>(t, second));
}

// A contact's three rows are projected onto Coulomb's cone at once, each from where its own response leads.
// Both sweeps return the largest change that they made, or would have made. Its unit is m or rad for
// positions, and m/s or rad/s for velocities.
template <ClusterStepper::Sweep sweep>
double ClusterStepper::sweep_positions() {
  double worst = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    const double u = slide<&Row::p>(row);
    double p = 0;
    switch (row.kind) {
      case Kind::normal: {
        const double kept = row.gap < 0 ? kept_of_overlaps_ : 1;
        const double normal = kept * std::max(0.0, row.p - row.over * row.gap - row.over * u);
        if (normal > 0 || row.p != 0) worst = std::max(worst, contact<&Row::p, sweep>(r, normal, kept));
        r += 2;
        continue;
      }
      case Kind::sliding:
        continue;
      case Kind::rolling:
        worst = std::max(worst, roll<&Row::p, sweep>(r++, row.bound * rows_[row.normal].p));
        continue;
      case Kind::spinning: {
        const double most = row.bound * rows_[row.normal].p;
        p = std::clamp(row.p - row.over * u, -most, most);
        break;
      }
      case Kind::limit:
        p = (row.gap < 0 ? kept_of_overlaps_ : 1) * std::max(0.0, row.p - row.over * (u + row.gap));
        break;
      case Kind::brake:
        p = std::clamp(row.p - row.over * u, -row.bound, row.bound);
        break;
    }
    worst = std::max(worst, set<&Row::p, sweep>(row, p));
  }
  return worst;
}

template <ClusterStepper::Sweep sweep>
double ClusterStepper::sweep_velocities() {
  double worst = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    double q = 0;
    switch (row.kind) {
      case Kind::normal:
        if (row.p > 0) {
          const double normal = std::max(0.0, row.q - row.over * (slide<&Row::q>(row) - row.bounce));
          worst = std::max(worst, contact<&Row::q, sweep>(r, normal, 1));
        }
        r += 2;
        continue;
      case Kind::sliding:
        continue;
      case Kind::rolling:
        worst = std::max(worst, roll<&Row::q, sweep>(r++, row.bound * rows_[row.normal].q));
        continue;
      case Kind::spinning: {
        const double most = row.bound * rows_[row.normal].q;
        q = std::clamp(row.q - row.over * see(row), -most, most);
        break;
      }
      case Kind::limit:
        if (row.p <= 0) continue;
        q = std::max(0.0, row.q - row.over * (see(row) - row.bounce));
        break;
      case Kind::brake:
        q = std::clamp(row.q - row.over * see(row), -row.bounce, row.bounce);
        break;
    }
    worst = std::max(worst, set<&Row::q, sweep>(row, q));
  }
  return worst;
}

template double ClusterStepper::sweep_velocities<ClusterStepper::Sweep::looks>();
template double ClusterStepper::sweep_velocities<ClusterStepper::Sweep::pushes>();

/// Sweeps positions until what is left is small or waits for corrections. Returns the largest change that is
/// left, in m or rad, and adds to `sweeps`.
double ClusterStepper::sweep(int correction, int& sweeps) {
  // A correction may have changed contacts too little to matter. Sweeping then would only disturb
  // constraints again.
  if (is_wide_) begin_free<&Row::p>();
  double left = correction == 0 && !rows_.empty() ? INFINITY : sweep_positions<Sweep::looks>();
  const bool is_late = correction >= most_turning_sweeps && (is_crowded() || turns());
  if (left <= (is_late ? 10 : 1) * still_) return left;
  const int most = correction == 0 || is_wide_ ? most_sweeps : most_sweeps / 4;
  if (is_wide_) return sweep_freely<&Row::p>(still_, rough, most, sweeps);
  left = sweep_positions<Sweep::pushes>();
  const double till = std::max(still_, rough * left);
  int taken = 1;
  for (; taken < most && left > till; ++taken) left = sweep_positions<Sweep::pushes>();
  sweeps += taken;
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
  if (on_ground) island.ground.look(linkage, island.d, correction < bounds_follow_for);
  const bool lacks = on_ground && island.ground.lack() > ground_enough;
  progress.lacks = progress.lacks || lacks;
  if (violation <= wanted && !lacks) return true;
  if (!std::isfinite(violation)) return false;
  ++report.newton;
  if (on_ground) {
    if (!correct_on_ground(island)) return false;
  } else {
    state.solve(island.unknowns);
    take_lag(island, 1);
    pull_elastics(island, 1);
    island.take_pulls(island.pulls, 1, 1);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
      island.d[k] += linkage.taken(right, k);
      island.there[k] = state.x[k] + island.d[k];
    }
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

bool ClusterStepper::solve_positions(Tally& report) {
  bool any_ground = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.sides.empty() && !is_wide_) see(island, island.d);
    any_ground = any_ground || !island.ground.is_empty();
  }
  if (is_wide_) begin_free<&Row::p>();
  push_held();
  if (is_wide_) end_free<&Row::p>();
  double last = INFINITY, last_to_do = INFINITY, first = 0;
  int sweeps = 0;
  const bool is_disturbed = any_ground || is_crowded() || kept_of_overlaps_ < 1;
  const int most = is_disturbed ? most_ground_corrections : most_corrections;
  Closing closing;
  bool is_patient = false;
  for (int correction = 0; correction < (is_patient ? most_patient_corrections : most); ++correction) {
    const double left = sweep(correction, sweeps);
    closing.see(left);
    is_patient = closing.goes_on() && last <= 10 * exact && correction + 1 < most_patient_corrections;
    found_crowd_ = correction == 0 && looks_for_crowd_ && presses_as_crowd();
    if (found_crowd_) return false;
    Progress now;
    for (std::uint32_t i = 0; i < count_; ++i)
      if (islands_[i].awake && !correct(islands_[i], correction, now, report)) return false;
    const bool is_finished = now.to_do <= 1 || now.to_do > 0.5 * last_to_do;
    if (now.violation <= exact && is_finished && !now.lacks &&
        (left <= 10 * still_ || (correction + 1 >= most / 2 && !is_patient && left <= settings_.tolerance))) {
      report.block_sweeps += static_cast<std::uint64_t>(sweeps);
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
