#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Orders the nodes of a graph by approximate minimum degree (Amestoy, Davis, Duff 1996).
Array<std::uint32_t> order_by_degree(std::uint32_t nodes,
                                     std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);

/// Cuts a graph in two through the middle level of a breadth-first search from an end of it, and the halves
/// again (George 1973). Small parts are left in the order found.
Array<std::uint32_t> order_by_dissection(std::uint32_t nodes,
                                         std::span<const std::pair<std::uint32_t, std::uint32_t>> edges);

/// On square nets degree wins below 10,000 particles, and dissection by a tenth above. Below this it is not
/// tried.
constexpr std::uint32_t least_dissected = 64;

}  // namespace plumb::detail
