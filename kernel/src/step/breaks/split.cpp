#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Takes the first free seats for so many solvers, and adds what lacks. Returns their numbers.
std::vector<std::uint32_t> take_seats(std::size_t count, std::vector<Seat>& seats) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t s = 0; numbers.size() < count; ++s) {
    if (s == seats.size()) seats.push_back(Seat::free);
    if (seats[s] != Seat::free) continue;
    seats[s] = Seat::taken;
    numbers.push_back(s);
  }
  return numbers;
}

}  // namespace

void Step::split(StepReport&) {
  if (!has_broken_) return;
  has_broken_ = false;
  Fallen fallen = breaks_.take_out([&](std::uint32_t rod) {
    const auto places = compiled_.cords.of(rod);  // The contact solver's islands stay whole.
    return !places.empty() && solver(places.front()).is_broken(places.front().slot);
  });
  if (!fallen.any()) return;
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    Particle& particle = fallen.scene.particles[k];
    particle.position = position(fallen.particles[k]);
    if (!particle.fixed) particle.velocity = velocity(fallen.particles[k]);
  }
  for (std::size_t k = 0; k < fallen.rods.size(); ++k)
    fallen.scene.rods[k].length = lengths_.length(fallen.rods[k]);
  for (std::size_t k = 0; k < fallen.tackles.size(); ++k)
    fallen.scene.tackles[k].length = lengths_.length(compiled_.info.rods + fallen.tackles[k]);
  Settings settings = settings_;
  settings.threads = workers_.size();
  exchange(fallen, compile_parts(fallen.scene, settings));
}

/// Lets new solvers move islands that fell apart, from where they are.
void Step::exchange(const Fallen& fallen, Compiled made) {
  using IslandOfSolver = std::pair<std::uint32_t, std::uint32_t>;
  std::set<IslandOfSolver> gone;
  const auto island_at = [&](const Place& place) {
    return IslandOfSolver{place.solver, solver(place).island_of(place.slot)};
  };
  for (const std::uint32_t particle : fallen.particles)
    if (!anchors_.is_fixed(particle))
      for (const Place& place : compiled_.places.of(particle))
        if (gone.insert(island_at(place)).second) solver(place).set_away(place.slot, true);
  const auto leaves = [&](const Place& place) { return gone.count(island_at(place)) > 0; };

  // Numbers of solvers stay what they are, since others know them. New ones take those that nobody needs.
  std::vector<Seat> seats(compiled_.solvers.size(), Seat::free);
  for (std::size_t s = 0; s < seats.size(); ++s)
    if (compiled_.solvers[s]->has_changing_pieces()) seats[s] = Seat::kept;
  for (const Place& place : compiled_.places.all())
    if (!leaves(place)) seats[place.solver] = Seat::kept;
  const std::vector<std::uint32_t> numbers = take_seats(made.solvers.size(), seats);

  std::vector<std::uint32_t> cords = fallen.rods;
  for (const std::uint32_t tackle : fallen.tackles) cords.push_back(compiled_.info.rods + tackle);
  std::vector<std::uint8_t> changes(compiled_.cords.count(), 0);
  for (const std::uint32_t cord : cords) changes[cord] = 1;
  const auto particle_leaves = [&](std::uint32_t, const Place& place) { return leaves(place); };
  compiled_.places = compiled_.places.replaced(particle_leaves, made.places, fallen.particles, numbers);
  compiled_.twists = compiled_.twists.replaced(particle_leaves, {}, {}, numbers);
  compiled_.cords = compiled_.cords.replaced(
      [&](std::uint32_t cord, const Place&) { return changes[cord] != 0 || breaks_.is_broken(cord); },
      made.cords, cords, numbers);

  compiled_.solvers.resize(seats.size());
  for (std::size_t s = 0; s < numbers.size(); ++s) compiled_.solvers[numbers[s]] = std::move(made.solvers[s]);
  anchors_.resize(seats.size());
  sleep_.exchange(compiled_.solvers, seats);
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    const Particle& particle = fallen.scene.particles[k];
    if (particle.fixed) continue;
    for (const Place& place : made.places.of(static_cast<std::uint32_t>(k))) {
      Solver& to = *compiled_.solvers[numbers[place.solver]];
      to.set_motion(place.slot, particle.position, particle.velocity);
      if (const Vec3 force = loads_.force(fallen.particles[k]); force != Vec3{})
        to.set_force(place.slot, force);
    }
  }
  for (const std::uint32_t number : numbers) compiled_.solvers[number]->go_on(dt_ / rules_.substeps);
}

}  // namespace plumb::detail
