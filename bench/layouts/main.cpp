// bench_layouts measures what a rod projection costs, by shape, layout, precision, instruction set, threads
// and size. It shows that beside what a plain loop takes and what the machine allows.
//
// Contests take their samples themselves, side by side (contest.hpp). Google Benchmark names, filters and
// counts them and writes JSON. A repetition of a benchmark is one sample.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <regex>

#include "layouts/grid.hpp"
#include "layouts/line_reporter.hpp"
#include "layouts/summary.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/runs/report.hpp"
#include "support/flags.hpp"
#include "support/output.hpp"
#include "support/quiet.hpp"
#include "support/run_main.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {
namespace {

constexpr const char* usage =
    "bench_layouts [--full] [--rounds N] [--csv FILE] [--summary FILE] [--benchmark_...]\n"
    "  --full           every layout, instruction set and size: takes hours\n"
    "  --rounds N       samples of each benchmark, at least 2 [11]\n"
    "  --csv FILE       all numbers, a row per benchmark\n"
    "  --summary FILE   the tables that are printed at the end, as Markdown\n"
    "  --benchmark_filter=REGEX, --benchmark_out=FILE, --benchmark_list_tests, ...: Google Benchmark's own\n";

struct Options {
  bool full = false;
  std::uint32_t rounds = 11;
  std::string csv;
  std::string summary;
};

Options take_options(Flags& flags) {
  Options options;
  options.full = flags.take("--full");
  options.rounds = flags.take_count("--rounds", options.rounds, 2);
  options.csv = flags.take_value("--csv").value_or("");
  options.summary = flags.take_value("--summary").value_or("");
  return options;
}

/// Hands Google Benchmark what is left of the command line, after settings of our own that it may override. A
/// repetition is one iteration.
void initialize_benchmark(Flags& flags, std::uint32_t rounds) {
  std::vector<std::string> words = flags.rest();
  const std::string own[] = {"--benchmark_repetitions=" + std::to_string(rounds),
                             "--benchmark_min_time=1e-9"};
  words.insert(words.begin() + 1, std::begin(own), std::end(own));
  static std::vector<std::string> kept;  // Google Benchmark keeps the program's name
  kept = std::move(words);
  std::vector<char*> argv;
  for (std::string& word : kept) argv.push_back(word.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  if (argc > 1) throw std::invalid_argument(std::string("unknown: ") + argv[1] + "\n" + usage);
  const scenes::Machine machine = scenes::describe_machine();
  benchmark::AddCustomContext("cpu", machine.cpu);
  benchmark::AddCustomContext("isa", machine.isa);
  benchmark::AddCustomContext("compiler", machine.compiler);
  benchmark::AddCustomContext("flags", machine.flags);
  benchmark::AddCustomContext("commit", machine.commit);
}

/// Leaves out what nobody asked for, unless something is compared with it.
void keep_wanted(std::vector<std::shared_ptr<Contest>>& contests, const std::string& filter) {
  if (filter.empty() || filter == "all" || filter.front() == '-') return;
  const std::regex wanted(filter, std::regex::extended);
  for (auto& contest : contests)
    contest->keep([&](const std::string& name) { return std::regex_search(name, wanted); });
  std::erase_if(contests, [](const auto& contest) { return !contest->has_listed(); });
}

void report_contender(benchmark::State& state, Contest& contest, std::size_t i, Limits& limits,
                      std::uint32_t round) {
  limits.measure();
  contest.measure();
  const Contender& contender = contest.contenders()[i];
  const Outcome& outcome = contender.outcome;
  for (auto _ : state) state.SetIterationTime(outcome.step_s[round]);
  state.counters["ns_per_projection"] = outcome.ns_per_projection(round);
  state.counters["rods"] = outcome.rods;
  state.counters["max_stretch"] = outcome.max_stretch;
  state.counters["run_up_stretch"] = outcome.run_up_stretch;
  if (contender.is_baseline) return;
  state.counters["sweep_ns_per_projection"] = outcome.median_sweep_ns();
  state.counters["speedup"] = contest.speedup(i, "natural", round);
  if (contest.has_baseline("colored"))
    state.counters["speedup_colored"] = contest.speedup(i, "colored", round);
  const Reached share = reached(outcome, contender, contest.scene_case(), limits);
  state.counters["fraction_of_compute_limit"] = share.compute;
  state.counters["fraction_of_bandwidth_limit"] = share.bandwidth;
  state.counters["threads_working"] = outcome.threads;
  state.counters["state_bytes"] = static_cast<double>(outcome.bytes);
  state.SetLabel("state " + scenes::hash_text(outcome.state_hash));
}

void report_limit(benchmark::State& state, Limits& limits, std::size_t i, std::uint32_t round) {
  limits.measure();
  const Limits::Row& row = limits.rows()[i];
  const double sample = row.samples[round];
  for (auto _ : state) state.SetIterationTime(row.is_bandwidth ? 1 / sample : 1e-9 * sample);
  state.counters[row.is_bandwidth ? "bytes_per_second" : "ns_per_projection"] = sample;
}

/// Registers a benchmark. `report(state, round)` is called once per repetition.
template <class Report>
void add_benchmark(const std::string& name, std::uint32_t rounds, Report report) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [report, rounds, round = 0u](benchmark::State& state) mutable {
                                 report(state, round);
                                 round = (round + 1) % rounds;
                               })
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond)
      ->ReportAggregatesOnly()
      ->ComputeStatistics("min", least);
}

void add_benchmarks(const std::vector<std::shared_ptr<Contest>>& contests, Limits& limits,
                    std::uint32_t rounds) {
  for (std::size_t i = 0; i < limits.rows().size(); ++i)
    add_benchmark(limits.rows()[i].name, rounds, [&limits, i](benchmark::State& state, std::uint32_t round) {
      report_limit(state, limits, i, round);
    });
  for (const auto& contest : contests)
    for (std::size_t i = 0; i < contest->contenders().size(); ++i)
      if (const Contender& contender = contest->contenders()[i]; contender.listed)
        add_benchmark(contender.name(contest->scene_case()), rounds,
                      [contest, i, &limits](benchmark::State& state, std::uint32_t round) {
                        report_contender(state, *contest, i, limits, round);
                      });
}

int run(int argc, char** argv) {
  Flags flags(argc, argv);
  if (flags.take("--help")) {
    std::printf("%s", usage);
    return 0;
  }
  const Options options = take_options(flags);
  initialize_benchmark(flags, options.rounds);
  Limits limits(options.rounds);
  std::vector<std::shared_ptr<Contest>> contests = make_contests(options.full, options.rounds);
  keep_wanted(contests, benchmark::GetBenchmarkFilter());
  add_benchmarks(contests, limits, options.rounds);

  std::optional<scenes::OutputFile> csv = open_output(options.csv), summary = open_output(options.summary);

  const double quiet = work_of_two_threads();
  LineReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  const std::string tables = summary_text(contests, limits);
  if (tables.empty()) return 0;  // benchmarks were only listed
  const std::string text = quiet_text(quiet) + "\n\n" + tables;
  std::printf("\n%s", text.c_str());
  finish_output(summary, text);
  finish_output(csv, full_sheet(contests, limits).to_csv());
  return 0;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_layouts", plumb::bench::run, argc, argv);
}
