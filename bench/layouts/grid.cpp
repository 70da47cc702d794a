#include "layouts/grid.hpp"

#include <algorithm>
#include <map>
#include <thread>

namespace plumb::bench {
namespace {

std::vector<Isa> supported_isas() {
  std::vector<Isa> isas;
  for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512})
    if (is_supported(isa)) isas.push_back(isa);
  return isas;
}

std::vector<unsigned> thread_counts() {
  if (std::thread::hardware_concurrency() < 2) return {1};
  return {1, 2};
}

bool is_wanted(const Case& c, LayoutChoice layout, Isa isa, unsigned threads, bool full) {
  const bool is_auto = layout == LayoutChoice::automatic, is_best = isa == best_isa();
  if (c.extra) return is_auto && is_best && threads == 1;
  if (full || (is_auto && is_best)) return true;
  return c.level == Level::l2 && threads == 1 && (is_auto || is_best);
}

std::vector<Contender> worlds(const Case& c, bool full) {
  std::vector<Contender> list;
  for (const LayoutChoice layout :
       {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa}) {
    for (const Isa isa : supported_isas()) {
      for (const unsigned threads : thread_counts()) {
        const bool listed = is_wanted(c, layout, isa, threads, full);
        const bool is_reference =
            c.level <= Level::l2 && layout == LayoutChoice::automatic && isa == Isa::scalar && threads == 1;
        if (listed || is_reference)
          list.push_back({.arrangement = std::string(to_string(layout)),
                          .layout = layout,
                          .isa = isa,
                          .threads = threads,
                          .is_reference = is_reference,
                          .listed = listed});
      }
    }
  }
  return list;
}

std::vector<Contender> baselines(const Case& c, bool listed) {
  std::vector<Contender> list{{.is_baseline = true, .arrangement = "natural", .listed = listed}};
  if (c.shape == Shape::graph || c.level <= Level::l2)
    list.push_back({.is_baseline = true, .arrangement = "colored", .listed = listed});
  return list;
}

/// Groups the contenders whose worlds may be alive together. Outside the caches these are the worlds of one
/// layout and instruction set.
std::map<std::pair<LayoutChoice, Isa>, std::vector<Contender>> heats(const Case& c,
                                                                     std::vector<Contender> all) {
  std::map<std::pair<LayoutChoice, Isa>, std::vector<Contender>> heats;
  for (Contender& contender : all) {
    const auto key = c.level == Level::dram ? std::pair{contender.layout, contender.isa}
                                            : std::pair{LayoutChoice{}, Isa{}};
    heats[key].push_back(std::move(contender));
  }
  return heats;
}

}  // namespace

std::vector<std::shared_ptr<Contest>> make_contests(bool full, std::uint32_t rounds) {
  std::vector<std::shared_ptr<Contest>> contests;
  for (const Case& c : make_cases(full)) {
    bool first = true;
    for (auto& [key, contenders] : heats(c, worlds(c, full))) {
      const auto bases = baselines(c, first);
      contenders.insert(contenders.begin(), bases.begin(), bases.end());
      contests.push_back(std::make_shared<Contest>(c, std::move(contenders), rounds));
      first = false;
    }
  }
  return contests;
}

}  // namespace plumb::bench
