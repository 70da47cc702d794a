// This file makes islands of the contact solver anew that a program edits, and ends those that are removed.

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "contact/contact_solver.hpp"
#include "contact/linkage/scene_parts.hpp"
#include "math/byte_sum.hpp"

namespace plumb::detail {
void LinkageState::end() {
  motion() = {};
  asleep = true;
  linkage = nullptr;
  particles.clear();
  force.clear();
  laws.clear();
  gives.clear();
  angle_rules.clear();
  factors.clear();
  wave_inertia_at.clear();
  wave_inertia.clear();
  factored = false;
}

/// Goes on as `from`, an island of which this one has the particles `of`. Factors, and the forces of contacts
/// from which substeps start, are found anew.
void LinkageState::go_on_from(const LinkageState& from, std::span<const std::uint32_t> of) {
  const std::uint32_t were_movable = static_cast<std::uint32_t>(from.force.size());
  for (std::uint32_t k = 0; k < of.size(); ++k) {
    const bool is_movable = k < linkage->movable(), was_movable = of[k] < were_movable;
    particles.push_back(from.particles[of[k]]);
    x[k] = from.x[of[k]];
    v[k] = is_movable || !was_movable ? from.v[of[k]] : Vec3{};
    if (is_movable) {
      force[k] = from.force[of[k]];
      acceleration[k] = from.acceleration[of[k]];
    } else if (!was_movable) {
      anchors_went[k - linkage->movable()] = from.anchors_went[of[k] - were_movable];
    }
  }
  gradient = from.gradient;
  asleep = false;
  frozen = from.frozen;
  on_ground = from.on_ground;
  relax_for = from.relax_for;
  is_relaxed = from.is_relaxed;
  strain = from.strain;
  leftovers.go_on(from.leftovers);
}

/// Copies how elastics pull and are numbered, where as many are there.
void LinkageState::keep_elastics(const LinkageState& from, Linkage::ElasticRange old,
                                 Linkage::ElasticRange own) {
  if (old.count != own.count) return;
  for (std::uint32_t i = 0; i < old.count; ++i) {
    laws[own.first + i] = from.laws[old.first + i];
    elastic_numbers[own.first + i] = from.elastic_numbers[old.first + i];
  }
}

void LinkageState::keep_rod(const LinkageState& from, std::uint32_t old, std::uint32_t own) {
  const auto was = from.linkage->elastic_of_rod(old), is = linkage->elastic_of_rod(own);
  if (!was || !is) return;
  keep_elastics(from, {static_cast<std::uint32_t>(*was), 1}, {static_cast<std::uint32_t>(*is), 1});
  if (!from.broken.empty() && !broken.empty()) broken[*is] = from.broken[*was];
}

void LinkageState::keep_angle(const LinkageState& from, std::uint32_t old, std::uint32_t own) {
  keep_elastics(from, from.linkage->elastics_of_angle(old), linkage->elastics_of_angle(own));
  angle_rules[own] = from.angle_rules[old];
}

void LinkageState::keep_spring(const LinkageState& from, std::uint32_t old, std::uint32_t own) {
  keep_elastics(from, from.linkage->elastics_of_spring(old), linkage->elastics_of_spring(own));
}

void LinkageState::keep_torsion(const LinkageState& from, std::uint32_t old, std::uint32_t own) {
  keep_elastics(from, from.linkage->elastics_of_torsion(old), linkage->elastics_of_torsion(own));
}

/// Returns an island as its kind was made, with the scene's numbers of what it has.
NamedPart ContactSolver::named_part(std::uint32_t island) const {
  const std::size_t kind = kind_number(states_[island]);
  NamedPart out;
  out.scene = parts_[kind].scene();
  out.scene.gravity = linkages_[kind]->gravity();
  out.names = names_[island];
  out.names.particles = states_[island].particles;
  return out;
}

/// Lets the elastics and lengths of part `number` go on as in the islands where they were: what programs
/// changed of them, turns, and what broke. Homes tell the lengths of rods of plain islands by themselves.
void ContactSolver::copy_laws(const NamedPart& whole, const SceneParts& parts, std::uint32_t number,
                              LinkageState& to, bool with_plain_lengths) const {
  using Shares = Array<SceneParts::Share>;
  // A torsion that is joined begins within half a turn of now, not of where its sides stood in the scene.
  std::fill(to.elastic_numbers.begin(), to.elastic_numbers.end(), 0.0);
  const ByKind<Shares>& shares = parts.shares();
  const auto for_own = [&](const Array<std::uint32_t>& names, const Array<Owner>& owners,
                           const Shares& of_kind, auto&& f) {
    for (std::uint32_t i = 0; i < of_kind.size(); ++i)
      if (of_kind[i].part == number && names[i] < owners.size() && owners[names[i]].island < ended)
        f(i, of_kind[i].number, states_[owners[names[i]].island], owners[names[i]].number);
  };
  const auto keep = [&](auto&& how) {
    return [&to, how](std::uint32_t, std::uint32_t own, const LinkageState& from, std::uint32_t old) {
      (to.*how)(from, old, own);
    };
  };
  for_own(whole.names.rods, owners_.rods, shares.rods,
          [&](std::uint32_t i, std::uint32_t own, const LinkageState& from, std::uint32_t old) {
            const RodLaw& law = whole.scene.rods[i].law;
            if (law.stiffness != 0) to.keep_rod(from, old, own);
            const RodLengths::Change* const change = from.lengths.find(old);
            // What was cut, and of which the mass alone is left, gives.
            if (change && law.is_rigid() && (with_plain_lengths || is_plain_[from.number] == 0))
              to.lengths.take(*change, own, to.linkage->rods());
          });
  for_own(whole.names.angles, owners_.angles, shares.angles, keep(&LinkageState::keep_angle));
  for_own(whole.names.springs, owners_.springs, shares.springs, keep(&LinkageState::keep_spring));
  for_own(whole.names.torsions, owners_.torsions, shares.torsions, keep(&LinkageState::keep_torsion));
  to.follow_elastics();
}

std::optional<std::uint32_t> ContactSolver::mover_of(std::size_t kind, std::uint32_t number) const {
  const Array<Owner>& owners = *owners_.all()[kind];
  if (number >= owners.size() || owners[number].island >= ended) return std::nullopt;
  return states_[owners[number].island].particles.front();
}

/// Lets nothing move an island any more, nor find it.
void ContactSolver::retire(std::uint32_t island) {
  if (states_[island].linkage == nullptr) return;
  for (std::size_t kind = 0; kind < owners_.kinds; ++kind)
    for (const std::uint32_t name : *names_[island].all()[kind])
      if (Owner& owner = (*owners_.all()[kind])[name]; owner.island == island) owner.island = ended;
  names_[island] = {};
  --uses_[kind_number(states_[island])];
  clusters_.end(island);
  states_[island].end();
  visitors_[island].end();
  numbers_.end(island);
  for (const auto& mover : movers_) mover->forget();
}

void ContactSolver::remove(Slot slot) {
  retire(island_of_[slot]);
}

std::size_t ContactSolver::kind_number(const LinkageState& state) const {
  const Linkage* const of = kind_of(state);
  std::size_t kind = 0;
  while (linkages_[kind].get() != of) ++kind;
  return kind;
}

/// Lets the islands of an edited part take the place of those of which it was made. go_on() does what lets
/// the state of one go on. plain() says whether one may go home; without shapes it is left there.
void ContactSolver::replace(std::span<const std::uint32_t> islands, const NamedPart& by, const IsPlain& plain,
                            const GoOn& go_on) {
  const SceneParts parts(by.scene);
  Array<std::uint32_t> numbers(parts.count(), ended);
  for (std::uint32_t p = 0; p < parts.count(); ++p) {
    const Scene part = parts.part(p);
    const bool may_go_home = plain(parts, p);
    if (may_go_home && part.capsules.empty()) continue;
    numbers[p] = begin_island(kind_like(part), part, may_go_home);
    go_on(parts, p, states_[numbers[p]]);
  }
  clusters_.grow(states_);
  for (const std::uint32_t number : numbers)
    if (number != ended) clusters_.begin(number);
  for (const std::uint32_t island : islands) retire(island);
  rename(by, parts, numbers);
}

auto ContactSolver::make_anew(std::span<const std::uint32_t> islands, const PartEdits& edits) -> Array<Made> {
  Array<Made> out;
  for (const std::uint32_t island : islands) {
    clusters_.wake(island);  // and what lies on it
    NamedPart part = named_part(island);
    edit(part, edits);
    const bool plain = is_plain_[island] != 0, visits = plain && !visitors_[island].is_at_home();
    const auto stays_plain = [plain](const SceneParts&, std::uint32_t) { return plain; };
    const auto go_on = [&](const SceneParts& parts, std::uint32_t p, LinkageState& state) {
      state.go_on_from(states_[island], parts.particles(p));
      copy_laws(part, parts, p, state, true);
      out.push_back({state.number, visits});
    };
    replace({&island, 1}, part, stays_plain, go_on);
  }
  return out;
}

auto ContactSolver::add(const NamedPart& part) -> Array<Made> {
  Array<Made> out;
  const auto may_go_home = [](const SceneParts& parts, std::uint32_t p) { return is_plain(parts.part(p)); };
  replace({}, part, may_go_home, [&](const SceneParts& parts, std::uint32_t p, LinkageState& state) {
    for (const std::uint32_t own : parts.particles(p)) state.particles.push_back(part.names.particles[own]);
    state.gradient = gradients_.of(*state.linkage, is_plain_[state.number] != 0);
    out.push_back({state.number, false});
  });
  return out;
}

/// Does to an island what is listed of it.
void ContactSolver::edit(NamedPart& part, const PartEdits& edits) {
  const Scene before = part.scene;
  part.refix(edits);  // before cuts, which give movable particles shapes
  part.sever(edits.severed);
  for (const std::uint32_t rod : edits.cut) part.cut(rod, edits);
  for (const auto& [particle, mass] : edits.heavier)
    if (Particle* const own = part.find(particle)) own->mass += mass;
  part.end_fixed();
  part.end_torn_capsules(&before);
}

/// Returns whether a part that is like a kind is of it. How a part stands may forbid motions twice, as of a
/// line between two anchors that is straight. A kind is made for that, by how its first part stood.
bool ContactSolver::is_of_kind(std::size_t kind, const Scene& part) const {
  if (relaxes_) return true;
  const Linkage& of = *linkages_[kind];
  Array<Vec3> x;
  for (const Particle& particle : part.particles) x.push_back(particle.position);
  const bool is_redundant = of.is_redundant_at(x);
  return is_redundant == of.is_redundant() && (!is_redundant || parts_[kind].stands_like(part));
}

/// Returns a kind that is like a part, if there is one, or makes it.
std::size_t ContactSolver::kind_like(const Scene& part) {
  const Array<double> numbers = likeness(part);
  const auto sum_over = [](const Array<double>& of) { return sum_of(std::as_bytes(std::span(of)), {}); };
  const std::uint64_t sum = sum_over(numbers);
  while (sums_.size() < parts_.size())  // those that the world began with
    sums_.push_back(sum_over(likeness(parts_[sums_.size()].scene())));
  for (std::size_t kind = 0; kind < parts_.size(); ++kind)
    if (sums_[kind] == sum && likeness(parts_[kind].scene()) == numbers && is_of_kind(kind, part))
      return kind;
  const std::size_t kind = add_kind(part, KeptPart(part));
  sums_.resize(parts_.size());
  sums_[kind] = sum;
  return kind;
}

std::size_t ContactSolver::add_kind(const Scene& part, KeptPart kept) {
  // One that no island has any more, or a new one.
  const auto kind = static_cast<std::size_t>(std::find(uses_.begin(), uses_.end(), 0u) - uses_.begin());
  if (kind == uses_.size()) {
    uses_.push_back(0);
    linkages_.emplace_back();
    parts_.emplace_back();
  }
  const auto use = relaxes_ ? Linkage::Use::relaxed : Linkage::Use::solved;
  linkages_[kind] = std::make_unique<Linkage>(part, isa_, use);
  parts_[kind] = std::move(kept);
  return kind;
}

void ContactSolver::resize_islands(std::uint32_t count) {
  for (std::uint32_t number = island_count(); number < count; ++number) numbers_.add_free(number);
  make_room(count);
}

void ContactSolver::make_room(std::uint32_t count) {
  if (count < island_count()) return;
  for (std::uint32_t number = island_count(); number < count; ++number) states_.emplace_back(number);
  is_plain_.resize(count, 0);
  first_slot_.resize(count, 0);
  names_.resize(count);
  rooms_.resize(count);
  visitors_.resize(count);
  if (is_controlled_) histories_.resize(count);
  clusters_.grow(states_);
}

/// Begins an island of a kind, and returns its number.
std::uint32_t ContactSolver::begin_island(std::size_t kind, const Scene& part, bool plain) {
  const std::uint32_t number = numbers_.take(island_count());
  if (number >= island_count()) make_room(number + 1);
  LinkageState& state = states_[number] = LinkageState(*linkages_[kind], number, part, relaxes_);
  ++uses_[kind];
  if (counts_pulls_) state.pulls = state.linkage->make_pulls();
  state.pulls.touched.counts = counts_touches_;
  is_plain_[number] = plain;
  const std::size_t slots = part.particles.size();
  if (slots > rooms_[number]) {
    first_slot_[number] = static_cast<Slot>(island_of_.size());
    island_of_.resize(island_of_.size() + slots, number);
    rooms_[number] = slots;
  }
  return number;
}

/// Lets what has numbers in the scene be found in the islands `numbers` of a part. The rest is where it was,
/// or has ended with its island.
void ContactSolver::rename(const NamedPart& part, const SceneParts& parts,
                           std::span<const std::uint32_t> numbers) {
  for (std::size_t kind = 0; kind < owners_.kinds; ++kind) {
    const Array<std::uint32_t>& names = *part.names.all()[kind];
    const Array<SceneParts::Share>& shares = *parts.shares().all()[kind];
    if (shares.empty() || names.empty()) continue;
    Array<Owner>& owners = *owners_.all()[kind];
    const std::size_t least = *std::max_element(names.begin(), names.end()) + std::size_t{1};
    owners.resize(std::max(owners.size(), least), Owner{ended, 0});
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::uint32_t number = shares[i].part < numbers.size() ? numbers[shares[i].part] : ended;
      if (number == ended) continue;
      owners[names[i]] = {number, shares[i].number};
      names_[number].all()[kind]->push_back(names[i]);
    }
  }
}

}  // namespace plumb::detail
