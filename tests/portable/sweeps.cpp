// Times sweeps of relaxation by each instruction set that this processor runs, in ns per rod, so that
// processors without a benchmark library can be compared. The least of ten rounds counts.
//
//   portable_sweeps

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb {
namespace {

double time_sweep(const Scene& scene, Isa isa, Precision precision) {
  constexpr std::uint32_t sweeps = 200;
  World world(scene, {.method = Method::relax,
                      .precision = precision,
                      .stop = {.sweeps = sweeps},
                      .isa = isa,
                      .threads = 1});
  world.step(1.0 / 60);
  double least = 1e30;
  for (int round = 0; round < 10; ++round) {
    const auto start = std::chrono::steady_clock::now();
    world.step(1.0 / 60);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    least = std::min(least, took.count() / (sweeps * static_cast<double>(scene.rods.size())));
  }
  return least;
}

}  // namespace
}  // namespace plumb

int main() {
  using namespace plumb;
  const struct {
    const char* name;
    Scene scene;
  } cases[] = {{"chain:links=1000", scenes::make_chain(1000)},
               {"net:width=32,height=32", scenes::make_net(32, 32)}};
  for (const auto& each : cases)
    for (const Precision precision : {Precision::single, Precision::double_})
      for (const Isa isa : all_isas()) {
        if (!is_supported(isa)) continue;
        const std::string_view number = to_string(precision), set = to_string(isa);
        std::printf("%-24s %-7.*s %-8.*s %7.3f ns per rod\n", each.name, static_cast<int>(number.size()),
                    number.data(), static_cast<int>(set.size()), set.data(),
                    time_sweep(each.scene, isa, precision));
      }
}
