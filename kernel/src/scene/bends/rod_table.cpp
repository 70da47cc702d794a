#include "scene/bends/rod_table.hpp"

#include "scene/refuse.hpp"

namespace plumb::detail {

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
