#pragma once

#include <cstdint>

namespace plumb::detail {

/// Says of a particle which island it is of now, by a number without further meaning, and whether that
/// sleeps. Fixed ones, from which several may hang, are of none.
struct Standing {
  std::uint64_t island = ~std::uint64_t{0};
  bool is_asleep = false;
};

}  // namespace plumb::detail
