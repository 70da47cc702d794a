// This file lets rods of the contact solver change their lengths.

#include <algorithm>

#include "contact/contact_solver.hpp"

namespace plumb::detail {

bool ContactSolver::is_of_body(std::uint32_t rod) const {
  const auto [island, number] = owners_.rods[rod];
  const Scene& part = parts_[kind_number(states_[island])];
  const Rod& of = part.rods[number];
  return std::any_of(part.bodies.begin(), part.bodies.end(), [&](const Body& body) {
    return std::count_if(body.particles.begin(), body.particles.end(),
                         [&](std::uint32_t each) { return each == of.a || each == of.b; }) == 2;
  });
}

const char* ContactSolver::keeps_length(std::uint32_t rod) const {
  const auto [island, number] = owners_.rods[rod];
  if (states_[island].lengths.find(number)) return nullptr;  // it was asked before
  const Scene& part = parts_[kind_number(states_[island])];
  const Rod& of = part.rods[number];
  if (!of.law.is_rigid()) return "it gives, where its island has joints or shapes";
  if (of.linear_drag != 0 || of.orthogonal_drag != 0)
    return "air drags it, where its island has joints or shapes";
  if (is_of_body(rod)) return "a body holds both its ends";
  const auto lies_along = [&](const Bend& bend) {
    const auto joins = [&](std::uint32_t one, std::uint32_t other) {
      return (of.a == one && of.b == other) || (of.a == other && of.b == one);
    };
    return joins(bend.a, bend.b) || joins(bend.b, bend.c);
  };
  if (std::any_of(part.bends.begin(), part.bends.end(), lies_along))
    return "it bends, where its island has joints or shapes";
  return nullptr;
}

void ContactSolver::set_length(Slot rod, double length, double rate) {
  const auto [island, number] = owners_.rods[rod];
  LinkageState& state = states_[island];
  if (!state.lengths.change(number, length, rate)) {
    const Scene& part = parts_[kind_number(state)];
    // What gives has no row that could follow. It stops, or was cut: its island is made of what it is now.
    if (!part.rods[number].law.is_rigid()) return;
    state.lengths.set(number, static_cast<std::uint32_t>(part.rods.size()), rod_length(part, number), length,
                      rate);
  }
  state.energy.reset();
  if (rate != 0) clusters_.wake(island);
}

}  // namespace plumb::detail
