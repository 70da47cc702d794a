#pragma once

#include <memory>

#include "reference/mechanical_system.hpp"

namespace plumb::detail {

/// Featherstone's algorithm (thesis §3.5) on an island without loops that hangs from one fixed particle by
/// one rod, or from none. Every rod is a slender link with a spherical joint at the end nearer the fixed
/// particle and the particle at its other end on it; without a fixed particle, one particle is a base that
/// floats. Rods have their length whatever the scene's positions say: those give directions.
///
/// Drag and initial velocities need nothing of their own: a force -c M v makes accelerations smaller by c
/// times the speeds, and the velocities closest to given ones, by mass, are what impulses M v would bring
/// about from rest. An anchor that changes its velocity does so by an impulse.
///
/// Throws InputError naming the rods that make it another kind of island.
std::unique_ptr<MechanicalSystem> make_featherstone(const Scene& island, const Settings& settings,
                                                    const IslandNames& names);

}  // namespace plumb::detail
