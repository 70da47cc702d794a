#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace plumb::detail {

/// Where a particle's numbers are.
struct Place {
  std::uint32_t solver;
  std::uint32_t slot;

  friend bool operator==(const Place&, const Place&) = default;
};

/// From particles to places. A fixed particle has a place in every island that hangs from it, and none if
/// nothing does. Movable particles have one at least; lanes that repeat an island are further ones.
class Places {
 public:
  struct Entry {
    std::uint32_t particle;
    Place place;
  };

  Places() = default;
  /// Places of a particle keep the order of `entries`. Linear time.
  Places(std::uint32_t particles, std::span<const Entry> entries);

  /// All places of a particle.
  std::span<const Place> of(std::uint32_t particle) const {
    return std::span(places_).subspan(begin_[particle], begin_[particle + std::size_t{1}] - begin_[particle]);
  }

 private:
  std::vector<std::size_t> begin_;  ///< particles + 1 entries, into places_
  std::vector<Place> places_;
};

}  // namespace plumb::detail
