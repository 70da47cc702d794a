#include "step/places.hpp"

#include <algorithm>
#include <array>

namespace plumb::detail {

Places::Places(std::uint32_t particles, std::span<const Entry> entries) : rows_(particles, entries) {
  count_uses(rows_.items(), 1);
  for (std::uint32_t particle = 0; particle < particles; ++particle)
    several_ += of(particle).size() > 1 ? 1 : 0;
}

void Places::replace(std::uint32_t particle, std::span<const Place> by) {
  const std::span<const Place> before = of(particle);
  count_uses(before, -1);
  count_uses(by, 1);
  several_ -= before.size() > 1 ? 1 : 0;
  several_ += by.size() > 1 ? 1 : 0;
  rows_.replace(particle, by);
  make_stale(particle / chunk_size);
}

void Places::grow(std::uint32_t particles) {
  if (particles > count()) make_stale(count() / chunk_size);
  rows_.grow(particles);
}

void Places::find_runs(std::span<const std::unique_ptr<Solver>> solvers) {
  const std::uint32_t chunks = (count() + chunk_size - 1) / chunk_size, before = runs_.count();
  runs_.grow(chunks);
  for (std::uint32_t chunk = before; chunk < chunks; ++chunk) stale_.push_back(chunk);
  std::sort(stale_.begin(), stale_.end());
  stale_.erase(std::unique(stale_.begin(), stale_.end()), stale_.end());
  for (const std::uint32_t chunk : stale_) find_runs_of(chunk, solvers);
  stale_.clear();
}

namespace {

/// Lists the first places of the particles of a chunk, with their addresses.
struct Firsts {
  struct First {
    std::uint32_t solver, slot, address;
  };
  std::array<First, Places::chunk_size> all;
  std::uint32_t size;

  /// Returns how many from `i` on are of one solver, in places evenly apart, or `most` if there are more.
  /// With `every` 2 those of the odd ones and those of the even ones are.
  std::uint32_t length(std::uint32_t i, std::uint32_t every, std::uint32_t most = Places::chunk_size) const {
    const std::uint32_t solver = all[i].solver, end = std::min(size, i + std::min(most, size));
    std::uint32_t k = i + 1;
    for (const std::uint32_t two = std::min(end, i + 2 * every); k < two && all[k].solver == solver;) ++k;
    if (k < i + 2 * every) return k - i;
    const auto goes_on = [&](const First* of) {
      const First &last = of[0], &middle = *(of - every), &first = *(of - 2 * every);
      return last.solver == solver && last.slot + first.slot == 2 * middle.slot &&
             last.address + first.address == 2 * middle.address;
    };
    while (k < end && goes_on(&all[k])) ++k;
    return k - i;
  }
  /// Returns `count` of them from `i` on, where the first of all is particle `base`.
  Run run(std::uint32_t base, std::uint32_t i, std::uint32_t every, std::uint32_t count) const {
    const First &first = all[i], &second = all[count > 1 ? i + every : i];
    return {base + i,      every,
            count,         first.solver,
            first.slot,    second.slot - first.slot,
            first.address, second.address - first.address};
  }
};

}  // namespace

/// Adds a run to those found, or to the rows of one of the last: between those of ropes are their anchors.
void Places::add_run(const Run& run) {
  const std::size_t looked_at = std::min<std::size_t>(found_.size(), 2);
  for (auto last = found_.rbegin(); last != found_.rbegin() + static_cast<std::ptrdiff_t>(looked_at); ++last)
    if (last->takes(run)) return;
  found_.push_back(run);
}

void Places::find_runs_of(std::uint32_t chunk, std::span<const std::unique_ptr<Solver>> solvers) {
  const std::uint32_t base = chunk * chunk_size;
  Firsts firsts;  // of which those that there are get numbers
  firsts.size = std::min(chunk_size, count() - base);
  const std::span<const Place> places = rows_.items();
  for (std::uint32_t i = 0; i < firsts.size; ++i) {
    const auto& range = rows_.range(base + i);
    if (range.count == 0) {
      firsts.all[i] = {Run::nowhere, 0, 0};
    } else {
      const auto [solver, slot] = places[range.begin];
      firsts.all[i] = {solver, slot, solvers[solver]->address(slot)};
    }
  }
  found_.clear();
  for (std::uint32_t i = 0, next = 0; i < firsts.size; i = next) {
    const std::uint32_t in_turn = firsts.length(i, 1), by_two = in_turn < 4 ? firsts.length(i, 2) : 0;
    if (by_two >= 8) {
      add_run(firsts.run(base, i, 2, (by_two + 1) / 2));
      add_run(firsts.run(base, i + 1, 2, by_two / 2));
      next = i + by_two;
    } else {
      // The first of two may be an anchor, which lies elsewhere, and the second one of many.
      const bool is_apart = in_turn == 2 && firsts.length(i + 1, 1, 3) > 2;
      next = i + (is_apart ? 1 : in_turn);
      add_run(firsts.run(base, i, 1, next - i));
    }
  }
  runs_.replace(chunk, found_);
}

}  // namespace plumb::detail
