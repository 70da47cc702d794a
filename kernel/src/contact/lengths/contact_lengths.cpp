// This file lets rods of the contact solver change their lengths.

#include "contact/contact_solver.hpp"

namespace plumb::detail {

bool ContactSolver::is_of_body(std::uint32_t rod) const {
  const auto [island, number] = owners_.rods[rod];
  return parts_[kind_number(states_[island])].is_of_body(number);
}

const char* ContactSolver::keeps_length(std::uint32_t rod) const {
  const auto [island, number] = owners_.rods[rod];
  if (states_[island].lengths.find(number)) return nullptr;  // it was asked before
  const KeptPart& part = parts_[kind_number(states_[island])];
  const Rod& of = part.rod(number);
  if (!of.law.is_rigid()) return "it gives, where its island has joints or shapes";
  if (of.linear_drag != 0 || of.orthogonal_drag != 0)
    return "air drags it, where its island has joints or shapes";
  if (part.is_of_body(number)) return "a body holds both its ends";
  if (part.bends(number)) return "it bends, where its island has joints or shapes";
  return nullptr;
}

void ContactSolver::set_length(Slot rod, double length, double rate) {
  const auto [island, number] = owners_.rods[rod];
  LinkageState& state = states_[island];
  if (!state.lengths.change(number, length, rate)) {
    const KeptPart& part = parts_[kind_number(state)];
    // What gives has no row that could follow. It stops, or was cut: its island is made of what it is now.
    if (!part.rod(number).law.is_rigid()) return;
    state.lengths.set(number, state.linkage->rods(), part.rod_length(number), length, rate);
  }
  state.energy.reset();
  if (rate != 0) clusters_.wake(island);
}

}  // namespace plumb::detail
