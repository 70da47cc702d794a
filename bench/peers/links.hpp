#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::bench {

/// Describes a rod as libraries in joint coordinates have it. It turns on a ball joint at its parent's end
/// and carries the particle at its own. Vectors are in the world's axes, as the scene starts.
struct Link {
  static constexpr std::int32_t none = -1;

  std::uint32_t particle = 0;  ///< index into Scene::particles
  std::uint32_t from = 0;      ///< the scene's particle at the joint
  std::int32_t parent = none;  ///< index of the link that carries `from`; none if that is fixed
  std::uint32_t root = 0;      ///< the scene's fixed particle that all hangs from
  Vec3 offset{};               ///< from the joint to the particle, m
  double mass = 0;             ///< mass of the particle, kg
};

/// Returns the rods of a scene, parents before children and every root's links together. Throws InputError
/// unless the scene starts from rest without drag and its rods are massless and at their length. All must
/// hang in trees from one fixed particle each.
std::vector<Link> find_links(const Scene& scene);

/// Returns whether find_links() takes the scene.
bool has_links(const Scene& scene);

/// Returns what a link turns with besides its particle's mass, in kg·m², about the particle. A point mass has
/// no inertia about the rod's own axis, and equations for ball joints are singular without any. The value is
/// far below the errors that are measured, and far above what rounding leaves of mass × length².
double bead_inertia(const Link& link);

}  // namespace plumb::bench
