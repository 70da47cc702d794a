#include "time/advance.hpp"

#include <algorithm>

#include "time/accuracy.hpp"

namespace plumb::detail {
namespace {

/// This many substeps are taken between two looks at whether the work is spent. More overshoot the bound
/// farther.
constexpr std::uint32_t substeps_at_once = 64;

/// Advances by `count` substeps, or by fewer if the work is spent before. Returns the largest error estimate,
/// m.
double advance_while_work_is_left(Solver& solver, std::uint32_t piece, double h, std::uint32_t count,
                                  unsigned part, Tally& tally) {
  double error = 0;
  for (std::uint32_t left = count; left > 0 && !tally.is_spent();) {
    const std::uint32_t now = std::min(left, substeps_at_once);
    error = std::max(error, solver.advance(piece, h, now, part, tally));
    left -= now;
  }
  return error;
}

/// Moves a piece as AccuracyControl::compare() asks.
struct ComparedPiece {
  Solver& solver;
  std::uint32_t piece;
  unsigned part;

  void advance(double h, std::uint32_t substeps, Tally& counters) const {
    advance_while_work_is_left(solver, piece, h, substeps, part, counters);
  }
  void keep() const { solver.save(piece, Saved::window); }
  void take_back() const {
    solver.mark(piece);
    solver.restore(piece, Saved::window);
  }
  double distance() const { return solver.distance_from_mark(piece); }
};

/// Takes one piece through a step under the control of an accuracy.
class ControlledPiece {
 public:
  ControlledPiece(Solver& solver, std::uint32_t piece, unsigned part)
      : solver_(solver), piece_(piece), part_(part), model_(solver.error_model()) {}

  void step(double dt, const TimeRules& rules, Tally& report) {
    AccuracyControl control{*rules.error_growth, rules.substeps, model_.most_substeps, model_.order,
                            model_.by_comparison};
    control.begin_step(solver_.anchors_changed(piece_), solver_.cuts(piece_, dt));
    solver_.save(piece_, Saved::step);
    if (solver_.try_calm_step(piece_, dt / control.least, control.least, control.allowed, part_, report))
      return;
    double error = 0, h = dt;
    const std::uint64_t most_work = report.most_work;
    report.most_work /= 2;  // the other half is for equal substeps, if no attempt ends
    const bool done = control.step(
        dt, solver_.best_substep(piece_), report,
        [&](double length, std::uint32_t substeps, Tally& of_attempt) {
          h = length;
          const AccuracyControl::Attempt result = attempt(control, length, substeps, of_attempt);
          error = result.error;
          return result;
        },
        [&] { solver_.restore(piece_, Saved::step); });
    report.most_work = most_work;
    if (!done) {
      report.capped_steps = 1;
      solver_.advance(piece_, dt / rules.substeps, rules.substeps, part_, report);
    }
    solver_.end_controlled_step(piece_, error, h, dt / control.least, control.allowed, part_);
  }

 private:
  AccuracyControl::Attempt attempt(const AccuracyControl& control, double h, std::uint32_t substeps,
                                   Tally& report) {
    AccuracyControl::Attempt result;
    if (control.by_comparison)
      result = compare(control, h, substeps, report);
    else
      result.error = advance_while_work_is_left(solver_, piece_, h, substeps, part_, report);
    result.is_blind = result.is_blind || report.fallbacks > 0 ||
                      (control.by_comparison && model_.fallback_is_final && report.halvings > 0);
    result.is_final =
        result.is_final || report.has_given_up() || (model_.fallback_is_final && report.fallbacks > 0);
    return result;
  }

  AccuracyControl::Attempt compare(const AccuracyControl& control, double h, std::uint32_t substeps,
                                   Tally& report) {
    return control.compare(h, substeps, solver_.starts_anew(piece_), ComparedPiece{solver_, piece_, part_},
                           report);
  }

  Solver& solver_;
  std::uint32_t piece_;
  unsigned part_;
  ErrorModel model_;
};

/// Advances by equal substeps, or by one if time is over before. That is asked once: solvers look ahead over
/// all substeps of a step.
void advance_equally(Solver& solver, std::uint32_t piece, double dt, std::uint32_t substeps, unsigned part,
                     Tally& tally) {
  const std::uint32_t count = substeps > 1 && tally.is_late() ? 1 : substeps;
  solver.advance(piece, dt / count, count, part, tally);
}

}  // namespace

void advance_piece(Solver& solver, std::uint32_t piece, double dt, const TimeRules& rules, unsigned part,
                   StepReport& report) {
  solver.begin_piece(piece, part);
  Tally tally;
  const bool is_controlled = rules.error_growth && solver.takes_accuracy();
  // Equal sweeps are what the user asked for, however many, so that their work is not bounded.
  if (is_controlled || !solver.sweeps()) {
    tally.most_work = rules.most_work * solver.islands(piece);
    tally.deadline = rules.deadline;
    tally.gives_up_late = is_controlled;
  }
  if (is_controlled)
    ControlledPiece(solver, piece, part).step(dt, rules, tally);
  else
    advance_equally(solver, piece, dt, rules.substeps, part, tally);
  if (tally.was_late || tally.work() >= tally.most_work) tally.capped_steps = 1;
  report += tally;
}

}  // namespace plumb::detail
