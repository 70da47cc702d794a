#pragma once

#include <cstdint>
#include <optional>

#include "plumb/scene.hpp"

namespace plumb::view {

/// Returns a scene in which the body that has a rod hangs from nothing: its joints, springs and torsions are
/// out. Returns nothing if the rod is of no body. Throws InputError if that hangs from nothing as it is.
std::optional<Scene> with_limb_severed(const Scene& scene, std::uint32_t rod);

}  // namespace plumb::view
