#include "contact/linkage/flight.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace plumb::detail {
namespace {

/// Whether nothing turns an island as a whole.
bool keeps_spin(const LinkageState& state) {
  const Linkage& linkage = *state.linkage;
  const bool is_grabbed = linkage.first_grab() < linkage.elastics().size();
  return !linkage.is_grounded() && !is_grabbed && linkage.movable() > 1 && !linkage.has_air() &&
         std::all_of(state.force.begin(), state.force.end(), [](Vec3 force) { return force == Vec3{}; });
}

/// Constraints are kept to this share of their lengths: larger errors would hide the order.
constexpr double exact_landing = 1e-11;
constexpr int most_landings = 12;

/// A method's coefficients: of every stage those of the stages before it, and those of the end.
struct Tableau {
  std::size_t stages;
  double share[7][7];
  double end[7];
};

/// Kutta's 3/8 rule (1901) and a method of Butcher (1964). Both have their last stage at the step's end, so
/// that its factors serve there.
const Tableau& tableau(std::uint32_t order) {
  static constexpr Tableau fourth{
      4, {{}, {1.0 / 3}, {-1.0 / 3, 1}, {1, -1, 1}}, {1.0 / 8, 3.0 / 8, 3.0 / 8, 1.0 / 8}};
  static constexpr Tableau sixth{7,
                                 {{},
                                  {1.0 / 3},
                                  {0, 2.0 / 3},
                                  {1.0 / 12, 1.0 / 3, -1.0 / 12},
                                  {-1.0 / 16, 9.0 / 8, -3.0 / 16, -3.0 / 8},
                                  {0, 9.0 / 8, -3.0 / 8, -3.0 / 4, 1.0 / 2},
                                  {9.0 / 44, -9.0 / 11, 63.0 / 44, 18.0 / 11, 0, -16.0 / 11}},
                                 {11.0 / 120, 0, 27.0 / 40, 27.0 / 40, -4.0 / 15, -4.0 / 15, 11.0 / 120}};
  return order == 4 ? fourth : sixth;
}

}  // namespace

/// Adds drag and joint drag, which act by mass, to the forces of a stage.
void Flight::brake(const Linkage& linkage, const Stage& stage) {
  const std::uint32_t movable = linkage.movable();
  const bool has_joints = linkage.joint_drag() != 0 && (movable > 1 || linkage.is_grounded());
  rigid_.assign(movable, Vec3{});
  if (has_joints && !linkage.is_grounded()) linkage.split(stage.x, stage.v, rigid_);
  braked_.resize(movable);
  momentum_.resize(movable);
  const double by = has_joints ? linkage.joint_drag() : 0;
  for (std::uint32_t k = 0; k < movable; ++k)
    braked_[k] = linkage.drag() * stage.v[k] + by * (stage.v[k] - rigid_[k]);
  linkage.momenta(braked_, momentum_);
  for (std::uint32_t k = 0; k < movable; ++k) force_[k] -= momentum_[k];
}

/// Finds the accelerations of a stage by the factors there, which count for `time` (s) of the step.
void Flight::accelerate(LinkageState& state, Stage& stage, double time) {
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = numbers(unknowns_);
  linkage.bends(stage.v, right);
  linkage.forces(stage.x, stage.v, state.force, force_);
  state.add_elastic_pulls(force_);
  if (linkage.drag() != 0 || linkage.joint_drag() != 0) brake(linkage, stage);
  linkage.put(force_, right);
  state.solve(unknowns_);
  if (state.pulls.counts) count_pulls(state, stage, time);
  for (std::size_t i = 0; i < state.broken.size(); ++i) rod_impulses_[i] += time * state.elastic_pull(i);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) stage.a[k] = linkage.taken(right, k);
}

/// Adds up what constraints and elastics of a stage pull with, for `time` (s).
void Flight::count_pulls(LinkageState& state, const Stage& stage, double time) {
  const Linkage& linkage = *state.linkage;
  pulls_.assign(linkage.constraints(), 0);
  linkage.take_multipliers(numbers(unknowns_), 1, pulls_);
  linkage.count_pulls(stage.x, state.lengths.squares(), pulls_, time, state.pulls);
  for (std::size_t i = 0; i < state.laws.size(); ++i)
    linkage.count_pull(i, stage.x, time * state.elastic_pull(i), state.pulls);
  state.count_motors(time, stage.x, [&](std::size_t i) { return state.elastic_numbers[i]; });
}

/// Takes from velocities what constraints forbid where the factors are.
void Flight::take_forbidden(LinkageState& state) {
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = numbers(unknowns_);
  momentum_.resize(linkage.movable());
  linkage.momenta(state.v, momentum_);
  state.rates(state.v, linkage.fixed_ones(), right);
  linkage.put(momentum_, right);
  state.solve(unknowns_);
  pulls_.assign(state.pulls.counts ? linkage.constraints() : 0, 0);
  linkage.take_multipliers(right, 1, pulls_);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) state.v[k] = linkage.taken(right, k);
  if (linkage.is_redundant()) state.correct_velocities(state.v, unknowns_, pulls_);
  if (!state.pulls.counts) return;
  state.lengths.begin_pulls(state.pulls.rods);
  linkage.count_pulls(state.x, state.lengths.squares(), pulls_, 1, state.pulls);
  state.lengths.end_pulls(state.pulls.rods);
}

void Flight::follow_anchors(LinkageState& state) {
  const auto now = std::span(state.v).subspan(state.linkage->movable());
  if (std::equal(now.begin(), now.end(), state.anchors_went.begin()) && !state.lengths.jump()) return;
  unknowns_.assign(state.linkage->plan().columns(), simd::Quad{});
  if (state.factored || state.factor()) take_forbidden(state);
  state.keep_given();  // The rest of the substep is at the new rates.
}

/// Brings positions onto the constraints by the factors of the last stage, and velocities by those there.
bool Flight::land(LinkageState& state, Tally& report) {
  const Linkage& linkage = *state.linkage;
  const std::span<double> right = numbers(unknowns_);
  for (int i = 0;; ++i) {
    std::fill(right.begin(), right.end(), 0.0);
    const double violation = linkage.violations(state.x, state.lengths.squares(), right);
    if (violation <= exact_landing) break;
    if (!std::isfinite(violation) || i == most_landings) return false;
    ++report.newton;
    state.solve(unknowns_);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) state.x[k] += linkage.taken(right, k);
  }
  if (!state.factor()) return false;
  take_forbidden(state);
  return true;
}

bool Flight::step(LinkageState& state, std::uint32_t order, double h, Tally& report) {
  const Linkage& linkage = *state.linkage;
  const Tableau& method = tableau(order);
  const std::size_t count = state.x.size();
  before_x_ = state.x;
  before_v_ = state.v;
  if (state.pulls.counts) before_pulls_ = state.pulls;
  rod_impulses_.assign(state.broken.size(), 0);
  force_.resize(linkage.movable());
  unknowns_.assign(linkage.plan().columns(), simd::Quad{});
  const auto come = [&](const double* shares, std::size_t stages) {
    for (std::size_t k = 0; k < count; ++k) {
      Vec3 x = before_x_[k], v = before_v_[k];
      for (std::size_t s = 0; s < stages; ++s) {
        if (shares[s] == 0) continue;
        x += (h * shares[s]) * stages_[s].v[k];
        v += (h * shares[s]) * stages_[s].a[k];
      }
      state.x[k] = x;
      state.v[k] = v;
    }
  };
  bool good = state.factored || state.factor();
  if (good && linkage.is_grounded()) {  // anchors may have changed their velocity
    take_forbidden(state);
    std::copy_n(state.v.begin(), linkage.movable(), before_v_.begin());
  }
  for (std::size_t s = 0; good && s < method.stages; ++s) {
    come(method.share[s], s);
    if (s > 0) good = state.factor();
    Stage& stage = stages_[s];
    stage.x = state.x;
    stage.v = state.v;
    stage.a.assign(count, Vec3{});
    ++report.newton;
    if (good) accelerate(state, stage, h * method.end[s]);
  }
  if (good) {
    come(method.end, method.stages);
    good = land(state, report);
  }
  if (good && keeps_spin(state))
    linkage.turn_to(linkage.angular_momentum(before_x_, before_v_), state.x, state.v);
  if (good) {
    for (std::uint32_t k = 0; k < linkage.movable(); ++k)
      state.acceleration[k] = (1 / (h * h)) * (state.x[k] - before_x_[k] - h * before_v_[k]);
    state.follow_elastics(h);
    report.broken_rods += state.break_rods([&](std::size_t i) { return rod_impulses_[i] / h; });
    return true;
  }
  state.x = before_x_;
  state.v = before_v_;
  if (state.pulls.counts) state.pulls = before_pulls_;
  state.factored = false;
  return false;
}

}  // namespace plumb::detail
