// This file tells what becomes of a world's islands, and what went wrong with them.

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "step/step.hpp"

namespace plumb::detail {

bool Step::is_asleep(std::uint32_t particle) const {
  const Place& place = *place_of(particle);
  return &solver(place) == compiled_.contact ? compiled_.contact->is_asleep(place.slot)
                                             : sleep_.is_asleep(compiled_.solvers, place);
}

/// Finds the heads of islands among particles which have places now. They are as they are, with no event.
void Step::find_heads(std::span<const std::uint32_t> particles) {
  if (!settings_.events) return;
  Array<std::uint32_t> sorted(particles.begin(), particles.end());
  std::sort(sorted.begin(), sorted.end());
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const std::uint32_t particle : sorted) {
    const auto places = compiled_.places.of(particle);
    if (anchors_.is_fixed(particle) || places.empty()) continue;
    const Place& place = places.front();
    if (seen.emplace(place.solver, solver(place).island_of(place.slot)).second)
      events_.set_head(particle, is_asleep(particle));
  }
  events_.reserve(breaks_.weak().size(), sleep_.tasks().size() + contact_islands());
}

/// Returns of each of the particles of whole islands whether its island was asleep at the end of the last
/// step.
Array<std::uint8_t> Step::were_asleep(std::span<const std::uint32_t> particles) const {
  Array<std::uint8_t> out(particles.size(), 0);
  if (!settings_.events) return out;
  std::set<std::pair<std::uint32_t, std::uint32_t>> asleep;
  const auto island_of = [&](std::uint32_t particle) {
    const Place& place = compiled_.places.of(particle).front();
    return std::pair(place.solver, solver(place).island_of(place.slot));
  };
  const auto is_of_one = [&](std::uint32_t particle) {
    return !anchors_.is_fixed(particle) && !compiled_.places.of(particle).empty();
  };
  for (const std::uint32_t particle : particles)
    if (is_of_one(particle) && events_.is_head(particle) && events_.was_asleep(particle))
      asleep.insert(island_of(particle));
  for (std::size_t k = 0; k < particles.size(); ++k)
    if (is_of_one(particles[k])) out[k] = asleep.count(island_of(particles[k])) > 0;
  return out;
}

/// Lists what went wrong with tasks, and then with islands that the contact solver has. What goes on while
/// they sleep is told of those that are asleep only if `also_lasting`.
void Step::list_troubles(bool also_lasting, Array<Troubles>& out) const {
  out.clear();
  for (const Task& task : sleep_.tasks()) {
    const unsigned hidden = task.asleep && !also_lasting ? lasting : 0u;
    out.push_back(static_cast<Troubles>(task.troubles & ~hidden));
  }
  for (std::uint32_t i = 0; i < contact_islands(); ++i)
    out.push_back(compiled_.contact->troubles(i, also_lasting));
}

/// Returns where list_troubles() lists those of a movable particle.
std::size_t Step::troubles_at(std::uint32_t particle) const {
  const Place& place = *place_of(particle);
  const auto task = sleep_.task_of(compiled_.solvers, place);
  return task ? *task : sleep_.tasks().size() + compiled_.contact->island_of(place.slot);
}

/// Lists what became of islands and rods in this step.
void Step::list_events(StepReport& report) {
  events_.clear();
  // What touches sleeps by itself, and nobody counts how often.
  const std::optional<std::uint64_t> changes =
      compiled_.contact ? std::nullopt : std::optional(sleep_.changes());
  if (events_.may_list_sleep(changes))
    events_.list_sleep([&](std::uint32_t head) { return is_asleep(head); });
  if (report.broken_rods > 0)
    for (const std::uint32_t rod : breaks_.weak())
      if (!events_.was_broken(rod) && is_broken(rod))
        events_.add_broken(rod, rods_.end(rod), breaks_.scene_now().rods[rod].law.strength);
  if (troubles_between({}, report) != 0) {
    Array<Troubles>& troubles = events_.troubles();
    list_troubles(false, troubles);
    events_.for_heads([&](std::uint32_t head) {
      events_.add_troubles(std::exchange(troubles[troubles_at(head)], 0), head);
    });
  }
  events_.sort();
}

Array<Problem> Step::problems(double most_strain) const {
  Array<Problem> out;
  Array<Troubles> troubles;
  list_troubles(true, troubles);
  for (std::uint32_t particle = 0; particle < compiled_.info.particles; ++particle) {
    if (anchors_.is_fixed(particle) || compiled_.places.of(particle).empty()) continue;
    append_problems(std::exchange(troubles[troubles_at(particle)], 0), particle, out);
  }
  rods_.judge(
      most_strain, [&](std::uint32_t particle) { return position(particle); },
      [&](std::uint32_t rod, double distance) {
        const double strain = distance / lengths_.length(rod) - 1;
        const auto places = compiled_.cords.of(rod);
        return places.empty() ? strain : solver(places.front()).strain(places.front().slot, strain);
      },
      [&](std::uint32_t rod) { return is_broken(rod); }, out);
  return out;
}

}  // namespace plumb::detail
