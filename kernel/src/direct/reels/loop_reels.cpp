#include "direct/reels/loop_reels.hpp"

#include <algorithm>
#include <cmath>

#include "direct/loops/loop_stepper.hpp"
#include "direct/reels/reel_view.hpp"
#include "scene/reels/reels.hpp"

namespace plumb::detail {
namespace {

/// Gives the rod that leaves the drum its own law at a length (m). An elastic rod is the stiffer, the shorter
/// the piece of rope is.
void set_law(LoopState& state, const ReelView& reel, double length) {
  LoopLaws::Numbers law = reel.numbers.laws[reel.motion.first - 1];
  const double stiffer = reel.made_length() / length;
  law[0] *= stiffer;
  law[1] *= stiffer;
  state.laws.rods[reel.rod()] = law;
}

/// Returns the vector along which a rod pulls vertex `of` with a positive multiplier, for the end `theta` of
/// its ends' displacements.
Vec3 pull_along(const LoopState& state, std::uint32_t rod, std::uint32_t of, double theta,
                const LoopWorkspace& work) {
  const auto [a, b] = state.topology->rods[rod];
  const Vec3 along = at(work.d, rod) + theta * (at(work.delta, a) - at(work.delta, b));
  return of == a ? along : -1.0 * along;
}

/// Adds to what a drum held, in N s.
void hold(LoopState& state, const ReelView& reel, Vec3 impulse) {
  state.hold[reel.drum() - state.topology->nodes] += impulse;
}

template <class F>
void for_reels(const LoopState& state, F&& f) {
  for (std::size_t i = 0; i < state.reels.size(); ++i) f(ReelView(state, i), i);
}

}  // namespace

void set_leaving_rod(LoopState& state, const ReelView& reel) {
  const double length = reel.length_after(0);
  state.laws.length[reel.rod()] = length;
  state.length2[reel.rod()] = length * length;
  state.laws.rate[reel.rod()] = reel.length_rate(0);
  set_law(state, reel, length);
}

void weigh_carried(LoopState& state) {
  for_reels(state, [&](const ReelView& reel, std::size_t) {
    state.mass[reel.free()] = reel.numbers.mass[reel.motion.first];
  });
  for_reels(state, [&](const ReelView& reel, std::size_t) { state.mass[reel.free()] += reel.added_mass(); });
}

void load_reels(LoopState& state, const Scene& scene, std::span<const std::uint32_t> reels) {
  if (reels.empty()) return;
  state.laws.make(state.length2);
  state.laws.moves = true;
  state.locks.anchors.assign(state.topology->nodes, Locks::none);
  const RodTable rods(scene);
  for (std::size_t i = 0; i < reels.size(); ++i) {
    const LoopReel& shape = state.topology->reels[i];
    const ReelStart start = start_of(scene, rods, scene.reels[reels[i]]);
    LoopReelNumbers& numbers = state.reel_numbers.emplace_back();
    for (const std::uint32_t vertex : shape.vertices)
      numbers.mass.push_back(vertex < state.topology->nodes ? state.mass[vertex] : 0);
    for (const std::uint32_t rod : shape.rods) {
      numbers.length.push_back(state.laws.length[rod]);
      numbers.laws.push_back(state.laws.rods[rod]);
    }
    numbers.behind = start.behind;
    state.reels.push_back({.out = start.out, .first = start.first});
  }
  restore_reels(state);
  place_wound(state);
}

void begin_reels(LoopState& state) {
  for_reels(state, [&](const ReelView& reel, std::size_t i) { state.reels[i].momentum = reel.momentum(); });
}

void turn_reel(LoopState& state, std::uint32_t reel, double out, double rate) {
  const ReelView view(state, reel);
  const double before = view.length_rate(0);
  state.reels[reel].out = out;
  state.reels[reel].rate = rate;
  set_leaving_rod(state, view);
  state.laws.jump[view.rod()] = view.length_rate(0) - before;
}

void place_wound(LoopState& state) {
  for_reels(state, [&](const ReelView& reel, std::size_t) {
    const Vec3 place = state.position(reel.drum());
    for (std::uint32_t j = 1; j < reel.motion.first; ++j)
      put(&state.x[3 * std::size_t{reel.shape.vertices[j]}], place);
  });
}

void restore_reels(LoopState& state) {
  for_reels(state, [&](const ReelView& reel, std::size_t) {
    for (std::uint32_t j = 0; j < reel.last(); ++j) {
      const std::uint32_t rod = reel.shape.rods[j];
      state.laws.rods[rod] = j + 1 < reel.motion.first ? LoopLaws::Numbers{} : reel.numbers.laws[j];
      state.laws.length[rod] = reel.numbers.length[j];
      state.length2[rod] = reel.numbers.length[j] * reel.numbers.length[j];
      state.laws.rate[rod] = state.laws.jump[rod] = 0;
    }
    for (std::uint32_t j = 1; j <= reel.last(); ++j) {
      const std::uint32_t vertex = reel.shape.vertices[j];
      state.locks.anchors[vertex] = j < reel.motion.first ? reel.drum() : Locks::none;
      state.mass[vertex] = reel.numbers.mass[j];
    }
    set_leaving_rod(state, reel);
  });
  weigh_carried(state);
}

void set_reel_lengths(LoopState& state, double h) {
  for_reels(state, [&](const ReelView& reel, std::size_t) {
    state.mass[reel.free()] = reel.numbers.mass[reel.motion.first];
    if (reel.motion.rate == 0) return;
    const double length = reel.length(), end = reel.length_after(h);
    state.laws.rate[reel.rod()] = (end - length) / h;
    set_law(state, reel, (length + end) / 2);
  });
}

void start_reels(LoopState& state, const SubstepStart& start, LoopWorkspace& work) {
  const double h = start.h, ratio = start.ratio, kick = start.kick;  // clang 14 lets no lambda take bindings
  for_reels(state, [&](const ReelView& reel, std::size_t i) {
    work.reels[i] = {};
    if (!reel.may_carry()) return;
    const Vec3 still = reel.drum_velocity(), free = reel.velocity(reel.free());
    ReelLine from = reel.line(reel.length(), reel.length_rate(0));
    ReelLine to = reel.line(reel.length() + h * state.laws.rate[reel.rod()], reel.length_rate(h));
    // One that is carried for a part of the substep alone takes all of its jump from the drum, and none from
    // its neighbour. Otherwise elastic ropes would be of first order.
    if (from.share == 0 && to.share > 0) from.share_rate = reel.length_rate(0) / reel.made_length();
    if (to.share == 0 && from.share > 0) to.share_rate = reel.length_rate(h) / reel.made_length();
    const Vec3 before = ReelView::velocity_on(from, still, free);
    // The neighbour moves by delta. Then M delta - load of the carried particle is mass (gain delta + known).
    double gain = to.share;
    Vec3 known;
    if (work.laws.is_mid) {  // that is h/2 times its change of velocity, as for free particles
      const double decay = ratio / h;
      gain = std::max(to.share + h / (2 * decay) * to.share_rate, 0.0);
      const Vec3 after = to.share_rate * (from.way - h * still) + (1 - to.share) * still;
      known = h / 2 * (1 / decay * after - decay * (to.share * free + before));
    } else {
      const double inertia = state.u_step != 0 ? ratio * state.u_step : ratio;
      known = (to.share - from.share) * from.way + (1 - to.share) * h * still - inertia * before;
    }
    // What holds it on the line acts on the neighbour by the mean share.
    const double share = (from.share + to.share) / 2, mass = reel.numbers.mass[reel.motion.first - 1];
    work.reels[i].added = share * mass * gain;
    work.reels[i].push = share * (kick * at(state.force, reel.carried()) - mass * known);
    const std::uint32_t node = reel.free();
    state.mass[node] += work.reels[i].added;
    put(&work.load[3 * std::size_t{node}], at(work.load, node) + work.reels[i].push);
  });
}

void end_reels(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work) {
  const double scale = end.h / end.kick * end.mass_unit;
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    const std::uint32_t node = reel.free();
    // The free particle got this from what is locked, and from the rod that leaves the drum.
    const Vec3 given = work.reels[i].push - work.reels[i].added * at(work.delta, node) +
                       state.mu[reel.rod()] * pull_along(state, reel.rod(), node, end.theta, work);
    Vec3 impulse = scale * given;
    for (std::uint32_t j = 1; j < reel.motion.first; ++j)
      impulse += -end.h * end.mass_unit * at(state.force, reel.shape.vertices[j]);
    LoopReelMotion& motion = state.reels[i];
    motion.out += end.h * motion.rate;
    motion.turned += end.h * std::abs(motion.rate);
    set_leaving_rod(state, reel);
    const Vec3 momentum = reel.momentum();
    hold(state, reel, impulse + (momentum - motion.momentum));
    motion.momentum = momentum;
  }
  weigh_carried(state);
}

void note_reel_blows(const LoopState& state, LoopWorkspace& work) {
  for_reels(state,
            [&](const ReelView& reel, std::size_t i) { work.reels[i].before = reel.velocity(reel.free()); });
}

void hold_reel_blows(LoopState& state, const LoopWorkspace& work) {
  for_reels(state, [&](const ReelView& reel, std::size_t i) {
    const std::uint32_t node = reel.free();
    const Vec3 given = work.blows[reel.rod()] * pull_along(state, reel.rod(), node, 0, work) -
                       reel.added_mass() * (reel.velocity(node) - work.reels[i].before);
    hold(state, reel, state.mass_unit * given);
  });
}

Vec3 reeled_position(const LoopState& state, std::uint32_t vertex) {
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    if (reel.may_carry() && reel.carried() == vertex) return reel.place_on(reel.line());
  }
  return state.position(vertex);
}

Vec3 reeled_velocity(const LoopState& state, std::uint32_t vertex, std::span<const double> velocities) {
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    if (reel.may_carry() && reel.carried() == vertex)
      return ReelView::velocity_on(reel.line(),
                                   state.fixed_last_velocity[reel.drum() - state.topology->nodes],
                                   at(velocities, reel.free()));
  }
  return at(velocities, vertex);
}

bool is_wound(const LoopState& state, std::uint32_t rod) {
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    for (std::uint32_t j = 0; j + 1 < reel.motion.first; ++j)
      if (reel.shape.rods[j] == rod) return true;
  }
  return false;
}

double reeled_strain(const LoopState& state, std::uint32_t rod, double strain) {
  if (is_wound(state, rod)) return 0;
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    if (reel.rod() == rod)
      return norm(state.position(reel.free()) - state.position(reel.drum())) / reel.length() - 1;
  }
  return strain;
}

}  // namespace plumb::detail
