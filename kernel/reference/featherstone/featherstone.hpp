#pragma once

#include <memory>

#include "reference/mechanical_system.hpp"

namespace plumb::detail {

/// Makes Featherstone's algorithm (thesis §3.5) for an island without loops that hangs from one fixed
/// particle by one rod, or from none.
///
/// Every rod is a slender link. It has a spherical joint at the end nearer the fixed particle, and carries
/// the particle at its other end. Without a fixed particle, one particle is a base that floats. Rods have
/// their length whatever the scene's positions say, which give directions only.
///
/// Drag and initial velocities need no code of their own. A force -c M v makes accelerations smaller by c
/// times the speeds. The velocities closest to given ones, by mass, are what impulses M v would bring about
/// from rest. An anchor that changes its velocity does so by an impulse.
///
/// Throws InputError with the names of the rods that make it another kind of island.
std::unique_ptr<MechanicalSystem> make_featherstone(const Scene& island, const Settings& settings,
                                                    const IslandNames& names);
/// Makes the same of an island of bodies, its movable particles first. Ball joints (pins, or a particle that
/// two bodies share) and hinges make a tree of them, which hangs from one place or floats. Springs, torsions
/// and drives of angles are forces. Throws InputError on anything else, naming `particle`.
std::unique_ptr<MechanicalSystem> make_jointed_featherstone(const Scene& island, const Settings& settings,
                                                            std::uint32_t particle);

}  // namespace plumb::detail
