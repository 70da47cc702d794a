// bench_crowd measures what a frame of falling, touching and sleeping humanoids costs, and how exact it is.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/world.hpp"
#include "scenes/humanoid/humanoid.hpp"

namespace plumb::bench {
namespace {

constexpr double frame = 1.0 / 60;

enum Phase : std::int64_t { falling, touching, heaped };

constexpr std::size_t layers = 4;         // of a heap
constexpr double apart = 0.8, above = 2;  // m, figures of a heap and their layers

/// Returns where a figure of a heap stands, not quite in rows.
Vec3 place_in_heap(std::size_t i, std::uint32_t count) {
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count) / layers)));
  const std::size_t layer = i / (side * side), row = i % (side * side);
  const auto turn = static_cast<double>(i);
  return {apart * static_cast<double>(row % side) + 0.1 * std::sin(7.3 * turn),
          0.02 + above * static_cast<double>(layer),
          apart * static_cast<double>(row / side) + 0.1 * std::cos(5.1 * turn)};
}

/// Makes `count` figures. The first `awake` of them are in the air, 5 m up, topple from where they stand, or
/// fall on each other. The others sleep.
Scene figures(std::uint32_t count, std::uint32_t awake, Phase phase) {
  Scene scene = scenes::make_crowd({.humanoids = count, .hit = 0});
  const std::size_t each = scene.particles.size() / count;
  for (std::size_t figure = 0; figure < awake; ++figure) {
    const std::span<Particle> limbs = std::span(scene.particles).subspan(figure * each, each);
    // No two figures are alike, as they are not in a game.
    const auto turn = static_cast<double>(figure);
    Vec3 by{};
    if (phase == falling) by.y = 5;
    if (phase == heaped) {
      for (const Particle& particle : limbs) by += (-1.0 / static_cast<double>(each)) * particle.position;
      by.y = 0;
      by += place_in_heap(figure, count);
    }
    for (Particle& particle : limbs) {
      particle.asleep = false;
      particle.velocity = {0.4 * particle.position.y * std::cos(turn), 0,
                           0.4 * particle.position.y * std::sin(turn)};
      particle.position += by;
    }
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
            .skipped = phase == falling    ? 5
                       : phase == touching ? 40
                                           : 0,
            .frames = phase == falling    ? 45
                      : phase == touching ? 80
                                          : 60};
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
BENCHMARK(awake)
    ->Name("heap")
    ->ArgNames({"figures", "touching", "threads"})
    ->ArgsProduct({{16, 64, 1000, 10000}, {heaped}, {1}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(asleep)->Unit(benchmark::kMillisecond)->Iterations(5)->UseRealTime();
BENCHMARK(few_awake)->ArgName("figures")->Arg(100)->Arg(10000)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace plumb::bench

BENCHMARK_MAIN();
