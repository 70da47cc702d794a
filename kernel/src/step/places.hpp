#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace plumb::detail {

/// Where a particle's numbers are.
struct Place {
  std::uint32_t block;
  std::uint32_t slot;

  friend bool operator==(const Place&, const Place&) = default;
};

/// From particles to places. A fixed particle has a place in every island that hangs from it, and islands may
/// be repeated to fill lanes; every particle has one place at least.
class Places {
 public:
  Places() = default;
  /// `slot_vertex[block][slot]` is the particle there. Linear time.
  Places(std::uint32_t particles, std::span<const std::span<const std::uint32_t>> slot_vertex);

  /// All places of a particle, in the order of blocks and slots.
  std::span<const Place> of(std::uint32_t particle) const {
    return std::span(places_).subspan(begin_[particle], begin_[particle + std::size_t{1}] - begin_[particle]);
  }
  /// The place that is read.
  Place first(std::uint32_t particle) const { return places_[begin_[particle]]; }

 private:
  std::vector<std::size_t> begin_;  ///< particles + 1 entries, into places_
  std::vector<Place> places_;
};

}  // namespace plumb::detail
