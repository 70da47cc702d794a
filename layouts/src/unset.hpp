#pragma once

#include <cstdint>
#include <limits>

namespace plumb::layouts {

/// What stands where no number of a vertex, edge, colour or island is known yet.
inline constexpr std::uint32_t unset = std::numeric_limits<std::uint32_t>::max();

}  // namespace plumb::layouts
