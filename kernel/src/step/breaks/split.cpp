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
  if (!(next_gravity_ == gravity_)) change_gravity();
  if (!has_broken_ && !edits_.any()) return;
  Split now;
  if (std::exchange(has_broken_, false))
    for (const std::uint32_t rod : breaks_.weak()) {
      if (breaks_.is_out(rod)) continue;
      const auto places = compiled_.cords.of(rod);  // The contact solver's islands stay whole.
      if (!places.empty() && solver(places.front()).is_broken(places.front().slot)) now.rods.push_back(rod);
    }
  std::swap(now.edits, edits_);
  if (now.rods.empty() && !now.edits.any()) return;
  const Fallen fallen = breaks_.take_out(now.rods, now.edits);
  for (const std::uint32_t particle : fallen.particles) {
    now.positions.push_back(position(particle));
    now.velocities.push_back(velocity(particle));
  }
  for (std::size_t k = 0; k < fallen.particles.size(); ++k)
    if (!fallen.scene.particles[k].fixed && anchors_.is_fixed(fallen.particles[k]))
      now.velocities[k] = anchors_.last_velocity(fallen.particles[k]);
  for (const std::uint32_t rod : fallen.rods) now.lengths.push_back(lengths_.length(rod));
  for (const std::uint32_t tackle : fallen.tackles)
    now.lengths.push_back(lengths_.length(compiled_.info.rods + tackle));
  split(fallen, now);
  splits_.push_back(std::move(now));
}

/// Takes out again what a world of this scene took out.
void Step::repeat(const Split& split_then) {
  breaks_.begin();
  split(breaks_.take_out(split_then.rods, split_then.edits), split_then);
  splits_.push_back(split_then);
}

/// Lets new solvers move what fell apart or was edited, if anything did.
void Step::split(Fallen fallen, const Split& now) {
  for (const std::vector<std::uint32_t>* const rods : {&now.rods, &now.edits.cut})
    for (const std::uint32_t rod : *rods) compiled_.cords.replace(rod, {});
  if (!fallen.any()) return;
  fallen.scene.gravity = gravity_;
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
  settings.substeps = rules_.substeps;  // which a budget may have made fewer
  exchange(fallen, now, compile_parts(fallen.scene, settings, compiled_.info.relaxed_rods));
}

/// Lets new solvers move islands that fell apart, from where they are.
void Step::exchange(const Fallen& fallen, const Split& now, Compiled made) {
  using IslandOfSolver = std::pair<std::uint32_t, std::uint32_t>;
  std::set<IslandOfSolver> gone;
  const auto island_at = [&](const Place& place) {
    return IslandOfSolver{place.solver, solver(place).island_of(place.slot)};
  };
  std::vector<double> substeps(fallen.particles.size(), 0);  // s, the last of each particle
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    if (anchors_.is_fixed(fallen.particles[k])) continue;
    const Place& place = compiled_.places.of(fallen.particles[k]).front();
    substeps[k] = solver(place).last_substep(place.slot);
  }
  // Those that were freed join islands whose velocities are of one substep, or else of now.
  if (!now.edits.fixed.empty() && !substeps.empty()) {
    const double longest = *std::max_element(substeps.begin(), substeps.end());
    const bool is_one = std::all_of(substeps.begin(), substeps.end(),
                                    [&](double each) { return each == longest || each == 0; });
    substeps.assign(substeps.size(), is_one ? longest : 0);
  }
  for (const std::uint32_t particle : fallen.leaving)
    for (const Place& place : compiled_.places.of(particle))
      if (gone.insert(island_at(place)).second) solver(place).remove(place.slot);
  refix(now.edits);
  replace_places(fallen, made, [&](const Place& place) { return gone.count(island_at(place)) > 0; });
  compiled_.info.islands += made.info.islands - static_cast<std::uint32_t>(gone.size());
  describe();
  compiled_.info.parallel = uses_threads();
  reserve();
  hand_over(fallen, substeps);
}

/// Leads from particles, rods and twists to where they are from now on. leaves(place) says which places of
/// particles end. Numbers of solvers stay what they are, since others know them. New ones take those that
/// nobody needs.
template <class Leaves>
void Step::replace_places(const Fallen& fallen, Compiled& made, Leaves&& leaves) {
  std::vector<Place> left;
  for (const std::uint32_t particle : fallen.touched) {
    left.clear();
    for (const Place& place : compiled_.places.of(particle))
      if (!leaves(place)) left.push_back(place);
    compiled_.places.replace(particle, left);
  }
  for (const std::uint32_t rod : fallen.leaving_rods) compiled_.cords.replace(rod, {});
  for (const std::uint32_t twist : fallen.leaving_twists) compiled_.twists.replace(twist, {});
  seats_.assign(compiled_.solvers.size(), Seat::free);
  for (std::uint32_t s = 0; s < seats_.size(); ++s)
    if (compiled_.solvers[s]->has_changing_pieces() || compiled_.places.uses(s) > 0) seats_[s] = Seat::kept;
  const std::vector<std::uint32_t> numbers = take_seats(made.solvers.size(), seats_);

  const auto add = [&](std::span<const Place> places) {
    for (const Place& place : places) left.push_back({numbers[place.solver], place.slot});
  };
  for (std::uint32_t k = 0; k < fallen.particles.size(); ++k) {
    const std::span<const Place> others = compiled_.places.of(fallen.particles[k]);
    left.assign(others.begin(), others.end());
    add(made.places.of(k));
    compiled_.places.replace(fallen.particles[k], left);
  }
  for (std::uint32_t k = 0; k < made.cords.count(); ++k) {
    left.clear();
    add(made.cords.of(k));
    const bool is_rod = k < fallen.rods.size();
    compiled_.cords.replace(
        is_rod ? fallen.rods[k] : compiled_.info.rods + fallen.tackles[k - fallen.rods.size()], left);
  }
  compiled_.solvers.resize(seats_.size());
  for (std::size_t s = 0; s < numbers.size(); ++s) compiled_.solvers[numbers[s]] = std::move(made.solvers[s]);
  anchors_.resize(seats_.size());
  sleep_.exchange(compiled_.solvers, seats_);
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
