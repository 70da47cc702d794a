#include "profile/caches.hpp"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <fstream>

#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

std::string read_word(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  in >> word;
  return word;
}

/// Reads a size in bytes as sysfs spells it, such as "32K". Returns 0 if the text is no size.
std::uint64_t parse_size(std::string text) {
  std::uint64_t unit = 1;
  if (!text.empty() && (text.back() == 'K' || text.back() == 'M')) {
    unit = text.back() == 'K' ? 1024 : 1024 * 1024;
    text.pop_back();
  }
  return unit * scenes::parse_number<std::uint64_t>(text).value_or(0);
}

bool is_whole(const Cache& cache) {
  return cache.level > 0 && cache.bytes > 0 && cache.ways > 0 && cache.line > 0;
}

void append_from_sysconf(std::vector<Cache>& caches) {
#ifdef _SC_LEVEL1_DCACHE_SIZE
  constexpr int names[][3] = {{_SC_LEVEL1_DCACHE_SIZE, _SC_LEVEL1_DCACHE_ASSOC, _SC_LEVEL1_DCACHE_LINESIZE},
                              {_SC_LEVEL2_CACHE_SIZE, _SC_LEVEL2_CACHE_ASSOC, _SC_LEVEL2_CACHE_LINESIZE},
                              {_SC_LEVEL3_CACHE_SIZE, _SC_LEVEL3_CACHE_ASSOC, _SC_LEVEL3_CACHE_LINESIZE}};
  for (unsigned level = 1; level <= 3; ++level) {
    const auto value = [&](int which) { return std::max(0L, ::sysconf(names[level - 1][which])); };
    const Cache cache{level, static_cast<std::uint64_t>(value(0)), static_cast<unsigned>(value(1)),
                      static_cast<unsigned>(value(2))};
    if (is_whole(cache)) caches.push_back(cache);
  }
#endif
}

}  // namespace

std::vector<Cache> read_caches(const std::filesystem::path& folder) {
  std::vector<Cache> caches;
  for (int index = 0;; ++index) {
    const std::filesystem::path one = folder / ("index" + std::to_string(index));
    if (!std::filesystem::exists(one / "level")) break;
    if (read_word(one / "type") == "Instruction") continue;
    const auto count = [&](const char* name) {
      return scenes::parse_number<unsigned>(read_word(one / name)).value_or(0);
    };
    const Cache cache{count("level"), parse_size(read_word(one / "size")), count("ways_of_associativity"),
                      count("coherency_line_size")};
    if (is_whole(cache)) caches.push_back(cache);
  }
  if (caches.empty()) append_from_sysconf(caches);
  std::sort(caches.begin(), caches.end(), [](const Cache& l, const Cache& r) { return l.level < r.level; });
  return caches;
}

CachePair pick_caches(const std::vector<Cache>& caches, unsigned last_level) {
  if (caches.empty()) return {{1, 32 * 1024, 8, 64}, {2, 1024 * 1024, 16, 64}, true};
  CachePair pair{caches.front(), caches.front(), false};
  for (const Cache& cache : caches)
    if (cache.level <= last_level) pair.last = cache;
  return pair;
}

Cache nearest_simulated(const Cache& cache) {
  if (!is_whole(cache) || !std::has_single_bit(cache.line))
    throw InputError("a cache of " + describe(cache) + " cannot be simulated");
  const std::uint64_t way = std::uint64_t{cache.ways} * cache.line;
  Cache out = cache;
  const std::uint64_t sets = std::bit_floor(std::max<std::uint64_t>(1, cache.bytes / way));
  out.ways = static_cast<unsigned>((cache.bytes + sets * cache.line / 2) / (sets * cache.line));
  out.bytes = sets * out.ways * cache.line;
  return out;
}

std::string describe(const Cache& cache) {
  const bool large = cache.bytes >= 1024 * 1024;
  return scenes::short_number(static_cast<double>(cache.bytes) / (large ? 1024 * 1024 : 1024), 4) +
         (large ? " MB, " : " kB, ") + std::to_string(cache.ways) + " ways, lines of " +
         std::to_string(cache.line) + " bytes";
}

}  // namespace plumb::tools
