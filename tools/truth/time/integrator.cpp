#include "truth/time/integrator.hpp"

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

/// Takes Newton steps on the lengths with the factors at hand, then solves once for the velocities. Returns
/// by how much these changed at most, in m/s.
Real Integrator::project() {
  Real before = std::numeric_limits<Real>::infinity();
  for (int round = 0; round < 5; ++round) {
    Real worst = 0;
    for (std::size_t r = 0; r < model_.rods.size(); ++r) {
      const ModelRod& rod = model_.rods[r];
      const Point d = state_.x[rod.b] - state_.x[rod.a];
      const Real square = rod.length * rod.length;
      c_[r] = (square - dot(d, d)) / 2;
      worst = std::max(worst, std::abs(c_[r]) / square);
    }
    if (worst < 1e-18L || !(worst < before / 2)) break;
    before = worst;
    solver_.solve(none_, c_, change_, push_);
    for (std::size_t i = 0; i < change_.size(); ++i) state_.x[i] += change_[i];
  }
  const WorstRod worst = worst_stretch(model_, state_.x);
  if (!(worst.stretch <= most_stretch)) refuse_stretch(worst);
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const ModelRod& rod = model_.rods[r];
    c_[r] = -dot(state_.x[rod.b] - state_.x[rod.a], state_.v[rod.b] - state_.v[rod.a]);
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
  series_.expand(state_, solver_);
}

void Integrator::finish_step(Real h) {
  std::swap(state_, next_);
  time_ += h;
  ++steps_;
  solver_.factor(state_.x);
  project();
}

void Integrator::step(Real h) {
  expand();
  series_.evaluate(h, next_);
  finish_step(h);
}

void Integrator::advance_to(Real t) {
  // A strain comes from the rounding of positions, and from what the tolerance allows.
  Real shortest = model_.diagonal;
  for (const ModelRod& rod : model_.rods) shortest = std::min(shortest, rod.length);
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
    // The series' own estimate looks at three coefficients; the rods, which it does not know of, depend on
    // all. Redundant rods that contradict each other by rounding may keep the strain that they had before.
    const Real most = allowed + 2 * worst_stretch(model_, state_.x).stretch;
    for (int halvings = 0;; ++halvings) {
      series_.evaluate(h, next_);
      const WorstRod worst = worst_stretch(model_, next_.x);
      if (worst.stretch <= most) break;
      // A series too short for its step gains order digits from every halving. A rod that was left out as
      // redundant and is not gains four: it is held straight, and nothing finite can hold it.
      if (halvings == (solver_.redundant() > 0 ? 4 : 20)) refuse_stretch(worst);
      h /= 2;
    }
    if (h != left && !(h > 1e-12L * std::max(left, time_))) {
      throw Unreachable("the motion cannot be followed beyond t = " + text(time_, 6) +
                        " s: steps there shrink to nothing");
    }
    const bool last = h == left;
    finish_step(h);
    if (last) time_ = t;
  }
}

}  // namespace plumb::truth
