// This file says how cords of a world pulled in the last step, and what held its anchors.

#include <limits>

#include "step/step.hpp"

namespace plumb::detail {

/// Returns whether the contact solver moves a rod now, and holds its anchors. It does so with what belongs to
/// no rod.
bool Step::is_held_by_contact(std::uint32_t cord) const {
  if (cord == Reactions::no_rod) return true;
  return is_known_to_contact(cord) && compiled_.contact->has_pull(cord);
}

/// Returns whether the solver that moves a rod says what its anchors hold.
bool Step::is_held_by_solver(std::uint32_t cord) const {
  if (is_held_by_contact(cord)) return true;
  const auto places = compiled_.cords.of(cord);
  return places.empty() || solver(places.front()).holds_rods();
}

double Step::pull(std::uint32_t cord, std::uint32_t segment) const {
  if (is_held_by_contact(cord)) return compiled_.contact->pull_of_rod(cord);
  const auto places = compiled_.cords.of(cord);
  if (places.empty()) return 0;  // it is out, or between fixed particles
  const auto task = sleep_.task_of(compiled_.solvers, places.front());
  const double dt = task ? sleep_.tasks()[*task].dt : 0;
  if (dt == 0) return std::numeric_limits<double>::quiet_NaN();
  const Solver& of = solver(places.front());
  return segment > 0 ? of.segment_pull(places.front().slot, segment, dt) : of.pull(places.front().slot, dt);
}

/// The work of a blow has the mean of both rates.
double Step::power(std::uint32_t cord) const {
  const double rate = lengths_.rate(cord), before = lengths_.rate_before(cord);
  if (rate == 0 && before == 0) return 0;
  if (is_held_by_contact(cord)) return compiled_.contact->power_of_rod(cord);
  const auto places = compiled_.cords.of(cord);
  if (places.empty()) return 0;  // what broke has no place
  const auto task = sleep_.task_of(compiled_.solvers, places.front());
  const double blow = task ? solver(places.front()).blow(places.front().slot) / sleep_.tasks()[*task].dt : 0;
  return blow * (rate - before) / 2 - pull(cord) * rate;
}

void Step::copy_pulls(std::span<double> out) {
  last_dt_.assign(compiled_.solvers.size(), -1);
  for (const Task& task : sleep_.tasks()) {
    double& dt = last_dt_[task.solver];
    dt = dt < 0 || dt == task.dt ? task.dt : 0;
  }
  compiled_.cords.rods.for_runs(
      static_cast<std::uint32_t>(out.size()),
      [&](std::uint32_t first, std::uint32_t count, std::span<const Place> places) {
        const double dt = places.empty() || compiled_.contact ? 0 : last_dt_[places.front().solver];
        if (dt > 0) return solver(places.front()).read_pulls(places.first(count), dt, &out[first]);
        for (std::uint32_t cord = first; cord < first + count; ++cord) out[cord] = pull(cord);
      });
}

Vec3 Step::reaction(std::uint32_t particle) const {
  if (!anchors_.is_fixed(particle)) return {};  // it will be from the next step on
  Vec3 sum = -1.0 * loads_.loaded(particle);
  for (const Reactions::Held& held : reactions_.at(particle))
    sum += reactions_.holding(held, is_held_by_solver(held.rod) ? 0 : pull(held.rod),
                              position(held.other) - position(particle), velocity(held.other), dt_);
  for (const Place place : compiled_.places.of(particle)) {
    const auto task = sleep_.task_of(compiled_.solvers, place);
    sum += solver(place).hold(place.slot, task ? sleep_.tasks()[*task].dt : dt_);
  }
  return sum;
}

}  // namespace plumb::detail
