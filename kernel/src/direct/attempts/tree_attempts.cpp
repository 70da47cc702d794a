// A tree alone is tried in pieces and in halves, and with gradient new.

#include <algorithm>
#include <bit>
#include <cmath>

#include "direct/trees/newton_limits.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "time/pace.hpp"

namespace plumb::detail {

template <class T>
bool TreeStepper<T>::try_alone(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work,
                               Tally& counters) const {
  begin(state, h, gradient, work);
  if (solve(state, gradient, work, counters) && (gradient != Gradient::old || is_stable(state, h, work)))
    return true;
  state.grabs.put_back();
  restore_multipliers(state, 0);
  return false;
}

template <class T>
bool TreeStepper<T>::advance_alone(TreeState<T>& state, double h, int depth, Attempts& attempts,
                                   TreeWorkspace<T>& work, Tally& counters) const {
  const bool last = depth == tree_limits::most_halvings || --attempts.left <= 0 || counters.is_spent() ||
                    counters.newton >= attempts.most_newton;
  if (try_alone(state, h, gradient_, work, counters)) {
    accept(state, h, gradient_, work, counters);
    ++counters.direct_substeps;
    attempts.deepest = std::max(attempts.deepest, depth);
    attempts.done += std::ldexp(1.0, -depth);
    return true;
  }
  if (last || attempts.are_too_few_for_halves(counters.newton, depth)) return false;
  if (!attempts.probed) {
    attempts.probed = true;
    if (!try_alone(state, std::ldexp(h, depth - tree_limits::most_halvings), gradient_, work, counters))
      return false;
    restore_multipliers(state, 0);
  }
  ++counters.halvings;
  return advance_alone(state, h / 2, depth + 1, attempts, work, counters) &&
         advance_alone(state, h / 2, depth + 1, attempts, work, counters);
}

/// Where frames are bounded pieces nest as halves do. The next is as short as the last half that was solved,
/// and longer once some in a row were not halved.
template <class T>
bool TreeStepper<T>::advance_in_pieces(TreeState<T>& state, double h, Attempts& attempts,
                                       TreeWorkspace<T>& work, Tally& counters) const {
  if (!bounds_frames_)
    return advance_alone(state, h / 2, 1, attempts, work, counters) &&
           advance_alone(state, h / 2, 1, attempts, work, counters);
  const std::uint32_t whole = 1u << Pace::most_cuts;
  Pace pace;
  pace.longest = std::abs(h) / 2;
  for (std::uint32_t done = 0; done < whole;) {
    const std::uint32_t piece = std::min(whole >> pace.cuts(h), done == 0 ? whole : done & (0 - done));
    const int depth = Pace::most_cuts + 1 - std::bit_width(piece);
    if (done > 0 && counters.newton >= attempts.most_newton) return false;
    attempts.deepest = depth;
    const double length = std::ldexp(h, -depth);
    if (!advance_alone(state, length, depth, attempts, work, counters)) return false;
    done += piece;
    pace.took(length, attempts.deepest - depth);
  }
  return true;
}

template <class T>
bool TreeStepper<T>::advance_damped(TreeState<T>& state, double h, int halvings, TreeWorkspace<T>& work,
                                    Tally& counters) const {
  if (!try_alone(state, h, Gradient::new_, work, counters)) {
    if (halvings == 0) return false;
    ++counters.halvings;
    return advance_damped(state, h / 2, halvings - 1, work, counters) &&
           advance_damped(state, h / 2, halvings - 1, work, counters);
  }
  accept(state, h, Gradient::new_, work, counters);
  ++counters.direct_substeps;
  ++counters.fallbacks;
  // u becomes a velocity, which every gradient can go on from.
  for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] = static_cast<T>(state.u[i] / h);
  state.u_step[0] = 0;
  return true;
}

#define PLUMB_INSTANTIATE(T)                                                                                 \
  template bool TreeStepper<T>::try_alone(TreeState<T>&, double, Gradient, TreeWorkspace<T>&, Tally&) const; \
  template bool TreeStepper<T>::advance_alone(TreeState<T>&, double, int, Attempts&, TreeWorkspace<T>&,      \
                                              Tally&) const;                                                 \
  template bool TreeStepper<T>::advance_in_pieces(TreeState<T>&, double, Attempts&, TreeWorkspace<T>&,       \
                                                  Tally&) const;                                             \
  template bool TreeStepper<T>::advance_damped(TreeState<T>&, double, int, TreeWorkspace<T>&, Tally&) const;
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
