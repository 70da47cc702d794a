// This file lets particles be grabbed that relaxation moves.

#include <algorithm>

#include "relax/relax_solver.hpp"

namespace plumb::detail {

template <class T>
const char* RelaxSolver<T>::refuses_grab(std::span<const Slot> slots) const {
  return slots.size() == 1
             ? nullptr
             : "is between particles, which relaxation moves one by one; grab one of them, or solve directly";
}

template <class T>
typename Block<T>::Weighing RelaxSolver<T>::weighing() const {
  const Settings& settings = rules_->settings;
  return {rules_->constants, settings.weights, settings.order, settings.omega};
}

/// Weighs all rods, also those of grabbed particles.
template <class T>
void RelaxSolver<T>::weigh() {
  block_.set_weights(weighing());
}

/// Lets grabbed particles be as heavy as they are in substeps of `h` (s).
template <class T>
void RelaxSolver<T>::weigh_grabs(double h) {
  const double kick = rules_->verlet.kick({1, 0, 0}, h).x;
  for (BlockGrab& grab : grabs_) {
    grab.kick = rules_->verlet.kick(acceleration(grab.slot), h);
    if (!grab.is_first) continue;
    double mass = grab.mass;
    for (const BlockGrab& each : grabs_)
      if (each.slot == grab.slot)
        mass += kick * GrabSubstep::begin(each, rules_->verlet.gradient, grab.mass, {}, {}, h).stiff;
    block_.set_grabbed(grab.slot, 1 / mass, weighing());
  }
}

template <class T>
Vec3 RelaxSolver<T>::acceleration(Slot slot) const {
  const std::uint32_t particle = particle_of(slot);
  if (!is_movable(particle)) return {};
  if (forces_.empty()) return rules_->gravity;
  return rules_->gravity + rules_->constants.inverse_mass[particle] * forces_[slot];
}

/// Returns the inverse mass (1/kg) of a particle in a substep, with what grabs add to it.
template <class T>
double RelaxSolver<T>::inverse_mass(Slot slot) const {
  const bool is_grabbed =
      std::any_of(grabs_.begin(), grabs_.end(), [&](const BlockGrab& each) { return each.slot == slot; });
  return is_grabbed ? block_.grabbed_inverse_mass(slot) : rules_->constants.inverse_mass[particle_of(slot)];
}

/// Returns the acceleration of a particle that goes by `before` (m) in a substep of `h` (s), grabs included.
template <class T>
Vec3 RelaxSolver<T>::acceleration(Slot slot, Vec3 before, double h) const {
  Vec3 force{};
  double mass = 0;
  for (const BlockGrab& grab : grabs_) {
    if (grab.slot != slot) continue;
    mass = grab.mass;
    force += GrabSubstep::begin(grab, rules_->verlet.gradient, mass, position(slot), before, h).force;
  }
  if (mass == 0) return acceleration(slot);
  return block_.grabbed_inverse_mass(slot) * (mass * acceleration(slot) + force);
}

/// Keeps the velocity of now as what grabs a particle changes, which displacements know of.
template <class T>
template <class Change>
void RelaxSolver<T>::keep_velocity(Slot slot, Change&& change) {
  const bool knows = has_moved_ && rules_->verlet.gradient != Gradient::mid && !block_.is_frozen(slot);
  const Vec3 went = block_.read(block_.displacement(0), slot);
  const Vec3 old = knows ? acceleration(slot, went, h_) : Vec3{};
  change();
  kicks_stale_ = true;
  if (!knows) return;
  change_acceleration(slot, (h_ * h_) * (acceleration(slot, went, h_) - old));
}

template <class T>
template <class Change>
void RelaxSolver<T>::change_grabs(Slot slot, Change&& change) {
  keep_velocity(slot, [&] {
    change();
    weigh();
    if (h_ > 0) weigh_grabs(h_);
  });
}

template <class T>
void RelaxSolver<T>::put_grab(const HeldGrab& held, std::span<const GrabShare> shares) {
  BlockGrab grab{held};
  grab.slot = shares.front().slot;
  grab.mass = 1 / rules_->constants.inverse_mass[particle_of(grab.slot)];
  grab.is_first = std::none_of(grabs_.begin(), grabs_.end(),
                               [&](const BlockGrab& each) { return each.slot == grab.slot; });
  change_grabs(grab.slot, [&] {
    if (grab.is_first) block_.add_grabbed(grab.slot, 1 / grab.mass);
    grabs_.push_back(grab);
  });
  for (Motion& saved : saved_) saved.grabs.reserve(grabs_.size());
}

template <class T>
void RelaxSolver<T>::end_grab(std::uint32_t number) {
  for (std::size_t i = 0; i < grabs_.size(); ++i) {
    if (grabs_[i].number != number) continue;
    const Slot slot = grabs_[i].slot;
    change_grabs(slot, [&] {
      grabs_.erase(grabs_.begin() + static_cast<std::ptrdiff_t>(i));
      const auto next = std::find_if(grabs_.begin(), grabs_.end(),
                                     [&](const BlockGrab& each) { return each.slot == slot; });
      if (next == grabs_.end())
        block_.remove_grabbed(slot);
      else
        next->is_first = true;
    });
    --i;
  }
}

/// A damper's force jumps with the velocity of its target.
template <class T>
void RelaxSolver<T>::aim_grab(std::uint32_t number, Vec3 velocity) {
  for (BlockGrab& grab : grabs_) {
    if (grab.number != number || grab.velocity == velocity) continue;
    if (grab.damping > 0)
      keep_velocity(grab.slot, [&] { grab.velocity = velocity; });
    else
      grab.velocity = velocity;
  }
}

template <class T>
void RelaxSolver<T>::place_grab(std::uint32_t number, Vec3 target) {
  for (BlockGrab& grab : grabs_)
    if (grab.number == number) grab.target = target;
}

template <class T>
const HeldGrab* RelaxSolver<T>::held_grab(std::uint32_t number) const {
  for (const BlockGrab& grab : grabs_)
    if (grab.number == number) return &grab;
  return nullptr;
}

#define PLUMB_INSTANTIATE(T)                                                           \
  template const char* RelaxSolver<T>::refuses_grab(std::span<const Slot>) const;      \
  template typename Block<T>::Weighing RelaxSolver<T>::weighing() const;               \
  template void RelaxSolver<T>::weigh();                                               \
  template void RelaxSolver<T>::weigh_grabs(double);                                   \
  template double RelaxSolver<T>::inverse_mass(Slot) const;                            \
  template Vec3 RelaxSolver<T>::acceleration(Slot) const;                              \
  template Vec3 RelaxSolver<T>::acceleration(Slot, Vec3, double) const;                \
  template void RelaxSolver<T>::put_grab(const HeldGrab&, std::span<const GrabShare>); \
  template void RelaxSolver<T>::end_grab(std::uint32_t);                               \
  template void RelaxSolver<T>::aim_grab(std::uint32_t, Vec3);                         \
  template void RelaxSolver<T>::place_grab(std::uint32_t, Vec3);                       \
  template const HeldGrab* RelaxSolver<T>::held_grab(std::uint32_t) const;
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
