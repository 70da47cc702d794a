// This file reads where particles of a world are, and how fast they go.

#include "step/step.hpp"

namespace plumb::detail {

/// Returns where a particle is moved now, or null for a fixed one from which nothing hangs.
const Place* Step::place_of(std::uint32_t particle) const {
  const auto places = compiled_.places.of(particle);
  if (places.empty()) return nullptr;
  const bool visits = compiled_.contact && &solver(places.back()) == compiled_.contact &&
                      compiled_.contact->has(places.back().slot);
  return visits ? &places.back() : &places.front();
}

Standing Step::standing(std::uint32_t particle) const {
  if (anchors_.is_fixed(particle)) return {};
  // The island is that of the first place, also while the contact solver has it.
  const Place& place = compiled_.places.of(particle).front();
  return {std::uint64_t{place.solver} << 32 | solver(place).island_of(place.slot), is_asleep(particle)};
}

Vec3 Step::position(std::uint32_t particle) const {
  const Place* const place = place_of(particle);
  return place ? solver(*place).position(place->slot) : anchors_.position(particle);
}

Vec3 Step::velocity(std::uint32_t particle) const {
  if (anchors_.is_fixed(particle)) return {};
  const Place* const place = place_of(particle);
  return solver(*place).velocity(place->slot);
}

/// Calls read(solver, runs) for runs of particles, since a call for each would take several times as long,
/// and rest(particle) for those without a place. Then one(slot) reads those that the contact solver has.
template <class Read, class Rest, class One>
void Step::read_all(std::span<Vec3> out, Read&& read, Rest&& rest, One&& one) const {
  compiled_.places.for_reading([&](std::uint32_t number, std::span<const Run> runs) {
    if (number != Run::nowhere) return read(*compiled_.solvers[number], runs);
    for (const Run& run : runs)
      run.for_particles([&](std::uint32_t particle) { out[particle] = rest(particle); });
  });
  if (!compiled_.contact || !compiled_.places.any_several()) return;
  for (std::uint32_t particle = 0; particle < out.size(); ++particle)
    if (compiled_.places.of(particle).size() > 1)
      if (const Place& place = *place_of(particle); &solver(place) == compiled_.contact)
        out[particle] = one(place.slot);
}

void Step::copy_positions(std::span<Vec3> out) const {
  read_all(
      out, [&](const Solver& of, std::span<const Run> runs) { of.read_positions(runs, out.data()); },
      [&](std::uint32_t particle) { return anchors_.position(particle); },
      [&](Slot slot) { return compiled_.contact->position(slot); });
}

void Step::copy_velocities(std::span<Vec3> out) const {
  read_all(
      out, [&](const Solver& of, std::span<const Run> runs) { of.read_velocities(runs, out.data()); },
      [](std::uint32_t) { return Vec3{}; }, [&](Slot slot) { return compiled_.contact->velocity(slot); });
  anchors_.for_fixed([&](std::uint32_t particle) { out[particle] = {}; });
}

std::uint64_t Step::state_hash() const {
  StateHash hash;
  for (std::uint32_t particle = 0; particle < compiled_.info.particles; ++particle) {
    if (!population_.particles.has(particle)) continue;
    if (const Place* const place = place_of(particle))
      solver(*place).add_to_hash(place->slot, hash);
    else
      hash.add<double>(anchors_.position(particle));
  }
  return hash.value();
}

}  // namespace plumb::detail
