#include "step/places.hpp"

namespace plumb::detail {

Places::Places(std::uint32_t particles, std::span<const Entry> entries)
    : begin_(particles + std::size_t{1}, 0), places_(entries.size()) {
  for (const Entry& entry : entries) ++begin_[entry.particle + std::size_t{1}];
  for (std::size_t i = 0; i < particles; ++i) begin_[i + 1] += begin_[i];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (const Entry& entry : entries) places_[next[entry.particle]++] = entry.place;
  find_runs();
}

void Places::find_runs() {
  for (std::uint32_t i = 0; i < count(); ++i) {
    if (of(i).empty()) continue;
    const Place place = of(i).front();
    Run* const last = runs_.empty() ? nullptr : &runs_.back();
    const bool follows = last && last->place.solver == place.solver && last->first + last->count == i &&
                         (last->count == 1 || place.slot == last->place.slot + last->count * last->stride);
    if (!follows) {
      runs_.push_back({.first = i, .count = 1, .place = place, .stride = 0});
      continue;
    }
    if (last->count == 1) last->stride = place.slot - last->place.slot;  // it may wrap round, backwards
    ++last->count;
  }
}

}  // namespace plumb::detail
