#pragma once

#include <cstdint>

namespace plumb::detail {

/// Says where the numbers of a particle or a rod are: the solver, and the slot in it.
struct Place {
  std::uint32_t solver;
  std::uint32_t slot;

  friend bool operator==(const Place&, const Place&) = default;
};

}  // namespace plumb::detail
