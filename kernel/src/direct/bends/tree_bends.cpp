#include "direct/bends/tree_bends.hpp"

#include <algorithm>
#include <cmath>

#include "direct/bends/line_motion.hpp"
#include "direct/trees/tree_solver.hpp"
#include "scene/bends/curvature.hpp"

namespace plumb::detail {
namespace {

using simd::tree_fields::bend;

template <class T>
std::size_t entry(const TreeState<T>& state, std::uint32_t slot, std::uint32_t lane) {
  return state.at(bend * slot, lane);
}

template <class T>
void put_weights(TreeState<T>& state, std::uint32_t slot, std::uint32_t lane, double first, double second) {
  const std::array<double, 3> weights = bend_weights(first, second);
  for (std::uint32_t i = 0; i < 3; ++i)
    state.bends.law[entry(state, slot, lane) + i * state.lanes] = static_cast<T>(weights[i]);
}

/// Returns the length of the rod from a place of a line to the one before, or 0 between fixed particles.
template <class T>
double length_at(const TreeState<T>& state, std::int64_t place, std::uint32_t lane) {
  const auto nodes = static_cast<std::int64_t>(state.topology->nodes);
  const auto root = [&](const auto& squares, std::uint32_t i) {
    return std::sqrt(squares[state.at(i, lane)]);
  };
  if (place == 0) return root(state.tie_length2, state.topology->bends.ends[1]);
  if (place == nodes) return root(state.tie_length2, state.topology->bends.ends[2]);
  return place > 0 && place < nodes ? root(state.length2, static_cast<std::uint32_t>(place)) : 0;
}

template <class T>
void put_present_weights(TreeState<T>& state, std::uint32_t slot, std::uint32_t lane) {
  const BendNumbers numbers = bend_numbers(state, slot, lane);
  const double first = length_at(state, std::int64_t{slot} - 1, lane), second = length_at(state, slot, lane);
  put_weights(state, slot, lane, first > 0 ? first : -1 / numbers.weights[0],
              second > 0 ? second : -1 / numbers.weights[2]);
}

}  // namespace

template <class T>
void load_bends(TreeState<T>& state, std::uint32_t lane, const BendTable& table,
                std::span<const std::uint32_t> bends) {
  const LineBends& line = state.topology->bends;
  for (std::size_t k = 0; k < bends.size(); ++k) {
    const Bend& from = table.scene.bends[bends[k]];
    const auto [first, second] = table.lengths[bends[k]];
    const bool turned = line.turned[k] != 0;
    put_weights(state, line.slots[k], lane, turned ? second : first, turned ? first : second);
    const double numbers[3] = {from.stiffness / state.mass_unit[lane], curvature_of_angle(from.angle),
                               from.damping / state.mass_unit[lane]};
    for (std::uint32_t i = 0; i < 3; ++i)
      state.bends.law[entry(state, line.slots[k], lane) + (3 + i) * state.lanes] = static_cast<T>(numbers[i]);
    state.bends.damped = state.bends.damped || from.damping > 0;
  }
}

template <class T>
BendNumbers bend_numbers(const TreeState<T>& state, std::uint32_t slot, std::uint32_t lane) {
  const auto at = [&](std::uint32_t i) {
    return static_cast<double>(state.bends.law[entry(state, slot, lane) + i * state.lanes]);
  };
  return {{at(0), at(1), at(2)}, at(3), at(4), at(5)};
}

template <class T>
void begin_bends(TreeState<T>& state, double h, TreeWorkspace<T>& work) {
  std::fill_n(work.bend_rate.data(), work.bend_rate.size(), static_cast<T>(1 / h));
  if (!state.laws.moves) return;
  for (const std::uint32_t slot : state.topology->bends.slots)
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) put_present_weights(state, slot, lane);
}

namespace {

/// Adds to the pull of the rod before a place, if there is one, what a force (N s) has along it.
template <class T>
void add_along(const LineMotion<T>& motion, std::int64_t place, double theta, Vec3 force,
               TreeState<T>& state) {
  const auto nodes = static_cast<std::int64_t>(state.topology->nodes);
  if (place < 0 || place > nodes) return;
  const Vec3 d = motion.rod(place) + theta * motion.growth(place);
  const double along = dot(force, d) / norm(d);
  if (place == 0 || place == nodes)
    state.laws.impulse.ties[state.at(motion.end(place == 0 ? -1 : nodes), motion.lane)] += along;
  else
    state.laws.impulse.rods[state.at(static_cast<std::uint32_t>(place), motion.lane)] += along;
}

}  // namespace

template <class T>
void hold_bends(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work) {
  for (const std::uint32_t slot : state.topology->bends.slots)
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
      if (work.active[lane] == 0) continue;
      const LineMotion<T> motion{state, work, lane};
      const BendNumbers numbers = bend_numbers(state, slot, lane);
      const std::int64_t place = slot;
      const Vec3 change =
          numbers.weights[2] * motion.growth(place) - numbers.weights[0] * motion.growth(place - 1);
      const double kick = static_cast<double>(work.kick[lane]);
      const Vec3 start = motion.read(work.bend_start, 3 * std::size_t{slot});
      const Vec3 pull =
          h / kick * state.mass_unit[lane] * bend_pull(numbers, {kick, kick / h, theta}, start, change).pull;
      add_along(motion, place - 1, theta, -numbers.weights[0] * pull, state);
      add_along(motion, place, theta, numbers.weights[2] * pull, state);
      for (std::uint32_t i = 0; i < 3; ++i)
        if (const std::int64_t at = place - 2 + i; !motion.is_node(at))
          state.hold[state.at(motion.end(at), lane)] += numbers.weights[i] * pull;
    }
}

template <class T>
void TreeSolver<T>::fill_bends(std::uint32_t lane, const BendTable& table,
                               std::span<const std::uint32_t> bends) {
  load_bends(state_, lane, table, bends);
}

#define PLUMB_INSTANTIATE(T)                                                                                \
  template void load_bends(TreeState<T>&, std::uint32_t, const BendTable&, std::span<const std::uint32_t>); \
  template BendNumbers bend_numbers(const TreeState<T>&, std::uint32_t, std::uint32_t);                     \
  template void begin_bends(TreeState<T>&, double, TreeWorkspace<T>&);                                      \
  template void hold_bends(TreeState<T>&, double, double, const TreeWorkspace<T>&);                         \
  template void TreeSolver<T>::fill_bends(std::uint32_t, const BendTable&, std::span<const std::uint32_t>);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
