#pragma once

#include <string>

#include "plumb/world.hpp"

namespace plumb::scenes {

/// A measured number depends on these besides the scene and the settings.
struct Machine {
  std::string cpu;       ///< Processor, as the system names it.
  std::string isa;       ///< Instruction set that was used.
  unsigned threads = 1;  ///< Threads that were used.
  std::string compiler;
  std::string flags;   ///< Flags of the compiler without warnings.
  std::string commit;  ///< Commit of the source, with "-dirty" if it changed since; "unknown" without git.
};

/// Describes this machine and build, with the instruction set and threads that a world used.
Machine describe_machine(const WorldInfo& info);
/// Describes the same with the best instruction set and all hardware threads.
Machine describe_machine();

/// Returns the version of plumb, such as "0.2.0".
std::string version();

}  // namespace plumb::scenes
