#include "direct/twists/tree_twists.hpp"

#include "direct/bends/line_motion.hpp"
#include "direct/trees/tree_solver.hpp"
#include "direct/twists/twist_law.hpp"

namespace plumb::detail {
namespace {

/// Adds up what the torque of a lane asks of what is fixed at the ends of its line.
template <class T>
void add_holds(TreeState<T>& state, std::uint32_t lane, double h, double theta,
               const TreeWorkspace<T>& work) {
  const LineBends& line = state.topology->bends;
  const LineMotion<T> motion{state, work, lane};
  const double impulse = h / static_cast<double>(work.kick[lane]) * state.mass_unit[lane] *
                         static_cast<double>(work.torque[lane]);
  for (std::int64_t slot = line.twist_begin; slot < line.twist_end; ++slot) {
    if (slot >= 2 && slot < state.topology->nodes) continue;  // nothing there is fixed
    const RodPair pull = twist_direction({motion.rod(slot - 1) + theta * motion.growth(slot - 1),
                                          motion.rod(slot) + theta * motion.growth(slot)});
    const Vec3 on[3] = {-1 * pull.first, pull.first - pull.second, pull.second};
    for (std::int64_t i = 0; i < 3; ++i)
      if (const std::int64_t place = slot - 2 + i; !motion.is_node(place))
        state.hold[state.at(motion.end(place), lane)] += impulse * on[i];
  }
}

}  // namespace

template <class T>
void load_twist(TreeState<T>& state, std::uint32_t lane, const BendTable& table, std::uint32_t twist) {
  state.twists.numbers[lane] = twist_numbers(table, twist, state.mass_unit[lane]);
  state.twists.twisted[lane] = state.twists.numbers[lane].imposed;
}

template <class T>
void start_twists(const TreeState<T>& state, double h, TreeWorkspace<T>& work) {
  for (std::uint32_t lane = 0; lane < state.twists.numbers.size(); ++lane) {
    const TwistSubstep now = twist_substep(state.twists.numbers[lane], state.twists.twisted[lane], h,
                                           static_cast<double>(work.kick[lane]), work.is_mid);
    work.twist_stiffness[lane] = static_cast<T>(now.stiffness);
    work.twist_start[lane] = static_cast<T>(now.start);
    work.torque[lane] = static_cast<T>(now.torque);
  }
}

template <class T>
void end_twists(TreeState<T>& state, double h, double theta, const TreeWorkspace<T>& work) {
  for (std::uint32_t lane = 0; lane < state.twists.numbers.size(); ++lane) {
    if (work.active[lane] == 0) continue;
    state.twists.twisted[lane] +=
        static_cast<double>(work.twist_turn[lane]) + h * state.twists.numbers[lane].rate;
    if (state.laws.pulls) add_holds(state, lane, h, theta, work);
  }
}

template <class T>
void TreeSolver<T>::fill_twist(std::uint32_t lane, const BendTable& table, std::uint32_t twist) {
  load_twist(state_, lane, table, twist);
}

#define PLUMB_INSTANTIATE(T)                                                               \
  template void load_twist(TreeState<T>&, std::uint32_t, const BendTable&, std::uint32_t); \
  template void start_twists(const TreeState<T>&, double, TreeWorkspace<T>&);              \
  template void end_twists(TreeState<T>&, double, double, const TreeWorkspace<T>&);        \
  template void TreeSolver<T>::fill_twist(std::uint32_t, const BendTable&, std::uint32_t);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
