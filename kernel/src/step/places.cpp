#include "step/places.hpp"

namespace plumb::detail {

Places::Places(std::uint32_t particles, std::span<const Entry> entries) : rows_(particles, entries) {
  count_uses(rows_.items(), 1);
}

void Places::count_uses(std::span<const Place> places, std::int32_t change) {
  for (const Place& place : places) {
    if (place.solver >= uses_.size()) uses_.resize(place.solver + std::size_t{1});
    uses_[place.solver] += static_cast<std::uint32_t>(change);
  }
}

void Places::replace(std::uint32_t particle, std::span<const Place> by) {
  are_runs_known_ = false;
  count_uses(of(particle), -1);
  count_uses(by, 1);
  rows_.replace(particle, by);
}

void Places::find_runs() const {
  runs_.clear();
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
  are_runs_known_ = true;
}

}  // namespace plumb::detail
