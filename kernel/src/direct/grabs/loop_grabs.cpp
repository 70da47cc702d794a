#include "direct/grabs/loop_grabs.hpp"

#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

bool is_fixed(const LoopState& state, std::uint32_t vertex) {
  return vertex >= state.topology->nodes;
}

double mass_of(const LoopState& state, const LoopGrab& grab) {
  double gives = 0;
  for (const auto& [vertex, share] : grab.all())
    if (!is_fixed(state, vertex)) gives += share * share / state.mass[vertex];
  return state.mass_unit / gives;
}

void begin(LoopState& state, LoopGrab& grab, const GrabBegin& substep, Gradient gradient) {
  Vec3 x{}, before{};
  for (const auto& [vertex, share] : grab.all()) {
    x += share * at(state.x, vertex);
    before += share * (is_fixed(state, vertex)
                           ? substep.h * state.fixed_last_velocity[vertex - state.topology->nodes]
                           : substep.ratio * at(state.u, vertex));
  }
  grab.substep = GrabSubstep::begin(grab, gradient, mass_of(state, grab), x, before, substep.h);
  const double added = substep.kick * grab.substep.stiff / state.mass_unit;
  for (const auto& [vertex, share] : grab.all()) {
    if (is_fixed(state, vertex)) continue;
    state.changed.change(state.mass[vertex], share * share * added);
    const Vec3 push = (share / state.mass_unit) * grab.substep.force;
    const double by[3] = {push.x, push.y, push.z};
    for (std::size_t c = 0; c < 3; ++c) state.changed.change(state.force[3 * std::size_t{vertex} + c], by[c]);
  }
  if (grab.count == 2)
    state.changed.change(state.coupling[grab.rod], grab.parts[0].share * grab.parts[1].share * added);
}

}  // namespace

void note_masses(const LoopState& state, LoopWorkspace& work) {
  if (work.lines)
    work.lines->solver.set_masses(state.mass, [&](std::uint32_t i) { return state.locks.has(i); });
}

void begin_grabs(LoopState& state, const GrabBegin& substep, Gradient gradient, LoopWorkspace& work) {
  state.changed.put_back();
  if (state.grabs.empty()) return;
  for (LoopGrab& grab : state.grabs) begin(state, grab, substep, gradient);
  note_masses(state, work);
}

void end_grabs(LoopState& state, const GrabBegin& substep, double decay, LoopWorkspace& work) {
  state.changed.put_back();
  for (LoopGrab& grab : state.grabs) {
    Vec3 d{}, past_mean{}, stop{};
    double squares = 0;
    for (const auto& [vertex, share] : grab.all()) {
      d += share * at(work.delta, vertex);
      if (is_fixed(state, vertex)) continue;
      past_mean += share * (at(state.u, vertex) - (decay / substep.h) * at(work.delta, vertex));
      squares += share * share;
    }
    const Vec3 change = grab.substep.velocity_change(past_mean);
    for (const auto& [vertex, share] : grab.all()) {
      if (is_fixed(state, vertex) || !grab.substep.is_mid) continue;
      const Vec3 by = (share / squares) * change;
      put(&state.u[3 * std::size_t{vertex}], at(state.u, vertex) + by);
      stop += state.mass_unit * state.weighs[vertex] * by;
    }
    grab.substep.end(substep.h, substep.kick, d, stop, grab);
  }
}

void hold_at_end(LoopState& state, LoopWorkspace& work) {
  for (LoopGrab& grab : state.grabs)
    begin(state, grab, {state.u_step, 1, state.u_step * state.u_step}, Gradient::old);
  note_masses(state, work);
}

}  // namespace plumb::detail
