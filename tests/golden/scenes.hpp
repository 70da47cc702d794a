#pragma once

#include <string_view>

#include "plumb/scene.hpp"

namespace plumb::golden {

/// The scene that a row names, then changes to it, separated by blanks:
/// `chain:links=20,end_mass=10 drag=0.3 rod_mass=0.5`.
///
/// The scene is a generator of the command (scenes/spec.hpp) or one of these:
///
///   forest          two trees of rods with mass, the five rods, and six chains of unequal end masses
///   mixed           a wide net, a chain, a truss and a particle that nothing holds
///   random_tree     40 particles and two anchors in a tree, some rods with mass off the middle
///   ladder          a truss of rods with mass between two anchors
///   tower           three blocks, one upon the other on the ground, the upper ones set down from 1 cm
///   slide           a block on a rough slope of 3 in 4, which it leaves for a box
///   rollers         balls, cylinders and a block on a belt, a platform and a drum of anchors
///   mechanism       five bodies by a ball joint, a revolute, a universal and a prismatic joint, with angles
///   that are
///                   limited, driven and rubbing
///   springs         the mechanism with springs, one of them slack at first, a torsion and an elastic rod
///   pool            a ball that rolls into sleeping balls and a sleeping rod
///   rope            a chain with capsules that falls over a box onto the ground
///   hoist           a load in a block, from which a rod hangs, and a lighter one at the end of the cord
///
/// The changes are:
///
///   drag=C joint_drag=C  Scene::drag and joint_drag, 1/s
///   rod_drag=C           1/s across every rod, a quarter of it along
///   rod_mass=M           kg of every rod
///   uneven=1             rods with mass have it off the middle, with an inertia of its own
///   off_length=E         rods are longer and shorter by this share than the places of their ends, in turn
///   friction=C           of every tackle
///   velocity=V           m/s, in directions that pull on rods
///   snap=1               coordinates are rounded to 2⁻⁴⁰ m: last bits of sine and cosine are gone
///   ball=V               a ball flies at the torso of a standing humanoid, m/s
///
/// Throws InputError on anything else.
Scene build_scene(std::string_view text);

}  // namespace plumb::golden
