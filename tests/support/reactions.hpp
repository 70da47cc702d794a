#pragma once

#include <vector>

#include "plumb/plumb.hpp"

namespace plumb::test {

/// Returns the sum of the forces (N) that hold all anchors, of a world that knows them.
inline Vec3 sum_of_reactions(const World& world) {
  std::vector<Vec3> all(world.particle_count());
  world.copy_reactions(all);
  Vec3 sum;
  for (const Vec3 each : all) sum += each;
  return sum;
}

}  // namespace plumb::test
