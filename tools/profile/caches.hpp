#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace plumb::tools {

/// A cache holds data, alone or with instructions.
struct Cache {
  unsigned level = 0;
  std::uint64_t bytes = 0;
  unsigned ways = 0;  ///< Lines that may hold the same address.
  unsigned line = 0;  ///< Length of a line, in bytes.
};

/// A pair holds the first data cache and the last cache that is looked at.
struct CachePair {
  Cache first, last;
  /// Whether these are common sizes, since the system does not tell those of this machine.
  bool assumed = false;
};

/// Returns the caches that hold data, by level. It reads /sys/devices/system/cpu/cpu0/cache, another `folder`
/// of that form, or else sysconf. The list is empty if none of them tells.
std::vector<Cache> read_caches(const std::filesystem::path& folder = "/sys/devices/system/cpu/cpu0/cache");

/// Returns the first level and the highest other level up to `last_level`. Without a second level both are
/// the same cache.
CachePair pick_caches(const std::vector<Cache>& caches, unsigned last_level);

/// Returns the nearest cache whose number of sets is a power of two, as cachegrind simulates no other. It has
/// fewer sets, more ways, and a size as near as whole ways allow. Throws InputError if the length of a line
/// is no power of two.
Cache nearest_simulated(const Cache& cache);

/// Describes a cache, such as "1 MB, 16 ways, lines of 64 bytes". Here kB and MB are powers of two.
std::string describe(const Cache& cache);

}  // namespace plumb::tools
