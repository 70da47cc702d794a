// This file changes springs, torsions and angles of the contact solver's islands.

#include <cmath>
#include <numbers>

#include "contact/contact_solver.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

[[noreturn]] void refuse_number(const char* what, std::uint32_t number) {
  refuse(what, " ", number,
         ": unknown: the scene does not have so many, or its method keeps them as they are");
}

}  // namespace

void refuse_unknown(std::uint32_t number, const Spring&) {
  refuse_number("spring", number);
}
void refuse_unknown(std::uint32_t number, const Torsion&) {
  refuse_number("torsion", number);
}
void refuse_unknown(std::uint32_t number, const AngleControl&) {
  refuse_number("angle", number);
}

void ContactSolver::wake_with_laws(LinkageState& state) {
  state.energy.reset();
  clusters_.wake(state.number);
}

void ContactSolver::set_law(std::uint32_t number, const Spring& spring) {
  if (number >= owners_.springs.size()) refuse_unknown(number, spring);
  LinkageState& state = states_[owners_.springs[number].island];
  const auto [first, count] = state.linkage->elastics_of_spring(owners_.springs[number].number);
  if ((spring.length == 0) != (count > 1))
    refuse("spring ", number, ": its length cannot become 0, nor anything else if it was 0");
  set_laws(spring, std::span(state.laws).subspan(first, count));
  wake_with_laws(state);
}

void ContactSolver::set_law(std::uint32_t number, const Torsion& torsion) {
  if (number >= owners_.torsions.size()) refuse_unknown(number, torsion);
  LinkageState& state = states_[owners_.torsions[number].island];
  const auto [first, count] = state.linkage->elastics_of_torsion(owners_.torsions[number].number);
  set_laws(torsion, std::span(state.laws).subspan(first, count));
  wake_with_laws(state);
}

void ContactSolver::set_law(std::uint32_t number, const AngleControl& angle) {
  if (number >= owners_.angles.size()) refuse_unknown(number, angle);
  LinkageState& state = states_[owners_.angles[number].island];
  const auto [first, count] = state.linkage->elastics_of_angle(owners_.angles[number].number);
  if (count == 0 && (angle.stiffness != 0 || angle.damping != 0))
    refuse("angle ", number, ": had neither stiffness nor damping in the scene, and cannot get them later");
  set_laws(angle, std::span(state.laws).subspan(first, count));
  state.angle_rules[owners_.angles[number].number] = {angle.lower, angle.upper, angle.friction};
  wake_with_laws(state);
}

double ContactSolver::torsion_angle(std::uint32_t number) const {
  if (number >= owners_.torsions.size()) refuse_unknown(number, Torsion{});
  const LinkageState& state = states_[owners_.torsions[number].island];
  return state.elastic_numbers[state.linkage->elastics_of_torsion(owners_.torsions[number].number).first];
}

void ContactSolver::read_law(std::uint32_t number, Spring& out) const {
  const auto [island, own] = owners_.springs[number];
  const auto [first, count] = states_[island].linkage->elastics_of_spring(own);
  const ElasticLaw& along = states_[island].laws[first];
  out.length = along.rest;
  out.force = along.force;
  out.one_sided = along.one_sided;
  const ElasticLaw& pulls = states_[island].laws[first + (count > 1 ? 1 : 0)];
  out.stiffness = pulls.stiffness;
  out.damping = pulls.damping;
}

void ContactSolver::read_law(std::uint32_t number, Torsion& out) const {
  const auto [island, own] = owners_.torsions[number];
  const ElasticLaw& law = states_[island].laws[states_[island].linkage->elastics_of_torsion(own).first];
  constexpr double turn = 2 * std::numbers::pi;
  out.angle = law.rest - turn * std::round(torsion_angle(number) / turn);
  out.stiffness = law.stiffness;
  out.damping = law.damping;
  out.torque = -law.force;
}

void ContactSolver::read_law(std::uint32_t number, AngleControl& out) const {
  const auto [island, own] = owners_.angles[number];
  const LinkageState& state = states_[island];
  const auto& [lower, upper, friction] = state.angle_rules[own];
  out.lower = lower;
  out.upper = upper;
  out.friction = friction;
  const auto [first, count] = state.linkage->elastics_of_angle(own);
  if (count == 0) return;
  out.target = state.laws[first].rest;
  out.stiffness = state.laws[first].stiffness;
  out.damping = state.laws[first].damping;
}

}  // namespace plumb::detail
