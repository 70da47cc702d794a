#include "scene/bends/rod_table.hpp"

#include "scene/refuse.hpp"

namespace plumb::detail {

void mark_rods(const RodTable& rods, std::span<const std::uint32_t> chain, Array<std::uint8_t>& out) {
  for (std::size_t k = 1; k < chain.size(); ++k)
    if (const auto rod = rods.find(chain[k - 1], chain[k])) out[*rod] = 1;
}

void require_rod(const Scene& scene, const RodTable& rods, Named what, std::uint32_t from, std::uint32_t to) {
  if (rods.find(from, to)) return;
  const Particle &first = scene.particles[from], &second = scene.particles[to];
  if (!first.fixed || !second.fixed)
    refuse(what.name, what.number, ": no rod joins particles ", from, " and ", to,
           "; only fixed particles need none");
  if (first.position == second.position)
    refuse(what.name, what.number, ": fixed particles ", from, " and ", to, " are at the same place");
}

}  // namespace plumb::detail
