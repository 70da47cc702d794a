#pragma once

#include <string>

#include "plumb/scene.hpp"
#include "scenes/files/scene_json.hpp"

/// These functions handle the part of a scene file that is about bodies, joints, shapes and ground.
namespace plumb::scenes {

/// Adds what the lists of the file say. A list that is not there is empty. Throws InputError.
void read_limbs(const Object& top, Scene& scene);

/// Returns the lists that are not empty.
void append_limbs(std::string& out, const Scene& scene);

}  // namespace plumb::scenes
