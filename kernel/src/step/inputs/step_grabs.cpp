// This file lets places be grabbed, and hands grabs over where islands are made anew.

#include <algorithm>

#include "step/step.hpp"

namespace plumb::detail {

std::uint32_t Step::grab(const Grab& grab) {
  const std::uint32_t number = grabs_.add(grab, compiled_.places, compiled_.solvers);
  wake_grabbed(number);
  return number;
}

void Step::release(std::uint32_t number) {
  wake_grabbed(number);
  grabs_.end(number, compiled_.places, compiled_.solvers);
}

/// Sends targets on their ways, which wakes what they pull.
void Step::begin_grabs() {
  if (!grabs_.any()) return;
  grabs_.for_moving_places(compiled_.places,
                           [&](const Place& place) { sleep_.wake(compiled_.solvers, place); });
  grabs_.begin_step(dt_, compiled_.places, compiled_.solvers);
}

void Step::end_grabs() {
  if (grabs_.any())
    grabs_.end_step(dt_, compiled_.places, compiled_.solvers,
                    [&](std::uint32_t particle) { return is_asleep(particle); });
}

void Step::wake_grabbed(std::uint32_t number) {
  grabs_.for_homes(number, compiled_.places,
                   [&](const Place& place) { sleep_.wake(compiled_.solvers, place); });
}

/// Takes the grabs of these particles from solvers that are about to end. Returns which those are.
Array<std::uint32_t> Step::take_grabs(std::span<const std::uint32_t> particles) {
  Array<std::uint32_t> out;
  grabs_.for_grabs_of(
      [&](std::uint32_t particle) {
        return std::find(particles.begin(), particles.end(), particle) != particles.end();
      },
      [&](std::uint32_t number) { out.push_back(number); });
  for (const std::uint32_t number : out) grabs_.take_out(number, compiled_.places, compiled_.solvers);
  return out;
}

/// Gives grabs to new solvers. Those of what became fixed, or fell apart, let go.
void Step::put_grabs(std::span<const std::uint32_t> numbers) {
  for (const std::uint32_t number : numbers) {
    bool moves = false;
    const Point& at = grabs_.place(number);
    for (std::size_t k = 0; k < at.particles.size(); ++k)
      moves = moves || (at.weights[k] != 0 && !anchors_.is_fixed(at.particles[k]));
    if (moves && grabs_.fits(number, compiled_.places, compiled_.solvers))
      grabs_.put_in(number, compiled_.places, compiled_.solvers);
    else
      grabs_.end(number, compiled_.places, compiled_.solvers);
  }
}

}  // namespace plumb::detail
