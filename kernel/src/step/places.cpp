#include "step/places.hpp"

namespace plumb::detail {

Places::Places(std::uint32_t particles, std::span<const Entry> entries)
    : begin_(particles + std::size_t{1}, 0), places_(entries.size()) {
  for (const Entry& entry : entries) ++begin_[entry.particle + std::size_t{1}];
  for (std::size_t i = 0; i < particles; ++i) begin_[i + 1] += begin_[i];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (const Entry& entry : entries) places_[next[entry.particle]++] = entry.place;
}

}  // namespace plumb::detail
