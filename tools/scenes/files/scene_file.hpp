#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "plumb/scene.hpp"

/// Scene files are JSON, version 1, in SI units.
///
///   {"plumb": 1, "gravity": [0, -9.81, 0], "drag": 0, "joint_drag": 0,
///    "particles": [{"position": [x, y, z], "velocity": [x, y, z], "mass": 1, "fixed": false,
///                   "asleep": false}, ...],
///    "rods": [{"a": 0, "b": 1, "length": 0.1, "mass": 0, "center": 0.5, "inertia": 0,
///              "linear_drag": 0, "orthogonal_drag": 0,
///              "stiffness": N/m, "damping": N s/m, "one_sided": false, "strength": N}, ...],
///    "bends": [{"a": 0, "b": 1, "c": 2, "stiffness": N m, "angle": 0, "damping": N m s}, ...],
///    "twists": [{"particles": [0, 1, 2], "stiffness": N m², "angle": 0}, ...],
///    "tackles": [{"particles": [0, 1, 2], "length": 1, "stiffness": N/m, "damping": N s/m,
///                 "one_sided": false, "friction": 0}, ...],
///    "reels": [{"particles": [0, 1, 2], "out": 1}, ...],
///    "bodies": [{"particles": [0, 1, 2, 3], "mass": 1, "center": [x, y, z],
///                "inertia": {"xx": 1, "yy": 1, "zz": 1, "xy": 0, "xz": 0, "yz": 0}}, ...],
///    "pins": [{"a": point, "b": point}, ...],
///    "alignments": [{"u": direction, "v": direction, "value": m²}, ...],
///    "angles": [{"u": direction, "v": direction, "lower": 0, "upper": 3.14, "friction": 0,
///                "target": 1.57, "stiffness": 0, "damping": 0}, ...],
///    "springs": [{"a": point, "b": point, "length": m, "stiffness": N/m, "damping": N s/m, "force": N,
///                 "one_sided": false}, ...],
///    "torsions": [{"axis": direction, "u": direction, "v": direction, "angle": rad, "stiffness": N m/rad,
///                  "damping": N m s/rad, "torque": N m}, ...],
///    "capsules": [{"a": point, "b": point, "radius": 0.1}, ...],
///    "planes": [{"normal": [0, 1, 0], "offset": 0, "platform": 0, "belt": [x, y, z]}, ...],
///    "boxes": [{"center": [x, y, z], "half_size": [x, y, z], "orientation": [w, x, y, z],
///               "platform": 0, "belt": [x, y, z]}, ...],
///    "platforms": [{"position": [x, y, z], "orientation": [w, x, y, z]}, ...]}
///
/// Capsules, planes and boxes also have "friction": 0.5, "restitution": 0, "rolling": 0, "spinning": 0,
/// "category": 1, "mask": 4294967295 and "group": 0, and capsules "own_island": false.
///
/// A point is the number of a particle, or {"particles": [0, 1], "weights": [0.5, 0.5]} with up to four of
/// each. A direction is {"from": point, "to": point}.
///
/// "plumb", "particles" with "position", and "rods" with "a" and "b" must be there. Items of the other lists
/// must have their particles (a bend "a", "b" and "c", a twist, a tackle and a reel "particles"), points and
/// directions, "radius", "normal", "center" and "half_size". A twist must have its "stiffness". A body must
/// have its "mass", "center" and "inertia", but not its products. A capsule without "b" is a sphere. All else
/// defaults as in Scene, and units are those of Scene: m, kg, s and rad. Any other key is an error.
namespace plumb::scenes {

/// Reads a scene. `name` begins every message. Throws InputError with the line of what is not JSON, the path
/// of what is unknown, missing or mistyped (such as particles[3].mass), or what validate() says.
Scene parse_scene(std::string_view json, std::string_view name);

/// Writes a scene, one particle, rod or other item to a line. It leaves out empty lists, fields that hold
/// their default and, of points, particles without weight. Reading it back gives the same bits.
std::string format_scene(const Scene& scene);

Scene read_scene(const std::filesystem::path& path);
void write_scene(const Scene& scene, const std::filesystem::path& path);

}  // namespace plumb::scenes
