#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "plumb/scene.hpp"

/// Scene files: JSON, version 1, SI units.
///
///   {"plumb": 1, "gravity": [0, -9.81, 0], "drag": 0,
///    "particles": [{"position": [x, y, z], "velocity": [x, y, z], "mass": 1, "fixed": false}, ...],
///    "rods": [{"a": 0, "b": 1, "length": 0.1, "mass": 0}, ...]}
///
/// "plumb", "particles" with "position", and "rods" with "a" and "b" must be there; the rest defaults as in
/// Scene. Units: m, m/s, kg, m/s² for gravity, 1/s for drag. Any other key is an error.
namespace plumb::scenes {

/// `name` begins every message. Throws InputError with the line of what is not JSON, the path of what is
/// unknown, missing or mistyped (such as particles[3].mass), or what validate() says.
Scene parse_scene(std::string_view json, std::string_view name);

/// One particle or rod to a line; fields that hold their default are left out. Reading it back gives the same
/// bits.
std::string format_scene(const Scene& scene);

Scene read_scene(const std::filesystem::path& path);
void write_scene(const Scene& scene, const std::filesystem::path& path);

}  // namespace plumb::scenes
