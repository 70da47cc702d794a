// bench_mechanisms: mechanisms of the literature, their error against published or exact motion beside time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "scenes/basics/clock.hpp"
#include "scenes/basics/numbers.hpp"
#include "support/flags.hpp"
#include "support/mechanisms.hpp"
#include "support/run_main.hpp"
#include "support/sheet.hpp"

namespace plumb::bench {
namespace {

using test::Andrews;
using test::FourBars;
using test::Governor;

constexpr const char* usage =
    "usage: bench_mechanisms [--repeat N]\n"
    "\n"
    "Andrews' squeezer mechanism against its published end, a flyball governor with stiff springs beside a\n"
    "rigid one, and a row of 40 four-bar linkages against its exact motion. One thread, double precision.\n"
    "\n"
    "  --repeat N   runs of every setting, in turns [5]\n";

std::string number(double value) {
  return scenes::short_number(value, 2);
}

/// Milliseconds of all steps; the world is left at the end.
double run_ms(World& world, double dt, int steps) {
  const auto start = scenes::Clock::now();
  for (int i = 0; i < steps; ++i) world.step(dt);
  return 1e3 * scenes::seconds_since(start);
}

void show_andrews(std::uint32_t rounds) {
  Sheet table({"Andrews", "order", "steps", "error of the crank, rad", "ms"});
  const std::pair<const char*, Scene> kinds[] = {{"of rods", Andrews::of_rods()},
                                                 {"of bodies", Andrews::of_bodies()}};
  for (const auto& [name, scene] : kinds)
    for (const std::uint32_t order : {2u, 4u, 6u})
      for (const int steps : {500, 1000, 2000, 4000}) {
        Settings settings = test::body_settings();
        settings.time_order = order;
        settings.gradient = Gradient::old;
        double ms = 1e30, error = 0;
        for (std::uint32_t k = 0; k < rounds; ++k) {
          World world(scene, settings);
          ms = std::min(ms, run_ms(world, Andrews::duration / steps, steps));
          error = std::abs(world.torsion_angle(0) - Andrews::end[0]);
        }
        table.add_row(
            {name, std::to_string(order), std::to_string(steps), number(error), scenes::plain_number(ms)});
      }
  std::fputs((table.to_markdown() + "\n").c_str(), stdout);
}

void show_governor(std::uint32_t rounds) {
  constexpr int frames = 600;
  const auto collar = [](bool rigid, std::uint32_t substeps, double& ms) {
    World world(Governor::scene(rigid), test::body_settings(substeps));
    ms = std::min(ms, run_ms(world, test::frame, frames));
    return world.position(Governor::collar).y;
  };
  Sheet table(
      {"governor, 10 s, substeps", "error of s, springs, m", "rigid, m", "ms, springs", "rigid", "ratio"});
  double unused = 1e30;
  const double best[2] = {collar(false, 256, unused), collar(true, 256, unused)};
  for (const std::uint32_t substeps : {1u, 2u, 4u, 8u, 16u}) {
    double ms[2] = {1e30, 1e30}, error[2] = {};
    for (std::uint32_t k = 0; k < rounds; ++k)
      for (const bool rigid : {false, true})
        error[rigid] = std::abs(collar(rigid, substeps, ms[rigid]) - best[rigid]);
    table.add_row({std::to_string(substeps), number(error[0]), number(error[1]), scenes::plain_number(ms[0]),
                   scenes::plain_number(ms[1]), number(ms[0] / ms[1])});
  }
  std::fputs((table.to_markdown() + "\n").c_str(), stdout);
}

void show_four_bars(std::uint32_t rounds) {
  constexpr std::uint32_t bars = 40;
  constexpr double duration = 20;
  const Scene scene = FourBars::scene(bars);
  const Vec3 truth = FourBars::first_end(bars, duration);
  std::vector<std::pair<std::string, Settings>> ways;
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6})
    ways.push_back({"auto, accuracy " + number(accuracy), {.accuracy = accuracy, .threads = 1}});
  for (const std::uint32_t substeps : {1u, 4u, 16u}) {
    const std::string many = std::to_string(substeps) + " substeps";
    ways.push_back({"direct, " + many, {.method = Method::direct, .substeps = substeps, .threads = 1}});
    ways.push_back(
        {"multipliers, " + many, {.method = Method::multipliers, .substeps = substeps, .threads = 1}});
  }
  Sheet table({"40 four-bars, 20 s", "error, m", "of the diagonal", "ms"});
  for (const auto& [name, settings] : ways) {
    double ms = 1e30, error = 0;
    for (std::uint32_t k = 0; k < rounds; ++k) {
      World world(scene, settings);
      ms = std::min(ms, run_ms(world, test::frame, static_cast<int>(std::lround(60 * duration))));
      error = norm(world.position(bars + 1) - truth);
    }
    table.add_row({name, number(error), number(error / bounding_diagonal(scene)), scenes::plain_number(ms)});
  }
  std::fputs(table.to_markdown().c_str(), stdout);
}

int run(int argc, char** argv) {
  Flags flags(argc, argv);
  if (flags.take("--help") || flags.take("-h")) {
    std::fputs(usage, stdout);
    return 0;
  }
  const std::uint32_t rounds = flags.take_count("--repeat", 5, 1);
  if (flags.rest().size() > 1)
    throw std::invalid_argument("unknown: " + flags.rest()[1] + "; see bench_mechanisms --help");
  show_andrews(rounds);
  show_governor(rounds);
  show_four_bars(rounds);
  return 0;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_mechanisms", plumb::bench::run, argc, argv);
}
