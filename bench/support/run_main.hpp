#pragma once

#include <cstdio>
#include <exception>
#include <stdexcept>

namespace plumb::bench {

/// Returns what a benchmark's main() returns: run's own status, 2 for bad usage and 1 for what else it
/// throws. It says the reason on stderr after the program's name.
inline int run_main(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace plumb::bench
