#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Rods that are off their lengths by no more than this share were drawn by nothing but rounding.
constexpr double drawn = 1e-6;

/// Returns so many numbers of solvers that are free, the first ones. The last may be new.
Array<std::uint32_t> free_numbers(std::size_t count, std::span<const Seat> seats) {
  Array<std::uint32_t> numbers;
  for (std::uint32_t s = 0; numbers.size() < count; ++s)
    if (s >= seats.size() || seats[s] == Seat::free) numbers.push_back(s);
  return numbers;
}

}  // namespace

void wind(Rod& rod, double described, double now) {
  rod.length = now;
  if (rod.inertia) *rod.inertia *= (now / described) * (now / described);
}

/// Returns the rods that broke in the last step, and whose islands are still as they were.
Array<std::uint32_t> Step::broken_now() const {
  Array<std::uint32_t> out;
  for (const std::uint32_t rod : breaks_.weak()) {
    if (breaks_.is_out(rod)) continue;
    const auto places = compiled_.cords.of(rod);  // cut_broken() lists those of the contact solver.
    if (!places.empty() && solver(places.front()).is_broken(places.front().slot)) out.push_back(rod);
  }
  return out;
}

void Step::split(StepReport&) {
  if (is_to_fit_) fit();
  if (!(next_gravity_ == gravity_)) change_gravity();
  list_side_by_side();
  if (!has_broken_ && !edits_.any()) return;
  Split now;
  if (std::exchange(has_broken_, false)) now.rods = broken_now();
  std::swap(now.edits, edits_);
  if (now.rods.empty() && !now.edits.any()) return;
  Fallen fallen = take_out(now);
  const Log::Group group = group_of(fallen, now);
  // Here alone: what is done again for a snapshot has the population of its end.
  for (std::size_t kind = 0; kind < population_.kinds; ++kind)
    population_.all()[kind]->give_back(*now.edits.severed.all()[kind]);
  put_joined(now.edits);
  now.positions.reserve(fallen.particles.size());
  now.velocities.reserve(fallen.particles.size());
  now.lengths.reserve(fallen.rods.size() + fallen.tackles.size());
  for (const std::uint32_t particle : fallen.particles) {
    now.positions.push_back(position(particle));
    now.velocities.push_back(velocity(particle));
  }
  for (std::size_t k = 0; k < fallen.particles.size(); ++k)
    if (!fallen.scene.particles[k].fixed && anchors_.is_fixed(fallen.particles[k]))
      now.velocities[k] = anchors_.last_velocity(fallen.particles[k]);
  for (const std::uint32_t rod : fallen.rods) now.lengths.push_back(lengths_.length(rod));
  for (const std::uint32_t tackle : fallen.tackles)
    now.lengths.push_back(lengths_.length(tackle_cord(tackle)));
  for (const std::uint32_t rod : fallen.held.names.rods) now.lengths.push_back(lengths_.length(rod));
  if (!now.edits.joined.names.rods.empty()) settle(fallen, now);
  split(std::move(fallen), now);
  log_.push(std::move(now), group);
}

/// Returns the log's group of what is done: of all particles that it names.
Log::Group Step::group_of(const Fallen& fallen, const Split& now) {
  Array<std::uint32_t> particles = fallen.touched;
  const auto add_ends = [&](const Rod& rod) { particles.insert(particles.end(), {rod.a, rod.b}); };
  for (const Array<std::uint32_t>* const rods : {&now.rods, &now.edits.cut})
    for (const std::uint32_t rod : *rods) add_ends(breaks_.scene_now().rods[rod]);
  now.edits.for_joined([&](std::size_t, std::uint32_t, std::uint32_t each) { particles.push_back(each); });
  for (const auto& [particle, mass] : now.edits.masses) particles.push_back(particle);
  for (const auto& [particle, is_fixed] : now.edits.fixed) particles.push_back(particle);
  return log_.join(particles);
}

/// Does again what a world of this scene did.
void Step::repeat(Split split_then) {
  breaks_.begin();
  if (!split_then.removed.empty()) {
    const Names gone = take_away(split_then.removed.front());
    return log_.push_removal(std::move(split_then), gone.particles);
  }
  if (!split_then.added.empty()) {
    put(split_then, compile_addition(scene_of(split_then.added.front())));
    return log_.push_addition(std::move(split_then));
  }
  Fallen fallen = take_out(split_then);
  const Log::Group group = group_of(fallen, split_then);
  put_joined(split_then.edits);
  split(std::move(fallen), split_then);
  log_.push(std::move(split_then), group);
}

/// Lets new solvers move what fell apart or was edited, if anything did.
void Step::split(Fallen fallen, Split& now) {
  for (const Array<std::uint32_t>* const rods : {&now.rods, &now.edits.cut})
    for (const std::uint32_t rod : *rods) {
      compiled_.cords.replace(rod, {});
      if (settings_.events) events_.set_broken(rod, true);  // a cut is ordered, and no event
    }
  if (!fallen.any()) return;
  set_state(fallen, now);
  set_held_state(fallen, now);
  exchange(fallen, now, compile_parts(fallen.scene, settings_of_now(), compiled_));
}

/// Lets the scene of what is made anew begin where that is now, and as fast.
void Step::set_state(Fallen& fallen, const Split& now) const {
  fallen.scene.gravity = gravity_;
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    Particle& particle = fallen.scene.particles[k];
    particle.position = now.positions[k];
    if (!particle.fixed) particle.velocity = now.velocities[k];
  }
  for (std::size_t k = 0; k < fallen.rods.size(); ++k)
    wind(fallen.scene.rods[k], rod_length(breaks_.scene_now(), fallen.rods[k]), now.lengths[k]);
  for (std::size_t k = 0; k < fallen.tackles.size(); ++k)
    fallen.scene.tackles[k].length = now.lengths[fallen.rods.size() + k];
}

/// Lets what others move from now on begin where it is, and as fast. Anchors have the velocities that they
/// were moved with.
void Step::set_held_state(Fallen& fallen, const Split& now) const {
  Scene& scene = fallen.held.scene;
  const Names& names = fallen.held.names;
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const std::uint32_t number = names.particles[k];
    scene.particles[k].position = position(number);
    scene.particles[k].velocity =
        anchors_.is_fixed(number) ? anchors_.last_velocity(number) : velocity(number);
  }
  const std::size_t first = fallen.rods.size() + fallen.tackles.size();
  for (std::size_t k = 0; k < scene.rods.size(); ++k)
    wind(scene.rods[k], rod_length(breaks_.scene_now(), names.rods[k]), now.lengths[first + k]);
}

/// Takes from islands that rods have joined what pulls on those: an inelastic blow, which keeps momentum and
/// angular momentum. A world that is compiled begins so, too.
void Step::settle(Fallen fallen, Split& now) const {
  set_state(fallen, now);
  const Compiled made = compile_addition(fallen.scene);
  for (std::uint32_t k = 0; k < fallen.particles.size(); ++k) {
    if (fallen.scene.particles[k].fixed) continue;
    const Place& place = made.places.of(k).front();
    now.velocities[k] = made.solvers[place.solver]->velocity(place.slot);
  }
}

Settings Step::settings_of_now() const {
  Settings settings = settings_;
  settings.threads = workers_.size();
  settings.substeps = rules_.substeps;  // which a budget may have made fewer
  // Solvers are made for the accuracy that the world began with, or its snapshots would not fit.
  settings.accuracy = origin_.settings.accuracy;
  return settings;
}

/// Lets new solvers move islands that fell apart, from where they are.
void Step::exchange(Fallen& fallen, Split& now, Compiled made) {
  Array<Solver::Past> pasts(fallen.particles.size());
  for (std::size_t k = 0; k < fallen.particles.size(); ++k) {
    if (anchors_.is_fixed(fallen.particles[k])) continue;
    const Place& place = compiled_.places.of(fallen.particles[k]).front();
    pasts[k] = solver(place).past(place.slot);
  }
  // Those that were freed or joined go into islands whose velocities are of one substep, or else of now.
  if (!now.edits.fixed.empty() || !now.edits.joined.names.rods.empty()) {
    double longest = 0;
    for (const Solver::Past& each : pasts) longest = std::max(longest, each.substep);
    const bool is_one = std::all_of(pasts.begin(), pasts.end(), [&](const Solver::Past& each) {
      return each.substep == longest || each.substep == 0;
    });
    for (Solver::Past& each : pasts) each.substep = is_one ? longest : 0;
  }
  const Array<std::uint8_t> slept = were_asleep(fallen.particles);
  const Array<std::uint8_t> linkages_slept = were_asleep(fallen.of_linkages);
  const Array<std::uint32_t> grabs = take_grabs(fallen.leaving);
  refix(now.edits);
  Array<ContactSolver::Made> parts;
  if (fallen.is_in_contact()) parts = make_numbered_parts(fallen, now);
  std::uint32_t islands = 0;
  const Array<std::uint32_t> solvers = remove_places(fallen.leaving, fallen.touched, islands);
  for (const std::uint32_t rod : fallen.leaving_rods) compiled_.cords.replace(rod, {});
  for (const std::uint32_t twist : fallen.leaving_twists) compiled_.twists.replace(twist, {});
  free_seats(solvers);
  compiled_.info.islands += made.info.islands - islands;
  seat(std::move(made.solvers), now.seats, !now.edits.packs);
  put_places(fallen, made, now.seats);
  if (fallen.is_in_contact()) {
    compiled_.info.islands += put_parts(parts);
    go_on_in_contact(fallen, parts);
  }
  find_heads(fallen.of_linkages);
  for (std::size_t k = 0; k < linkages_slept.size(); ++k)
    if (linkages_slept[k] != 0 && events_.is_head(fallen.of_linkages[k]))
      events_.set_head(fallen.of_linkages[k], true);
  for (std::size_t k = 0; k < fallen.particles.size(); ++k)
    if (slept[k] != 0 && events_.is_head(fallen.particles[k])) events_.set_head(fallen.particles[k], true);
  hand_over(fallen, now, pasts);
  put_grabs(grabs);
}

/// Takes islands of particles out of their solvers for good, and their places from all that are touched.
/// Returns the solvers that they had. Adds up how many islands went. Runs of places are to be found after
/// that.
Array<std::uint32_t> Step::remove_places(std::span<const std::uint32_t> leaving,
                                         std::span<const std::uint32_t> touched, std::uint32_t& islands) {
  using IslandOfSolver = std::pair<std::uint32_t, std::uint32_t>;
  std::set<IslandOfSolver> gone;
  IslandOfSolver last{};       // that was found to be gone, as that of the next particle mostly is
  std::uint32_t visitors = 0;  // which have a home, and count there
  const auto island_at = [&](const Place& place) {
    return IslandOfSolver{place.solver, solver(place).island_of(place.slot)};
  };
  const auto is_last = [&](const IslandOfSolver& island) { return !gone.empty() && island == last; };
  for (const std::uint32_t particle : leaving) {
    const auto places = compiled_.places.of(particle);
    for (std::size_t k = places.size(); k-- > 0;) {  // from the contact solver first, then from its home
      const IslandOfSolver island = island_at(places[k]);
      if (is_last(island)) continue;
      last = island;
      if (!gone.insert(island).second) continue;
      if (&solver(places[k]) == compiled_.contact && compiled_.contact->may_go_home(places[k].slot))
        ++visitors;
      solver(places[k]).remove(places[k].slot);
    }
  }
  Array<Place> left;
  for (const std::uint32_t particle : touched) {
    left.clear();
    for (const Place& place : compiled_.places.of(particle)) {
      const IslandOfSolver island = island_at(place);
      if (is_last(island)) continue;
      if (gone.count(island) > 0)
        last = island;
      else
        left.push_back(place);
    }
    compiled_.places.replace(particle, left);
  }
  if (settings_.events)
    for (const std::uint32_t particle : leaving) events_.remove_head(particle);
  Array<std::uint32_t> solvers;
  for (const auto& [number, island] : gone)
    if (solvers.empty() || solvers.back() != number) solvers.push_back(number);
  islands += static_cast<std::uint32_t>(gone.size()) - visitors;
  return solvers;
}

/// Ends solvers that nobody needs any more. Numbers of others stay what they are, since others know them.
void Step::free_seats(std::span<const std::uint32_t> solvers) {
  for (const std::uint32_t s : solvers) {
    if (compiled_.solvers[s]->has_changing_pieces() || compiled_.places.uses(s) > 0) continue;
    compiled_.info.relaxed_rods -= relaxed_rods_of(*compiled_.solvers[s]);
    seats_[s] = Seat::free;
    anchors_.forget(s);
    compiled_.solvers[s].reset();
  }
}

/// Gives new solvers the numbers `seats`, or if there are none, the first ones that are free, and says which.
void Step::seat(Array<std::unique_ptr<Solver>> made, Array<std::uint32_t>& seats, bool are_loose) {
  if (seats.empty()) seats = free_numbers(made.size(), seats_);
  for (std::size_t k = 0; k < seats.size(); ++k) {
    const std::uint32_t number = seats[k];
    if (number >= seats_.size()) seats_.resize(number + std::size_t{1}, Seat::free);
    if (number >= compiled_.solvers.size()) compiled_.solvers.resize(number + std::size_t{1});
    is_loose_.resize(seats_.size(), 0);
    is_loose_[number] = are_loose ? 1 : 0;
    seats_[number] = Seat::taken;
    compiled_.info.relaxed_rods += relaxed_rods_of(*made[k]);
    compiled_.solvers[number] = std::move(made[k]);
  }
  anchors_.resize(seats_.size());
  sleep_.exchange(compiled_.solvers, seats_);
  for (const std::uint32_t number : seats) seats_[number] = Seat::kept;
  is_described_ = false;
  reserve();
}

std::uint32_t Step::relaxed_rods_of(const Solver& solver) const {
  WorldInfo info;
  solver.describe(info);
  return info.relaxed_rods;
}

/// Leads from particles, rods and tackles to where new solvers of these numbers have them.
void Step::put_places(const Fallen& fallen, const Compiled& made, std::span<const std::uint32_t> numbers) {
  Array<Place> left;
  const auto add = [&](std::span<const Place> places) {
    for (const Place& place : places) left.push_back({numbers[place.solver], place.slot});
  };
  for (std::uint32_t k = 0; k < fallen.particles.size(); ++k) {
    const std::span<const Place> others = compiled_.places.of(fallen.particles[k]);
    left.assign(others.begin(), others.end());
    add(made.places.of(k));
    compiled_.places.replace(fallen.particles[k], left);
  }
  compiled_.places.find_runs(compiled_.solvers);
  if (settings_.events) {
    events_.grow(compiled_.places.count(), compiled_.cords.rods.count());
    for (const std::uint32_t rod : fallen.rods) events_.set_broken(rod, false);
    find_heads(fallen.particles);
  }
  const auto put = [&](std::uint32_t cord, std::span<const Place> places) {
    left.clear();
    add(places);
    compiled_.cords.replace(cord, left);
  };
  for (std::uint32_t k = 0; k < fallen.rods.size(); ++k) put(fallen.rods[k], made.cords.rods.of(k));
  for (std::uint32_t k = 0; k < fallen.tackles.size(); ++k)
    put(tackle_cord(fallen.tackles[k]), made.cords.lines.of(k));
}

/// Gives new solvers the motion of islands that fell apart, and the forces on them.
void Step::hand_over(const Fallen& fallen, const Split& now, std::span<const Solver::Past> pasts) {
  const auto for_movable = [&](auto&& f) {
    for (std::size_t k = 0; k < fallen.particles.size(); ++k)
      if (!fallen.scene.particles[k].fixed)
        for (const Place& place : compiled_.places.of(fallen.particles[k])) f(k, solver(place), place.slot);
  };
  const auto is_new = [&](const Place& place) {
    return std::find(now.seats.begin(), now.seats.end(), place.solver) != now.seats.end();
  };
  // Velocities have the rates of the last step, and a cord that stops now would not seem to.
  for (const std::uint32_t cord : lengths_.moving())
    if (const auto places = compiled_.cords.of(cord); std::any_of(places.begin(), places.end(), is_new))
      tell_length(cord, lengths_.length(cord), lengths_.rate(cord));
  for_movable([&](std::size_t k, Solver& to, Slot slot) {
    to.set_motion(slot, fallen.scene.particles[k].position, fallen.scene.particles[k].velocity);
  });
  for_movable([&](std::size_t k, Solver& to, Slot slot) {
    to.go_on(slot, pasts[k]);
    if (const Vec3 force = loads_.force(fallen.particles[k]); force != Vec3{}) to.set_force(slot, force);
  });
  // They know how fast anchors went, or a steady one would seem to jump.
  anchors_.for_moved([&](std::uint32_t particle, const AnchorMove& path) {
    for (const Place& place : compiled_.places.of(particle))
      if (is_new(place)) solver(place).move_anchor(place.slot, path);
  });
  for (const std::uint32_t number : now.seats) {
    compiled_.solvers[number]->end_anchors();
    anchors_.settle(number);
  }
  fit_freed(fallen, now);
}

/// Brings rods to their lengths that anchors had drawn too far, where one of these is freed: without a blow,
/// as at a start.
void Step::fit_freed(const Fallen& fallen, const Split& now) {
  Array<std::uint32_t> off;
  for (std::size_t k = 0; !now.edits.fixed.empty() && k < fallen.rods.size(); ++k) {
    const Rod& rod = fallen.scene.rods[k];
    const auto at = [&](std::uint32_t particle) { return fallen.scene.particles[particle].position; };
    const double by = norm(at(rod.b) - at(rod.a)) - now.lengths[k];
    if (rod.law.is_elastic() || (rod.law.one_sided && by < 0) || std::abs(by) <= drawn * now.lengths[k])
      continue;
    for (const Place& place : compiled_.cords.of(fallen.rods[k]))
      if (std::find(now.seats.begin(), now.seats.end(), place.solver) != now.seats.end())
        off.push_back(place.solver);
  }
  std::sort(off.begin(), off.end());
  off.erase(std::unique(off.begin(), off.end()), off.end());
  for (const std::uint32_t number : off)
    if (!compiled_.solvers[number]->sweeps()) compiled_.solvers[number]->fit(true);
}

}  // namespace plumb::detail
