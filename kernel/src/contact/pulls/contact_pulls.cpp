// This file says what the contact solver's islands were held and pushed with in the last step.

#include <limits>
#include <optional>

#include "contact/contact_solver.hpp"
#include "plumb/joints.hpp"

namespace plumb::detail {

void ContactSolver::name(const SceneParts& parts, std::span<const std::uint32_t> number_of) {
  names_.resize(states_.size());
  for (std::uint32_t part = 0; part < number_of.size(); ++part) {
    if (number_of[part] == no_island) continue;
    Names& names = names_[number_of[part]] = parts.names(part);
    names.particles = {};  // which states know
  }
  for (std::size_t kind = 0; kind < owners_.kinds; ++kind) {
    const Array<SceneParts::Share>& shares = *parts.shares().all()[kind];
    Array<Owner>& owners = *owners_.all()[kind];
    owners.reserve(shares.size());
    for (const auto& [part, number] : shares)
      owners.push_back({part < number_of.size() ? number_of[part] : no_island, number});
  }
  std::uint32_t anchored = 0;
  for (Owner& owner : owners_.capsules)
    if (owner.island == no_island) owner.number = surroundings_.numbers.of_anchored(anchored++);
}

/// Names a shape of an island by its number there.
ShapeId ContactSolver::id_of(std::uint32_t island, std::uint32_t shape) const {
  const auto &capsules = names_[island].capsules, &hulls = names_[island].hulls;
  if (shape < capsules.size()) return {ShapeKind::capsule, capsules[shape]};
  return {ShapeKind::hull, hulls[shape - capsules.size()]};
}

std::optional<std::uint32_t> ContactSolver::middle_of(std::uint32_t capsule) const {
  if (capsule >= owners_.capsules.size() || owners_.capsules[capsule].island >= ended) return std::nullopt;
  const auto [island, number] = owners_.capsules[capsule];
  const Linkage::Shape& shape = states_[island].linkage->shapes()[number];
  const std::uint32_t at = shape.a[0].particle;
  if (shape.a.size() != 1 || shape.b.size() != 1 || shape.b[0].particle != at) return std::nullopt;
  return states_[island].particles[at];
}

Capsule ContactSolver::sphere(std::uint32_t capsule) const {
  const auto [island, number] = owners_.capsules[capsule];
  const Linkage::Shape& shape = states_[island].linkage->shapes()[number];
  const Point middle = point_at(*middle_of(capsule));
  return {.a = middle, .b = middle, .radius = shape.radius, .surface = shape.surface, .filter = shape.filter};
}

void ContactSolver::begin_pulls(const Settings& settings) {
  counts_pulls_ = settings.tensions;
  lists_contacts_ = settings.contacts;
  counts_touches_ = counts_pulls_ || lists_contacts_;
  for (LinkageState& state : states_) {
    if (counts_pulls_) state.pulls = state.linkage->make_pulls();
    state.pulls.touched.counts = counts_touches_;
  }
}

void ContactSolver::list_contacts() {
  if (!counts_touches_) return;
  const bool moved = !pieces_.empty();
  if (!moved && is_listed_ && contacts_.is_steady()) return;  // while all sleep it stays as it is
  is_listed_ = !moved;
  ground_pushes_.assign(surroundings_.numbers.count(), Vec3{});
  contacts_.begin();
  for (const LinkageState& state : states_) {
    if (visitors_[state.number].is_at_home()) continue;
    for (const TouchedPair& pair : state.pulls.touched.pairs()) {
      const bool on_ground = pair.island == TouchedPair::ground;
      if (on_ground) ground_pushes_[pair.other] -= mean(state.pulls, pair.impulse);
      if (lists_contacts_)
        contacts_.add(id_of(state.number, pair.shape),
                      on_ground ? surroundings_.numbers.id(pair.other) : id_of(pair.island, pair.other),
                      pair);
    }
  }
  contacts_.end();
}

void ContactSolver::end_contacts_of(const Names& gone) {
  if (!counts_touches_) return;
  for (const std::uint32_t each : gone.capsules) contacts_.end_pairs_of({ShapeKind::capsule, each});
  for (const std::uint32_t each : gone.hulls) contacts_.end_pairs_of({ShapeKind::hull, each});
}

Vec3 ContactSolver::ground_force(std::uint32_t ground) const {
  return ground < ground_pushes_.size() ? ground_pushes_[ground] : mean(LinkagePulls{}, Vec3{});
}

template <class Number>
Number ContactSolver::mean(const LinkagePulls& pulls, const Number& sum) {
  return (pulls.dt > 0 ? 1 / pulls.dt : std::numeric_limits<double>::quiet_NaN()) * sum;
}

double ContactSolver::pull_of_rod(std::uint32_t rod) const {
  const LinkagePulls& pulls = states_[owners_.rods[rod].island].pulls;
  return mean(pulls, pulls.rods[owners_.rods[rod].number]);
}

double ContactSolver::power_of_rod(std::uint32_t rod) const {
  const auto [island, number] = owners_.rods[rod];
  const RodLengths::Change* const change = states_[island].lengths.find(number);
  return change ? mean(states_[island].pulls, change->work) : 0;
}

bool ContactSolver::has_broken(std::uint32_t rod) const {
  if (rod >= owners_.rods.size()) return false;
  const auto [island, number] = owners_.rods[rod];
  if (island >= ended || states_[island].broken.empty()) return false;
  const auto elastic = states_[island].linkage->elastic_of_rod(number);
  return elastic && states_[island].broken[*elastic] != 0;
}

Vec3 ContactSolver::pin_force(std::uint32_t pin) const {
  const LinkagePulls& pulls = states_[owners_.pins[pin].island].pulls;
  return mean(pulls, pulls.pins[owners_.pins[pin].number]);
}

double ContactSolver::angle_torque(std::uint32_t angle) const {
  const auto [island, number] = owners_.angles[angle];
  const LinkagePulls& pulls = states_[island].pulls;
  const auto [first, count] = states_[island].linkage->elastics_of_angle(number);
  return mean(pulls, pulls.angles[number] - (count > 0 ? pulls.elastics[first] : 0));
}

Vec3 ContactSolver::spring_force(std::uint32_t spring) const {
  const auto [island, number] = owners_.springs[spring];
  const LinkagePulls& pulls = states_[island].pulls;
  const auto [first, count] = states_[island].linkage->elastics_of_spring(number);
  Vec3 sum{};
  for (std::uint32_t i = first; i < first + count; ++i) sum += pulls.along_first[i];
  return mean(pulls, sum);
}

double ContactSolver::torsion_torque(std::uint32_t torsion) const {
  const auto [island, number] = owners_.torsions[torsion];
  const LinkagePulls& pulls = states_[island].pulls;
  return -mean(pulls, pulls.elastics[states_[island].linkage->elastics_of_torsion(number).first]);
}

Vec3 ContactSolver::contact_force(ShapeId shape) const {
  if (!has_shape(shape)) return {};
  const auto [island, number] = owners_of(shape)[shape.number];
  if (island == no_island) return ground_force(number);
  const LinkagePulls& pulls = states_[island].pulls;
  if (visitors_[island].is_at_home() || pulls.dt == 0) return {};
  const std::size_t first = shape.kind == ShapeKind::hull ? names_[island].capsules.size() : 0;
  return mean(pulls, pulls.shapes[first + number]);
}

Vec3 ContactSolver::hold(Slot slot, double) const {
  const LinkageState& state = state_of(slot);
  if (!state.pulls.counts || visitors_[state.number].is_at_home()) return {};
  return -1.0 * mean(state.pulls, state.pulls.fixed[local(slot) - state.linkage->movable()]);
}

}  // namespace plumb::detail
