#include "scenes/runs/machine.hpp"

#include <algorithm>
#include <fstream>
#include <thread>

#include "build_info.hpp"
#include "commit.hpp"

namespace plumb::scenes {
namespace {

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t start = line.find_first_not_of(" \t", line.find(':') + 1);
    if (start != std::string::npos) return line.substr(start);
  }
  return "unknown";
}

Machine machine_with(Isa isa, unsigned threads) {
  return {.cpu = cpu_name(),
          .isa = std::string(to_string(isa)),
          .threads = threads,
          .compiler = PLUMB_COMPILER,
          .flags = PLUMB_FLAGS,
          .commit = PLUMB_COMMIT};
}

}  // namespace

Machine describe_machine(const WorldInfo& info) {
  return machine_with(info.isa, info.parallel ? info.threads : 1);
}

Machine describe_machine() {
  return machine_with(best_isa(), std::max(1u, std::thread::hardware_concurrency()));
}

std::string version() {
  return PLUMB_VERSION;
}

}  // namespace plumb::scenes
