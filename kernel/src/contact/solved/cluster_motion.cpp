#include <algorithm>
#include <cmath>
#include <span>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"
#include "math/elementary.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

/// Returns whether velocities at the end of a substep of h (s) have no more energy than its displacements
/// (m), gravity, and anchors that move may give. Where anchors ask for what rods in one line cannot do until
/// they break, what fits nearly goes far aside.
bool are_sound(const LinkageState& state, std::span<const Vec3> v, std::span<const Vec3> d, double h) {
  const Linkage& linkage = *state.linkage;
  if (!linkage.breaks() || state.lengths.move()) return true;
  double fastest = 0;
  for (std::size_t k = linkage.movable(); k < state.v.size(); ++k)
    fastest = std::max(fastest, norm(state.v[k]));
  if (fastest == 0) return true;
  fastest += h * norm(linkage.gravity());
  const double given = linkage.kinetic(d) / (h * h) + linkage.mass() * fastest * fastest;
  return linkage.kinetic(v) <= most_aside * given;
}

}  // namespace

// Lays down what velocities follow from: Island::impulse and the pushes on its sides.
void ClusterStepper::fill_velocities(Island& island) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = island.right();
  state.rates(state.v, linkage.fixed_ones(), right);
  hold_elastics(island);
  linkage.put(island.impulse, right);
  add_pushes(island);
}

/// Lets velocities follow anchors and lengths that change their speed, where positions are those of both
/// ends. Rods are as long then as at the substep's end.
void ClusterStepper::begin_given(Island& island, double h) {
  LinkageState& state = *island.state;
  state.lengths.follow(now_);
  if (island.theta == 0.5) flight_.follow_anchors(state);
  state.lengths.follow(now_ + h);
}

// Finds velocities along the constraints where the island is now, with cables that let go.
void ClusterStepper::find_velocities(Island& island) {
  if (!island.ground.is_empty()) return find_velocities_on_ground(island);
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  do {
    fill_velocities(island);
    state.solve(island.unknowns);
    island.take_pulls(island.end_pulls, 0, 1);
  } while (let_go_at_end(island));
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] = linkage.taken(island.right(), k);
  if (linkage.is_redundant()) state.correct_velocities(island.v, island.unknowns, island.end_pulls);
}

void ClusterStepper::finish(double h, bool touched) {
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) std::swap(islands_[i].state->x, islands_[i].there);  // there: where it was
  follow_round();
  renew_levers();
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    LinkageState& state = *island.state;
    const Linkage& linkage = *state.linkage;
    if (island.theta > 0 && end_turned(island, h, touched)) continue;
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] = (1 / h) * island.d[k];
    if (!island.ground.is_empty()) {
      island.ground.follow_round(state);
      island.ground.begin_velocities();
    } else if (state.laws.empty())
      state.factor();
    if (linkage.has_air() || !state.laws.empty())
      linkage.forces(state.x, island.v, state.force, island.force);
    state.add_motors(island.force);
    island.impulse.resize(linkage.movable());
    state.momenta(island.v, island.impulse);
    for (std::uint32_t k = 0; island.theta == 0 && k < linkage.movable(); ++k)
      island.impulse[k] += (0.5 * h) * island.force[k];
    end_elastics(island, h);
    island.push.assign(island.batches(), Lanes{});
    if (!island.sides.empty() && touched) continue;
    find_velocities(island);
    if (!island.ground.is_empty() || are_sound(state, island.v, island.d, h)) continue;
    std::fill(island.end_pulls.begin(), island.end_pulls.end(), 0.0);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] = (1 / h) * island.d[k];
  }
}

// Pushes act along the constraints where the islands are now; the responses of where they were only lead
// there, in a few rounds.
void ClusterStepper::bounce(double h) {
  // Where the substep ends, elastics that it resolves do not hold what is pushed.
  find_responses(true);
  // What pushed at the end of the last substep, if the row was there then and pushes in this one. Else, at
  // rest, what pushes in the second half is what pushed in the first. What was hit is pushed less.
  const double share = rests_ ? 1 : 0.5;
  bool pushes = false;  // rows of a contact follow their normal
  for (Row& row : rows_) {
    if (!row.follows_normal()) pushes = row.p != 0;
    const bool lasts = row.kind != Kind::brake && row.bounce == 0;
    // Gradient new has pushed all it is to push by then.
    const bool is_over = islands_[row.island[0]].theta == 1;
    if (!row.held || !pushes) row.q = lasts && !is_over ? share * row.p / h : 0;
  }
  lay_pushes();
  const double enough = still_ / h;
  for (int round = 0; round < most_rounds; ++round) {
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (island.sides.empty()) continue;
      find_velocities(island);
      if (!is_wide_) see(island, island.v);
    }
    if (renew_responses()) lay_pushes();
    if (is_wide_) begin_free<&Row::q>();
    const double left = sweep_velocities<Sweep::looks>();
    if (left <= enough) return;
    const bool is_last = round + 1 == most_rounds;
    if (is_wide_) {
      int sweeps = 0;
      sweep_freely<&Row::q>(enough, is_last ? 0 : rough, most_sweeps, sweeps);
      lay_pushes();
      continue;
    }
    const double till = is_last ? enough : std::max(enough, rough * left);
    int sweeps = 0;
    sweep_on<&Row::q>(till, most_sweeps, sweeps_alone, sweeps);
  }
  for (std::uint32_t i = 0; i < count_; ++i)
    if (!islands_[i].sides.empty()) find_velocities(islands_[i]);
}

void ClusterStepper::brake(Island& island, double h) {
  const Linkage& linkage = *island.state->linkage;
  if (linkage.drag() != 0) {
    const double kept = linkage.kept(0.5 * h);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] = kept * island.v[k];
  }
  linkage.brake_joints(h, island.state->x, island.v, island.rigid);
}

double ClusterStepper::energy() const {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (!island.awake) continue;
    const LinkageState& state = *island.state;
    sum += state.linkage->kinetic(state.v) + state.linkage->potential(state.x, state.force);
  }
  return sum;
}

/// Finds what islands do as rigid wholes, which is nothing for those that hang somewhere. Returns the kinetic
/// energy of the rest, J.
double ClusterStepper::find_rigid_motion() {
  double loose = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    const Linkage& linkage = *island.state->linkage;
    island.rigid.assign(linkage.movable(), Vec3{});
    if (linkage.is_grounded()) {
      std::fill(island.rigid.begin(), island.rigid.end(), island.state->velocity_of_anchors());
      island.impulse.resize(linkage.movable());
      for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.impulse[k] = island.v[k] - island.rigid[k];
      loose += linkage.kinetic(island.impulse);
    } else if (linkage.movable() > 1)
      loose += linkage.split(island.state->x, island.v, island.rigid);
    else
      island.rigid[0] = island.v[0];
  }
  return loose;
}

/// Scales the part of the motion that is not rigid.
void ClusterStepper::scale_loose_motion(double by) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    for (std::uint32_t k = 0; k < island.state->linkage->movable(); ++k)
      island.v[k] = island.rigid[k] + by * (island.v[k] - island.rigid[k]);
  }
}

/// Takes energy (J) from all motion, which has `moving`, but for what is common to all: what flies keeps its
/// momentum and angular momentum. If pushing it apart has stretched more than the rest has, that stops, and
/// what is left of the excess stays.
void ClusterStepper::slow_all(double excess, double moving) {
  find_common_motion();
  double rest = moving;
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) rest -= islands_[i].state->linkage->kinetic(islands_[i].rigid);
  scale_loose_motion(rest > excess ? std::sqrt(1 - excess / rest) : 0);
}

/// Returns by how much a row has opened in the substep, in m or rad.
double ClusterStepper::opened(const Row& row) const {
  double out = -row.given;
  for (std::uint32_t k = 0; k < row.ends; ++k) {
    const Island& island = islands_[row.island[k]];
    const Side& side = island.sides[row.side[k]];
    out += dot(side.along_a, island.of(side.a, island.d)) + dot(side.along_b, island.of(side.b, island.d));
  }
  return out;
}
double ClusterStepper::opened(const Island& island, const GroundContact& contact) {
  return dot(contact.normal, contact.at.of(island.d) - contact.more->carried);
}

/// Returns the work (J) of what has ended overlaps in the substep, which lifts what lies in something.
double ClusterStepper::work_of_recovery() const {
  double sum = 0;
  for (const Row& row : rows_)
    if (row.p > 0 && row.gap < 0)
      sum += row.p * std::clamp(opened(row), 0.0, -row.gap) / islands_[row.island[0]].kick;
  for (std::uint32_t i = 0; i < count_; ++i)
    islands_[i].ground.for_kept([&](const GroundContact& contact, Vec3 position, Vec3) {
      const double most = std::max(0.0, -contact.gap);
      sum += dot(position, contact.normal) * std::clamp(opened(islands_[i], contact), 0.0, most) /
             islands_[i].kick;
    });
  return sum;
}

namespace {

/// Returns the height (m) of an island that is as high as its largest rod at least. What is left of lengths
/// adds up along it.
double height_of(const ClusterIsland& island) {
  const Vec3 g = island.state->linkage->gravity(), size = island.bounds.high - island.bounds.low;
  const double high = std::abs(g.x) * size.x + std::abs(g.y) * size.y + std::abs(g.z) * size.z;
  return std::max(island.state->linkage->size(), high / norm(g));
}

/// What is awake has these energies (J) with its new velocities, and these forces.
struct Account {
  double now = 0, moving = 0;
  double weight = 0;  ///< J, what it takes to lift all by its height
  double pulls = 0;   ///< N, what it takes to lift all
  double blow = 0;    ///< J, see LinkageState::most_of_blow()
  bool flies_freely = true, driven = false;
  bool is_open = false;  ///< what is given does work that is not known well enough
};

Account account_of(std::span<const ClusterIsland> islands, bool touched) {
  Account out;
  for (const ClusterIsland& island : islands) {
    if (!island.awake) continue;
    const LinkageState& state = *island.state;
    const double kinetic = state.linkage->kinetic(island.v), pull = island.pull();
    out.moving += kinetic;
    out.weight += pull * height_of(island);
    out.pulls += pull;
    out.now += kinetic + state.linkage->potential(state.x, state.force);
    out.flies_freely = out.flies_freely && !state.linkage->has_air() && island.theta == 0;
    out.driven = out.driven || state.is_driven();
    if (state.is_driven()) out.blow += state.most_of_blow();
    // Work of what is given is not known well enough beside elastics, and where gradients are not old.
    if (state.trades_energy() || (out.driven && (touched || island.theta != 0 || state.linkage->has_air())))
      out.is_open = true;
  }
  return out;
}

}  // namespace

// Returns whether the substep may stand as it is or with less motion. Energy is that of the states with their
// new velocities still apart, in Island::v.
//
// It returns false if more energy was gained than half of the motion has, and than ending overlaps may have
// lifted.
// If no shorter substep is to be tried, all motion stops instead but what is common to what flies.
bool ClusterStepper::guard_energy(double before, double recovered, bool touched, bool can_shorten,
                                  Tally& report) {
  if (keeps_energy()) return true;
  const auto [now, moving, weight, pulls, blow, flies_freely, driven, is_open] =
      account_of({islands_.data(), count_}, touched);
  const bool free = flies_freely && count_ == 1 && !touched;
  if (!std::isfinite(now) && can_shorten) return false;
  for (std::uint32_t i = 0; i < count_; ++i)
    if ((!free || driven) && !islands_[i].state->trades_energy()) islands_[i].state->energy.reset();
  if (is_open || moving == 0) return true;
  LinkageState& first = *islands_[0].state;
  if (free && !driven && !first.energy) first.energy = before;
  const double wanted = free && !driven ? *first.energy : before;
  double excess = now - wanted;
  if (excess < 0) excess = std::min(0.0, excess + blow);
  if (excess <= 0 && !free) return true;
  // What a cable that comes taut takes is not given back.
  if (excess <= 0 && islands_[0].comes_taut()) {
    first.energy.reset();
    return true;
  }
  if (std::abs(excess) <= 1e-15 * std::abs(now)) return true;

  // What sweeps leave of positions may lift what rests, too. No motion has that energy.
  const double lifted = rests_ ? swept_left_ * pulls : 0;
  const double unseen = recovered + unnoticed * weight + (rests_ ? left_by_sweeps * still_ * pulls : 0);
  // Energy is taken from the motion that is not a rigid whole's first. If that is not enough, it is taken
  // from all.
  const double loose = find_rigid_motion();
  const double by = std::sqrt(1 - excess / loose);
  if (by >= 0.5 && by * by <= 1.5) {
    scale_loose_motion(by);
  } else if (touched && !driven && excess <= lifted) {
    slow_trembling(excess);
  } else if (excess > (free ? let_be * moving : 0)) {
    const bool lifts = excess > most_lifting * (driven ? loose : moving) + unseen;
    if (lifts && can_shorten) return false;
    is_stopped_ = is_stopped_ || lifts;
    driven ? scale_loose_motion(by > 0 ? by : 0) : slow_all(excess, moving);
  } else {
    return true;
  }
  // In flight it is given back as often as it is taken. What rests gains shares of next to nothing.
  if (excess > 0 && !free) {
    const bool is_of_contact = touched && excess > gained * moving + unseen;
    ++(is_of_contact ? report.guarded_energy : report.trimmed_energy);
  }
  return true;
}

void ClusterStepper::keep_contacts(double h) {
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].state->kept.clear();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    const bool resists = row.kind == Kind::rolling && r > 0 && rows_[r - 1].kind != Kind::rolling;
    if (row.follows_normal() ? !resists || rows_[row.normal].p == 0 : row.p == 0) continue;
    LinkageState& state = *islands_[row.island[0]].state;
    const auto pushed = [&](double Row::*of) {
      if (row.kind != Kind::normal && !resists) return Vec3{row.*of, 0, 0};
      return row.*of * row.along + rows_[r + 1].*of * rows_[r + 1].along +
             rows_[r + 2].*of * rows_[r + 2].along;
    };
    state.kept.push_back({row.key, (1 / (h * h)) * pushed(&Row::p), (2 / h) * pushed(&Row::q)});
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    LinkageState& state = *islands_[i].state;
    state.on_ground = !islands_[i].ground.is_empty();
    islands_[i].ground.for_kept([&](const GroundContact& contact, Vec3 position, Vec3 end) {
      state.kept.push_back({contact.key, (1 / (h * h)) * position, (2 / h) * end});
    });
  }
  find_pushed_out(h);
}

/// Notes which islands are pushed out of what they overlap. That is no part of their velocities, which may be
/// nothing meanwhile. What is squeezed from both sides is pushed and goes nowhere, so it does not count.
void ClusterStepper::find_pushed_out(double h) {
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].state->is_pushed_out = false;
  const double enough = -std::min(1.0, h * recovery_rate_) * std::max(settings_.slop, settings_.tolerance);
  const double opening = -0.5 * kept_of_overlaps_;  // What yields opens by a share.
  const auto opens = [opening](double gap, double by) { return by > opening * gap; };
  for (const Row& row : rows_) {
    if (row.kind != Kind::normal || row.p <= 0 || row.gap >= enough || !opens(row.gap, opened(row))) continue;
    for (std::uint32_t k = 0; k < row.ends; ++k) islands_[row.island[k]].state->is_pushed_out = true;
  }
  for (std::uint32_t i = 0; i < count_; ++i)
    islands_[i].ground.for_kept([&](const GroundContact& contact, Vec3, Vec3) {
      if (contact.gap < enough && opens(contact.gap, opened(islands_[i], contact)))
        islands_[i].state->is_pushed_out = true;
    });
}

/// Finds the change of a position that no longer matters in a substep of h (s). What sweeps leave of things
/// that rest is a speed that friction near its bound takes long to stop, and pushes of the last substep need
/// few sweeps there.
void ClusterStepper::find_stillness(double h) {
  rests_ = std::all_of(islands_.begin(), islands_.begin() + count_, [&](const Island& each) {
    return !each.awake || top_speed(*each.state) < settings_.sleep_speed;
  });
  still_ = least_still * settings_.length_scale;
  for (std::uint32_t i = 0; i < count_; ++i)
    still_ = std::max(still_, (tight_ || rests_ ? tighter : 1) * settings_.sweep_tolerance * 0.5 * h * h *
                                  norm(islands_[i].state->linkage->gravity()));
}

}  // namespace plumb::detail
