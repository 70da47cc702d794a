// bench_snapshots measures what it costs to save a world, to go back to it, and to keep by how much it
// differs from an earlier one, beside a plain copy of the same bytes. Every way back is checked to the bit.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <vector>

#include "plumb/embedding/deltas.hpp"
#include "plumb/world.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid.hpp"

namespace plumb::bench {
namespace {

using Bytes = std::vector<std::byte>;
constexpr double frame = 1.0 / 60;
constexpr int repeats = 100;

/// Returns the least time (us) of many calls of f().
template <class F>
double time(F&& f) {
  double least = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    f();
    least = std::min(
        least, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

void measure(const char* name, const Scene& scene, Settings settings) {
  settings.threads = 1;
  World world(scene, settings);
  for (int i = 0; i < 5; ++i) world.step(frame);
  Bytes base(world.snapshot_size());
  world.save(base);
  world.step(frame);
  Bytes now(world.snapshot_size());
  const double save = time([&] { world.save(now); });
  const double restore = time([&] { world.restore(now); });
  Bytes copy(now.size()), delta(most_delta_size(now.size())), then(now.size());
  const double plain = time([&] { std::memcpy(copy.data(), now.data(), now.size()); });
  std::size_t size = 0;
  const double differ = time([&] { size = save_delta(base, now, delta); });
  const double back = time([&] { restore_delta(base, delta, then); });
  world.save(copy);
  std::printf("| %s | %zu | %.0f | %.0f | %.0f | %zu | %.0f | %.0f |%s\n", name, now.size(), save, restore,
              plain, size, differ, back, copy == now && then == now ? "" : " WRONG");
}

}  // namespace
}  // namespace plumb::bench

int main() {
  using namespace plumb;
  std::puts("| world | bytes | save, us | restore, us | memcpy, us | delta, bytes | made, us | undone, us |");
  std::puts("|---|---|---|---|---|---|---|---|");
  const Scene ropes = scenes::make_ensemble({.chains = 1000, .links = 32});
  bench::measure("1,000 ropes, relaxed, float", ropes,
                 {.method = Method::relax, .precision = Precision::single});
  bench::measure("the same, direct", ropes, {.method = Method::direct});
  Scene asleep = ropes;
  for (std::size_t i = 33 * std::size_t{10}; i < asleep.particles.size(); ++i)
    asleep.particles[i].asleep = true;
  bench::measure("the same, 990 asleep", asleep, {.method = Method::direct});
  bench::measure("graph, relaxed, float", scenes::make_graph({.particles = 100000, .degree = 5}),
                 {.method = Method::relax, .precision = Precision::single});
  bench::measure("net, relaxed, double", scenes::make_net(316, 316), {.method = Method::relax});
  bench::measure("100 figures", scenes::make_crowd({.humanoids = 100, .hit = 100}), {});
}
