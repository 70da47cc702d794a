// An island with loops lets its places be grabbed.

#include <algorithm>

#include "direct/loops/loop_solver.hpp"

namespace plumb::detail {
namespace {

/// Returns the rod between two vertices whose mass couples them, else any between them, else how many rods
/// there are.
std::size_t rod_between(const LoopState& state, Slot a, Slot b) {
  const Array<LoopRod>& rods = state.topology->rods;
  std::size_t found = rods.size();
  for (std::size_t k = 0; k < rods.size(); ++k) {
    if (!((rods[k].a == a && rods[k].b == b) || (rods[k].a == b && rods[k].b == a))) continue;
    if (state.coupling[k] != 0) return k;
    found = std::min(found, k);
  }
  return found;
}

}  // namespace

const char* LoopSolver::refuses_grab(std::span<const Slot> slots) const {
  if (!state_.reels.empty())
    return "is of an island with a reel, whose drum changes what its particles weigh";
  if (slots.size() == 1) return nullptr;
  if (slots.size() > 2) return "is of more than a rod; rods and bodies have places that can be grabbed";
  const std::size_t rod = rod_between(state_, slots[0], slots[1]);
  if (rod == state_.topology->rods.size()) return "is not on a rod";
  if (state_.coupling[rod] == 0)
    return "is between particles, and the masses of its rod are all in these; grab one of them";
  return nullptr;
}

void LoopSolver::put_grab(const HeldGrab& held, std::span<const GrabShare> shares) {
  LoopGrab grab{held};
  for (const auto& [slot, share] : shares) grab.parts[grab.count++] = {slot, share};
  if (grab.count == 2)
    grab.rod = static_cast<std::uint32_t>(rod_between(state_, shares[0].slot, shares[1].slot));
  grabs_change();
  state_.grabs.push_back(grab);
  constexpr std::size_t changed_by_one = 9;  // numbers of a state
  state_.changed.all.reserve(changed_by_one * state_.grabs.size());
  work_.saved.grabs.reserve(state_.grabs.size());
  for (LoopMotion& saved : saved_) saved.grabs.reserve(state_.grabs.size());
}

/// Factors of earlier substeps do not fit any more, nor do displacements stand for velocities.
void LoopSolver::grabs_change() {
  keep_velocities();
  velocity_known_ = false;
  for (LoopWorkspace::Factor* const factor : {work_.first.get(), work_.second.get()})
    if (factor) factor->h = 0;
  grabs_changed_ = true;
}

void LoopSolver::end_grab(std::uint32_t number) {
  if (held_grab(number) == nullptr) return;
  grabs_change();
  std::erase_if(state_.grabs, [&](const LoopGrab& grab) { return grab.number == number; });
  note_masses(state_, work_);
}

/// A damper's force jumps with the velocity of its target.
void LoopSolver::aim_grab(std::uint32_t number, Vec3 velocity) {
  for (LoopGrab& grab : state_.grabs) {
    if (grab.number != number || grab.velocity == velocity) continue;
    if (grab.damping > 0) keep_velocities();
    grab.velocity = velocity;
    grabs_changed_ = true;
  }
}

void LoopSolver::place_grab(std::uint32_t number, Vec3 target) {
  for (LoopGrab& grab : state_.grabs) {
    if (grab.number != number || grab.target == target) continue;
    grab.target = target;
    velocity_known_ = false;  // or a snapshot, which does not hold them, would find others
  }
}

const HeldGrab* LoopSolver::held_grab(std::uint32_t number) const {
  for (const LoopGrab& grab : state_.grabs)
    if (grab.number == number) return &grab;
  return nullptr;
}

}  // namespace plumb::detail
