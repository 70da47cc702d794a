#include "direct/grabs/tree_grabs.hpp"

#include <algorithm>
#include <cmath>

#include "direct/trees/tree_state.hpp"
#include "math/elementary.hpp"

namespace plumb::detail {

using namespace simd;

template <class T>
void TreeGrabs<T>::copy_lane(std::uint32_t lane, const TreeGrabs& from, std::uint32_t from_lane) {
  changed.clear();  // those numbers are copied, too
  const auto is_of = [](std::uint32_t which) {
    return [which](const TreeGrab& grab) { return grab.lane == which; };
  };
  const auto count = [&](const Array<TreeGrab>& grabs, std::uint32_t which) {
    return std::count_if(grabs.begin(), grabs.end(), is_of(which));
  };
  if (count(all, lane) != count(from.all, from_lane)) {
    std::erase_if(all, is_of(lane));
    const auto at =
        std::find_if(all.begin(), all.end(), [&](const TreeGrab& each) { return each.lane > lane; });
    TreeGrab added;
    added.lane = lane;
    all.insert(at, static_cast<std::size_t>(count(from.all, from_lane)), added);
  }
  auto to = std::find_if(all.begin(), all.end(), is_of(lane));
  for (const TreeGrab& each : from.all) {
    if (each.lane != from_lane) continue;
    *to = each;
    (to++)->lane = lane;
  }
}

namespace {

/// Adds up what the parts of a place have: of a node, or of a tie's anchor.
Vec3 sum_of(const TreeGrab& grab, auto&& of_node, auto&& of_tie) {
  Vec3 sum{};
  for (const auto& [entry, share, is_tie, line] : grab.all())
    sum += share * (is_tie ? of_tie(3 * std::size_t{entry}) : of_node(3 * std::size_t{entry}));
  return sum;
}

/// Lets nodes be as heavy as a grab makes them, and be pulled by it.
template <class T>
void weigh_down(TreeState<T>& state, const TreeGrab& grab, double inertia) {
  const std::uint32_t lane = grab.lane;
  const double unit = state.mass_unit[lane], added = inertia / unit;
  TreeGrabs<T>& grabs = state.grabs;
  for (const auto& [entry, share, is_tie, line] : grab.all()) {
    if (is_tie) continue;
    const std::uint32_t first = tree_fields::node * entry;
    grabs.change(state.node[state.at(first, lane)], share * share * added);
    if (grab.count == 1) {
      T& over_least = state.node[state.at(first + 3, lane)];
      const double least = 1 / static_cast<double>(over_least);
      grabs.change(over_least, 1 / (least + added) - static_cast<double>(over_least));
    }
    const Vec3 push = (share / unit) * grab.substep.force;
    const double by[3] = {push.x, push.y, push.z};
    for (std::uint32_t c = 0; c < 3; ++c) grabs.change(state.force[state.at(3 * entry + c, lane)], by[c]);
  }
  if (grab.count == 1) return;
  // The second of two is the parent of the first, or the anchor of its tie.
  const auto& [first, second] = grab.parts;
  T& coupling = second.is_tie ? state.tie[state.at(tree_fields::tie * second.entry, lane)]
                              : state.node[state.at(tree_fields::node * first.entry + 1, lane)];
  grabs.change(coupling, first.share * second.share * added);
}

template <class T>
double mass_of(const TreeState<T>& state, const TreeGrab& grab) {
  double gives = 0;
  for (const auto& [entry, share, is_tie, line] : grab.all())
    if (!is_tie)
      gives +=
          share * share / static_cast<double>(state.node[state.at(tree_fields::node * entry, grab.lane)]);
  return state.mass_unit[grab.lane] / gives;
}

/// Begins a substep of a lane, whose nodes would be displaced by `ratio` times u.
template <class T>
void begin(TreeState<T>& state, TreeGrab& grab, double h, Gradient gradient, double ratio, double kick) {
  const std::uint32_t lane = grab.lane;
  const Vec3 x = sum_of(
      grab, [&](std::size_t i) { return state.read(state.x, i, lane); },
      [&](std::size_t i) { return state.read(state.tie_x, i, lane); });
  const Vec3 before = sum_of(
      grab, [&](std::size_t i) { return ratio * state.read(state.u, i, lane); },
      [&](std::size_t i) { return state.read(state.tie_u, i, lane); });
  grab.substep = GrabSubstep::begin(grab, gradient, mass_of(state, grab), x, before, h);
  weigh_down(state, grab, kick * grab.substep.stiff);
}

}  // namespace

template <class T>
void begin_grabs(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work) {
  state.grabs.put_back();
  for (TreeGrab& grab : state.grabs.all)
    if (state.idle[grab.lane] == 0)
      begin(state, grab, h, gradient, static_cast<double>(work.ratio[grab.lane]),
            static_cast<double>(work.kick[grab.lane]));
}

template <class T>
void end_grabs(TreeState<T>& state, double h, Gradient gradient, double drag, TreeWorkspace<T>& work) {
  state.grabs.put_back();
  const double decay = drag > 0 ? detail::exp(-drag * h / 2) : 1;
  for (TreeGrab& grab : state.grabs.all) {
    const std::uint32_t lane = grab.lane;
    if (work.active[lane] == 0) continue;
    const auto moved = [&](std::size_t i) { return state.read(work.delta, i, lane); };
    const Vec3 d = sum_of(grab, moved, [&](std::size_t i) { return state.read(state.tie_delta, i, lane); });
    Vec3 stop{};
    if (gradient == Gradient::mid) {
      const Vec3 past_mean = sum_of(
          grab, [&](std::size_t i) { return state.read(state.u, i, lane) - (decay / h) * moved(i); },
          [](std::size_t) { return Vec3{}; });
      const Vec3 change = grab.substep.velocity_change(past_mean);
      double squares = 0;
      for (const TreeGrab::Part& part : grab.all()) squares += part.is_tie ? 0 : part.share * part.share;
      for (const auto& [entry, share, is_tie, line] : grab.all()) {
        if (is_tie) continue;
        const Vec3 by = (share / squares) * change;
        const double of[3] = {by.x, by.y, by.z};
        for (std::uint32_t c = 0; c < 3; ++c) state.u[state.at(3 * entry + c, lane)] += static_cast<T>(of[c]);
        stop += state.weighs[state.at(entry, lane)] * by;
      }
    }
    grab.substep.end(h, static_cast<double>(work.kick[lane]), d, stop, grab);
  }
}

template <class T>
void hold_at_end(TreeState<T>& state, TreeWorkspace<T>& work) {
  for (TreeGrab& grab : state.grabs.all) {
    const std::uint32_t lane = grab.lane;
    if (work.kick[lane] == 0) continue;
    const double step = state.u_step[lane];
    begin(state, grab, step, Gradient::old, 1, step * step);
  }
}

#define PLUMB_INSTANTIATE(T)                                                           \
  template struct TreeGrabs<T>;                                                        \
  template void begin_grabs(TreeState<T>&, double, Gradient, TreeWorkspace<T>&);       \
  template void end_grabs(TreeState<T>&, double, Gradient, double, TreeWorkspace<T>&); \
  template void hold_at_end(TreeState<T>&, TreeWorkspace<T>&);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
