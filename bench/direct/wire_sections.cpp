#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "direct/sections.hpp"
#include "plumb/plumb.hpp"
#include "scenes/basics/numbers.hpp"
#include "support/sheet.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {
namespace {

using scenes::plain_number;
using scenes::short_number;

/// So many clamped wires stand side by side, of so many rods each, which bend and may be twisted.
struct Wires {
  std::uint32_t count, rods;
  bool twisted;

  std::string name() const { return std::to_string(count) + (twisted ? " twisted" : ""); }
};

/// Wires of 1 m and 0.2 kg, which sink under their weight. A finite strength, which they never reach, keeps
/// them out of the lanes of lines.
Scene clamped_wires(const Wires& wires, double strength) {
  const std::uint32_t rods = wires.rods;
  Scene scene;
  const double length = 1.0 / rods;
  for (std::uint32_t wire = 0; wire < wires.count; ++wire) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (std::uint32_t i = 0; i < rods + 2; ++i)
      scene.particles.push_back({.position = {length * (i - 1.0), 0, 0.2 * wire},
                                 .mass = i < 2 ? 0 : 0.2 * length,
                                 .fixed = i < 2});
    for (std::uint32_t i = 1; i <= rods; ++i) {
      scene.rods.push_back({.a = first + i, .b = first + i + 1, .law = {.strength = strength}});
      scene.bends.push_back({first + i - 1, first + i, first + i + 1, (i == 1 ? 0.04 : 0.02) / length});
    }
    if (!wires.twisted) continue;
    Twist& twist = scene.twists.emplace_back();
    for (std::uint32_t i = 0; i < rods + 2; ++i) twist.particles.push_back(first + i);
    twist.stiffness = 0.02;
    twist.angle = 3;
  }
  return scene;
}

struct WireCost {
  std::vector<double> ns;  ///< ns of everything in a step, per particle and Newton step, of every step
  std::uint64_t newton = 0, halvings = 0;
};

/// Steps wires as lines and as islands of any shape by turns.
std::vector<WireCost> measure_wires(const Wires& wires, std::uint32_t steps) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const Settings settings{.method = Method::direct, .threads = 1};
  std::vector<World> worlds;
  for (const double strength : {never, 1e30}) worlds.emplace_back(clamped_wires(wires, strength), settings);
  std::vector<WireCost> out(2);
  for (std::uint32_t i = 0; i < steps; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const auto start = std::chrono::steady_clock::now();
      const StepReport report = worlds[k].step(1.0 / 240);
      const double ns =
          std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
      out[k].ns.push_back(ns / (static_cast<double>(report.newton) * wires.rods));
      out[k].newton += report.newton;
      out[k].halvings += report.halvings;
    }
  return out;
}

}  // namespace

Section wires_section(const Plan& plan) {
  std::fprintf(stderr, "wires\n");
  Section out;
  Sheet sheet(
      {"wires", "rods", "solved as", "least", "median", "islands / this", "Newton steps", "halvings"});
  std::vector<Wires> all;
  for (const bool twisted : {false, true})
    for (const auto& [count, rods] : {std::pair{1u, 40u}, {1u, 400u}, {64u, 20u}, {1000u, 20u}})
      all.push_back({count, rods, twisted});
  for (const Wires& wires : all) {
    const std::vector<WireCost> costs = measure_wires(wires, 2 * plan.rounds);
    for (std::size_t k = 0; k < 2; ++k) {
      const char* const solver = k == 0 ? "lines" : "islands";
      sheet.add_row({wires.name(), std::to_string(wires.rods), solver, plain_number(least(costs[k].ns)),
                     plain_number(median(costs[k].ns)), plain_number(least(costs[1].ns) / least(costs[k].ns)),
                     std::to_string(costs[k].newton), std::to_string(costs[k].halvings)});
      out.csv += "wires," + wires.name() + " of " + std::to_string(wires.rods) + "," + solver +
                 ",newton_step," + short_number(least(costs[k].ns)) + ",ns per particle,mid double\n";
    }
  }
  out.text =
      "\n## Wires\n\nClamped wires with bends, straight or twisted by 3 rad, that sink under their weight, "
      "gradient mid, substeps of 1/240 "
      "s. "
      "ns per particle and Newton step, everything in a step included. `islands`: by the solver for islands "
      "of "
      "any shape.\n\n" +
      sheet.to_markdown();
  return out;
}

}  // namespace plumb::bench
