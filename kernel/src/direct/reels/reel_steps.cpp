#include <algorithm>

#include "direct/loops/loop_stepper.hpp"
#include "direct/reels/loop_reels.hpp"

namespace plumb::detail {
namespace {

/// No part of a substep that ends where a particle becomes free or carried is a smaller share of it. Rounding
/// of places would show in the velocities of shorter ones.
constexpr double least_part = 1e-4;

}  // namespace

void LoopStepper::pass_events(LoopState& state, double soon, LoopWorkspace& work) const {
  const ReelEvents events = pass_reel_events(state, soon);
  if (!events.any) return;
  for (LoopWorkspace::Factor* factor : {work.first.get(), work.second.get()})
    if (factor) factor->h = 0;
  if (!events.jolts || gradient_ != Gradient::mid) return;  // gradient new damps what does not fit
  project_velocities(state, work);
  count_blows(state, work);
}

double LoopStepper::advance(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const {
  if (state.reels.empty()) return advance_whole(state, h, work, counters);
  const double least = least_part * h;
  double error = 0;
  pass_events(state, least, work);
  for (double left = h; left > 0;) {
    double part = std::max(next_reel_event(state, left), least);
    if (left - part < least) part = left;
    error += advance_whole(state, part, work, counters);
    left -= part;
    pass_events(state, least, work);
  }
  return error;
}

}  // namespace plumb::detail
