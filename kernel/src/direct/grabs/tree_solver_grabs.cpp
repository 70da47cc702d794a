// A lane group lets places of its trees be grabbed.

#include <algorithm>

#include "direct/trees/tree_solver.hpp"

namespace plumb::detail {

template <class T>
const char* TreeSolver<T>::refuses_grab(std::span<const Slot> slots) const {
  if (slots.size() == 1) return nullptr;
  if (slots.size() > 2) return "is of more than a rod; rods and bodies have places that can be grabbed";
  if (!state_.is_coupled)
    return "is between particles, and the masses of its island are all in these; grab one of them";
  const bool is_first_tie = is_tie(slots[0]);
  const Entry first = place_of(slots[is_first_tie ? 1 : 0]), second = place_of(slots[is_first_tie ? 0 : 1]);
  const TreeTopology& tree = *state_.topology;
  if (first.lane == second.lane) {
    if (is_first_tie || is_tie(slots[1])) {
      if (second.node >= tree.tie_begin[first.node] && second.node < tree.tie_begin[first.node + 1])
        return nullptr;
    } else if ((first.node > 0 && tree.parent[first.node] == second.node) ||
               (second.node > 0 && tree.parent[second.node] == first.node)) {
      return nullptr;
    }
  }
  return "is not on a rod";
}

template <class T>
void TreeSolver<T>::put_grab(const HeldGrab& held, std::span<const GrabShare> shares) {
  TreeGrab grab{held};
  for (const auto& [slot, share] : shares) {
    const Entry place = place_of(slot);
    const bool of_tie = is_tie(slot);
    grab.lane = of_tie && line_ ? 0 : place.lane;
    std::uint32_t of_line = place.node;
    if (line_ && !of_tie) of_line = line_->segments.node(place.node, place.lane);
    grab.parts[grab.count++] = {place.node, share, of_tie, of_line};
  }
  auto& [first, second] = grab.parts;
  const bool is_turned = first.is_tie || (grab.count == 2 && !second.is_tie && second.entry > 0 &&
                                          state_.topology->parent[second.entry] == first.entry);
  if (is_turned) std::swap(first, second);
  if (kind_->rules.gradient == Gradient::old) keep_velocities(grab.lane);
  Array<TreeGrab>& all = state_.grabs.all;
  all.insert(
      std::find_if(all.begin(), all.end(), [&](const TreeGrab& each) { return each.lane > grab.lane; }),
      grab);
  constexpr std::size_t changed_by_one = 12;  // numbers of a state
  const std::size_t room = changed_by_one * all.size();
  state_.grabs.changed.reserve(room);
  const auto make_room = [&](TreeState<T>& state) {
    state.grabs.changed.reserve(room);
    state.grabs.all.reserve(all.size());
  };
  for (auto& crew : kind_->crews)
    if (TreeState<T>* const alone = crew.alone.made()) make_room(*alone);
  if (line_) make_room(line_->whole);
  for (auto& saved : saved_)
    if (saved) make_room(*saved);
  grabs_changed_ = true;
}

template <class T>
void TreeSolver<T>::end_grab(std::uint32_t number) {
  if (held_grab(number) == nullptr) return;
  Array<TreeGrab>& all = state_.grabs.all;
  for (const TreeGrab& grab : all)
    if (grab.number == number && kind_->rules.gradient == Gradient::old) keep_velocities(grab.lane);
  std::erase_if(all, [&](const TreeGrab& grab) { return grab.number == number; });
  grabs_changed_ = true;
}

/// A damper's force jumps with the velocity of its target.
template <class T>
void TreeSolver<T>::aim_grab(std::uint32_t number, Vec3 velocity) {
  for (TreeGrab& grab : state_.grabs.all) {
    if (grab.number != number || grab.velocity == velocity) continue;
    if (grab.damping > 0 && kind_->rules.gradient == Gradient::old) keep_velocities(grab.lane);
    grab.velocity = velocity;
    grabs_changed_ = true;
  }
}

template <class T>
void TreeSolver<T>::place_grab(std::uint32_t number, Vec3 target) {
  for (TreeGrab& grab : state_.grabs.all) {
    if (grab.number != number || grab.target == target) continue;
    grab.target = target;
    velocities_known_ = false;  // or a snapshot, which does not hold them, would find others
  }
}

template <class T>
const HeldGrab* TreeSolver<T>::held_grab(std::uint32_t number) const {
  for (const TreeGrab& grab : state_.grabs.all)
    if (grab.number == number) return &grab;
  return nullptr;
}

#define PLUMB_INSTANTIATE(T)                                                          \
  template const char* TreeSolver<T>::refuses_grab(std::span<const Slot>) const;      \
  template void TreeSolver<T>::put_grab(const HeldGrab&, std::span<const GrabShare>); \
  template void TreeSolver<T>::end_grab(std::uint32_t);                               \
  template void TreeSolver<T>::aim_grab(std::uint32_t, Vec3);                         \
  template void TreeSolver<T>::place_grab(std::uint32_t, Vec3);                       \
  template const HeldGrab* TreeSolver<T>::held_grab(std::uint32_t) const;
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
