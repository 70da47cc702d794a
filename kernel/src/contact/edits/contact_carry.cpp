// This file lets the contact solver go on as one of the same scene did under other settings.

#include <algorithm>
#include <cstddef>
#include <utility>

#include "contact/contact_solver.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {
auto ContactSolver::whereabouts() const -> Whereabouts {
  Whereabouts out;
  for (const LinkageState& state : states_)
    for (std::uint32_t k = 0; state.linkage != nullptr && k < state.linkage->movable(); ++k) {
      const std::uint32_t particle = state.particles[k];
      if (particle >= out.size()) out.resize(particle + std::size_t{1}, {no_island, 0});
      out[particle] = {state.number, k};
    }
  return out;
}

void ContactSolver::go_on_from(const ContactSolver& from) {
  copy_listed(from.surroundings_, surroundings_);
  wake_all();
  Whereabouts were = from.whereabouts();
  were.resize(std::max(were.size(), whereabouts().size()), {no_island, 0});
  for (LinkageState& state : states_) {
    if (state.linkage == nullptr) continue;
    const std::uint32_t island = were[state.particles.front()].first;
    take_motion(state, from, were);
    if (visitors_[state.number].has_home() && island != no_island && !from.visitors_[island].is_at_home())
      visitors_[state.number].stay();
  }
  take_laws(from);
  // Islands have other numbers than before where removed ones left gaps.
  Array<std::uint32_t> now(from.states_.size(), no_island);
  const auto for_same = [&](auto&& f) {
    for (LinkageState& state : states_) {
      const std::uint32_t was = state.linkage ? were[state.particles.front()].first : no_island;
      if (was != no_island && state.particles == from.states_[was].particles &&
          names_[state.number] == from.names_[was])
        f(state, from.states_[was]);
    }
  };
  for_same([&](const LinkageState& state, const LinkageState& was) { now[was.number] = state.number; });
  for_same([&](LinkageState& state, const LinkageState& was) { take_step(state, from, was, now); });
  contacts_ = lists_contacts_ && from.lists_contacts_ ? from.contacts_ : ContactList();
  if (counts_pulls_ == from.counts_pulls_) ground_pushes_ = from.ground_pushes_;
}

/// Takes how particles of an island move that were here. Others are put where they are, as anchors are, and
/// so are those that a home moved and none moves now.
void ContactSolver::take_motion(LinkageState& state, const ContactSolver& from,
                                const Whereabouts& were) const {
  const std::uint32_t movable = state.linkage->movable();
  for (std::uint32_t k = 0; k < movable; ++k) {
    const auto [island, number] = were[state.particles[k]];
    if (island == no_island || (from.visitors_[island].is_at_home() && !visitors_[state.number].has_home()))
      continue;
    const LinkageState& was = from.states_[island];
    state.x[k] = was.x[number];
    state.v[k] = is_finite(was.v[number]) ? was.v[number] : Vec3{};
    if (!relaxes_ && !from.relaxes_ && state.gradient == was.gradient)
      state.acceleration[k] = was.acceleration[number];
  }
  state.factored = false;
  state.energy.reset();
  if (were[state.particles.front()].first == no_island) return;
  const LinkageState& was = from.states_[were[state.particles.front()].first];
  const std::uint32_t were_movable = was.linkage->movable();
  for (std::size_t k = movable; k < state.particles.size(); ++k)
    for (std::size_t i = were_movable; i < was.particles.size(); ++i)
      if (was.particles[i] == state.particles[k])
        state.anchors_went[k - movable] = was.anchors_went[i - were_movable];
  state.slow_time = was.slow_time;
  state.slow_from = was.slow_from;
}

/// Takes what the last step left of an island that has the same particles, shapes and joints. That is where
/// the next one starts to look for forces, if these are alike, and what it was pushed with. `now` says which
/// numbers islands have here.
void ContactSolver::take_step(LinkageState& state, const ContactSolver& from, const LinkageState& was,
                              std::span<const std::uint32_t> now) const {
  if (relaxes_ == from.relaxes_) {
    state.kept = was.kept;
    const auto has_moved = [&](const LinkageState& each) {
      return now[each.number] != each.number && each.linkage != nullptr;
    };
    if (std::any_of(from.states_.begin(), from.states_.end(), has_moved))
      std::erase_if(state.kept, [](const KeptContact& each) { return names_island(each.key); });
    state.on_ground = was.on_ground;
    state.relax_for = was.relax_for;
    state.is_relaxed = was.is_relaxed;
    state.strain = was.strain;
    state.leftovers = was.leftovers;
    state.kept_violations = was.kept_violations;
    if (state.stiffness.size() == was.stiffness.size()) {
      state.stiffness = was.stiffness;
      state.stiffness_before = was.stiffness_before;
      state.knows_tautness = was.knows_tautness;
      state.waves_before = was.waves_before;
    }
  }
  const LinkagePulls& pulls = was.pulls;
  const bool counts_touches = state.pulls.touched.counts;
  const auto fits = [](const auto& one, const auto& other) { return one.size() == other.size(); };
  if (counts_pulls_ == from.counts_pulls_ && fits(pulls.elastics, state.pulls.elastics) &&
      fits(pulls.rods, state.pulls.rods) && fits(pulls.fixed, state.pulls.fixed))
    state.pulls = pulls;
  if (counts_touches_ && from.counts_touches_) state.pulls.touched = pulls.touched;
  state.pulls.touched.counts = counts_touches;
  state.pulls.touched.renumber(now);
}

/// Takes what programs changed of springs and their like, how often they turned, and what broke.
void ContactSolver::take_laws(const ContactSolver& from) {
  const auto keep = [&](const Array<Owner>& of, const Array<Owner>& were, auto&& how) {
    for (std::size_t i = 0; i < std::min(of.size(), were.size()); ++i)
      if (of[i].island < ended && were[i].island < ended)
        (states_[of[i].island].*how)(from.states_[were[i].island], were[i].number, of[i].number);
  };
  keep(owners_.rods, from.owners_.rods, &LinkageState::keep_rod);
  keep(owners_.angles, from.owners_.angles, &LinkageState::keep_angle);
  keep(owners_.springs, from.owners_.springs, &LinkageState::keep_spring);
  keep(owners_.torsions, from.owners_.torsions, &LinkageState::keep_torsion);
  for (LinkageState& state : states_)
    if (state.linkage != nullptr) state.follow_elastics();
}

// --- Sleep

void ContactSolver::wake_all() {
  for (const LinkageState& state : states_) clusters_.wake(state.number);
}

/// Islands of which some part was awake are awake.
void ContactSolver::sleep_as(const ContactSolver& from) {
  const Whereabouts were = from.whereabouts();
  for (const LinkageState& state : states_) {
    if (state.linkage == nullptr || state.asleep) continue;
    const auto movable = state.particles.begin() + static_cast<std::ptrdiff_t>(state.linkage->movable());
    const auto was_asleep = [&](std::uint32_t particle) {
      return particle < were.size() && were[particle].first != no_island &&
             from.states_[were[particle].first].asleep;
    };
    if (std::all_of(state.particles.begin(), movable, was_asleep)) clusters_.fall_asleep(state.number);
  }
}

/// Sweeps leave rods and joints a little off. Velocities are made to fit by what solves them.
void ContactSolver::fit(bool) {
  if (relaxes_) return;
  for (LinkageState& state : states_) {
    if (state.linkage == nullptr || visitors_[state.number].is_at_home()) continue;
    work_.holds.clear();
    project_positions(state, work_);
    if (!state.asleep) project_velocities(state, work_);
  }
}

}  // namespace plumb::detail
