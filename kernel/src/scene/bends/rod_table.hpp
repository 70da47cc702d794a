#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Finds a scene's rods by their ends.
class RodTable {
 public:
  explicit RodTable(const Scene& scene) : RodTable(scene, [](std::size_t) { return true; }) {}
  /// Knows those alone of which has(i) says so.
  template <class Has>
  RodTable(const Scene& scene, Has&& has) {
    rods_.reserve(scene.rods.size());
    for (std::size_t i = 0; i < scene.rods.size(); ++i)
      if (has(i)) rods_.emplace_back(key(scene.rods[i].a, scene.rods[i].b), i);
    std::sort(rods_.begin(), rods_.end());
  }

  std::optional<std::size_t> find(std::uint32_t a, std::uint32_t b) const {
    const auto at = std::lower_bound(rods_.begin(), rods_.end(), std::pair{key(a, b), std::size_t{0}});
    if (at == rods_.end() || at->first != key(a, b)) return std::nullopt;
    return at->second;
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    return std::uint64_t{low} << 32 | high;
  }

  Array<std::pair<std::uint64_t, std::size_t>> rods_;
};

/// Returns whether particles that follow each other in a chain, and are not both fixed, lack a rod.
template <class Particles>
bool lacks_rod(const Scene& scene, const RodTable& rods, const Particles& chain) {
  for (std::size_t k = 1; k < chain.size(); ++k)
    if (!(scene.particles[chain[k - 1]].fixed && scene.particles[chain[k]].fixed) &&
        !rods.find(chain[k - 1], chain[k]))
      return true;
  return false;
}

/// Sets to 1, by rod, what joins particles that follow each other in a chain.
void mark_rods(const RodTable& rods, std::span<const std::uint32_t> chain, Array<std::uint8_t>& out);

/// Refuses a bend or a twist, by its name and number, where no rod joins two of its particles that follow
/// each other. Fixed particles in different places need none.
struct Named {
  const char* name;
  std::size_t number;
};
void require_rod(const Scene& scene, const RodTable& rods, Named what, std::uint32_t from, std::uint32_t to);

}  // namespace plumb::detail
