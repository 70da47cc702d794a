#include "direct/laws/held_rods.hpp"

#include "direct/laws/pulls_ahead.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

/// Calls f(tie, its node) for all ties that are rods.
template <class T, class F>
void for_ties(const TreeState<T>& state, F&& f) {
  const TreeTopology& tree = *state.topology;
  for (std::uint32_t i = 0; i < tree.nodes; ++i)
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) f(k, i);
}

template <class T>
Vec3 start_of(const TreeState<T>& state, std::uint32_t tie, std::uint32_t lane,
              const TreeWorkspace<T>& work) {
  return state.read(work.tie_rod, simd::tree_fields::rod * tie, lane);
}

}  // namespace

template <class T>
void hold_rods(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work) {
  if (!state.laws.pulls) return;
  for_ties(state, [&](std::uint32_t tie, std::uint32_t node) {
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
      if (work.active[lane] == 0) continue;
      const double pulled = pulled_time(theta, h, state.u_step_before[lane]);
      const double scale = pulled / static_cast<double>(work.kick[lane]) * state.mass_unit[lane];
      const std::size_t at = state.at(tie, lane);
      const Vec3 change = state.read(work.delta, 3 * node, lane) - state.read(state.tie_delta, 3 * tie, lane);
      state.hold[at] +=
          scale * static_cast<double>(state.tie_mu[at]) * (start_of(state, tie, lane, work) + theta * change);
    }
  });
}

template <class T>
void hold_rod_blows(TreeState<T>& state, const TreeWorkspace<T>& work) {
  for_ties(state, [&](std::uint32_t tie, std::uint32_t) {
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
      const std::size_t at = state.at(tie, lane);
      state.hold[at] +=
          state.mass_unit[lane] * static_cast<double>(work.tie_blow[at]) * start_of(state, tie, lane, work);
    }
  });
}

void hold_rods(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work) {
  if (!state.laws.pulls) return;
  const LoopTopology& shape = *state.topology;
  const double scale = end.pulled / end.kick * end.mass_unit;
  for (const std::uint32_t k : shape.anchored) {
    const auto [a, b] = shape.rods[k];
    const Vec3 d = state.position(a) - state.position(b), e = at(work.delta, a) - at(work.delta, b);
    state.hold[b - shape.nodes] += scale * state.mu[k] * (d + end.theta * e);
  }
}

void hold_rod_blows(LoopState& state, const LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  for (const std::uint32_t k : shape.anchored) {
    const auto [a, b] = shape.rods[k];
    state.hold[b - shape.nodes] += state.mass_unit * work.blows[k] * (state.position(a) - state.position(b));
  }
}

#define PLUMB_INSTANTIATE(T)                                                       \
  template void hold_rods(TreeState<T>&, double, double, const TreeWorkspace<T>&); \
  template void hold_rod_blows(TreeState<T>&, const TreeWorkspace<T>&);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
