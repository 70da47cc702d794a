#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "profile/caches.hpp"
#include "profile/perf_counters.hpp"
#include "profile/work.hpp"

namespace plumb::tools {

/// Counts of a run, or per projection (method relax) or per rod and Newton step (method direct). None where
/// the way of measuring does not give it.
struct Counts {
  std::optional<double> instructions{}, cycles{};
  std::optional<double> l1d_read_misses{}, l1d_write_misses{};
  std::optional<double> ll_misses{};  ///< of data
};

/// What the longer of two runs counted more than the shorter, by what it did more: what both did alike, such
/// as setting up the scene, does not count. None where either has none. Throws InputError unless the longer
/// run did more.
Counts counts_per_unit(const Counts& shorter, std::uint64_t shorter_units, const Counts& longer,
                       std::uint64_t longer_units);

/// Of each count the median of those that are there.
Counts median_of(const std::vector<Counts>& samples);

/// A cost, the difference of two times, if it is one. Work costs time: a difference that is not positive is
/// that of other programs' work in between, and the cost is not measurable under this noise.
std::optional<double> measurable_cost(std::optional<double> ns);

/// How cache misses are found: the processor's counters, simulated by cachegrind, or not at all.
enum class Way : std::uint8_t { counters, cachegrind, none };
std::string_view to_string(Way);

/// What is there to measure with.
struct Means {
  bool miss_counters = false;  ///< at least one of the two counters of misses
  std::string refusals;        ///< why counters are not there
  std::optional<std::filesystem::path> valgrind;
};
/// What this machine has.
Means find_means();

/// The way asked for, or the best there is. Throws InputError with the reason if the way asked for is not
/// there; without an own wish there is always `none`.
Way choose_way(std::optional<Way> asked, const Means& means);
/// How to get cache misses where they cannot be measured.
std::string advice(const Means& means);

/// A measured case. Counts and time are per unit, see WorkDone.
struct ProfileRow {
  ProfileCase profile_case;
  std::string layout;    ///< as the world names that of most rods; empty for method direct
  bool is_auto = false;  ///< --layout auto gives this layout
  std::uint32_t rods = 0;
  std::optional<std::size_t> state_bytes;  ///< state and rods with padding; none for method direct
  double model_bytes = 0;                  ///< read and written by a unit before any cache
  std::optional<double> ns;                ///< none: not measurable under the noise of other programs
  Counts counts;
};

struct Profile {
  Way way = Way::none;
  CachePair caches;     ///< of the machine
  CachePair simulated;  ///< with way cachegrind
  std::string remark;   ///< why another way was not taken; may be empty
  Isa isa = Isa::scalar;
  Precision precision = Precision::single;
  std::vector<ProfileRow> rows;
};

/// Measures every case; `show` is told how many are done.
std::vector<ProfileRow> measure_cases(const std::vector<ProfileCase>& cases, Way way, const Means& means,
                                      const CachePair& simulated,
                                      const std::function<void(std::size_t)>& show);

}  // namespace plumb::tools
