// bench_threads measures from which size on two threads are faster than one. plumb has two thresholds for
// that. They should be where the ratio of times falls below 1 for good, so that two threads are never slower.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scenes/basics/numbers.hpp"
#include "support/flags.hpp"
#include "support/output.hpp"
#include "support/quiet.hpp"
#include "support/run_main.hpp"
#include "support/sheet.hpp"
#include "support/statistics.hpp"
#include "threads/duel.hpp"

namespace plumb::bench {
namespace {

using scenes::plain_number;
using scenes::short_number;

constexpr const char* usage =
    "bench_threads [--rounds N] [--most-rods N] [--pause-ms N] [--precision float|double] "
    "[--keep-thresholds]\n"
    "              [--csv FILE] [--summary FILE]\n"
    "  --rounds N         samples of each world, at least 2 [15]\n"
    "  --most-rods N      the largest scene, at least 64 [1048576]\n"
    "  --pause-ms N       pause before a step in the second of the two tables [3]\n"
    "  --keep-thresholds  do not share work that plumb itself would leave to one thread\n"
    "  --csv FILE         all numbers\n"
    "  --summary FILE     the tables that are printed at the end, as Markdown\n";

struct Options {
  std::uint32_t rounds = 15;
  std::uint32_t most_rods = 1u << 20;
  std::uint32_t pause_ms = 3;
  Precision precision = Precision::single;
  bool keep_thresholds = false;
  std::string csv;
  std::string summary;
};

Options take_options(Flags& flags) {
  Options options;
  options.rounds = flags.take_count("--rounds", options.rounds, 2);
  options.most_rods = flags.take_count("--most-rods", options.most_rods, 64);
  options.pause_ms = flags.take_count("--pause-ms", options.pause_ms, 0);
  const std::string precision = flags.take_value("--precision").value_or("float");
  if (precision != "float" && precision != "double")
    throw std::invalid_argument("--precision is float or double");
  if (precision == "double") options.precision = Precision::double_;
  options.keep_thresholds = flags.take("--keep-thresholds");
  options.csv = flags.take_value("--csv").value_or("");
  options.summary = flags.take_value("--summary").value_or("");
  if (flags.rest().size() > 1) throw std::invalid_argument("unknown: " + flags.rest()[1] + "\n" + usage);
  return options;
}

constexpr Shape shapes[] = {Shape::chain, Shape::ensemble, Shape::net, Shape::graph};
constexpr std::uint32_t sweep_counts[] = {5, 20};

/// Makes a scene of about that many rods.
Case case_of(Shape shape, Precision precision, std::uint32_t rods) {
  Case c{.shape = shape, .precision = precision};
  switch (shape) {
    case Shape::chain:
      c.size = rods;
      break;
    case Shape::ensemble:
      c.size = rods / 32;
      break;
    case Shape::net:
      c.size = static_cast<std::uint32_t>(std::lround(std::sqrt(rods / 2.0)));
      break;
    case Shape::graph:
      c.size = rods / 2;
      break;
  }
  return c;
}

std::vector<Duel> hold_all(const Options& options) {
  std::vector<Duel> duels;
  for (const Shape shape : shapes) {
    std::fprintf(stderr, "%s\n", to_string(shape).data());
    for (std::uint32_t rods = 64; rods <= options.most_rods; rods *= 2) {
      for (const std::uint32_t sweeps : sweep_counts) {
        const auto held = hold_duels(case_of(shape, options.precision, rods), sweeps, options.rounds,
                                     1e-3 * options.pause_ms, !options.keep_thresholds);
        duels.insert(duels.end(), held.begin(), held.end());
      }
    }
  }
  return duels;
}

/// Returns the duels of one column, by size.
std::vector<const Duel*> column(const std::vector<Duel>& duels, Shape shape, std::uint32_t sweeps,
                                bool is_paused) {
  std::vector<const Duel*> list;
  for (const Duel& duel : duels)
    if (duel.c.shape == shape && duel.sweeps == sweeps && duel.is_paused == is_paused) list.push_back(&duel);
  return list;
}

/// Returns the smallest size from which on two threads win at every size, or null if they lose at the
/// largest.
const Duel* first_win(const std::vector<const Duel*>& sizes) {
  const Duel* first = nullptr;
  for (auto duel = sizes.rbegin(); duel != sizes.rend() && (*duel)->is_parallel && (*duel)->ratio() < 1;
       ++duel)
    first = *duel;
  return first;
}

Sheet ratio_sheet(const std::vector<Duel>& duels, bool is_paused) {
  std::vector<std::string> header{"rods"};
  std::vector<std::vector<const Duel*>> columns;
  for (const Shape shape : shapes) {
    for (const std::uint32_t sweeps : sweep_counts) {
      header.push_back(std::string(to_string(shape)) + ", " + std::to_string(sweeps) + " sweeps");
      columns.push_back(column(duels, shape, sweeps, is_paused));
    }
  }
  Sheet sheet(header);
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    std::vector<std::string> cells{std::to_string(columns.front()[row]->rods)};
    for (const auto& duel : columns)
      cells.push_back(duel[row]->is_parallel ? plain_number(duel[row]->ratio()) : "");
    sheet.add_row(cells);
  }
  return sheet;
}

Sheet wins_sheet(const std::vector<Duel>& duels) {
  Sheet sheet({"scene", "sweeps", "steps come", "two threads win from rods", "projections", "worst ratio"});
  for (const Shape shape : shapes) {
    for (const std::uint32_t sweeps : sweep_counts) {
      for (const bool is_paused : {false, true}) {
        const auto sizes = column(duels, shape, sweeps, is_paused);
        const Duel* first = first_win(sizes);
        double worst = 0;
        for (const Duel* duel : sizes)
          if (duel->is_parallel) worst = std::max(worst, duel->ratio());
        sheet.add_row({std::string(to_string(shape)), std::to_string(sweeps),
                       is_paused ? "after a pause" : "at once", first ? std::to_string(first->rods) : "never",
                       first ? short_number(first->projections()) : "",
                       worst == 0 ? "" : plain_number(worst)});
      }
    }
  }
  return sheet;
}

Sheet full_sheet(const std::vector<Duel>& duels) {
  Sheet sheet({"shape", "precision", "rods", "sweeps", "projections", "paused", "parallel", "samples",
               "one_us_min", "one_us_median", "two_us_min", "two_us_median", "ratio_min", "ratio_median"});
  for (const Duel& duel : duels) {
    sheet.add_row({std::string(to_string(duel.c.shape)), std::string(number_name(duel.c.precision)),
                   std::to_string(duel.rods), std::to_string(duel.sweeps),
                   short_number(duel.projections(), 12), std::to_string(duel.is_paused),
                   std::to_string(duel.is_parallel), std::to_string(duel.one_s.size()),
                   short_number(1e6 * least(duel.one_s)), short_number(1e6 * median(duel.one_s)),
                   short_number(1e6 * least(duel.two_s)), short_number(1e6 * median(duel.two_s)),
                   short_number(duel.ratio_of_least()), short_number(duel.ratio())});
  }
  return sheet;
}

std::string summary_text(const std::vector<Duel>& duels, std::uint32_t pause_ms, bool lifted) {
  std::string out = "Time of two threads over that of one, below 1 where two win; median of the rounds. ";
  out += lifted ? "plumb's thresholds are lifted: two threads share work of any size.\n"
                : "Empty below plumb's thresholds, where the second thread is left alone.\n";
  out += "\n### Step after step\n\n" + ratio_sheet(duels, false).to_markdown();
  out += "\n### After a pause of " + std::to_string(pause_ms) + " ms\n\n" +
         ratio_sheet(duels, true).to_markdown();
  out += "\n### Where two threads win\n\n" + wins_sheet(duels).to_markdown();
  return out;
}

int run(int argc, char** argv) {
  Flags flags(argc, argv);
  if (flags.take("--help")) {
    std::printf("%s", usage);
    return 0;
  }
  const Options options = take_options(flags);
  if (std::thread::hardware_concurrency() < 2)
    throw std::runtime_error("this machine runs one thread at a time");
  std::optional<scenes::OutputFile> csv = open_output(options.csv), summary = open_output(options.summary);
  const double quiet = work_of_two_threads();
  const std::vector<Duel> duels = hold_all(options);
  const std::string text =
      quiet_text(quiet) + "\n\n" + summary_text(duels, options.pause_ms, !options.keep_thresholds);
  std::printf("%s", text.c_str());
  finish_output(summary, text);
  finish_output(csv, full_sheet(duels).to_csv());
  return 0;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_threads", plumb::bench::run, argc, argv);
}
