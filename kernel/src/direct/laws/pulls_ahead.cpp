#include "direct/laws/pulls_ahead.hpp"

#include <algorithm>

#include "direct/loops/loop_vectors.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
namespace {

/// Calls f(is_tie, number, way) for all rods of a lane, where `way` (m) leads to the node from its parent, or
/// from the anchor of a tie. `number` counts rods to parents or ties, lanes included.
template <class T, class F>
void for_rods(const TreeState<T>& state, std::uint32_t lane, F&& f) {
  const TreeTopology& tree = *state.topology;
  for (std::uint32_t i = 0; i < tree.nodes; ++i) {
    const Vec3 place = state.position(i, lane);
    if (i > 0) f(false, state.at(i, lane), place - state.position(tree.parent[i], lane));
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k)
      f(true, state.at(k, lane), place - state.read(state.tie_x, 3 * std::size_t{k}, lane));
  }
}

/// Returns what anchors hold against a pull with an impulse (N s) along the way (m) from them.
Vec3 held(double impulse, Vec3 way) {
  return impulse == 0 ? Vec3{} : -impulse / norm(way) * way;
}

}  // namespace

template <class T>
void begin_pulls(TreeState<T>& state) {
  auto& impulse = state.laws.impulse;
  const auto& ahead = state.laws.ahead;
  std::fill(state.hold.begin(), state.hold.end(), Vec3{});
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane)
    for_rods(state, lane, [&](bool is_tie, std::size_t i, Vec3 way) {
      const double back = state.u_step[lane] != 0 ? -(is_tie ? ahead.ties : ahead.rods)[i] : 0;
      (is_tie ? impulse.ties : impulse.rods)[i] = back;
      if (is_tie) state.hold[i] = held(back, way);
    });
}

template <class T>
void count_pulls_ahead(TreeState<T>& state, double drag, const TreeWorkspace<T>& work) {
  auto& impulse = state.laws.impulse;
  auto& ahead = state.laws.ahead;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    const bool counts = work.active[lane] != 0;
    const double unit = counts ? state.mass_unit[lane] / mean_decay(drag * state.u_step[lane] / 2) : 0;
    for_rods(state, lane, [&](bool is_tie, std::size_t i, Vec3 way) {
      const double pull = counts ? -unit * double{(is_tie ? work.tie_blow : work.blow)[i]} * norm(way) : 0;
      (is_tie ? ahead.ties : ahead.rods)[i] = pull;
      (is_tie ? impulse.ties : impulse.rods)[i] += pull;
      if (is_tie) state.hold[i] += held(pull, way);
    });
  }
}

void begin_pulls(LoopState& state) {
  const LoopTopology& shape = *state.topology;
  LoopLaws& laws = state.laws;
  std::fill(state.hold.begin(), state.hold.end(), Vec3{});
  if (!laws.pulls) return;
  std::fill(laws.impulse.begin(), laws.impulse.end(), 0.0);
  if (state.u_step == 0) return;
  for (std::size_t k = 0; k < laws.impulse.size(); ++k) laws.impulse[k] = -laws.ahead[k];
  for (const std::uint32_t k : shape.anchored) {
    const auto [a, b] = shape.rods[k];
    state.hold[b - shape.nodes] += held(laws.impulse[k], state.position(a) - state.position(b));
  }
}

void count_pulls_ahead(LoopState& state, double drag, const LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  LoopLaws& laws = state.laws;
  const double unit = state.mass_unit / mean_decay(drag * state.u_step / 2);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const Vec3 way = state.position(a) - state.position(b);
    laws.ahead[k] = -unit * work.blows[k] * norm(way);
    laws.impulse[k] += laws.ahead[k];
    if (b >= shape.nodes) state.hold[b - shape.nodes] += held(laws.ahead[k], way);
  }
}

#define PLUMB_INSTANTIATE(T)                \
  template void begin_pulls(TreeState<T>&); \
  template void count_pulls_ahead(TreeState<T>&, double, const TreeWorkspace<T>&);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
