#include "relax/schedule.hpp"

namespace plumb::detail {

template <class T>
Schedule make_schedule(std::span<const Block<T>> blocks, std::uint32_t shared_rods) {
  Schedule schedule;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    const layouts::Packing& packing = blocks[b].packing();
    const bool independent = packing.coupling == layouts::Coupling::independent;
    if (!independent && blocks[b].rods() >= shared_rods) {
      schedule.shared_blocks.push_back(b);
      continue;
    }
    schedule.lone_blocks.push_back(b);
    const std::uint32_t piece = independent ? 1 : packing.positions;
    for (std::uint32_t q = 0; q < packing.positions; q += piece)
      schedule.lone_work.push_back({b, q, q + piece});
  }
  return schedule;
}

template Schedule make_schedule(std::span<const Block<float>>, std::uint32_t);
template Schedule make_schedule(std::span<const Block<double>>, std::uint32_t);

}  // namespace plumb::detail
