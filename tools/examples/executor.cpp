// plumb runs on an engine's own threads: it asks an Executor to run tasks, and the results do not depend on
// which.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <thread>
#include <vector>

namespace {

/// It starts a thread for every task, which is slow, but short. An engine hands its job system over instead.
class ThreadsExecutor final : public plumb::Executor {
 public:
  unsigned concurrency() const override { return 2; }
  void run(unsigned n, Task task, void* context) override {
    ++runs;
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < n; ++i) threads.emplace_back(task, context, i);
    for (std::thread& thread : threads) thread.join();
  }
  std::atomic<int> runs{0};
};

std::uint64_t hash_after(const plumb::Scene& scene, plumb::Settings settings) {
  plumb::World world(scene, settings);
  for (int frame = 0; frame < 5; ++frame) world.step(1.0 / 60);
  return world.state_hash();
}

}  // namespace

int main() {
  plumb::Scene scene;  // It has 2,000 separate chains, since one thread steps small scenes.
  for (std::uint32_t chain = 0; chain < 2000; ++chain) {
    const std::uint32_t first = 21 * chain;
    scene.particles.push_back({.position = {0, 0, 0.1 * chain}, .fixed = true});
    for (std::uint32_t i = 1; i <= 20; ++i) {
      scene.particles.push_back({.position = {0.1 * i, 0, 0.1 * chain}, .mass = 1});
      scene.rods.push_back({.a = first + i - 1, .b = first + i});
    }
  }

  ThreadsExecutor executor;
  const std::uint64_t alone = hash_after(scene, {.threads = 1});
  const std::uint64_t together = hash_after(scene, {.executor = &executor});
  std::printf("the executor %s, and the bits are %s\n", executor.runs > 0 ? "ran tasks" : "was not asked",
              alone == together ? "the same" : "different");
}
