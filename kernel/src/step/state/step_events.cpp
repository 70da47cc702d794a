// This file says to Events what becomes of a world's islands.

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
  events_.reserve(breaks_.weak().size(), sleep_.tasks().size());
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
  const std::span<const Task> tasks = std::as_const(sleep_).tasks();
  if (std::any_of(tasks.begin(), tasks.end(), [](const Task& task) { return task.troubles != 0; })) {
    Array<Troubles>& troubles = events_.troubles();
    troubles.clear();
    // What lasts through sleep is told while its island is awake.
    for (const Task& task : tasks)
      troubles.push_back(static_cast<Troubles>(task.troubles & ~(task.asleep ? lasting(task.troubles) : 0u)));
    events_.for_heads([&](std::uint32_t head) {
      if (const auto task = sleep_.task_of(compiled_.solvers, compiled_.places.of(head).front()))
        events_.add_troubles(std::exchange(troubles[*task], 0), head);
    });
  }
  events_.sort();
}

}  // namespace plumb::detail
