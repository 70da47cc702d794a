#include "scene/ground/weld.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace plumb::detail {

Array<std::uint32_t> weld(std::span<const Vec3> vertices) {
  Array<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    return std::tuple(vertices[i].x, vertices[i].y, vertices[i].z, i);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t k) { return key(i) < key(k); });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && vertices[order[k]] == vertices[order[k - 1]] ? first[order[k - 1]] : order[k];
  return first;
}

}  // namespace plumb::detail
