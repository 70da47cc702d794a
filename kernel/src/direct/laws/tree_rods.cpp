#include "direct/laws/tree_rods.hpp"

#include <array>
#include <cmath>

#include "direct/laws/loop_laws.hpp"

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
void put_length_rates(const TreeState<T>& state, TreeWorkspace<T>& work) {
  for_parts([&](auto part, bool ties) {
    const auto& lengths = part(state.laws.length);
    auto& starts = ties ? work.tie_law_start : work.law_start;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      const std::size_t slope = (simd::tree_fields::law_start * (i / state.lanes) + 2) * state.lanes;
      starts[slope + i % state.lanes] = static_cast<T>(lengths[i] * part(state.laws.rate)[i]);
    }
  });
}

template <class T>
std::uint32_t end_rods(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work) {
  TreeLaws<T>& laws = state.laws;
  const std::size_t lanes = state.lanes;
  std::uint32_t broken = 0;
  for_parts([&](auto part, bool ties) {
    auto& length2 = ties ? state.tie_length2 : state.length2;
    const auto& mu = ties ? state.tie_mu : state.mu;
    const auto& starts = ties ? work.tie_law_start : work.law_start;
    for (std::size_t i = ties ? 0 : lanes; i < length2.size(); ++i) {
      const std::size_t lane = i % lanes, entry = i / lanes;
      if (work.active[lane] == 0) continue;
      if (const double rate = part(laws.rate)[i]; rate != 0) {
        const double length = part(laws.length)[i] += h * rate;
        length2[i] = length * length;
      }
      if (!laws.pulls && !laws.breaks) continue;
      T* const numbers = part(laws.law).data() + law * entry * lanes + lane;
      // The pull of a rigid rod does its work along the mean of its lengths.
      double length = std::sqrt(length2[i]) - h / 2 * part(laws.rate)[i];
      if (numbers[2 * lanes] == 0) {
        std::array<double, simd::tree_fields::law_start> start;
        for (std::size_t c = 0; c < start.size(); ++c)
          start[c] = static_cast<double>(starts[(start.size() * entry + c) * lanes + lane]);
        length = pulled_length(start, static_cast<double>(mu[i]), theta);
      }
      const double pull = -static_cast<double>(mu[i]) * length / static_cast<double>(work.kick[lane]);
      part(laws.impulse)[i] += h * pull * state.mass_unit[lane];
      const double strength = static_cast<double>(numbers[5 * lanes]);
      if (!(strength > 0 && pull > strength)) continue;
      for (std::size_t c = 0; c < law; ++c) numbers[c * lanes] = 0;
      ++broken;
    }
  });
  return broken;
}

#define PLUMB_INSTANTIATE(T)                                              \
  template void set_substep_lengths(TreeState<T>&, double);               \
  template void put_length_rates(const TreeState<T>&, TreeWorkspace<T>&); \
  template std::uint32_t end_rods(TreeState<T>&, double, double, const TreeWorkspace<T>&);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
