#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "interface/place.hpp"
#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "step/rows.hpp"

namespace plumb::detail {

/// Leads from particles, or from rods, to places. A fixed particle has a place in every island that hangs
/// from it, and none if nothing does. A movable particle has at least one; lanes that repeat an island add
/// further ones.
class Places {
 public:
  using Entry = Rows<Place>::Entry;  ///< of a particle, or of a rod

  /// Runs are found by chunks of so many particles, so that a change looks at few.
  static constexpr std::uint32_t chunk_size = 256;

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
  void grow(std::uint32_t particles);
  /// Returns whether some particle has several places.
  bool any_several() const { return several_ > 0; }

  /// Finds runs of the first places of all particles, or after that, of what was replaced since. Places of
  /// cords need none.
  void find_runs(std::span<const std::unique_ptr<Solver>> solvers);
  /// Calls f(solver's number, runs) for these runs, by lists of one solver, and of particles nowhere.
  template <class F>
  void for_reading(F&& f) const {
    for (std::uint32_t chunk = 0; chunk < runs_.count(); ++chunk) {
      const std::span<const Run> runs = runs_.of(chunk);
      for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
        const auto is_other = [&](const Run& run) { return run.solver != runs[begin].solver; };
        end = static_cast<std::size_t>(
            std::find_if(runs.begin() + static_cast<std::ptrdiff_t>(begin), runs.end(), is_other) -
            runs.begin());
        f(runs[begin].solver, runs.subspan(begin, end - begin));
      }
    }
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
  void add_run(const Run& run);
  void make_stale(std::uint32_t chunk) {
    if (chunk < runs_.count() && (stale_.empty() || stale_.back() != chunk)) stale_.push_back(chunk);
  }
  void count_uses(std::span<const Place> places, std::int32_t change) {
    for (const Place& place : places) {
      if (place.solver >= uses_.size()) uses_.resize(place.solver + std::size_t{1});
      uses_[place.solver] += static_cast<std::uint32_t>(change);
    }
  }
  void find_runs_of(std::uint32_t chunk, std::span<const std::unique_ptr<Solver>> solvers);

  Rows<Place> rows_;            ///< by particle
  Array<std::uint32_t> uses_;   ///< by solver
  std::uint32_t several_ = 0;   ///< so many particles have several places
  Rows<Run> runs_;              ///< by chunk
  Array<std::uint32_t> stale_;  ///< chunks, of which some places were replaced
  Array<Run> found_;            ///< room for those of a chunk
};

}  // namespace plumb::detail
