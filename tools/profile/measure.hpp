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

/// These are counts of a run, or of a unit: a projection (method relax), or a rod in a Newton step (method
/// direct). A count is none where the way of measuring does not give it.
struct Counts {
  std::optional<double> instructions{}, cycles{};
  std::optional<double> l1d_read_misses{}, l1d_write_misses{};
  std::optional<double> ll_misses{};  ///< Misses of data in the last cache.
};

/// Divides what the longer run counted more by what it did more. What both did alike, such as setting up the
/// scene, cancels. A count is none where either run has none. Throws InputError unless the longer run did
/// more.
Counts counts_per_unit(const Counts& shorter, std::uint64_t shorter_units, const Counts& longer,
                       std::uint64_t longer_units);

/// Returns for each count the median of those that are there.
Counts median_of(const std::vector<Counts>& samples);

/// Returns a cost, which is the difference of two times, if it is positive. Work costs time, so any other
/// difference comes from programs that ran in between, and the cost is not measurable.
std::optional<double> measurable_cost(std::optional<double> ns);

/// Cache misses are found by the processor's counters, simulated by cachegrind, or not found.
enum class Way : std::uint8_t { counters, cachegrind, none };
std::string_view to_string(Way);

/// A machine has these means of measuring.
struct Means {
  bool miss_counters = false;  ///< Whether at least one of the two counters of misses is there.
  std::string refusals;        ///< Reasons why counters are not there.
  std::optional<std::filesystem::path> valgrind;
};
/// Finds out what this machine has.
Means find_means();

/// Returns the way asked for, or the best there is, which may be `none`. Throws InputError with the reason if
/// the way asked for is not there.
Way choose_way(std::optional<Way> asked, const Means& means);
/// Says how to get cache misses where they cannot be measured.
std::string advice(const Means& means);

/// A row is a measured case. Counts and time are per unit, see WorkDone.
struct ProfileRow {
  ProfileCase profile_case;
  std::string layout;    ///< Layout of most rods, as the world names it; empty for method direct.
  bool is_auto = false;  ///< Whether --layout auto gives this layout.
  std::uint32_t rods = 0;
  /// Size of state and rods with padding, in bytes; none for method direct.
  std::optional<std::size_t> state_bytes;
  double model_bytes = 0;    ///< Bytes that a unit reads and writes before any cache.
  std::optional<double> ns;  ///< Time of a unit in ns; none where the noise of other programs hides it.
  Counts counts;
};

struct Profile {
  Way way = Way::none;
  CachePair caches;     ///< Caches of the machine.
  CachePair simulated;  ///< Caches that cachegrind simulates.
  std::string remark;   ///< Reason why another way was not taken; may be empty.
  Isa isa = Isa::scalar;
  Precision precision = Precision::single;
  std::vector<ProfileRow> rows;
};

/// Measures every case, and tells `show` after each how many are done.
std::vector<ProfileRow> measure_cases(const std::vector<ProfileCase>& cases, Way way, const Means& means,
                                      const CachePair& simulated,
                                      const std::function<void(std::size_t)>& show);

}  // namespace plumb::tools
