#include "truth/integrators/integrator.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "scenes/basics/numbers.hpp"

namespace plumb::truth {
namespace {

std::string text(Real value, int digits = 3) {
  return scenes::short_number(static_cast<double>(value), digits);
}

/// Rods may have at most this strain once projected. It is far above rounding and far below what is asked
/// for, so that only rods that contradict each other exceed it.
constexpr Real most_stretch = 1e-12L;
/// The series of an elastic rod's length may differ so much from the distance of its ends, relative to the
/// diagonal. This is above what rounding makes of a step that holds a swing, and far below what is asked for.
constexpr Real most_length_error = 1e-15L;
/// The ends of an elastic rod that is shorter than this share of the diagonal count as meeting, for a
/// message.
constexpr Real short_length = 1e-3L;

}  // namespace

Integrator::Integrator(const Model& model, State start, Settings settings)
    : model_(model),
      settings_(settings),
      solver_(model),
      series_(model, settings.order),
      state_(std::move(start)),
      next_(state_),
      none_(model.particles()),
      change_(model.particles()),
      c_(model.rods.size()),
      push_(model.rods.size()) {
  solver_.factor(state_.x);
  velocity_change_ = project();
}

void Integrator::refuse_stretch(const WorstRod& worst) const {
  throw Unreachable("rod " + std::to_string(worst.rod) + " cannot be kept at its length at t = " +
                    text(time_, 6) + " s: it would be off by " + text(worst.stretch) +
                    " of it. Rods drawn straight between fixed particles have no truth, nor have rods that "
                    "contradict each other");
}

void Integrator::refuse_shrinking() const {
  std::string why;
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const ModelRod& rod = model_.rods[r];
    if (!rod.elastic || norm(state_.x[rod.b] - state_.x[rod.a]) > short_length * model_.diagonal) continue;
    why = ", because the ends of elastic rod " + std::to_string(r) + " meet, where its pull turns round";
  }
  throw Unreachable("the motion cannot be followed beyond t = " + text(time_, 6) +
                    " s: steps there shrink to nothing" + why);
}

void Integrator::refuse_folds() const {
  for (std::size_t i = 0; i < model_.bends.size(); ++i) {
    const auto& [a, b, c, first, second, stiffness, rest] = model_.bends[i];
    const Point w = (1 / first) * (state_.x[b] - state_.x[a]) - (1 / second) * (state_.x[c] - state_.x[b]);
    if (!(dot(w, w) < most_fold))
      throw Unreachable("bend " + std::to_string(i) + " is folded by more than 165.6 degrees at t = " +
                        text(time_, 6) + " s, where its law has no series");
  }
}

/// Takes Newton steps on the lengths with the factors at hand, then solves once for the velocities. Returns
/// by how much these changed at most, in m/s.
Real Integrator::project() {
  Real before = std::numeric_limits<Real>::infinity();
  for (int round = 0; round < 5; ++round) {
    Real worst = 0;
    for (std::size_t r = 0; r < model_.rods.size(); ++r) {
      const ModelRod& rod = model_.rods[r];
      if (rod.elastic) continue;
      const Point d = state_.x[rod.b] - state_.x[rod.a];
      const Real square = rod.length_at(time_) * rod.length_at(time_);
      c_[r] = (square - dot(d, d)) / 2;
      worst = std::max(worst, std::abs(c_[r]) / square);
    }
    if (worst < 1e-18L || !(worst < before / 2)) break;
    before = worst;
    solver_.solve(none_, c_, change_, push_);
    for (std::size_t i = 0; i < change_.size(); ++i) state_.x[i] += change_[i];
  }
  const WorstRod worst = worst_stretch(model_, state_.x, time_);
  if (!(worst.stretch <= most_stretch)) refuse_stretch(worst);
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const ModelRod& rod = model_.rods[r];
    if (rod.elastic) continue;
    c_[r] = rod.rate * rod.length_at(time_) -
            dot(state_.x[rod.b] - state_.x[rod.a], state_.v[rod.b] - state_.v[rod.a]);
  }
  solver_.solve(none_, c_, change_, push_);
  Real most = 0;
  for (std::size_t i = 0; i < change_.size(); ++i) {
    state_.v[i] += change_[i];
    most = std::max(most, norm(change_[i]));
  }
  return most;
}

void Integrator::expand() {
  solver_.factor(state_.x);
  series_.expand(state_, time_, solver_);
}

void Integrator::add_pulls(Real by, std::vector<Real>& out) {
  expand();
  for (std::size_t rod = 0; rod < out.size(); ++rod) out[rod] += by * series_.pull(rod);
}

void Integrator::finish_step(Real h) {
  std::swap(state_, next_);
  time_ += h;
  ++steps_;
  refuse_folds();
  solver_.factor(state_.x);
  project();
}

void Integrator::step(Real h) {
  expand();
  series_.evaluate(h, next_);
  finish_step(h);
}

/// Sets next_ to what follows in h or less, and returns that. The series' own estimate looks at three
/// coefficients. The lengths of rods, which it does not know of, depend on all.
Real Integrator::shorten_step(Real h, Real most) {
  // Where the ends of a rod meet, the step that the coefficients allow is always too long.
  constexpr int most_halvings = 20, most_halvings_of_lengths = 10;
  for (int halvings = 0;; ++halvings) {
    series_.evaluate(h, next_);
    const WorstRod worst = worst_stretch(model_, next_.x, time_ + h);
    const bool lengths_hold = series_.lengths_hold(h, next_, most_length_error);
    if (worst.stretch <= most && lengths_hold) return h;
    // A series too short for its step gains order digits from every halving. A rod that was left out as
    // redundant and is not gains four: it is held straight, and nothing finite can hold it.
    const int enough = solver_.redundant() > 0 ? 4 : most_halvings;
    if (halvings >= enough && !(worst.stretch <= most)) refuse_stretch(worst);
    if (halvings >= most_halvings_of_lengths && !lengths_hold) refuse_shrinking();
    h /= 2;
  }
}

void Integrator::advance_to(Real t) {
  // A strain comes from the rounding of positions, and from what the tolerance allows.
  Real shortest = model_.diagonal;
  for (const ModelRod& rod : model_.rods) {
    if (!rod.elastic) shortest = std::min(shortest, rod.length);
  }
  const Real allowed =
      std::max(100 * std::max(settings_.tolerance, Real{1e-18L}) * model_.diagonal / shortest, Real{1e-15L});
  while (time_ < t) {
    expand();
    Real h = series_.choose_step(settings_.tolerance);
    const Real left = t - time_;
    if (h >= left) {
      h = left;
    } else if (2 * h > left) {
      h = left / 2;  // Half of what is left avoids a short last step.
    }
    // Redundant rods that contradict each other by rounding may keep the strain that they had before.
    h = shorten_step(h, allowed + 2 * worst_stretch(model_, state_.x, time_).stretch);
    if (h != left && !(h > 1e-12L * std::max(left, time_))) refuse_shrinking();
    const bool last = h == left;
    finish_step(h);
    if (last) time_ = t;
  }
}

}  // namespace plumb::truth
