#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "interface/place.hpp"

namespace plumb::detail {

/// Leads from particles, or from rods, to places. A fixed particle has a place in every island that hangs
/// from it, and none if nothing does. A movable particle has at least one; lanes that repeat an island add
/// further ones.
class Places {
 public:
  struct Entry {
    std::uint32_t particle;  ///< or rod
    Place place;
  };

  Places() = default;
  /// Sorts the entries by particle in linear time. The places of a particle keep the order of `entries`.
  Places(std::uint32_t particles, std::span<const Entry> entries);

  /// Returns places of which those of `others` replace all that are gone. Theirs are at `numbers` here, and
  /// their solvers at `solvers`. is_gone(number, place) says which of these go.
  template <class IsGone>
  Places replaced(IsGone&& is_gone, const Places& others, std::span<const std::uint32_t> numbers,
                  std::span<const std::uint32_t> solvers) const {
    std::vector<Entry> entries;
    for (std::uint32_t i = 0; i < count(); ++i)
      for (const Place& place : of(i))
        if (!is_gone(i, place)) entries.push_back({i, place});
    for (std::uint32_t i = 0; i < numbers.size(); ++i)
      for (const Place& place : others.of(i))
        entries.push_back({numbers[i], {solvers[place.solver], place.slot}});
    return Places(count(), entries);
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(begin_.size() - 1); }  ///< of particles
  std::span<const Place> all() const { return places_; }

  /// Returns all places of a particle.
  std::span<const Place> of(std::uint32_t particle) const {
    return std::span(places_).subspan(begin_[particle], begin_[particle + std::size_t{1}] - begin_[particle]);
  }

  /// Returns the first places of all that have one, in runs.
  std::span<const Run> runs() const { return runs_; }

  /// Calls f(first, count, places) for all numbers below `end`, in runs from `first` on. In a run of several
  /// each has one place, all of one solver; else `places` are those of `first` alone.
  template <class F>
  void for_runs(std::uint32_t end, F&& f) const {
    const auto is_single = [&](std::uint32_t i) { return begin_[i + std::size_t{1}] == begin_[i] + 1; };
    for (std::uint32_t first = 0, next = 0; first < end; first = next) {
      next = first + 1;
      if (is_single(first))
        while (next < end && is_single(next) && places_[begin_[next]].solver == places_[begin_[first]].solver)
          ++next;
      f(first, next - first, std::span(places_).subspan(begin_[first], begin_[next] - begin_[first]));
    }
  }

 private:
  void find_runs();

  std::vector<std::size_t> begin_ = std::vector<std::size_t>(1);  ///< particles + 1 entries, into places_
  std::vector<Place> places_;
  std::vector<Run> runs_;
};

}  // namespace plumb::detail
