#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::bench {

/// A rod as libraries in joint coordinates have it: it turns on a ball joint at its parent's end and carries
/// the particle at its own. Worlds' axes, as the scene starts.
struct Link {
  static constexpr std::int32_t none = -1;

  std::uint32_t particle = 0;  ///< index into Scene::particles
  std::uint32_t from = 0;      ///< the particle at the joint
  std::int32_t parent = none;  ///< index of the link that carries `from`; none if that is fixed
  std::uint32_t root = 0;      ///< the fixed particle that all hangs from
  Vec3 offset{};               ///< m, from the joint to the particle
  double mass = 0;             ///< kg, of the particle
};

/// The rods of a scene, parents before children and every root's links together. Throws InputError unless
/// the scene starts from rest without drag, its rods are massless and at their length, and all hang in trees
/// from one fixed particle each.
std::vector<Link> find_links(const Scene& scene);

/// Whether find_links() takes it.
bool has_links(const Scene& scene);

/// What a link turns with besides its particle's mass, in kg·m², about the particle. A point mass has no
/// inertia about the rod's own axis, and equations for ball joints are singular without any. Far below the
/// errors that are measured, far above what rounding leaves of mass × length².
double bead_inertia(const Link& link);

}  // namespace plumb::bench
