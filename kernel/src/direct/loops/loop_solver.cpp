#include "direct/loops/loop_solver.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "direct/laws/pulls_ahead.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "direct/loops/settle.hpp"
#include "direct/tackles/loop_pulleys.hpp"
#include "interface/changes.hpp"
#include "time/accuracy.hpp"

namespace plumb::detail {
namespace {

/// Where an accuracy is set, nets solved by their lines may keep this share of it as strain, and at most what
/// float leaves. The next substep takes it back. Even 1e-5 changes a net of 128 x 128 after 0.5 s by no more
/// than 2e-9 of its diagonal. A substep of another length makes a velocity of it, which counts as error the
/// more, the shorter substeps are.
constexpr double strain_of_accuracy = 0.01, most_strain = 1e-6;

}  // namespace

void LoopRules::set_stop_rule(const StopRule& rule) {
  stepper.set_line_tolerance(
      accuracy ? std::min({strain_of_accuracy * *accuracy, most_strain, rule.tolerance.value_or(most_strain)})
               : rule.tolerance.value_or(0));
}

LoopSolver::LoopSolver(std::shared_ptr<LoopRules> rules, LoopState state)
    : rules_(std::move(rules)),
      state_(std::move(state)),
      work_(state_, rules_->gradient, rules_->isa),
      velocity_(3 * std::size_t{state_.topology->nodes}) {
  if (rules_->estimates) state_.acceleration = state_.acceleration_before = state_.u;
}

std::uint32_t LoopSolver::project_positions() {
  const bool settled = settle(state_, work_);
  if (!settled) LoopStepper::damp(state_);
  if (work_.lines) work_.lines->forget();
  locks_known_ = false;
  return settled ? 0 : 1;
}

void LoopSolver::set_velocity(Slot slot, Vec3 velocity) {
  double* const u = state_.u.data() + 3 * std::size_t{slot};
  u[0] = velocity.x;
  u[1] = velocity.y;
  u[2] = velocity.z;
}

void LoopSolver::project_velocities() {
  velocity_known_ = false;
  if (!locks_known_) lock(find_locks(state_));
  const bool rests = std::all_of(state_.u.begin(), state_.u.end(), [](double u) { return u == 0; });
  if (!rests) rules_->stepper.project_velocities(state_, work_);
  begin_reels(state_);
}

// --- Steps

void LoopSolver::lock(Locks locks) {
  locks_known_ = true;
  if (!state_.reels.empty()) return;  // they lock what is wound, and that alone
  if (!state_.locks.any() && !locks.any()) return;
  for (const auto& [node, place] : std::exchange(locks.places, {})) {
    double* const x = state_.x.data() + 3 * std::size_t{node};
    x[0] = place.x, x[1] = place.y, x[2] = place.z;
    // As its anchor went last: where that stops in this step, a blow stops both.
    const Vec3 last = state_.fixed_last_velocity[locks.anchors[node] - state_.topology->nodes];
    set_velocity(node, (state_.u_step != 0 ? state_.u_step : 1) * last);
  }
  state_.locks = std::move(locks);
  work_.take_locks(state_);
}

void LoopSolver::begin_piece(std::uint32_t, unsigned) {
  velocity_known_ = false;
  begin_pulls(state_);
  for (LoopTackleMotion& tackle : state_.tackles) tackle.impulse = 0;
  std::fill(state_.pulley_impulses.begin(), state_.pulley_impulses.end(), 0.0);
  if ((!locks_known_ || state_.gave) && do_anchors_rest()) lock(find_locks(state_));
  for (LoopGrab& grab : state_.grabs) grab.begin_step();
  if ((anchors_changed_ || lengths_changed_) && state_.u_step == 0) take_blow();
  if (state_.laws.pulls && (state_.laws.moves || !state_.tackles.empty())) keep_blows();
}

/// Gives velocities what anchors and lengths that change their speed do.
void LoopSolver::take_blow() {
  begin_blow(work_.tackles);
  std::copy(state_.u.begin(), state_.u.end(), work_.start.begin());
  rules_->stepper.take_blow(state_, work_);
  if (finds_other_slides(state_, work_.start, work_)) {
    std::copy_n(work_.start.begin(), state_.u.size(), state_.u.begin());
    rules_->stepper.take_blow(state_, work_);
  }
  count_blows(state_, work_);
  end_blow(work_.tackles);
  state_.fixed_last_velocity = state_.fixed_velocity;  // rods have passed on how they changed
}

void LoopSolver::end_piece(std::uint32_t, double, unsigned) {
  if (!state_.laws.pulls || rules_->gradient != Gradient::old) return;
  find_velocities();
  count_pulls_ahead(state_, rules_->drag, work_);
}

double LoopSolver::advance(std::uint32_t, double h, std::uint32_t count, unsigned, Tally& report) {
  double error = 0;
  for (std::uint32_t i = 0; i < count; ++i)
    error = std::max(error, rules_->stepper.advance(state_, h, work_, report));
  state_.changed.put_back();
  return error;
}

// --- Accuracy

ErrorModel LoopSolver::error_model() const {
  return {.order = rules_->gradient == Gradient::new_ ? 1u
                   : state_.grabs.empty()             ? rules_->time_order
                                                      : 2u,
          .by_comparison = !rules_->estimates};
}

void LoopSolver::save(std::uint32_t, Saved which) {
  saved_[static_cast<int>(which)] = state_.motion();
  if (which == Saved::window && work_.lines) work_.lines->keep_history();
}

void LoopSolver::restore(std::uint32_t, Saved which) {
  state_.motion() = saved_[static_cast<int>(which)];
  restore_reels(state_);
  if (!work_.lines) return;
  if (which == Saved::window)
    work_.lines->take_history_back();
  else
    work_.lines->forget();
}

double LoopSolver::distance_from_mark(std::uint32_t) const {
  return largest_distance(state_.x, mark_, state_.topology->nodes, 1);
}

void LoopSolver::end_controlled_step(std::uint32_t, double, double, double, double, unsigned) {
  if (anchors_changed_) state_.known = 0;
}

// --- Sleep

bool LoopSolver::is_slower(std::uint32_t, double speed) const {
  const double most = speed * (state_.u_step != 0 ? state_.u_step : 1);
  return std::all_of(state_.u.rbegin(), state_.u.rend(), [most](double u) { return std::abs(u) <= most; });
}

void LoopSolver::rest(std::uint32_t) {
  std::fill(state_.u.begin(), state_.u.end(), 0.0);
  state_.u_step = 0;
  velocity_known_ = false;
}

double LoopSolver::size(std::uint32_t) const {
  return std::sqrt(state_.scale2);
}

// --- Particles

Vec3 LoopSolver::velocity(Slot slot) const {
  if (slot >= state_.topology->nodes) return {};
  find_velocities();
  return reeled_velocity(state_, slot, velocity_);
}

void LoopSolver::read_positions(std::span<const Run> runs, Vec3* out) const {
  if (!state_.reels.empty()) return Solver::read_positions(runs, out);
  for (const Run& run : runs)
    run.read_slots(out, [x = std::span<const double>(state_.x)](Slot slot) { return at(x, slot); });
}

void LoopSolver::read_velocities(std::span<const Run> runs, Vec3* out) const {
  if (!state_.reels.empty()) return Solver::read_velocities(runs, out);
  find_velocities();
  for (const Run& run : runs)
    run.read_slots(out, [v = std::span<const double>(velocity_), nodes = state_.topology->nodes](Slot slot) {
      return slot < nodes ? at(v, slot) : Vec3{};
    });
}

void LoopSolver::find_velocities() const {
  if (velocity_known_) return;
  rules_->stepper.find_velocities(state_, work_);
  std::copy_n(work_.delta.begin(), velocity_.size(), velocity_.begin());
  velocity_known_ = true;
}

void LoopSolver::add_to_hash(Slot slot, StateHash& hash) const {
  hash.add<double>(position(slot));
  if (slot >= state_.topology->nodes) return;
  for (std::size_t c = 0; c < 3; ++c) hash.add(state_.u[3 * std::size_t{slot} + c]);
}

double LoopSolver::read(std::span<const Slot> slots, std::span<Vec3> out) const {
  double most = 0;  // it is the largest square of a speed
  for (std::size_t i = 0; i < slots.size(); ++i) {
    out[i] = position(slots[i]);
    const double* const u = state_.u.data() + 3 * std::size_t{slots[i]};
    most = std::max(most, u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  }
  return std::sqrt(most) / (state_.u_step != 0 ? state_.u_step : 1);
}

/// A displacement stands for the velocity of now under the force that made it. It gives way to the velocity
/// before that force changes. While others move the island, it stands for nothing.
void LoopSolver::keep_velocities() {
  if (rules_->gradient != Gradient::old || state_.u_step == 0 || away_) return;
  find_velocities();
  state_.u = velocity_;
  state_.u_step = 0;
}

void LoopSolver::set_force(Slot slot, Vec3 newton) {
  keep_velocities();
  state_.set_force(slot, newton);
}

void LoopSolver::set_gravity(Vec3 gravity, Vec3) {
  keep_velocities();
  state_.set_gravity(gravity);
}

void LoopSolver::set_motion(Slot slot, Vec3 position, Vec3 velocity) {
  const double x[3] = {position.x, position.y, position.z}, v[3] = {velocity.x, velocity.y, velocity.z};
  for (std::size_t c = 0; c < 3; ++c) {
    state_.x[3 * std::size_t{slot} + c] = x[c];
    state_.u[3 * std::size_t{slot} + c] = v[c];
  }
  state_.u_step = 0;
  state_.mu_kick = 0;
  state_.known = 0;
  velocity_known_ = locks_known_ = false;
  if (work_.lines) work_.lines->forget();
}

void LoopSolver::go_on(Slot slot, const Past& past) {
  if (rules_->gradient != Gradient::new_ || past.substep == 0) return;
  for (std::size_t c = 0; c < 3; ++c) state_.u[3 * std::size_t{slot} + c] *= past.substep;
  state_.u_step = past.substep;
}

// --- Anchors

void LoopSolver::move_anchor(Slot slot, const AnchorMove& move) {
  state_.fixed_velocity[slot - state_.topology->nodes] = move.velocity();
  state_.anchors_move = true;
}

bool LoopSolver::do_anchors_rest() const {
  return std::all_of(state_.fixed_velocity.begin(), state_.fixed_velocity.end(),
                     [](Vec3 v) { return v == Vec3{}; });
}

void LoopSolver::begin_anchors() {
  anchors_changed_ = !std::equal(state_.fixed_last_velocity.begin(), state_.fixed_last_velocity.end(),
                                 state_.fixed_velocity.begin(), std::not_fn(velocity_changes));
  if (locks_hold(state_)) return;
  lock({});
  locks_known_ = false;  // lines that come to rest are looked at again
}

void LoopSolver::end_anchors() {
  anchors_changed_ = false;
  if (!state_.anchors_move) return;
  state_.anchors_move = !do_anchors_rest();
  state_.fixed_last_velocity = state_.fixed_velocity;
  std::fill(state_.fixed_velocity.begin(), state_.fixed_velocity.end(), Vec3{});
}

void LoopSolver::place_anchor(Slot slot, Vec3 target) {
  double* x = state_.x.data() + 3 * std::size_t{slot};
  x[0] = target.x;
  x[1] = target.y;
  x[2] = target.z;
  place_wound(state_);
  velocity_known_ = false;  // or a restored world would find others, from where the anchor is now
}

// --- Rods, tackles and reels

void LoopSolver::count_pulls() {
  state_.laws.make(state_.length2);
  state_.laws.pulls = true;
  state_.hold.resize(state_.fixed_velocity.size());
}

Vec3 LoopSolver::hold(Slot slot, double dt) const {
  if (state_.hold.empty() || away_) return {};
  return 1 / dt * state_.hold[slot - state_.topology->nodes];
}

/// Keeps what was pulled as the step began. What is taken back then is none of it.
void LoopSolver::keep_blows() {
  blows_ = state_.laws.impulse;
  for (std::size_t k = 0; k < blows_.size() && state_.u_step != 0; ++k) blows_[k] += state_.laws.ahead[k];
  for (const LoopTackleMotion& tackle : state_.tackles) blows_.push_back(tackle.impulse);
}

double LoopSolver::blow(Slot cord) const {
  return cord < blows_.size() ? blows_[cord] : 0;
}

double LoopSolver::pull(Slot cord, double dt) const {
  return (is_tackle(cord) ? tackle(cord).impulse : state_.laws.impulse[cord]) / dt;
}

double LoopSolver::segment_pull(Slot cord, std::uint32_t segment, double dt) const {
  const LoopTackle& of = state_.topology->tackles[cord - state_.topology->rods.size()];
  return of.rubs && segment > 0 ? state_.pulley_impulses[of.first_pulley + segment - 1] / dt : pull(cord, dt);
}

bool LoopSolver::is_broken(Slot rod) const {
  return state_.laws.any() && state_.laws.is_broken(rod) && !is_wound(state_, rod);
}

void LoopSolver::set_length(Slot cord, double length, double rate) {
  if (is_reel(cord)) {
    const auto number = static_cast<std::uint32_t>(cord - first_reel());
    see_change({state_.reels[number].out, state_.reels[number].rate}, {length, rate});
    turn_reel(state_, number, length, rate);
    return;
  }
  if (is_tackle(cord)) {
    see_change({tackle(cord).length, tackle(cord).rate}, {length, rate});
    tackle(cord).length = length;
    tackle(cord).jump = rate - tackle(cord).rate;
    tackle(cord).rate = rate;
    return;
  }
  state_.laws.make(state_.length2);
  see_change({state_.laws.length[cord], state_.laws.rate[cord]}, {length, rate});
  state_.laws.moves = true;
  if (work_.lines) work_.lines->forget();
  if (lies_between_held(state_, cord)) {
    lock({});
    locks_known_ = false;
  }
  state_.laws.jump[cord] = rate - state_.laws.rate[cord];
  state_.laws.rate[cord] = rate;
  state_.laws.length[cord] = length;
  state_.length2[cord] = length * length;
}

// --- Settings and reports

bool LoopSolver::set_stop_rule(const StopRule& rule) {
  rules_->set_stop_rule(rule);
  return work_.lines != nullptr;
}

void LoopSolver::describe(WorldInfo& info) const {
  info.direct_rods += static_cast<std::uint32_t>(state_.topology->rods.size());
}

}  // namespace plumb::detail
