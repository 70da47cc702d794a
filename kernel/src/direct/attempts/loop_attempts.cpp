// A substep of an island is tried whole, in pieces and in halves, and then in ways that damp.

#include <algorithm>
#include <cmath>
#include <limits>

#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "time/composition.hpp"

namespace plumb::detail {
namespace {

constexpr int most_halvings = 10;
constexpr int most_attempts = 256;  ///< They are of one substep, all halves together.
/// A part that was halved so often is tried at its shortest. If that is not solved either, no half will be.
constexpr int probed_depth = 1;
/// After a substep that failed, so many are taken with gradient new, and with fewer attempts. There is little
/// hope that what did not work then works now. Each time it does not, twice as many follow. Those in which
/// rods gave are not counted: they do not tell whether it would work once rods fit again.
constexpr std::uint32_t damped_substeps = 2, most_damped_substeps = 1024;
/// Cables that change their length by a smaller share in a substep do not ring.
constexpr double least_ringing = 1e-3;
struct Limits {
  int halvings, attempts;
};
constexpr Limits undamped{most_halvings, most_attempts}, damped{1, 3};
/// Islands with elements hardly ever fail, and are worth more halves.
constexpr Limits damped_elements{5, 63};

/// Substeps that lines need in more pieces are factorised as a whole. Lines are tried again when regrowth has
/// made such a piece of this share of a substep, which takes 30 substeps. On nets that fall, with 5 % and 30
/// % slack, 4 pieces took less time than 8.
constexpr std::uint32_t most_line_pieces = 4;
constexpr double line_pause = 64, regrowth = 1.1;
/// Pieces that were solved by lines grow so slowly. Longer ones are tried in vain every few substeps: a net
/// of 64 x 64 at rest took twice the Newton steps with `regrowth`.
constexpr double line_growth = 1.02;

const Limits& limits_of(const LoopState& state) {
  if (state.damped == 0) return undamped;
  return state.topology->any() ? damped_elements : damped;
}

/// Says whether all rigid cables pulled, and some changes its length faster than a substep of `h` (s)
/// resolves. Gradient mid keeps the speed of what they catch, as a velocity that swings about zero.
bool rings(const LoopState& state, double h) {
  if (!state.laws.any()) return false;
  const LoopTopology& shape = *state.topology;
  const auto velocity = [&](std::uint32_t i) {
    return i < shape.nodes ? at(state.u, i) : state.fixed_velocity[i - shape.nodes];
  };
  bool any = false;
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    if (!state.laws.is_rigid(k) || !state.laws.is_one_sided(k)) continue;
    if (!(state.mu[k] < 0)) return false;
    const auto [a, b] = shape.rods[k];
    const double rate = dot(at(state.x, a) - at(state.x, b), velocity(a) - velocity(b));
    any = any || std::abs(rate) * h > least_ringing * state.length2[k];
  }
  return any;
}

}  // namespace

void LoopStepper::end_ringing(LoopState& state, LoopWorkspace& work, Tally& counters) const {
  state.changed.put_back();
  project_velocities(state, work);
  count_blows(state, work);
  state.known = 0;
  ++counters.newton;
}

void LoopStepper::damp(LoopState& state) {
  state.next_damped = std::max(state.next_damped, damped_substeps);
  state.damped = state.next_damped;
  state.next_damped = std::min(2 * state.next_damped, most_damped_substeps);
}

bool LoopStepper::advance_part(LoopState& state, double h, int depth, Attempts& attempts, LoopWorkspace& work,
                               Tally& counters) const {
  const Gradient gradient = state.damped > 0 ? Gradient::new_ : gradient_;
  if (attempts.left-- == 0) return false;
  bool solved = solve(state, h, gradient, attempts.by_lines, work, counters);
  if (!solved && gradient == Gradient::mid && !attempts.caught && is_bounded(state) && rings(state, h)) {
    attempts.caught = true;
    end_ringing(state, work, counters);
    solved = solve(state, h, gradient, attempts.by_lines, work, counters);
  }
  if (solved) {
    attempts.error += accept(state, h, gradient, work, counters);
    attempts.deepest = std::max(attempts.deepest, depth);
    attempts.done += h;
    ++counters.direct_substeps;
    if (gradient != gradient_) ++counters.fallbacks;
    return true;
  }
  // Rods that give take a wide island longer than its halves, and others shorter.
  const bool is_late = !work.is_wide() && counters.is_late();
  if (depth == attempts.halvings || is_late || counters.is_spent() || counters.newton >= attempts.most_newton)
    return false;
  if (depth == probed_depth && !attempts.probed && !state.topology->any()) {
    attempts.probed = true;
    if (!solve(state, std::ldexp(h, depth - attempts.halvings), gradient, attempts.by_lines, work, counters))
      return false;
    std::copy(work.mu_start.begin(), work.mu_start.end(), state.mu.begin());
  }
  ++counters.halvings;
  return advance_part(state, h / 2, depth + 1, attempts, work, counters) &&
         advance_part(state, h / 2, depth + 1, attempts, work, counters);
}

std::uint32_t LoopStepper::cuts(const LoopState& state, double h) const {
  if (state.damped > 0) return 1;  // gradient new is hardly ever halved
  return pieces_of(largest_share_ * std::abs(h) / state.pace.longest);
}

bool LoopStepper::advance_pieces(LoopState& state, double h, std::uint32_t count, Attempts& attempts,
                                 LoopWorkspace& work, Tally& counters) const {
  bool solved = true;
  for (std::uint32_t i = 0; solved && i < count; ++i)
    solved = advance_piece(state, h / count, attempts, work, counters);
  if (!solved) state.motion() = work.saved;
  return solved;
}

bool LoopStepper::advance_piece(LoopState& state, double h, Attempts& attempts, LoopWorkspace& work,
                                Tally& counters) const {
  // What is grabbed takes it whole: a step back would let a stiff grab push.
  for (const double share : state.grabs.empty() ? shares_ : composition(2)) {
    attempts.left = limits_of(state).attempts;
    if (!advance_part(state, share * h, 0, attempts, work, counters)) return false;
  }
  return true;
}

bool LoopStepper::advance_at_pace(LoopState& state, double h, Attempts& attempts, LoopWorkspace& work,
                                  Tally& counters) const {
  const std::uint32_t whole = 1u << Pace::most_cuts;
  // Pieces nest as halves do: one begins only where its own length divides what is done, so that the next can
  // be twice as long.
  for (std::uint32_t done = 0; done < whole;) {
    const int cuts = state.damped > 0 ? 0 : state.pace.cuts(largest_share_ * h);
    const std::uint32_t piece = std::min(whole >> cuts, done == 0 ? whole : done & (0 - done));
    attempts.deepest = 0;
    if (counters.newton >= attempts.most_newton ||
        !advance_piece(state, h * piece / whole, attempts, work, counters))
      return false;
    done += piece;
    if (state.damped == 0) state.pace.took(largest_share_ * h * piece / whole, attempts.deepest);
  }
  return true;
}

bool LoopStepper::advance_wide(LoopState& state, double h, Attempts& attempts, LoopWorkspace& work,
                               Tally& counters) const {
  const std::uint32_t count = cuts(state, h);
  if (count <= most_line_pieces) {
    Attempts by_lines{.halvings = 0, .left = 0, .by_lines = true, .most_newton = attempts.most_newton};
    while (count << (by_lines.halvings + 1) <= most_line_pieces) ++by_lines.halvings;
    if (advance_pieces(state, h, count, by_lines, work, counters)) {
      attempts = by_lines;
      state.pace.longest = attempts.deepest > 0 ? std::ldexp(std::abs(h) / count, -attempts.deepest)
                                                : line_growth * state.pace.longest;
      return true;
    }
    state.pace.longest = std::abs(h) / line_pause;
  } else {
    state.pace.longest *= regrowth;
  }
  attempts.by_lines = false;
  // Every whole substep is tried: to begin with the pieces of the last one takes half as much time again.
  return advance_pieces(state, h, 1, attempts, work, counters);
}

double LoopStepper::advance_whole(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const {
  const std::uint64_t before = counters.newton;
  const double error = try_advance(state, h, work, counters);
  state.effort.took(counters.newton - before);
  return error;
}

double LoopStepper::try_advance(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const {
  work.saved = state.motion();
  const bool was_damped = state.damped > 0;
  // Nets that are solved without a factorisation take hundreds of steps in the time of one that gives way.
  const bool gives_up = is_bounded(state) && !work.net;
  double rest = h;
  for (const bool again : {false, true}) {
    if (again) {
      if (was_damped || gradient_ == Gradient::new_) break;
      damp(state);
      if (gives_up) break;  // rods that give come to the same end by a shorter way
      work.saved = state.motion();
    }
    Attempts attempts{.halvings = limits_of(state).halvings,
                      .left = 0,
                      .by_lines = work.is_wide(),
                      .most_newton = counters.newton + (gives_up ? state.effort.most() : Effort::endless)};
    const bool solved = work.lines && gradient_ != Gradient::old
                            ? advance_wide(state, h, attempts, work, counters)
                            : advance_at_pace(state, h, attempts, work, counters);
    if (!solved) {
      // What was solved stands where all that is left is taken at once.
      if (gives_up)
        rest = h - attempts.done;
      else
        state.motion() = work.saved;
      continue;
    }
    if (state.damped > 0)
      --state.damped;
    else
      state.next_damped /= 2;
    return attempts.error;
  }
  const bool fits = advance_elastic(state, rest, work, counters);
  if (fits && was_damped)
    --state.damped;
  else if (!was_damped && gradient_ == Gradient::new_)
    damp(state);
  return std::numeric_limits<double>::infinity();
}

}  // namespace plumb::detail
