#include "step/places.hpp"

#include <algorithm>
#include <utility>

namespace plumb::detail {

Places::Places(std::uint32_t particles, std::span<const Entry> entries)
    : ranges_(particles, Range{0, 0}), places_(entries.size()) {
  for (const Entry& entry : entries) ++ranges_[entry.particle].count;
  for (std::size_t i = 1; i < particles; ++i) ranges_[i].begin = ranges_[i - 1].begin + ranges_[i - 1].count;
  for (Range& range : ranges_) range.count = 0;
  for (const Entry& entry : entries) {
    Range& range = ranges_[entry.particle];
    places_[range.begin + range.count++] = entry.place;
  }
  count_uses(places_, 1);
}

void Places::count_uses(std::span<const Place> places, std::int32_t change) {
  for (const Place& place : places) {
    if (place.solver >= uses_.size()) uses_.resize(place.solver + std::size_t{1});
    uses_[place.solver] += static_cast<std::uint32_t>(change);
  }
}

void Places::replace(std::uint32_t particle, std::span<const Place> by) {
  Range& range = ranges_[particle];
  are_runs_known_ = false;
  count_uses(of(particle), -1);
  count_uses(by, 1);
  gaps_ += range.count;
  if (by.size() > range.count) {
    range.begin = static_cast<std::uint32_t>(places_.size());
    places_.resize(places_.size() + by.size());
    gaps_ += by.size();
  }
  range.count = static_cast<std::uint32_t>(by.size());
  gaps_ -= range.count;
  std::copy(by.begin(), by.end(), places_.begin() + range.begin);
  if (gaps_ > places_.size() / 2) close_gaps();
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

void Places::close_gaps() {
  const std::vector<Place> before = std::exchange(places_, {});
  places_.reserve(before.size() - gaps_);
  for (Range& range : ranges_) {
    const auto first = before.begin() + range.begin;
    range.begin = static_cast<std::uint32_t>(places_.size());
    places_.insert(places_.end(), first, first + range.count);
  }
  gaps_ = 0;
}

}  // namespace plumb::detail
