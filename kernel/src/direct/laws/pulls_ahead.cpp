#include "direct/laws/pulls_ahead.hpp"

#include <algorithm>

#include "direct/loops/loop_vectors.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
namespace {

/// Calls f(part, entry, way) for all rods of a lane: part(numbers) has those of rods to parents or to
/// anchors, and `way` (m) leads from there to the node.
template <class T, class F>
void for_rods(const TreeState<T>& state, std::uint32_t lane, F&& f) {
  const TreeTopology& tree = *state.topology;
  const auto rods = [](auto& of) -> auto& {
    return of.rods;
  };
  const auto ties = [](auto& of) -> auto& {
    return of.ties;
  };
  for (std::uint32_t i = 0; i < tree.nodes; ++i) {
    const Vec3 place = state.position(i, lane);
    if (i > 0) f(rods, i, place - state.position(tree.parent[i], lane));
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k)
      f(ties, k, place - state.read(state.tie_x, 3 * std::size_t{k}, lane));
  }
}

/// Returns what anchors hold against a pull with an impulse (N s) along the way (m) from them.
Vec3 held(double impulse, Vec3 way) {
  return impulse == 0 ? Vec3{} : -impulse / norm(way) * way;
}

}  // namespace

template <class T>
void begin_pulls(TreeState<T>& state) {
  TreeLaws<T>& laws = state.laws;
  std::fill(state.hold.begin(), state.hold.end(), Vec3{});
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane)
    for_rods(state, lane, [&](auto part, std::uint32_t entry, Vec3 way) {
      const std::size_t at = state.at(entry, lane);
      part(laws.impulse)[at] = state.u_step[lane] != 0 ? -part(laws.ahead)[at] : 0;
      if (&part(laws.impulse) == &laws.impulse.ties) state.hold[at] = held(laws.impulse.ties[at], way);
    });
}

template <class T>
void count_pulls_ahead(TreeState<T>& state, double drag, const TreeWorkspace<T>& work) {
  TreeLaws<T>& laws = state.laws;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    const bool counts = work.active[lane] != 0;
    const double unit = counts ? state.mass_unit[lane] / mean_decay(drag * state.u_step[lane] / 2) : 0;
    for_rods(state, lane, [&](auto part, std::uint32_t entry, Vec3 way) {
      const std::size_t at = state.at(entry, lane);
      const bool is_tie = &part(laws.ahead) == &laws.ahead.ties;
      const double ahead = counts ? -unit * double{(is_tie ? work.tie_blow : work.blow)[at]} * norm(way) : 0;
      part(laws.ahead)[at] = ahead;
      part(laws.impulse)[at] += ahead;
      if (is_tie) state.hold[at] += held(ahead, way);
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
