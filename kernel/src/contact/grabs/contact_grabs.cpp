// This file lets places of the contact solver's islands be grabbed: particles, places on rods and on bodies.

#include <algorithm>
#include <utility>

#include "contact/contact_solver.hpp"

namespace plumb::detail {

void LinkageState::take_kind(const Linkage& kind) {
  linkage = &kind;
  x.resize(kind.particles());
  v.resize(kind.particles());
  anchors_went.resize(kind.particles() - kind.movable());
  laws.resize(kind.elastics().size());
  elastic_numbers.resize(laws.size(), 0);
  elastic_rates.clear();
  gives.clear();
  if (!wave_inertia_at.empty()) wave_inertia_at.resize(x.size(), 0);
  if (pulls.counts) {
    pulls.elastics.resize(laws.size());
    pulls.along_first.resize(laws.size());
    pulls.fixed.resize(anchors_went.size());
  }
  energy.reset();
  factored = false;
}

const char* ContactSolver::refuses_grab(std::span<const Slot> slots) const {
  const std::uint32_t island = island_of_[slots.front()];
  const bool is_one =
      std::all_of(slots.begin(), slots.end(), [&](Slot slot) { return island_of_[slot] == island; });
  return is_one ? nullptr : "is of more than one island";
}

void ContactSolver::set_gravity(Vec3 gravity, Vec3) {
  for (const auto& linkage : linkages_) linkage->set_gravity(gravity);
  for (const IslandGrabs& of : grabs_) of.linkage->set_gravity(gravity);
  for (LinkageState& state : states_)
    if (state.linkage != nullptr) wake_with_laws(state);
}

/// Returns the kind that an island has when nothing grabs it.
const Linkage* ContactSolver::kind_of(const LinkageState& state) const {
  for (const IslandGrabs& of : grabs_)
    if (of.island == state.number) return linkages_[of.kind].get();
  return state.linkage;
}

/// Islands are in the order of their numbers, so that snapshots have one.
IslandGrabs& ContactSolver::grabs_of(std::uint32_t island) {
  const auto at =
      std::find_if(grabs_.begin(), grabs_.end(), [&](const IslandGrabs& of) { return of.island >= island; });
  if (at != grabs_.end() && at->island == island) return *at;
  std::size_t kind = 0;
  while (linkages_[kind].get() != states_[island].linkage) ++kind;
  return *grabs_.insert(at, IslandGrabs{island, kind});
}

/// Makes a kind of its own for an island with these grabs, and lets it go on as one.
void ContactSolver::make_kind(IslandGrabs& of) {
  LinkageState& state = states_[of.island];
  Scene part = parts_[of.kind].scene();
  part.gravity = linkages_[of.kind]->gravity();
  Array<Combination> sums;
  for (const IslandGrabs::One& each : of.all) {
    Combination& sum = sums.emplace_back(each.at);
    sum.add(static_cast<std::uint32_t>(part.particles.size()), -1);
    part.particles.push_back({.position = each.target, .fixed = true});
  }
  const auto use = relaxes_ ? Linkage::Use::relaxed : Linkage::Use::solved;
  auto made = of.all.empty() ? nullptr : std::make_unique<Linkage>(part, isa_, use, sums);
  const Linkage& kind = made ? *made : *linkages_[of.kind];
  state.take_kind(kind);
  std::size_t anchor = linkages_[of.kind]->particles(), elastic = kind.first_grab();
  for (const IslandGrabs::One& each : of.all) {
    state.x[anchor] = each.target;
    state.v[anchor++] = each.velocity;
    for (int axis = 0; axis < 3; ++axis)
      state.laws[elastic++] = {.stiffness = each.stiffness, .damping = each.damping};
  }
  state.follow_elastics();
  of.linkage = std::move(made);
  for (const auto& mover : movers_) mover->forget();
  wake_with_laws(state);
}

void ContactSolver::put_grab(const HeldGrab& held, std::span<const GrabShare> shares) {
  IslandGrabs& of = grabs_of(island_of_[shares.front().slot]);
  const auto later = std::find_if(of.all.begin(), of.all.end(),
                                  [&](const IslandGrabs::One& each) { return each.number > held.number; });
  IslandGrabs::One& added = *of.all.insert(later, IslandGrabs::One{held});
  for (const auto& [slot, share] : shares) added.at.add(local(slot), share);
  make_kind(of);
}

template <class F>
void ContactSolver::for_grab(std::uint32_t number, F&& f) {
  for (IslandGrabs& of : grabs_)
    for (std::size_t i = 0; i < of.all.size(); ++i)
      if (of.all[i].number == number) return f(of, i);
}

void ContactSolver::end_grab(std::uint32_t number) {
  for_grab(number, [&](IslandGrabs& of, std::size_t i) {
    of.all.erase(of.all.begin() + static_cast<std::ptrdiff_t>(i));
    make_kind(of);
    if (of.all.empty()) std::erase_if(grabs_, [](const IslandGrabs& each) { return each.all.empty(); });
  });
}

void ContactSolver::aim_grab(std::uint32_t number, Vec3 velocity) {
  for_grab(number, [&](IslandGrabs& of, std::size_t i) {
    LinkageState& state = states_[of.island];
    of.all[i].velocity = velocity;
    state.x[linkages_[of.kind]->particles() + i] = of.all[i].target;
    state.v[linkages_[of.kind]->particles() + i] = velocity;
    if (velocity != Vec3{}) clusters_.wake(of.island);
  });
}

void ContactSolver::place_grab(std::uint32_t number, Vec3 target) {
  for_grab(number, [&](IslandGrabs& of, std::size_t i) {
    LinkageState& state = states_[of.island];
    of.all[i].target = target;
    state.x[linkages_[of.kind]->particles() + i] = target;
    state.v[linkages_[of.kind]->particles() + i] = {};
    state.follow_elastics();
  });
}

void ContactSolver::begin_grabs(const LinkageState& state) {
  for (IslandGrabs& of : grabs_)
    if (of.island == state.number)
      for (IslandGrabs::One& each : of.all) each.began = each.at.of(state.x);
}

/// Takes note of what the grabs of an island pulled with in the step that ends.
void ContactSolver::count_grabs(const LinkageState& state, double dt) {
  for (IslandGrabs& of : grabs_) {
    if (of.island != state.number) continue;
    for (std::size_t i = 0; i < of.all.size(); ++i) {
      const std::size_t first = state.linkage->first_grab() + 3 * i;
      of.all[i].impulse = {};
      for (std::size_t axis = 0; axis < 3; ++axis) of.all[i].impulse -= state.pulls.along_first[first + axis];
      of.all[i].work = dot(of.all[i].impulse, (1 / dt) * (of.all[i].at.of(state.x) - of.all[i].began));
    }
  }
}

const HeldGrab* ContactSolver::held_grab(std::uint32_t number) const {
  for (const IslandGrabs& of : grabs_)
    for (const IslandGrabs::One& each : of.all)
      if (each.number == number && states_[of.island].pulls.counts && !visitors_[of.island].is_at_home())
        return &each;
  return nullptr;
}

}  // namespace plumb::detail
