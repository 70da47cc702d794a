#include "threads/duel.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "contest/world_stepper.hpp"
#include "support/check.hpp"
#include "support/statistics.hpp"
#include "threads/sharing.hpp"

namespace plumb::bench {
namespace {

constexpr double sample_s = 2e-3;

using Worlds = std::array<std::unique_ptr<WorldStepper>, 2>;

/// Makes two worlds: the first runs on one thread, the second on two of `executor`, or of the built-in one.
Worlds make_worlds(const Case& c, const Scene& scene, std::uint32_t sweeps, Executor* executor) {
  Worlds worlds;
  for (unsigned i = 0; i < 2; ++i) {
    Settings settings;
    settings.precision = c.precision;
    settings.threads = i + 1;
    if (i == 1) settings.executor = executor;
    settings.stop.sweeps = sweeps;
    worlds[i] = std::make_unique<WorldStepper>(scene, settings);
  }
  return worlds;
}

/// Takes the samples of one duel, with `steps` per sample. With a pause before each, a sample is a step that
/// comes out of it.
void hold(Duel& duel, Worlds& worlds, std::uint32_t steps, std::uint32_t rounds, double pause_s) {
  for (std::uint32_t round = 0; round < rounds; ++round) {
    for (unsigned turn = 0; turn < 2; ++turn) {
      const unsigned i = (round + turn) % 2;
      if (duel.is_paused) {
        std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
      } else {
        worlds[i]->run((steps + 1) / 2, duel.sweeps);
      }
      (i == 0 ? duel.one_s : duel.two_s).push_back(worlds[i]->run(steps, duel.sweeps));
    }
  }
}

}  // namespace

double Duel::ratio() const {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < one_s.size(); ++i) ratios.push_back(two_s[i] / one_s[i]);
  return median(ratios);
}

double Duel::ratio_of_least() const {
  return least(two_s) / least(one_s);
}

std::vector<Duel> hold_duels(const Case& c, std::uint32_t sweeps, std::uint32_t rounds, double pause_s,
                             bool any_size) {
  const auto scene = scene_of(c);
  const std::unique_ptr<Executor> pool = make_default_executor(2);
  detail::EagerExecutor eager(*pool, {.projections = 0, .rods = 0});
  Worlds worlds = make_worlds(c, *scene, sweeps, any_size ? &eager : nullptr);
  for (auto& world : worlds) world->run(3, sweeps);
  const double step_s = worlds[0]->run(3, sweeps);
  worlds[1]->run(3, sweeps);
  const auto steps = static_cast<std::uint32_t>(std::ceil(sample_s / step_s));
  Duel duel{.c = c,
            .rods = static_cast<std::uint32_t>(scene->rods.size()),
            .sweeps = sweeps,
            .is_parallel = worlds[1]->world().info().parallel};
  std::vector<Duel> duels(2, duel);
  duels[1].is_paused = true;
  hold(duels[0], worlds, steps, rounds, 0);
  hold(duels[1], worlds, 1, 2 * rounds, pause_s);
  if (worlds[0]->world().state_hash() != worlds[1]->world().state_hash())
    throw CheckFailed(std::string(to_string(c.shape)) + " of " + std::to_string(duel.rods) +
                      " rods: one thread and two end in different bits");
  return duels;
}

}  // namespace plumb::bench
