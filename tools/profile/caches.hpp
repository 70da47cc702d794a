#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace plumb::tools {

/// A data or unified cache.
struct Cache {
  unsigned level = 0;
  std::uint64_t bytes = 0;
  unsigned ways = 0;  ///< lines that may hold the same address
  unsigned line = 0;  ///< bytes
};

/// The first data cache and the last one that is looked at.
struct CachePair {
  Cache first, last;
  bool assumed = false;  ///< the system does not tell: these are common sizes, not this machine's
};

/// The caches that hold data, by level, as /sys/devices/system/cpu/cpu0/cache (or another `folder` of that
/// form) describes them, or else sysconf. Empty if neither does.
std::vector<Cache> read_caches(const std::filesystem::path& folder = "/sys/devices/system/cpu/cpu0/cache");

/// The first level and, of the rest, the highest one up to `last_level`. Without a second level both are the
/// same cache.
CachePair pick_caches(const std::vector<Cache>& caches, unsigned last_level);

/// The nearest cache whose number of sets is a power of two, which is all that cachegrind simulates: fewer
/// sets, more ways, and a size as near as whole ways allow. Throws InputError if the line is no power of two.
Cache nearest_simulated(const Cache& cache);

/// Such as "1 MB, 16 ways, lines of 64 bytes"; kB and MB are powers of two.
std::string describe(const Cache& cache);

}  // namespace plumb::tools
