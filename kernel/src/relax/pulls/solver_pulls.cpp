// This file adds up how rods pull that relaxation moves, and lets forces and gravity change. It sorts before
// relax_solver.cpp, which instantiates the class.

#include "interface/changes.hpp"
#include "relax/relax_solver.hpp"

namespace plumb::detail {

template <class T>
void RelaxSolver<T>::count_pulls() {
  block_.count_pulls();
  weigh();
}

template <class T>
void RelaxSolver<T>::begin_pulls(std::uint32_t piece) {
  const std::uint32_t positions = block_.packing().positions;
  block_.begin_pulls(pieces_ > 1 ? piece : 0, pieces_ > 1 ? piece + 1 : positions);
}

/// A pull acts as gravity does, see law_terms(). Its impulse is that of a substep.
template <class T>
double RelaxSolver<T>::pull_of_moves(double last) const {
  if (block_.pulls().empty() && !block_.breaks()) return 0;
  if (rules_->verlet.gradient == Gradient::mid) return 2 / h_;
  const double between = (h_ + last) / 2;
  return 1 / (mean_decay(rules_->verlet.drag * between) * between);
}

template <class T>
void RelaxSolver<T>::change_acceleration(Slot slot, Vec3 change) {
  const Displacements now{block_.read(block_.displacement(0), slot),
                          block_.read(block_.displacement(1), slot)};
  write_displacements(slot, rules_->verlet.change_acceleration(now, change));
}

template <class T>
void RelaxSolver<T>::write_displacements(Slot slot, const Displacements& now) {
  block_.write(block_.displacement(0), slot, now.last);
  block_.write(block_.displacement(1), slot, now.before);
}

template <class T>
void RelaxSolver<T>::set_force(Slot slot, Vec3 newton) {
  if (forces_.empty()) forces_.resize(block_.packing().slot_vertex.size());
  const Vec3 change = (h_ * h_ * inverse_mass(slot)) * (newton - forces_[slot]);
  forces_[slot] = newton;
  kicks_stale_ = true;
  if (!has_moved_ || rules_->verlet.gradient == Gradient::mid || block_.is_frozen(slot)) return;
  change_acceleration(slot, change);
}

/// Displacements of gradients old and new know the gravity of their substep, as they know forces.
template <class T>
void RelaxSolver<T>::set_gravity(Vec3 gravity, Vec3 change) {
  rules_->gravity = gravity;
  kicks_stale_ = true;
  if (!has_moved_ || rules_->verlet.gradient == Gradient::mid) return;
  const auto& vertices = block_.packing().slot_vertex;
  for (Slot slot = 0; slot < vertices.size(); ++slot) {
    if (!is_movable(vertices[slot]) || block_.is_frozen(slot)) continue;
    const double share = inverse_mass(slot) / rules_->constants.inverse_mass[vertices[slot]];
    change_acceleration(slot, (h_ * h_ * share) * change);
  }
}

template <class T>
void RelaxSolver<T>::set_length(Slot lane, double length, double rate) {
  lengths_jump_ = lengths_jump_ || rate_changes(block_.rate(lane), rate);
  block_.set_length(lane, length, rate);
}

template void RelaxSolver<float>::set_length(Slot, double, double);
template void RelaxSolver<double>::set_length(Slot, double, double);
template void RelaxSolver<float>::set_force(Slot, Vec3);
template void RelaxSolver<double>::set_force(Slot, Vec3);
template void RelaxSolver<float>::write_displacements(Slot, const Displacements&);
template void RelaxSolver<double>::write_displacements(Slot, const Displacements&);
template void RelaxSolver<float>::change_acceleration(Slot, Vec3);
template void RelaxSolver<double>::change_acceleration(Slot, Vec3);
template void RelaxSolver<float>::set_gravity(Vec3, Vec3);
template void RelaxSolver<double>::set_gravity(Vec3, Vec3);
template void RelaxSolver<float>::count_pulls();
template void RelaxSolver<double>::count_pulls();
template void RelaxSolver<float>::begin_pulls(std::uint32_t);
template void RelaxSolver<double>::begin_pulls(std::uint32_t);
template double RelaxSolver<float>::pull_of_moves(double) const;
template double RelaxSolver<double>::pull_of_moves(double) const;

}  // namespace plumb::detail
