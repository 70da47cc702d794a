// bench_crowd measures what a frame of falling, touching and sleeping humanoids costs, and how exact it is.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/world.hpp"
#include "scenes/humanoid/humanoid.hpp"

namespace plumb::bench {
namespace {

constexpr double frame = 1.0 / 60;

enum Phase : std::int64_t { falling, touching };

/// Makes `count` figures. The first `awake` of them are in the air, 5 m up, or topple from where they stand.
/// The others sleep.
Scene figures(std::uint32_t count, std::uint32_t awake, Phase phase) {
  Scene scene = scenes::make_crowd({.humanoids = count, .hit = 0});
  const std::size_t each = scene.particles.size() / count;
  for (std::size_t i = 0; i < awake * each; ++i) {
    Particle& particle = scene.particles[i];
    particle.asleep = false;
    // No two figures are alike, as they are not in a game.
    const double turn = static_cast<double>(i / each);
    particle.velocity = {0.4 * particle.position.y * std::cos(turn), 0,
                         0.4 * particle.position.y * std::sin(turn)};
    if (phase == falling) particle.position.y += 5;
  }
  return scene;
}

/// Holds the steps of a phase, from its start to its end.
struct Film {
  Scene scene;
  Settings settings;
  int skipped, frames;
  std::unique_ptr<World> world{};

  void rewind() {
    world = std::make_unique<World>(scene, settings);
    for (int i = 0; i < skipped; ++i) world->step(frame);
  }
};

/// Reports how far rods and ground are from being kept, at the end.
void say_errors(benchmark::State& state, const Film& film) {
  std::vector<Vec3> positions(film.world->particle_count());
  film.world->copy_positions(positions);
  double deepest = 0;
  for (const Capsule& capsule : film.scene.capsules)
    deepest = std::max(deepest, capsule.radius - positions[capsule.a.particles[0]].y);
  state.counters["stretch"] = measure_stretch(film.scene, positions).max;
  state.counters["depth_m"] = deepest;
}

/// Times a phase. An iteration is a whole film, because figures that hit the ground cost more than those that
/// lie.
void show(benchmark::State& state, Film& film, double figures) {
  for (auto _ : state) {
    state.PauseTiming();
    film.rewind();
    state.ResumeTiming();
    for (int i = 0; i < film.frames; ++i) film.world->step(frame);
  }
  const auto time_of_each = [&](double count) {
    return benchmark::Counter(count,
                              benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  };
  state.counters["frame"] = time_of_each(film.frames);
  state.counters["figure"] = time_of_each(film.frames * figures);
  say_errors(state, film);
}

void awake(benchmark::State& state) {
  const auto count = static_cast<std::uint32_t>(state.range(0));
  const auto phase = static_cast<Phase>(state.range(1));
  Film film{.scene = figures(count, count, phase),
            .settings = {.method = Method::direct,
                         .sleep = false,
                         .threads = static_cast<unsigned>(state.range(2))},
            .skipped = phase == falling ? 5 : 40,
            .frames = phase == falling ? 45 : 80};
  show(state, film, count);
}

void asleep(benchmark::State& state) {
  Film film{.scene = figures(10000, 0, touching),
            .settings = {.method = Method::direct, .threads = 1},
            .skipped = 1,
            .frames = 100000};
  show(state, film, 10000);
}

/// Steps `count` figures of which 100 are awake.
void few_awake(benchmark::State& state) {
  Film film{.scene = figures(static_cast<std::uint32_t>(state.range(0)), 100, touching),
            .settings = {.method = Method::direct, .threads = 1},
            .skipped = 20,
            .frames = 60};
  show(state, film, 100);
}

BENCHMARK(awake)
    ->ArgNames({"figures", "touching", "threads"})
    ->ArgsProduct({{1, 1000}, {falling, touching}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(asleep)->Unit(benchmark::kMillisecond)->Iterations(5)->UseRealTime();
BENCHMARK(few_awake)->ArgName("figures")->Arg(100)->Arg(10000)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace plumb::bench

BENCHMARK_MAIN();
