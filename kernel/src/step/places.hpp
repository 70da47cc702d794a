#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "interface/place.hpp"
#include "step/rows.hpp"

namespace plumb::detail {

/// Leads from particles, or from rods, to places. A fixed particle has a place in every island that hangs
/// from it, and none if nothing does. A movable particle has at least one; lanes that repeat an island add
/// further ones.
class Places {
 public:
  using Entry = Rows<Place>::Entry;  ///< of a particle, or of a rod

  Places() = default;
  /// The places of a particle keep the order of `entries`.
  Places(std::uint32_t particles, std::span<const Entry> entries);

  std::uint32_t count() const { return rows_.count(); }  ///< of particles
  /// Returns how many places a solver has here.
  std::uint32_t uses(std::uint32_t solver) const { return solver < uses_.size() ? uses_[solver] : 0; }

  /// Returns all places of a particle.
  std::span<const Place> of(std::uint32_t particle) const { return rows_.of(particle); }
  /// Gives a particle other places, in time that does not depend on how many particles there are.
  void replace(std::uint32_t particle, std::span<const Place> by);
  /// Adds particles without places, up to so many.
  void grow(std::uint32_t particles) { rows_.grow(particles); }

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
      const auto range = rows_.range(first);  // clang 14 lets no lambda take bindings
      const std::span<const Place> places = rows_.items();
      const auto goes_on = [&] {
        const auto other = rows_.range(next);
        return other.count == 1 && other.begin == range.begin + (next - first) &&
               places[other.begin].solver == places[range.begin].solver;
      };
      if (range.count == 1)
        while (next < end && goes_on()) ++next;
      f(first, next - first, places.subspan(range.begin, range.count == 1 ? next - first : range.count));
    }
  }

 private:
  void count_uses(std::span<const Place> places, std::int32_t change);
  void find_runs() const;

  Rows<Place> rows_;                 ///< by particle
  std::vector<std::uint32_t> uses_;  ///< by solver
  mutable std::vector<Run> runs_;
  mutable bool are_runs_known_ = false;
};

}  // namespace plumb::detail
