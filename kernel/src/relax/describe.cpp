#include "relax/describe.hpp"

#include <algorithm>
#include <vector>

namespace plumb::detail {
namespace {

/// Counts the islands of a block. Fixed particles that no rod holds belong to none.
std::uint32_t count_islands(const layouts::Packing& packing) {
  Array<std::uint32_t> islands = packing.slot_island;
  std::sort(islands.begin(), islands.end());
  islands.erase(std::unique(islands.begin(), islands.end()), islands.end());
  if (!islands.empty() && islands.back() == layouts::none) islands.pop_back();
  return static_cast<std::uint32_t>(islands.size());
}

}  // namespace

template <class T>
BlockInfo describe(const Block<T>& block) {
  constexpr const char* layout_names[] = {"aos", "soa", "aosoa"};
  const layouts::Packing& packing = block.packing();
  BlockInfo info;
  info.shape = packing.shape;
  info.layout = layout_names[static_cast<int>(packing.layout)];
  info.islands = count_islands(packing);
  info.particles = static_cast<std::uint32_t>(
      std::count(packing.slot_duplicate.begin(), packing.slot_duplicate.end(), std::uint8_t{0}));
  info.rods = block.rods();
  info.colors = packing.colors;
  info.bytes = block.bytes();
  info.uniform_fraction = block.uniform_rods() / std::max(1.0, double{1} * info.rods);
  // A projection reads and writes two ends. It reads the rod's vector and violation, weights where rods
  // differ, and addresses.
  const double end_numbers = packing.access == layouts::Access::records ? 16 : 12;
  const double numbers = end_numbers + simd::rod_fields + 3 * (1 - info.uniform_fraction);
  const double rods_per_address = packing.access == layouts::Access::rows ? packing.lanes : 1;
  info.bytes_per_projection = numbers * sizeof(T) + 2 * sizeof(std::uint32_t) / rods_per_address;
  return info;
}

template BlockInfo describe(const Block<float>&);
template BlockInfo describe(const Block<double>&);

void add_to_list(std::vector<BlockInfo>& list, BlockInfo info) {
  const auto known = std::find_if(list.begin(), list.end(), [&](const BlockInfo& each) {
    return each.shape == info.shape && each.layout == info.layout && each.colors == info.colors;
  });
  if (known == list.end()) return list.push_back(std::move(info));
  const double rods = std::max(1.0, double{1} * known->rods + info.rods);
  known->uniform_fraction =
      (known->uniform_fraction * known->rods + info.uniform_fraction * info.rods) / rods;
  known->islands += info.islands;
  known->particles += info.particles;
  known->rods += info.rods;
  known->bytes += info.bytes;
}

}  // namespace plumb::detail
