// This file sweeps the contacts of a cluster, each by what the others have pushed until then.

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

/// Returns whether anchors drive such a contact deeper.
bool ClusterStepper::is_driven_in(const Row& row) {
  return row.closes > still_ && is_held_in_ground(row);
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

/// Finds from where rows yield: from a share of what all weigh at most, since pushes that contradict each
/// other would grow, and throw what is squeezed once it gives way. What ground that moves presses yields from
/// nothing.
void ClusterStepper::find_yielding() {
  double most = 0;  // kg m
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) most += yielding_carries * islands_[i].kick * islands_[i].pull();
  if (std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.given != 0; })) most = 0;
  for (Row& row : rows_) row.from = row.held ? std::min(row.p, most) : 0;
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

/// Brings pushes of two rows, (a, b) where nothing bounds them, into a disk of this radius. What slides is
/// pushed against its motion, which pushes that are scaled alone are not where the rows' responses differ.
///
/// Of all pushes in the disk that is those which leave the least energy, (a, b) over 1 + over·m each. The
/// multiplier m is that of the last pushes, which are such in the end, after a step of Newton's method.
template <double ClusterRows::Row::*of>
void into_disk(const ClusterRows::Row& first, const ClusterRows::Row& second, double& a, double& b,
               double most) {
  constexpr double least = 1e-100;  // kg m or kg m/s, below which squares round to nothing
  const double square = a * a + b * b;
  if (square <= most * most) return;
  double size = std::sqrt(square);
  if (first.over != second.over && first.over > 0 && second.over > 0 && most > least) {
    const double a_alone = a, b_alone = b, last_a = first.*of, last_b = second.*of, over_most = 1 / most;
    const double yields = first.over * last_a * last_a + second.over * last_b * last_b;
    double multiplier = yields > 0 ? ((a - last_a) * last_a + (b - last_b) * last_b) / yields : 0;
    multiplier = std::max(multiplier, (size * over_most - 1) / std::max(first.over, second.over));
    const double keeps_a = 1 / (1 + first.over * multiplier), keeps_b = 1 / (1 + second.over * multiplier);
    a = keeps_a * a_alone;
    b = keeps_b * b_alone;
    const double now = a * a + b * b;
    multiplier += (std::sqrt(now) * over_most - 1) * now /
                  (a * a * first.over * keeps_a + b * b * second.over * keeps_b);
    // Only the ratio of both counts, since the circle is where they end.
    a = a_alone * (1 + second.over * multiplier);
    b = b_alone * (1 + first.over * multiplier);
    size = std::sqrt(a * a + b * b);
  }
  const double by = most / size;
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

/// Sets the pushes of the contact whose rows start at `r`: on to what its normal alone asks for, which may be
/// a pull that lets go, or a part of the way. `kept` is the share that stays of what holds against sliding.
///
/// What slides is pushed along the edge of Coulomb's cone: more normal push brings more friction. That may
/// move the place along the normal, too, by e times as much as the normal push does. A whole step then
/// overshoots by e. Beyond 1 steps go back and forth for ever, and with momentum beyond a third.
template <double ClusterStepper::Row::*of, ClusterStepper::Sweep sweep>
double ClusterStepper::contact(std::size_t r, double wanted, double kept) {
  Row &n = rows_[r], &s = rows_[r + 1], &t = rows_[r + 2];
  // The normal push also moves the other two rows. What does not depend on it is computed first, so that the
  // processor need not wait.
  const double first_alone = s.*of - s.over * slide<of>(s), second_alone = t.*of - t.over * slide<of>(t);
  const double square = first_alone * first_alone + second_alone * second_alone;
  const double most_now = n.bound * n.*of;
  if (square > most_now * most_now) {
    const double along = n.across[0] * s.own * first_alone + n.across[1] * t.own * second_alone;
    const double overshoot = n.bound * along / std::sqrt(square);
    if (overshoot > (has_momentum_ ? 0 : most_overshoot) * n.own)
      wanted = n.*of + n.own / (n.own + overshoot) * (wanted - n.*of);
  }
  const double normal = std::max(0.0, wanted), by0 = normal - n.*of;
  double first = friction_waits_ ? s.*of : kept * (first_alone - n.across[0] * by0);
  double second = friction_waits_ ? t.*of : kept * (second_alone - n.across[1] * by0);
  into_disk<of>(s, t, first, second, n.bound * normal);
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
  into_disk<of>(s, t, first, second, most);
  const double worst = set<of, sweep>(s, first);
  return std::max(worst, set<of, sweep>(t, second));
}

/// Returns what a normal or a limit that sees u asks for, where `whole` would end its overlap. One that
/// yields goes a part of the way there from what pushed in the last substep, or becomes hardly deeper. So
/// what carries a weight does not yield to that, substep by substep.
double ClusterStepper::wanted(const Row& row, double whole, double u) const {
  if (row.gap >= 0 || kept_of_overlaps_ == 1) return whole;
  const double from = std::min(yielding_keeps * row.from, whole);
  return std::max(from + kept_of_overlaps_ * (whole - from), yielding_deeper * (row.p - row.over * u));
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
        const double to = wanted(row, row.p - row.over * row.gap - row.over * u, u);
        if (to > 0 || row.p != 0) worst = std::max(worst, contact<&Row::p, sweep>(r, to, kept));
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
        p = std::max(0.0, wanted(row, row.p - row.over * (u + row.gap), u));
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
          const double to = row.q - row.over * (slide<&Row::q>(row) - row.bounce);
          worst = std::max(worst, contact<&Row::q, sweep>(r, to, 1));
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

template double ClusterStepper::sweep_positions<ClusterStepper::Sweep::looks>();
template double ClusterStepper::sweep_positions<ClusterStepper::Sweep::pushes>();
template double ClusterStepper::sweep_velocities<ClusterStepper::Sweep::looks>();
template double ClusterStepper::sweep_velocities<ClusterStepper::Sweep::pushes>();

template <double ClusterStepper::Row::*of>
double ClusterStepper::sweep() {
  if constexpr (of == &Row::p) return sweep_positions<Sweep::pushes>();
  return sweep_velocities<Sweep::pushes>();
}

/// Goes on along the last change of pushes by `share` of it.
template <double ClusterStepper::Row::*of>
void ClusterStepper::push_on(double share) {
  for (std::size_t r = 0; r < rows_.size(); ++r) Momentum::go_on(share, rows_[r].*of, last_pushes_[r]);
}

/// Takes note of pushes.
template <double ClusterStepper::Row::*of>
void ClusterStepper::keep_pushes(Array<double>& to) const {
  for (std::size_t r = 0; r < rows_.size(); ++r) to[r] = rows_[r].*of;
}

/// Returns whether pushes turn back from where they were going.
template <double ClusterStepper::Row::*of>
bool ClusterStepper::turn_back() const {
  double back = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r)
    back += rows_[r].own * (swept_from_[r] - rows_[r].*of) * (rows_[r].*of - last_pushes_[r]);
  return back > 0;
}

#define PLUMB_INSTANTIATE(of)                                          \
  template double ClusterStepper::sweep<of>();                         \
  template void ClusterStepper::push_on<of>(double);                   \
  template void ClusterStepper::keep_pushes<of>(Array<double>&) const; \
  template bool ClusterStepper::turn_back<of>() const;
PLUMB_INSTANTIATE(&ClusterStepper::Row::p)
PLUMB_INSTANTIATE(&ClusterStepper::Row::q)
#undef PLUMB_INSTANTIATE

/// Goes on along the last change of pushes, and of what they do, by `share` of it.
template <double ClusterStepper::Row::*of>
void ClusterStepper::go_on(double share) {
  push_on<of>(share);
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    for (std::size_t k = 0; k < island.batches(); ++k)
      for (std::size_t lane = 0; lane < simd::kkt_lanes; ++lane) {
        Momentum::go_on(share, island.speed[k].of[lane], island.last_speed[k].of[lane]);
        Momentum::go_on(share, island.push[k].of[lane], island.last_push[k].of[lane]);
      }
  }
}

/// Sweeps until a sweep changes no more than `till` (m or m/s), or `most` times, and adds to `sweeps`.
/// Returns the last change.
///
/// Sweeps alone carry a push through a pile in about the square of as many as it has layers. After so many
/// they have momentum, unless it led away.
template <double ClusterStepper::Row::*of>
double ClusterStepper::sweep_on(double till, int most, int alone, int& sweeps) {
  double left = INFINITY, least = INFINITY;
  Momentum momentum;
  for (int taken = 0; taken < most && left > till; ++taken, ++sweeps) {
    if (left > thrown_off * least) rounds_.is_thrown_off = true;
    least = std::min(least, left);
    has_momentum_ = taken >= alone && !rounds_.is_thrown_off;
    if (!has_momentum_) {
      left = sweep<of>();
      continue;
    }
    if (taken == alone) {
      keep_pushes<of>(last_pushes_);
      for (std::uint32_t i = 0; i < count_; ++i) {
        islands_[i].last_speed = islands_[i].speed;
        islands_[i].last_push = islands_[i].push;
      }
    } else {
      go_on<of>(momentum.share());
    }
    keep_pushes<of>(swept_from_);
    left = sweep<of>();
    for (std::size_t r = 0; r < rows_.size(); ++r)
      left = std::max(left, rows_[r].own * std::abs(rows_[r].*of - last_pushes_[r]));
    if (turn_back<of>()) momentum.begin_anew();
  }
  has_momentum_ = false;
  return left;
}

template double ClusterStepper::sweep_on<&ClusterStepper::Row::p>(double, int, int, int&);
template double ClusterStepper::sweep_on<&ClusterStepper::Row::q>(double, int, int, int&);

}  // namespace plumb::detail
