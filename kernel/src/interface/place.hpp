#pragma once

#include <cstdint>

namespace plumb::detail {

/// Says where the numbers of a particle or a rod are: the solver, and the slot in it.
struct Place {
  std::uint32_t solver;
  std::uint32_t slot;

  friend bool operator==(const Place&, const Place&) = default;
};

/// Says where many particles are whose numbers follow each other: in slots that are `stride` apart.
struct Run {
  std::uint32_t first;  ///< the first of the particles
  std::uint32_t count;
  Place place;  ///< of the first
  std::uint32_t stride;

  /// Calls f(slot) for each in turn.
  template <class F>
  void for_slots(F&& f) const {
    std::uint32_t slot = place.slot;
    for (std::uint32_t i = 0; i < count; ++i, slot += stride) f(slot);
  }
};

}  // namespace plumb::detail
