#include "step/places.hpp"

namespace plumb::detail {

Places::Places(std::uint32_t particles, std::span<const std::span<const std::uint32_t>> slot_vertex)
    : begin_(particles + std::size_t{1}, 0) {
  for (const auto& vertices : slot_vertex)
    for (const std::uint32_t vertex : vertices) ++begin_[vertex + std::size_t{1}];
  for (std::size_t i = 0; i < particles; ++i) begin_[i + 1] += begin_[i];
  places_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t block = 0; block < slot_vertex.size(); ++block)
    for (std::uint32_t slot = 0; slot < slot_vertex[block].size(); ++slot)
      places_[next[slot_vertex[block][slot]]++] = {block, slot};
}

}  // namespace plumb::detail
