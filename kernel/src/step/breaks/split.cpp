#include <algorithm>
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
  Split now;
  const Fallen fallen = breaks_.take_out([&](std::uint32_t rod) {
    const auto places = compiled_.cords.of(rod);  // The contact solver's islands stay whole.
    const bool leaves = !places.empty() && solver(places.front()).is_broken(places.front().slot);
    if (leaves) now.rods.push_back(rod);
    return leaves;
  });
  if (now.rods.empty()) return;
  for (const std::uint32_t particle : fallen.particles) {
    now.positions.push_back(position(particle));
    now.velocities.push_back(velocity(particle));
  }
  for (const std::uint32_t rod : fallen.rods) now.lengths.push_back(lengths_.length(rod));
  for (const std::uint32_t tackle : fallen.tackles)
    now.lengths.push_back(lengths_.length(compiled_.info.rods + tackle));
  split(fallen, now);
  splits_.push_back(std::move(now));
}

/// Takes out again what a world of this scene took out.
void Step::repeat(const Split& split_then) {
  split(breaks_.take_out([&](std::uint32_t rod) {
    return std::find(split_then.rods.begin(), split_then.rods.end(), rod) != split_then.rods.end();
  }),
        split_then);
  splits_.push_back(split_then);
}

/// Lets new solvers move what fell apart, if anything did.
void Step::split(Fallen fallen, const Split& now) {
  if (!fallen.any()) return;
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    Particle& particle = fallen.scene.particles[k];
    particle.position = now.positions[k];
    if (!particle.fixed) particle.velocity = now.velocities[k];
  }
  for (std::size_t k = 0; k < fallen.rods.size(); ++k) fallen.scene.rods[k].length = now.lengths[k];
  for (std::size_t k = 0; k < fallen.tackles.size(); ++k)
    fallen.scene.tackles[k].length = now.lengths[fallen.rods.size() + k];
  Settings settings = settings_;
  settings.threads = workers_.size();
  exchange(fallen, compile_parts(fallen.scene, settings, compiled_.info.relaxed_rods));
}

/// Lets new solvers move islands that fell apart, from where they are.
void Step::exchange(const Fallen& fallen, Compiled made) {
  using IslandOfSolver = std::pair<std::uint32_t, std::uint32_t>;
  std::set<IslandOfSolver> gone;
  const auto island_at = [&](const Place& place) {
    return IslandOfSolver{place.solver, solver(place).island_of(place.slot)};
  };
  std::vector<double> substeps(fallen.particles.size(), 0);  // s, the last of each particle
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    if (fallen.scene.particles[k].fixed) continue;
    const auto places = compiled_.places.of(fallen.particles[k]);
    substeps[k] = solver(places.front()).last_substep(places.front().slot);
    for (const Place& place : places)
      if (gone.insert(island_at(place)).second) solver(place).remove(place.slot);
  }
  const auto leaves = [&](const Place& place) { return gone.count(island_at(place)) > 0; };

  // Numbers of solvers stay what they are, since others know them. New ones take those that nobody needs.
  seats_.assign(compiled_.solvers.size(), Seat::free);
  for (std::size_t s = 0; s < seats_.size(); ++s)
    if (compiled_.solvers[s]->has_changing_pieces()) seats_[s] = Seat::kept;
  for (const Place& place : compiled_.places.all())
    if (!leaves(place)) seats_[place.solver] = Seat::kept;
  const std::vector<std::uint32_t> numbers = take_seats(made.solvers.size(), seats_);

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

  compiled_.solvers.resize(seats_.size());
  for (std::size_t s = 0; s < numbers.size(); ++s) compiled_.solvers[numbers[s]] = std::move(made.solvers[s]);
  anchors_.resize(seats_.size());
  sleep_.exchange(compiled_.solvers, seats_);
  compiled_.info.islands += made.info.islands - static_cast<std::uint32_t>(gone.size());
  describe();
  compiled_.info.parallel = uses_threads();
  reserve();
  hand_over(fallen, substeps);
}

/// Gives new solvers the motion of islands that fell apart, and the forces on them.
void Step::hand_over(const Fallen& fallen, std::span<const double> substeps) {
  const auto for_movable = [&](auto&& f) {
    for (std::size_t k = 0; k < fallen.particles.size(); ++k)
      if (!fallen.scene.particles[k].fixed)
        for (const Place& place : compiled_.places.of(fallen.particles[k])) f(k, solver(place), place.slot);
  };
  for_movable([&](std::size_t k, Solver& to, Slot slot) {
    to.set_motion(slot, fallen.scene.particles[k].position, fallen.scene.particles[k].velocity);
  });
  for_movable([&](std::size_t k, Solver& to, Slot slot) {
    to.go_on(slot, substeps[k]);
    if (const Vec3 force = loads_.force(fallen.particles[k]); force != Vec3{}) to.set_force(slot, force);
  });
  // They know how fast anchors went, or a steady one would seem to jump.
  anchors_.for_moved([&](std::uint32_t particle, const AnchorMove& path) {
    for (const Place& place : compiled_.places.of(particle))
      if (seats_[place.solver] == Seat::taken) solver(place).move_anchor(place.slot, path);
  });
  for (std::uint32_t s = 0; s < seats_.size(); ++s) {
    if (seats_[s] != Seat::taken) continue;
    compiled_.solvers[s]->end_anchors();
    anchors_.settle(s);
  }
}

}  // namespace plumb::detail
