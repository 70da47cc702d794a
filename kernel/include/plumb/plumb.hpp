/// @file
/// plumb simulates articulated things made of particles and rods. This header includes all headers of the
/// kernel.
///
///     plumb::Scene scene;                                   // describe: metres, kilograms, seconds
///     scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {1, 0, 0}, .mass = 1}};
///     scene.rods = {{.a = 0, .b = 1}};
///     plumb::World world(scene, {.substeps = 8});           // compile: islands, colours, layouts
///     world.step(1.0 / 60);                                 // advance
///     plumb::Vec3 tip = world.position(1);                  // read, in the scene's own order
///
/// - scene.hpp: what is simulated.
/// - shapes/ground.hpp: ground, from planes to landscapes.
/// - shapes/contact.hpp: what touched in a step.
/// - shapes/queries.hpp: what rays and what is cast meet, what overlaps, what is nearest.
/// - shapes/surface.hpp: how shapes feel, what they may touch, and how ground moves.
/// - settings.hpp: how it is simulated.
/// - world.hpp: the compiled scene and its step.
/// - report.hpp: what a step did and skipped, and what went wrong.
/// - loads.hpp: forces by function of time and state, and grabs, which pull places to targets.
/// - measures.hpp: how wrong it is, by strain, energy, momentum and truth.
/// - embedding/deltas.hpp: by how much a snapshot differs from an earlier one.
/// - embedding/drawing.hpp: lines, points and text that show what a world is like.
/// - embedding/frames.hpp: positions between steps, in the layout of a program, and what moved.
/// - executor.hpp: whose threads do it.
/// - error.hpp: what is refused.
/// - vec3.hpp: places, velocities, forces and other vectors.
/// - joints.hpp: bodies of a scene and the joints between them.
/// - key_frames.hpp: poses by time, for drives to seek.
/// - inertia.hpp: what sets of points and solids weigh.
/// - version.hpp: which plumb this is.
///
/// The library plumb::reference adds the thesis's other methods and its geometry, in plumb/reference:
/// - methods.hpp: makes springs, multipliers and Featherstone's method known.
/// - springs.hpp: which steps springs bear.
/// - bounding.hpp: volumes around points, and whether they overlap.
/// - impact.hpp: two bodies that collide.
#pragma once

#include "plumb/embedding/deltas.hpp"
#include "plumb/embedding/drawing.hpp"
#include "plumb/embedding/frames.hpp"
#include "plumb/error.hpp"
#include "plumb/executor.hpp"
#include "plumb/inertia.hpp"
#include "plumb/joints.hpp"
#include "plumb/key_frames.hpp"
#include "plumb/loads.hpp"
#include "plumb/measures.hpp"
#include "plumb/report.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/shapes/contact.hpp"
#include "plumb/shapes/ground.hpp"
#include "plumb/shapes/queries.hpp"
#include "plumb/shapes/surface.hpp"
#include "plumb/vec3.hpp"
#include "plumb/version.hpp"
#include "plumb/world.hpp"
