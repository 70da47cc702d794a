// This file says what the contact solver's islands were held and pushed with in the last step.

#include <limits>

#include "contact/contact_solver.hpp"

namespace plumb::detail {

template <class Number>
Number ContactSolver::mean(const LinkagePulls& pulls, const Number& sum) {
  return (pulls.dt > 0 ? 1 / pulls.dt : std::numeric_limits<double>::quiet_NaN()) * sum;
}

double ContactSolver::pull_of_rod(std::uint32_t rod) const {
  const LinkagePulls& pulls = states_[rods_[rod].island].pulls;
  return mean(pulls, pulls.rods[rods_[rod].number]);
}

bool ContactSolver::has_broken(std::uint32_t rod) const {
  const auto [island, number] = rods_[rod];
  if (island == no_island || states_[island].broken.empty()) return false;
  const auto elastic = states_[island].linkage->elastic_of_rod(number);
  return elastic && states_[island].broken[*elastic] != 0;
}

Vec3 ContactSolver::pin_force(std::uint32_t pin) const {
  const LinkagePulls& pulls = states_[pins_[pin].island].pulls;
  return mean(pulls, pulls.pins[pins_[pin].number]);
}

double ContactSolver::angle_torque(std::uint32_t angle) const {
  const auto [island, number] = angles_[angle];
  const LinkagePulls& pulls = states_[island].pulls;
  const auto [first, count] = states_[island].linkage->elastics_of_angle(number);
  return mean(pulls, pulls.angles[number] - (count > 0 ? pulls.elastics[first] : 0));
}

Vec3 ContactSolver::spring_force(std::uint32_t spring) const {
  const auto [island, number] = springs_[spring];
  const LinkagePulls& pulls = states_[island].pulls;
  const auto [first, count] = states_[island].linkage->elastics_of_spring(number);
  Vec3 sum{};
  for (std::uint32_t i = first; i < first + count; ++i) sum += pulls.along_first[i];
  return mean(pulls, sum);
}

double ContactSolver::torsion_torque(std::uint32_t torsion) const {
  const auto [island, number] = torsions_[torsion];
  const LinkagePulls& pulls = states_[island].pulls;
  return -mean(pulls, pulls.elastics[states_[island].linkage->elastics_of_torsion(number).first]);
}

Vec3 ContactSolver::contact_force(std::uint32_t shape) const {
  const auto [island, number] = shapes_[shape];
  if (island == no_island) return mean(LinkagePulls{}, Vec3{});  // of ground, which is not known
  const LinkagePulls& pulls = states_[island].pulls;
  if (visitors_[island].is_at_home() || pulls.dt == 0) return {};
  return mean(pulls, pulls.shapes[number]);
}

Vec3 ContactSolver::hold(Slot slot, double) const {
  const LinkageState& state = state_of(slot);
  if (!state.pulls.counts || visitors_[state.number].is_at_home()) return {};
  return -1.0 * mean(state.pulls, state.pulls.fixed[local(slot) - state.linkage->movable()]);
}

}  // namespace plumb::detail
