#pragma once

#include <cstddef>
#include <cstdint>

#include "plumb/vec3.hpp"

namespace plumb {

class World;

/// Shows positions (m) or velocities (m/s) of a World in the scene's particle order, read in place.
///
/// Nothing is copied, and what is read is always the present state. A view is valid while the world lives and
/// is not moved.
class StateView {
 public:
  std::size_t size() const;                       ///< Number of particles.
  Vec3 operator[](std::uint32_t particle) const;  ///< Throws InputError on an unknown particle.

 private:
  friend class World;
  enum class Field : std::uint8_t { position, velocity };
  StateView(const World& world, Field field) : world_(&world), field_(field) {}

  const World* world_;
  Field field_;
};

}  // namespace plumb
