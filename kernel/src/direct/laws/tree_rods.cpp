#include "direct/laws/tree_rods.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "direct/laws/loop_laws.hpp"
#include "direct/laws/pulls_ahead.hpp"

namespace plumb::detail {
namespace {

using simd::tree_fields::law;

/// Calls f(part) for the rods to parents and for those to anchors. part(state) has their numbers, one per rod
/// and lane, and part(laws.any member) those of laws.
template <class F>
void for_parts(F&& f) {
  f(
      [](auto& of) -> auto& { return of.rods; }, false);
  f(
      [](auto& of) -> auto& { return of.ties; }, true);
}

}  // namespace

template <class T>
void set_substep_lengths(TreeState<T>& state, double h) {
  TreeLaws<T>& laws = state.laws;
  laws.steps_are_old = true;
  for_parts([&](auto part, bool ties) {
    auto& length2 = ties ? state.tie_length2 : state.length2;
    for (std::size_t i = 0; i < length2.size(); ++i) {
      const double rate = part(laws.rate)[i];
      if (rate == 0) continue;
      const std::size_t rigid = (law * (i / state.lanes) + 2) * state.lanes + i % state.lanes;
      const double length = part(laws.length)[i] + (part(laws.law)[rigid] != 0 ? h : h / 2) * rate;
      length2[i] = length * length;
    }
  });
}

template <class T>
void draw_cables(TreeState<T>& state) {
  for_parts([&](auto part, bool ties) {
    auto& mu = ties ? state.tie_mu : state.mu;
    for (std::size_t i = 0; i < mu.size(); ++i) {
      const T* const of =
          part(state.laws.law).data() + law * state.lanes * (i / state.lanes) + i % state.lanes;
      const bool is_rigid_cable = of[2 * state.lanes] != 0 && of[3 * state.lanes] != 0;
      if (is_rigid_cable) mu[i] = std::min(mu[i], static_cast<T>(-drawn_cable));
    }
  });
}

namespace {

/// They are numbers of all lanes.
using OfLanes = std::array<double, simd::logical_width<float>>;

/// Breaks the rods of one entry, with these tree_fields::law `numbers`, that pulled more than they hold.
/// Returns how many have broken.
template <class T>
std::uint32_t break_rods(TreeLaws<T>& laws, T* numbers, const OfLanes& pull) {
  const std::size_t lanes = laws.factors.size();
  std::uint32_t broken = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const double strength = static_cast<double>(numbers[5 * lanes + lane]);
    if (!(strength > 0 && pull[lane] > strength)) continue;
    for (std::size_t c = 0; c < law; ++c) numbers[c * lanes + lane] = 0;
    laws.steps_are_old = true;
    ++broken;
  }
  return broken;
}

/// A substep of rods to parents or to anchors has these multipliers, tree_fields::law_start numbers, length h
/// (s) and gradient.
template <class T>
struct EndedSubstep {
  const T *mu, *starts;
  double h, theta;
};

/// Puts the lengths (m) along which the rods of an entry, which may give, have pulled. `first` is the number
/// of its first lane. A rigid rod does its work along the mean of its
/// lengths, but with gradient old it pulls where the substep starts.
template <class T, class Part>
void put_pulled_lengths(const TreeLaws<T>& laws, Part part, std::size_t first, const EndedSubstep<T>& ended,
                        OfLanes& to) {
  const std::size_t lanes = laws.factors.size();
  const T* const rigid = part(laws.law).data() + law * first + 2 * lanes;
  const T* const start = ended.starts + simd::tree_fields::law_start * first;
  const T* const step = part(laws.step).data() + simd::tree_fields::law_step * first;
  const double* const length = part(laws.length).data() + first;
  const double* const rate = part(laws.rate).data() + first;
  const double back = ended.theta == 0 ? ended.h : ended.h / 2;
  for (std::size_t lane = 0; lane < lanes; ++lane) to[lane] = static_cast<double>(start[lane]);
  for (std::size_t lane = 0; ended.theta != 0 && lane < lanes; ++lane)
    to[lane] = pulled_length(static_cast<double>(step[lane]), static_cast<double>(step[lanes + lane]),
                             to[lane], static_cast<double>(start[lanes + lane]),
                             static_cast<double>(ended.mu[first + lane]), ended.theta);
  for (std::size_t lane = 0; lane < lanes; ++lane)
    to[lane] = rigid[lane] != 0 ? length[lane] - back * rate[lane] : to[lane];
}

/// Puts those of elastic cables: what they pull with does not tell how long they are where they come tight.
/// `entry` is a node or a tie.
template <class T>
void put_cable_lengths(const TreeState<T>& state, const TreeWorkspace<T>& work, double theta,
                       std::uint32_t entry, bool is_tie, OfLanes& to) {
  const TreeTopology& tree = *state.topology;
  const auto& laws = is_tie ? state.laws.law.ties : state.laws.law.rods;
  const auto& rods = is_tie ? work.tie_rod : work.rod;
  const auto above = std::upper_bound(tree.tie_begin.begin(), tree.tie_begin.end(), entry);
  const std::size_t node =
      is_tie ? static_cast<std::size_t>(above - tree.tie_begin.begin()) - 1 : std::size_t{entry};
  for (std::size_t lane = 0; lane < state.lanes; ++lane) {
    const T* const numbers = laws.data() + law * state.lanes * entry + lane;
    if (numbers[2 * state.lanes] != 0 || numbers[3 * state.lanes] == 0) continue;
    const Vec3 other = is_tie ? state.read(state.tie_delta, 3 * std::size_t{entry}, lane)
                              : state.read(work.delta, 3 * std::size_t{tree.parent[entry]}, lane);
    const Vec3 d = state.read(rods, simd::tree_fields::rod * std::size_t{entry}, lane);
    const double start = norm(d);
    to[lane] = start + theta * (norm(d + state.read(work.delta, 3 * node, lane) - other) - start);
  }
}

/// Moves lengths of rods by a substep, in lanes that do not stand still.
template <class T>
void move_lengths(TreeState<T>& state, double h, const TreeWorkspace<T>& work) {
  for_parts([&](auto part, bool ties) {
    auto& length2 = ties ? state.tie_length2 : state.length2;
    auto& lengths = part(state.laws.length);
    for (std::size_t i = 0; i < length2.size(); ++i) {
      const double rate = part(state.laws.rate)[i];
      if (rate == 0 || work.active[i % state.lanes] == 0) continue;
      lengths[i] += h * rate;
      length2[i] = lengths[i] * lengths[i];
    }
  });
}

}  // namespace

template <class T>
std::uint32_t end_rods(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work) {
  TreeLaws<T>& laws = state.laws;
  const std::size_t lanes = state.lanes;
  if (laws.moves) move_lengths(state, h, work);
  if (!laws.pulls && !laws.breaks) return 0;
  OfLanes over_kick, weight;  // lanes that stand still have zeros
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    over_kick[lane] = work.active[lane] == 0 ? 0 : -1 / static_cast<double>(work.kick[lane]);
    weight[lane] = pulled_time(theta, h, state.u_step_before[lane]) * state.mass_unit[lane];
  }
  std::uint32_t broken = 0;
  for_parts([&](auto part, bool ties) {
    const auto& mu = ties ? state.tie_mu : state.mu;
    const auto& starts = ties ? work.tie_law_start : work.law_start;
    std::uint32_t entry = ties ? 0 : 1;
    for (std::size_t first = ties ? 0 : lanes; first < mu.size(); first += lanes, ++entry) {
      OfLanes pull;
      if (laws.gives) put_pulled_lengths<T>(laws, part, first, {mu.data(), starts.data(), h, theta}, pull);
      if (laws.cables && theta != 0) put_cable_lengths(state, work, theta, entry, ties, pull);
      if (!laws.gives) std::copy_n(part(laws.length).data() + first, lanes, pull.data());
      double* const impulse = part(laws.impulse).data() + first;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        // Of lanes that have failed, multipliers need not be finite.
        pull[lane] =
            over_kick[lane] == 0 ? 0 : pull[lane] * over_kick[lane] * static_cast<double>(mu[first + lane]);
        impulse[lane] += weight[lane] * pull[lane];
      }
      if (laws.breaks) broken += break_rods(laws, part(laws.law).data() + law * first, pull);
    }
  });
  return broken;
}

#define PLUMB_INSTANTIATE(T)                                \
  template void set_substep_lengths(TreeState<T>&, double); \
  template void draw_cables(TreeState<T>&);                 \
  template std::uint32_t end_rods(TreeState<T>&, double, double, const TreeWorkspace<T>&);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
