#include "stability/shots/shots_report.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <map>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "plot/table.hpp"
#include "scenes/basics/numbers.hpp"
#include "stability/shots/shots.hpp"

namespace plumb::tools {
namespace {

using scenes::short_number;
using scenes::ShotResult;
using scenes::ShotWay;
using scenes::Target;

/// All shots at a target, in one way, add up to this.
struct Tally {
  std::uint32_t shots = 0, hits = 0, through = 0, not_finite = 0, gained = 0, deep = 0;
  double worst_gain = 0, deepest = 0;
  std::uint32_t deepest_shot = 0;

  void add(std::uint32_t number, const ShotResult& result) {
    ++shots;
    hits += result.hit;
    through += result.through;
    not_finite += !result.finite;
    gained += result.gained;
    deep += result.deep;
    worst_gain = std::max(worst_gain, result.gain);
    keep_deepest(number, result.depth);
  }
  void add(const Tally& other) {
    shots += other.shots;
    hits += other.hits;
    through += other.through;
    not_finite += other.not_finite;
    gained += other.gained;
    deep += other.deep;
    worst_gain = std::max(worst_gain, other.worst_gain);
    keep_deepest(other.deepest_shot, other.deepest);
  }
  void keep_deepest(std::uint32_t number, double depth) {
    if (depth < deepest || (depth == deepest && number >= deepest_shot)) return;
    deepest = depth;
    deepest_shot = number;
  }
  std::vector<std::string> row(const std::string& target, const std::string& way) const {
    std::vector<std::string> out{target, way};
    for (const std::uint32_t each : {shots, hits, through, not_finite, gained})
      out.push_back(std::to_string(each));
    out.push_back(short_number(worst_gain, 2));
    out.push_back(std::to_string(deep));
    out.push_back(deep > 0 ? std::to_string(deepest_shot) : no_value);
    return out;
  }
};

/// What one thread fired: sums by way and target, and the bad ones.
struct Fired {
  std::map<std::pair<std::size_t, Target>, Tally> tallies;
  std::vector<std::pair<std::uint64_t, std::string>> bad;
};

/// Says what became of a shot, faults first.
std::string line_of(const ShotWay& way, const ShotResult& result, const std::string& fault) {
  return way.name + ": " + (fault.empty() ? "nothing wrong" : fault) +
         (result.through ? "; came through" : "") + "; energy up by " + short_number(result.gain, 3) +
         ", depth " + short_number(result.depth, 3);
}

void fire(std::uint32_t number, std::uint32_t seed, Fired& fired) {
  const scenes::Shot shot = scenes::make_shot({number, seed});
  const std::vector<ShotWay>& ways = scenes::shot_ways();
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const ShotResult result = scenes::fly(shot, ways[i]);
    fired.tallies[{i, shot.target}].add(number, result);
    if (const std::string fault = scenes::fault_of(result); !fault.empty())
      fired.bad.emplace_back(number, "shot " + std::to_string(number) + ", " +
                                         line_of(ways[i], result, fault) + "; " + shot.text());
  }
}

/// Threads take numbers in their turn. What is printed does not depend on who took which.
Fired fire_all(const ShotOrder& order) {
  const std::uint32_t cores = std::max(1u, std::thread::hardware_concurrency());
  std::vector<Fired> each(order.threads > 0 ? order.threads : cores);
  std::atomic<std::uint32_t> next{0};
  Progress progress("shooting", order.quiet);
  const auto work = [&](std::size_t thread) {
    for (std::uint32_t number = next++; number < order.count; number = next++) {
      fire(number, order.seed, each[thread]);
      if (thread == 0) progress.show(number, order.count);
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < each.size(); ++i) threads.emplace_back(work, i);
    work(0);
  }
  Fired all;
  for (const Fired& one : each) {
    for (const auto& [key, tally] : one.tallies) all.tallies[key].add(tally);
    all.bad.insert(all.bad.end(), one.bad.begin(), one.bad.end());
  }
  std::stable_sort(all.bad.begin(), all.bad.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return all;
}

void report_one(std::uint32_t number, std::uint32_t seed) {
  const scenes::Shot shot = scenes::make_shot({number, seed});
  std::printf("shot %u of seed %u: %s\n", number, seed, shot.text().c_str());
  std::uint32_t bad = 0;
  for (const ShotWay& way : scenes::shot_ways()) {
    const ShotResult result = scenes::fly(shot, way);
    const std::string fault = scenes::fault_of(result);
    bad += !fault.empty();
    std::printf("%s\n", line_of(way, result, fault).c_str());
  }
  std::printf("Its scene: plumb run shot:number=%u,seed=%u\n", number, seed);
  if (bad > 0) throw CheckFailed("shot " + std::to_string(number) + " is bad");
}

}  // namespace

void report_shots(const ShotOrder& order) {
  if (order.only) return report_one(*order.only, order.seed);
  const Fired fired = fire_all(order);
  for (const auto& [number, line] : fired.bad) std::printf("%s\n", line.c_str());
  Table table({"target", "way", "shots", "hits", "through", "not finite", "gained energy", "worst gain",
               "deep", "deepest"});
  for (const auto& [key, tally] : fired.tallies)
    table.add_row(tally.row(std::string(to_string(key.second)), scenes::shot_ways()[key.first].name));
  std::printf(
      "%s%s\nBalls, rods, ropes and boxes of 5 mm to 1 m are shot at up to 100 m/s, for 8 steps of 1/240 to "
      "1/15 s, without gravity.\nThrough: beyond a wall's middle or a held net, or on as though nothing had "
      "been there. Gained: above 1e-6 of the energy,\nand 1e-4 in float. Deep: at a step's end more than "
      "half of the thinner one's radius in the other, which is no fault; the deepest by its number.\n"
      "`plumb stability --shot N --seed %u` repeats one.\n",
      fired.bad.empty() ? "" : "\n", table.to_text().c_str(), order.seed);
  if (!fired.bad.empty())
    throw CheckFailed(std::to_string(fired.bad.size()) + " of " + std::to_string(order.count) +
                      " shots, each fired in " + std::to_string(scenes::shot_ways().size()) +
                      " ways, are bad");
}

}  // namespace plumb::tools
