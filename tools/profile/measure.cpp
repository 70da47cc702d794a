#include "profile/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "plumb/error.hpp"
#include "profile/cachegrind.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

using Field = std::optional<double> Counts::*;
constexpr Field fields[] = {&Counts::instructions, &Counts::cycles, &Counts::l1d_read_misses,
                            &Counts::l1d_write_misses, &Counts::ll_misses};

constexpr int repetitions = 5;
/// The shorter run in this process does at least so many units. It takes a millisecond or more, which
/// interrupts disturb little.
constexpr double least_timed_units = 1e6;

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return {};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Counts from_counters(const std::array<std::optional<double>, hardware_events>& values) {
  const auto at = [&](HardwareEvent event) { return values[static_cast<std::size_t>(event)]; };
  return {.instructions = at(HardwareEvent::instructions),
          .cycles = at(HardwareEvent::cycles),
          .l1d_read_misses = at(HardwareEvent::l1d_read_misses),
          .l1d_write_misses = {},
          .ll_misses = at(HardwareEvent::ll_misses)};
}

Counts from_cachegrind(const CachegrindTotals& totals) {
  const auto at = [&](std::string_view event) -> std::optional<double> {
    const auto it = totals.find(event);
    if (it == totals.end()) return {};
    return static_cast<double>(it->second);
  };
  Counts counts{.instructions = at("Ir"),
                .cycles = {},
                .l1d_read_misses = at("D1mr"),
                .l1d_write_misses = at("D1mw"),
                .ll_misses = {}};
  const auto reads = at("DLmr"), writes = at("DLmw");
  if (reads && writes) counts.ll_misses = *reads + *writes;
  return counts;
}

/// Times a world while this process steps it.
class Stopwatch {
 public:
  Stopwatch(World& world, PerfCounters* counters) : world_(world), counters_(counters) {}

  struct Reading {
    double ns = 0;
    std::uint64_t units = 0;
    Counts counts;
  };
  Reading run(const WorkPlan& plan) {
    // Only relaxation takes its length from sweeps. A world of method direct refuses the rule.
    if (plan.settings.method == Method::relax) world_.set_stop_rule(plan.settings.stop);
    Reading out;
    if (counters_) counters_->start();
    const auto start = std::chrono::steady_clock::now();
    const WorkDone done = do_work(world_, plan.frames, plan.dt);
    out.ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
    if (counters_) out.counts = from_counters(counters_->stop());
    out.units = done.units();
    return out;
  }

 private:
  World& world_;
  PerfCounters* counters_;
};

/// Measures time in this process, and the processor's counts if there are counters.
void measure_here(ProfileRow& row, World& world, PerfCounters* counters) {
  WorkPlan plan = row.profile_case.plan;
  Stopwatch watch(world, counters);
  const auto first = watch.run(plan);  // It also warms up, since first steps allocate.
  const double times =
      std::ceil(least_timed_units / static_cast<double>(std::max<std::uint64_t>(1, first.units)));
  plan = repeated(plan, static_cast<std::uint32_t>(std::max(1.0, times)));
  const WorkPlan twice = repeated(plan, 2);
  std::vector<double> ns;
  std::vector<Counts> counts;
  for (int i = 0; i < repetitions; ++i) {
    const auto shorter = watch.run(plan), longer = watch.run(twice);
    counts.push_back(counts_per_unit(shorter.counts, shorter.units, longer.counts, longer.units));
    ns.push_back((longer.ns - shorter.ns) / static_cast<double>(longer.units - shorter.units));
  }
  row.ns = measurable_cost(median(ns));
  row.counts = median_of(counts);
}

/// Simulates both runs at once, since what one counts does not depend on the other.
Counts simulate(const WorkPlan& plan, const std::filesystem::path& valgrind, const CachePair& caches,
                const std::filesystem::path& folder) {
  CachegrindRun shorter(valgrind, worker_arguments(plan), caches.first, caches.last, folder, "shorter");
  CachegrindRun longer(valgrind, worker_arguments(repeated(plan, 2)), caches.first, caches.last, folder,
                       "longer");
  const CachegrindRun::Result less = shorter.finish(), more = longer.finish();
  return counts_per_unit(from_cachegrind(less.totals), parse_work(less.output).units(),
                         from_cachegrind(more.totals), parse_work(more.output).units());
}

/// Returns the layout of the block that holds the most rods. A random graph also has a few stragglers, which
/// lie elsewhere.
const std::string& main_layout(const WorldInfo& info) {
  return std::max_element(info.blocks.begin(), info.blocks.end(),
                          [](const BlockInfo& l, const BlockInfo& r) { return l.rods < r.rods; })
      ->layout;
}

/// Keeps the scene of the last case and the layout that it gets by itself, since cases of the same scene
/// follow one another.
class SceneOfCase {
 public:
  const Scene& get(const WorkPlan& plan) {
    if (plan.scene != name_) {
      scene_ = scenes::load_scene(plan.scene);
      name_ = plan.scene;
      auto_layout_.clear();
    }
    return scene_;
  }
  /// Returns the layout that method relax gives the plan's scene by itself.
  const std::string& auto_layout(const WorkPlan& plan) {
    get(plan);
    if (auto_layout_.empty()) {
      Settings settings = plan.settings;
      settings.layout = LayoutChoice::automatic;
      const World world(scene_, settings);
      auto_layout_ = main_layout(world.info());
    }
    return auto_layout_;
  }

 private:
  std::string name_;
  Scene scene_;
  std::string auto_layout_;
};

/// Fills a row with what a world says about itself before it moves.
ProfileRow describe_row(const ProfileCase& one, const WorldInfo& info, SceneOfCase& scenes) {
  ProfileRow row;
  row.profile_case = one;
  row.rods = info.rods;
  const Settings& settings = one.plan.settings;
  if (settings.method != Method::relax) {
    row.model_bytes = newton_bytes(gradient_of(settings), settings.precision);
    return row;
  }
  row.layout = main_layout(info);
  row.is_auto = settings.layout == LayoutChoice::automatic || row.layout == scenes.auto_layout(one.plan);
  std::size_t state = 0;
  for (const BlockInfo& block : info.blocks) {
    state += block.bytes;
    row.model_bytes += block.bytes_per_projection * block.rods / info.rods;
  }
  row.state_bytes = state;
  return row;
}

}  // namespace

Counts counts_per_unit(const Counts& shorter, std::uint64_t shorter_units, const Counts& longer,
                       std::uint64_t longer_units) {
  if (longer_units <= shorter_units) {
    throw InputError("a run of " + std::to_string(longer_units) + " units is no longer than one of " +
                     std::to_string(shorter_units) + ": nothing can be learnt from their difference");
  }
  const auto units = static_cast<double>(longer_units - shorter_units);
  Counts out;
  for (const Field field : fields)
    if (shorter.*field && longer.*field) out.*field = (*(longer.*field) - *(shorter.*field)) / units;
  return out;
}

Counts median_of(const std::vector<Counts>& samples) {
  Counts out;
  for (const Field field : fields) {
    std::vector<double> values;
    for (const Counts& sample : samples)
      if (sample.*field) values.push_back(*(sample.*field));
    out.*field = median(std::move(values));
  }
  return out;
}

std::optional<double> measurable_cost(std::optional<double> ns) {
  if (!ns || !(*ns > 0)) return {};
  return ns;
}

std::string_view to_string(Way way) {
  constexpr std::string_view names[] = {"counters", "cachegrind", "none"};
  return names[static_cast<std::size_t>(way)];
}

Means find_means() {
  const PerfCounters counters;
  Means means;
  means.miss_counters =
      counters.has(HardwareEvent::l1d_read_misses) || counters.has(HardwareEvent::ll_misses);
  means.refusals = counters.refusals();
  means.valgrind = find_program("valgrind");
  return means;
}

Way choose_way(std::optional<Way> asked, const Means& means) {
  if (asked == Way::counters && !means.miss_counters)
    throw InputError("this machine's counters of cache misses cannot be read: " + means.refusals);
  if (asked == Way::cachegrind && !means.valgrind)
    throw InputError("there is no valgrind on the PATH; it is in the package valgrind");
  if (asked) return *asked;
  if (means.miss_counters) return Way::counters;
  return means.valgrind ? Way::cachegrind : Way::none;
}

std::string advice(const Means& means) {
  return "No cache misses: the processor's counters cannot be read (" + means.refusals +
         "), and there is no valgrind on the PATH to simulate caches with. Install the package valgrind "
         "(tools/setup does), or run on a machine whose counters can be read.";
}

std::vector<ProfileRow> measure_cases(const std::vector<ProfileCase>& cases, Way way, const Means& means,
                                      const CachePair& simulated,
                                      const std::function<void(std::size_t)>& show) {
  std::unique_ptr<PerfCounters> counters;
  if (way == Way::counters) counters = std::make_unique<PerfCounters>();
  const TemporaryFolder folder;
  SceneOfCase scenes;
  std::vector<ProfileRow> rows;
  for (const ProfileCase& one : cases) {
    {
      World world(scenes.get(one.plan), one.plan.settings);
      rows.push_back(describe_row(one, world.info(), scenes));
      measure_here(rows.back(), world, counters.get());
    }
    if (way == Way::cachegrind)
      rows.back().counts = simulate(one.plan, *means.valgrind, simulated, folder.path());
    show(rows.size());
  }
  return rows;
}

}  // namespace plumb::tools
