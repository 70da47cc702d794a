#include <algorithm>
#include <cmath>

#include "direct/laws/held_rods.hpp"
#include "direct/trees/newton_limits.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "math/elementary.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
using namespace tree_limits;

template <class T>
void TreeStepper<T>::project(TreeState<T>& state, const Drive& drive, TreeWorkspace<T>& work) const {
  std::fill_n(work.ratio.data(), work.ratio.size(), T(0));
  simd::TreeView<T> view = work.view(state);
  for (std::uint32_t lane = 0; state.laws.gives && lane < state.lanes; ++lane)
    LawFactors::of_projection(double{work.kick[lane]}, state.u_step[lane])
        .put(work.projection_factors.data() + lane, state.lanes);
  view.law_factors = work.projection_factors.data();
  view.length_rate = drive.rate.rods.data();
  view.tie_length_rate = drive.rate.ties.data();
  view.guesses = view.guesses_multipliers = false;  // what the last substeps left must stay
  // Of cables it matters whether a blow pushes.
  if (state.laws.cables || state.laws.pulls) {
    view.blow = work.blow.data();
    view.tie_blow = work.tie_blow.data();
    std::fill_n(work.blow.data(), work.blow.size(), T(0));
    std::fill_n(work.tie_blow.data(), work.tie_blow.size(), T(0));
  }
  for (std::size_t i = 0; i < drive.velocity.size(); ++i)
    put_ties(state, i, drive.velocity[i], drive.before[i]);
  view.has_laws = false;  // projections do not need what substeps of laws do
  kernels(state).prepare(view);
  view.has_laws = state.laws.gives;
  std::copy_n(work.velocity.data(), state.u.size(), work.delta.data());
  kernels(state).project(view);
  std::fill_n(state.tie_delta.data(), state.tie_delta.size(), T(0));
  std::fill_n(state.tie_u.data(), state.tie_u.size(), T(0));
}

template <class T>
void TreeStepper<T>::take_sound(const TreeState<T>& state, const Drive& drive, TreeWorkspace<T>& work,
                                std::span<T> to) const {
  for (std::size_t lane = 0; lane < state.lanes; ++lane) {
    double projected = 0, given = 0;
    for (std::size_t i = lane; i < to.size(); i += state.lanes) {
      projected += square(double{work.delta[i]});
      given += square(double{work.velocity[i]}) + square(double{work.kick[lane]} * double{state.force[i]});
    }
    // An anchor may move all particles, and a rod that is hauled in all that are behind it.
    const double particles = state.topology->nodes;
    for (std::size_t i = lane; i < drive.velocity.size(); i += state.lanes)
      for (const Vec3 v : {drive.velocity[i], drive.before[i]}) given += particles * dot(v, v);
    double hauled = 0;
    for (const auto* const rates : {&drive.rate.rods, &drive.rate.ties})
      for (std::size_t i = lane; state.laws.moves && i < rates->size(); i += state.lanes)
        hauled += std::abs((*rates)[i]);
    given += particles * square(hauled);
    // Numbers that are not finite fail this comparison, too.
    if (projected <= most_projected_growth * given) {
      for (std::size_t i = lane; i < to.size(); i += state.lanes) to[i] = work.delta[i];
      continue;
    }
    const double kick = double{work.kick[lane]} * state.mass_unit[lane];
    for (std::size_t i = lane; kick != 0 && i < to.size(); i += state.lanes)
      to[i] += static_cast<T>(kick * double{state.force[i]} /
                              state.weighs[state.at(static_cast<std::uint32_t>(i / state.lanes / 3), lane)]);
    for (auto* const blow : {&work.blow, &work.tie_blow})
      for (std::size_t i = lane; i < blow->size(); i += state.lanes) (*blow)[i] = 0;
  }
}

namespace {

/// Lets go of cables that a projection would push with more than `share` of what they pulled in the last
/// substep, which they do not do. Returns whether there were any.
template <class T>
bool let_go(TreeState<T>& state, const TreeWorkspace<T>& work, double share = 1) {
  if (!state.laws.cables) return false;
  const std::size_t lanes = state.lanes;
  bool any = false;
  const auto look = [&](std::span<const T> law, std::span<const T> blow, std::span<T> mu) {
    for (std::size_t i = 0; i < mu.size(); ++i) {
      const std::size_t lane = i % lanes;
      const T one_sided = law[simd::tree_fields::law * (i - lane) + 3 * lanes + lane];
      const double kick = state.mu_kick[lane];
      if (one_sided == 0 || kick == 0 || !(mu[i] < 0)) continue;
      if (!(kick * double{blow[i]} > -share * std::sqrt(2 * kick) * double{mu[i]})) continue;
      mu[i] = 0;
      any = true;
    }
  };
  look(state.laws.law.rods, work.blow, state.mu);
  look(state.laws.law.ties, work.tie_blow, state.tie_mu);
  return any;
}

/// Adds what rods pulled with in a projection to what they did in this step.
template <class T>
void count_blows(TreeState<T>& state, const TreeWorkspace<T>& work) {
  if (!state.laws.pulls) return;
  const auto count = [&](std::span<const T> blow, const auto& length2,
                         layouts::AlignedBuffer<double>& impulse) {
    for (std::size_t i = 0; i < blow.size(); ++i)
      impulse[i] -= double{blow[i]} * std::sqrt(double{length2[i]}) * state.mass_unit[i % state.lanes];
  };
  count(work.blow, state.length2, state.laws.impulse.rods);
  count(work.tie_blow, state.tie_length2, state.laws.impulse.ties);
  hold_rod_blows(state, work);
}

/// Lets projections act on lanes whose u are velocities, and no forces.
template <class T>
void set_velocities_active(const TreeState<T>& state, TreeWorkspace<T>& work) {
  std::fill_n(work.kick.data(), work.kick.size(), T(0));
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane)
    work.active[lane] = state.u_step[lane] == 0 ? T(1) : T(0);
}

}  // namespace

/// Projects what is in work.velocity, of lanes whose u are velocities.
template <class T>
void TreeStepper<T>::project_without_pushes(TreeState<T>& state, const Drive& drive,
                                            TreeWorkspace<T>& work) const {
  set_velocities_active(state, work);
  do project(state, drive, work);
  while (let_go(state, work));
}

template <class T>
void TreeStepper<T>::release_thrown_back(TreeState<T>& state, const Drive& jumps,
                                         TreeWorkspace<T>& work) const {
  if (!state.laws.cables) return;
  set_velocities_active(state, work);
  std::fill_n(work.velocity.data(), work.velocity.size(), T(0));
  project(state, jumps, work);
  for (std::size_t i = 0; i < state.u.size(); ++i) work.velocity[i] = state.u[i] + work.delta[i];
  project(state, {state.tie_velocity, state.tie_velocity, state.laws.rate}, work);
  let_go(state, work, thrown_back);
}

template <class T>
void TreeStepper<T>::project_velocities(TreeState<T>& state, TreeWorkspace<T>& work) const {
  std::copy_n(state.u.data(), state.u.size(), work.velocity.data());
  const Drive drive{state.tie_velocity, state.tie_last_velocity, state.laws.rate};
  project_without_pushes(state, drive, work);
  take_sound(state, drive, work, state.u);
  state.tie_last_velocity = state.tie_velocity;
}

template <class T>
void TreeStepper<T>::take_blow(TreeState<T>& state, TreeWorkspace<T>& work) const {
  if (std::none_of(state.u_step.begin(), state.u_step.end(), [](double step) { return step == 0; })) return;
  for (std::size_t i = 0; i < work.tie_jump.size(); ++i)
    work.tie_jump[i] = state.tie_velocity[i] - state.tie_last_velocity[i];
  const Drive drive{work.tie_jump, work.tie_rest, state.laws.jump};
  release_thrown_back(state, drive, work);
  std::fill_n(work.velocity.data(), work.velocity.size(), T(0));
  project_without_pushes(state, drive, work);
  take_sound(state, drive, work, work.velocity);
  for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] += work.velocity[i];
  count_blows(state, work);
  // Where u is a displacement, the next substep passes on how ties change their velocity.
  for (std::size_t i = 0; i < state.tie_velocity.size(); ++i)
    if (state.u_step[i % state.lanes] == 0) state.tie_last_velocity[i] = state.tie_velocity[i];
}

template <class T>
void TreeStepper<T>::find_velocities(TreeState<T>& state, TreeWorkspace<T>& work) const {
  bool any = false;
  for (std::uint32_t lane = 0; lane < state.lanes; ++lane) {
    const double step = state.u_step[lane];
    // Rods that gave do not say which velocities fit.
    const bool projects = step > 0 && !state.gave[lane];
    any = any || projects;
    const T scale = step > 0 ? static_cast<T>(detail::exp(-drag_ * step / 2) / step) : T(1);
    for (std::size_t i = lane; i < state.u.size(); i += state.lanes) work.velocity[i] = scale * state.u[i];
    // The displacement of gradient new is the velocity at the end of its substep, and that of old is half a
    // substep earlier.
    work.kick[lane] = gradient_ == Gradient::old && projects
                          ? static_cast<T>(mean_decay(drag_ * step / 2) * step / 2)
                          : T(0);
    work.active[lane] = projects ? T(1) : T(0);
  }
  if (any) {
    const Drive drive{state.tie_last_velocity, state.tie_last_velocity, state.laws.rate};
    if (state.grabs.any()) hold_at_end(state, work);
    project(state, drive, work);
    take_sound(state, drive, work, work.velocity);
    state.grabs.put_back();
  }
}

#define PLUMB_INSTANTIATE(T)                                                                               \
  template void TreeStepper<T>::project(TreeState<T>&, const Drive&, TreeWorkspace<T>&) const;             \
  template void TreeStepper<T>::project_without_pushes(TreeState<T>&, const Drive&, TreeWorkspace<T>&)     \
      const;                                                                                               \
  template void TreeStepper<T>::release_thrown_back(TreeState<T>&, const Drive&, TreeWorkspace<T>&) const; \
  template void TreeStepper<T>::take_sound(const TreeState<T>&, const Drive&, TreeWorkspace<T>&,           \
                                           std::span<T>) const;                                            \
  template void TreeStepper<T>::project_velocities(TreeState<T>&, TreeWorkspace<T>&) const;                \
  template void TreeStepper<T>::take_blow(TreeState<T>&, TreeWorkspace<T>&) const;                         \
  template void TreeStepper<T>::find_velocities(TreeState<T>&, TreeWorkspace<T>&) const;
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
