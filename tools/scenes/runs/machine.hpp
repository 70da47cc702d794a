#pragma once

#include <string>

#include "plumb/world.hpp"

namespace plumb::scenes {

/// What a measured number depends on besides the scene and the settings.
struct Machine {
  std::string cpu;       ///< as the system names it
  std::string isa;       ///< the instruction set that was used
  unsigned threads = 1;  ///< threads that were used
  std::string compiler;
  std::string flags;   ///< without warnings
  std::string commit;  ///< of the source, "-dirty" if changed since; "unknown" without git
};

/// This machine and build, with the instruction set and threads that a world used.
Machine describe_machine(const WorldInfo& info);
/// The same with the best instruction set and all hardware threads.
Machine describe_machine();

/// Such as "0.2.0".
std::string version();

}  // namespace plumb::scenes
