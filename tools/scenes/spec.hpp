#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plumb/scene.hpp"

namespace plumb::scenes {

/// Loads the scene that a user names. It is a file (it exists, or the name ends in .json) or a generator with
/// parameters, such as `chain` or `chain:links=20,end_mass=10`. Every generator takes the law of its rods,
/// too: stiffness (N/m), damping (N s/m), strength (N) and cables=1 (RodLaw). The scene has passed
/// validate(). Throws InputError that names what is unknown and lists what is known.
Scene load_scene(std::string_view spec);

struct GeneratorHelp {
  std::string name;
  std::string summary;     ///< One line, without a full stop.
  std::string parameters;  ///< Parameters with their defaults, in the form that load_scene reads.
};
std::vector<GeneratorHelp> list_generators();

}  // namespace plumb::scenes
