// This file lets a world that was made anew under other settings go on from how it was.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scene/bends/rod_table.hpp"
#include "scene/refuse.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Rods that are off their length by less than this share are so by what solving them leaves.
constexpr double least_gap = 1e-9;

/// Returns whether a cord is off its length by more than solving it leaves and the rounding (m) of its
/// places.
bool is_off(const RodLaw& law, double now, double length, double rounding) {
  if (law.is_elastic() || (law.one_sided && now < length)) return false;
  return std::abs(now - length) > least_gap * length + rounding;
}

/// Returns whether islands move by the same equations under both settings.
bool move_alike(const Settings& one, const Settings& other) {
  return one.method == other.method && one.precision == other.precision && one.gradient == other.gradient &&
         one.mass == other.mass && one.accuracy == other.accuracy;
}

}  // namespace

void Step::carry(const Step& from) {
  is_to_fit_ = from.is_to_fit_ || !move_alike(from.origin_.settings, settings_);
  has_broken_ = false;
  carry_inputs(from);
  carry_motion(from);
  carry_grabs(from);
  carry_sleep(from);
  if (!settings_.events) return;
  if (from.settings_.events)
    events_.go_on_from(from.events_);
  else
    for (const std::uint32_t rod : breaks_.weak()) events_.set_broken(rod, is_broken(rod));
  events_.for_heads([&](std::uint32_t head) {
    if (!from.settings_.events) events_.set_head(head, is_asleep(head));
  });
}

/// Takes what programs ordered.
void Step::carry_inputs(const Step& from) {
  if (!(from.gravity_ == gravity_)) apply_gravity(from.gravity_);
  next_gravity_ = from.next_gravity_;
  edits_ = from.edits_;
  order(edits_, true);
  size_ = from.size_;
  relate_errors();
  carry_lengths(from);
  anchors_.go_on_from(from.anchors_);
  carry_anchors();
  reactions_.go_on(anchors_);
  from.loads_.for_forces([&](std::uint32_t particle, Vec3 force) {
    for (const Place& place : compiled_.places.of(particle)) solver(place).set_force(place.slot, force);
  });
}

void Step::carry_lengths(const Step& from) {
  for (const std::uint32_t cord : from.lengths_.changed())
    tell_length(cord, from.lengths_.length(cord), from.lengths_.rate(cord));
  lengths_ = from.lengths_;
}

/// Puts anchors where they are, and lets solvers know how fast they went, or a steady one would seem to jump.
void Step::carry_anchors() {
  const auto is_of_contact = [&](const Place& place) { return &solver(place) == compiled_.contact; };
  anchors_.for_fixed([&](std::uint32_t particle) {
    const Vec3 at = anchors_.position(particle);
    for (const Place& place : compiled_.places.of(particle)) {
      if (!is_of_contact(place)) solver(place).move_anchor(place.slot, {at, at, 1});
      solver(place).place_anchor(place.slot, at);
    }
  });
  anchors_.for_moved([&](std::uint32_t particle, const AnchorMove& path) {
    for (const Place& place : compiled_.places.of(particle))
      if (!is_of_contact(place)) solver(place).move_anchor(place.slot, path);
  });
  for (std::uint32_t number = 0; number < seats_.size(); ++number) {
    if (seats_[number] == Seat::free) continue;
    compiled_.solvers[number]->end_anchors();
    anchors_.settle(number);
  }
}

void Step::carry_motion(const Step& from) {
  const auto for_movable = [&](auto&& f) {
    for (std::uint32_t particle = 0; particle < population_.particles.count(); ++particle)
      if (population_.particles.has(particle) && !anchors_.is_fixed(particle))
        for (const Place& place : compiled_.places.of(particle)) f(particle, solver(place), place.slot);
  };
  for_movable([&](std::uint32_t particle, Solver& to, Slot slot) {
    const Vec3 velocity = from.velocity(particle);
    to.set_motion(slot, from.position(particle), is_finite(velocity) ? velocity : Vec3{});
  });
  const bool goes_on = !is_to_fit_;
  for_movable([&](std::uint32_t particle, Solver& to, Slot slot) {
    const Place& home = from.compiled_.places.of(particle).front();
    Solver::Past past = from.solver(home).past(home.slot);
    if (!goes_on) past.substep = 0;
    to.go_on(slot, past);
  });
  if (compiled_.contact) compiled_.contact->go_on_from(*from.compiled_.contact);
}

void Step::carry_grabs(const Step& from) {
  grabs_ = from.grabs_;
  grabs_.for_grabs_of([](std::uint32_t) { return true; },
                      [&](std::uint32_t number) {
                        if (!grabs_.fits(number, compiled_.places, compiled_.solvers))
                          refuse("settings: grab ", number, ": no solver takes its place under these");
                        grabs_.put_in(number, compiled_.places, compiled_.solvers);
                      });
}

/// Lets what slept sleep on. Pieces of several islands do if all of these slept.
void Step::carry_sleep(const Step& from) {
  constexpr double never = std::numeric_limits<double>::infinity();
  Array<double> still(sleep_.tasks().size(), never);
  Array<std::uint8_t> wakes(still.size(), 0);
  for (std::uint32_t particle = 0; particle < population_.particles.count(); ++particle) {
    if (!population_.particles.has(particle) || anchors_.is_fixed(particle)) continue;
    const auto task = sleep_.task_of(compiled_.solvers, compiled_.places.of(particle).front());
    const auto before =
        from.sleep_.task_of(from.compiled_.solvers, from.compiled_.places.of(particle).front());
    if (!task || !before) continue;
    const Task& was = from.sleep_.tasks()[*before];
    still[*task] = std::min(still[*task], was.still_time);
    if (!was.asleep) wakes[*task] = 1;
  }
  for (std::size_t task = 0; task < still.size(); ++task) {
    if (still[task] == never) continue;
    sleep_.tasks()[task].still_time = still[task];
    if (wakes[task] == 0) sleep_.put_to_rest(compiled_.solvers, task);
  }
  if (compiled_.contact && settings_.sleep) compiled_.contact->sleep_as(*from.compiled_.contact);
}

/// Makes motion fit what is solved now, which sweeps left off it, as at a start: without a blow.
void Step::fit() {
  is_to_fit_ = false;
  Array<std::uint8_t> off(compiled_.solvers.size(), 0);
  // Four units in the last place of a coordinate.
  const double of_place = settings_.precision == Precision::single ? 0x1p-22 : 0x1p-51;
  const auto look = [&](std::uint32_t cord, const RodLaw& law, double now, Vec3 end) {
    const double rounding = of_place * (norm(end) + now);
    if (!is_off(law, now, lengths_.length(cord), rounding)) return;
    for (const Place& place : compiled_.cords.of(cord)) {
      if (solver(place).sweeps()) continue;
      off[place.solver] = 1;
      sleep_.wake(compiled_.solvers, place);
    }
  };
  const auto distance = [&](std::uint32_t a, std::uint32_t b) { return norm(position(b) - position(a)); };
  const Scene& scene = breaks_.scene_now();
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i)
    if (population_.rods.has(i) && !compiled_.cords.of(i).empty() && !is_broken(i))
      look(i, scene.rods[i].law, distance(scene.rods[i].a, scene.rods[i].b), position(scene.rods[i].a));
  for (std::uint32_t i = 0; i < scene.tackles.size(); ++i) {
    if (!population_.tackles.has(i)) continue;
    const std::vector<std::uint32_t>& of = scene.tackles[i].particles;
    double now = 0;
    for (std::size_t k = 1; k < of.size(); ++k) now += distance(of[k - 1], of[k]);
    look(tackle_cord(i), scene.tackles[i].law, now, position(of.front()));
  }
  for (std::uint32_t number = 0; number < seats_.size(); ++number)
    if (seats_[number] != Seat::free) compiled_.solvers[number]->fit(off[number] != 0);
}

}  // namespace plumb::detail
