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

  std::uint32_t count() const { return static_cast<std::uint32_t>(ranges_.size()); }  ///< of particles
  /// Returns how many places a solver has here.
  std::uint32_t uses(std::uint32_t solver) const { return solver < uses_.size() ? uses_[solver] : 0; }

  /// Returns all places of a particle.
  std::span<const Place> of(std::uint32_t particle) const {
    return std::span(places_).subspan(ranges_[particle].begin, ranges_[particle].count);
  }
  /// Gives a particle other places, in time that does not depend on how many particles there are.
  void replace(std::uint32_t particle, std::span<const Place> by);

  /// Returns the first places of all that have one, in runs. Those are found at the first call, and anew at
  /// the first after replace().
  std::span<const Run> runs() const {
    if (!are_runs_known_) find_runs();
    return runs_;
  }

  /// Calls f(first, count, places) for all numbers below `end`, in runs from `first` on. In a run of several
  /// each has one place, all of one solver; else `places` are those of `first` alone.
  template <class F>
  void for_runs(std::uint32_t end, F&& f) const {
    for (std::uint32_t first = 0, next = 0; first < end; first = next) {
      next = first + 1;
      const Range range = ranges_[first];  // clang 14 lets no lambda take bindings
      const auto goes_on = [&] {
        const Range other = ranges_[next];
        return other.count == 1 && other.begin == range.begin + (next - first) &&
               places_[other.begin].solver == places_[range.begin].solver;
      };
      if (range.count == 1)
        while (next < end && goes_on()) ++next;
      f(first, next - first,
        std::span(places_).subspan(range.begin, range.count == 1 ? next - first : range.count));
    }
  }

 private:
  struct Range {
    std::uint32_t begin, count;  ///< in places_
  };
  void count_uses(std::span<const Place> places, std::int32_t change);
  void close_gaps();
  void find_runs() const;

  std::vector<Range> ranges_;  ///< by particle
  std::vector<Place> places_;
  std::vector<std::uint32_t> uses_;  ///< by solver
  std::size_t gaps_ = 0;             ///< entries of places_ that no range has
  mutable std::vector<Run> runs_;
  mutable bool are_runs_known_ = false;
};

}  // namespace plumb::detail
