// plumb scale: frames a second against links, the thesis's figure 4.8, with the stretch beside it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "gnuplot.hpp"
#include "page.hpp"
#include "plumb/error.hpp"
#include "plumb/world.hpp"
#include "progress.hpp"
#include "scenes/files.hpp"
#include "scenes/generators.hpp"
#include "scenes/lists.hpp"
#include "scenes/numbers.hpp"
#include "scenes/report.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::plain_number;
using scenes::short_number;

constexpr double frame_length = 1.0 / 60;
constexpr int frames_before = 60;

struct ScaleOptions {
  std::vector<std::uint32_t> links = {5,    10,   20,   50,    100,   200,   500,
                                      1000, 2000, 5000, 10000, 20000, 50000, 100000};
  std::uint32_t sweeps = 5;
  std::uint32_t repetitions = 5;
  double seconds = 0.03;
  std::vector<Precision> precisions = {Precision::single, Precision::double_};
  std::string out;
  bool quiet = false;
};

/// A chain stepped with one precision and one number of threads.
struct Row {
  std::uint32_t links = 0;
  std::uint32_t sweeps = 0;
  Precision precision = Precision::double_;
  bool all_threads = false;
  unsigned threads = 1;  ///< that stepped it
  double least_s = 0;    ///< of a frame, over the repetitions
  double median_s = 0;
  Stretch stretch{};             ///< after a second of simulated time
  std::uint64_t state_hash = 0;  ///< then

  double frames_per_s() const { return 1 / least_s; }
  double ns_per_rod() const { return 1e9 * least_s / links; }
};

double step_seconds(World& world, std::uint64_t frames) {
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t i = 0; i < frames; ++i) world.step(frame_length);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Steps one second, measures the stretch, then times repetitions of at least `seconds` each.
Row measure_row(std::uint32_t links, std::uint32_t sweeps, Precision precision, bool all_threads,
                const ScaleOptions& options) {
  const Scene scene = scenes::make_chain(links);
  Settings settings;
  settings.precision = precision;
  settings.threads = all_threads ? 0 : 1;
  settings.stop.sweeps = sweeps;
  World world(scene, settings);
  Row row{.links = links, .sweeps = sweeps, .precision = precision, .all_threads = all_threads};
  row.threads = world.info().parallel ? world.info().threads : 1;

  const double before = step_seconds(world, frames_before);
  std::vector<Vec3> positions(world.particle_count());
  world.copy_positions(positions);
  row.stretch = measure_stretch(scene, positions);
  row.state_hash = world.state_hash();

  const auto frames = static_cast<std::uint64_t>(std::max(1.0, options.seconds * frames_before / before));
  std::vector<double> times;
  for (std::uint32_t i = 0; i < options.repetitions; ++i) {
    times.push_back(step_seconds(world, frames) / static_cast<double>(frames));
  }
  std::sort(times.begin(), times.end());
  row.least_s = times.front();
  row.median_s = times[times.size() / 2];
  return row;
}

std::string kind_of(const Row& row) {
  return std::string(to_string(row.precision)) + (row.all_threads ? ", all threads" : ", one thread");
}

Table scale_table(const std::vector<Row>& rows) {
  Table table({"links", "arithmetic", "threads", "frames/s", "µs a frame", "median", "ns per rod",
               "stretch RMS", "stretch max"});
  for (const Row& r : rows) {
    table.add_row({std::to_string(r.links), std::string(to_string(r.precision)), std::to_string(r.threads),
                   plain_number(r.frames_per_s()), plain_number(1e6 * r.least_s),
                   plain_number(1e6 * r.median_s), plain_number(r.ns_per_rod()),
                   plain_number(100 * r.stretch.rms) + " %", plain_number(100 * r.stretch.max) + " %"});
  }
  return table;
}

/// The two numbers that the thesis gives for its five links, on an Athlon XP 1800+ (section 4.4.2).
Table thesis_table(const std::vector<Row>& rows) {
  Table table({"five links", "thesis, frames/s", "here, frames/s", "stretch RMS"});
  for (const Row& r : rows) {
    table.add_row({std::to_string(r.sweeps) + " sweeps, " + std::string(to_string(r.precision)),
                   r.sweeps == 5 ? "597" : "30", plain_number(r.frames_per_s()),
                   plain_number(100 * r.stretch.rms) + " %"});
  }
  return table;
}

template <class Y>
std::vector<Series> series_of(const std::vector<Row>& rows, Y y) {
  std::vector<Series> out;
  for (const Row& row : rows) {
    const std::string kind = kind_of(row);
    auto it = std::find_if(out.begin(), out.end(), [&](const Series& s) { return s.name == kind; });
    if (it == out.end()) {
      const std::string color = row.precision == Precision::single ? "#1f5fa8" : "#d1495b";
      out.push_back({.name = kind, .points = {}, .color = color, .dashed = row.all_threads});
      it = out.end() - 1;
    }
    if (y(row) > 0) it->points.emplace_back(row.links, y(row));
  }
  return out;
}

std::string csv_of(const std::vector<Row>& rows) {
  std::string csv =
      "links,sweeps,precision,threads,least_s,median_s,frames_per_s,ns_per_rod,stretch_rms,stretch_max,state_"
      "hash\n";
  for (const Row& r : rows) {
    std::string line = std::to_string(r.links) + "," + std::to_string(r.sweeps) + "," +
                       std::string(to_string(r.precision)) + "," + std::to_string(r.threads);
    for (const double v :
         {r.least_s, r.median_s, r.frames_per_s(), r.ns_per_rod(), r.stretch.rms, r.stretch.max}) {
      append_item(line, short_number(v, 9), ",");
    }
    csv += line + "," + scenes::hash_text(r.state_hash) + "\n";
  }
  return csv;
}

nlohmann::ordered_json rows_json(const std::vector<Row>& rows) {
  auto list = nlohmann::ordered_json::array();
  for (const Row& r : rows) {
    list.push_back(
        {{"links", r.links},
         {"sweeps", r.sweeps},
         {"precision", std::string(to_string(r.precision))},
         {"threads", r.threads},
         {"least_s", r.least_s},
         {"median_s", r.median_s},
         {"frames_per_s", r.frames_per_s()},
         {"ns_per_rod", r.ns_per_rod()},
         {"stretch", {{"rms", r.stretch.rms}, {"max", r.stretch.max}, {"max_rod", r.stretch.max_rod}}},
         {"state_hash", scenes::hash_text(r.state_hash)}});
  }
  return list;
}

std::string what_text(const ScaleOptions& options) {
  return "Chains of equal masses, horizontal at first, " + std::to_string(options.sweeps) +
         " sweeps a frame of 1/60 s: the least time of " + std::to_string(options.repetitions) +
         " repetitions and their median, and the stretch after a second of simulated time. A fixed number of "
         "sweeps fixes the time per rod, not how well rods keep their length: the largest stretch grows with "
         "the "
         "chain until, in the longest, most rods still fall freely after a second (which is also why their "
         "RMS "
         "falls again).";
}

void publish(const ScaleOptions& options, const std::vector<Row>& rows, const std::vector<Row>& five,
             const scenes::Machine& machine) {
  const std::filesystem::path folder = options.out;
  nlohmann::ordered_json json{{"machine", scenes::machine_json(machine)}};
  json["five_links"] = rows_json(five);
  json["chains"] = rows_json(rows);
  scenes::write_file(folder / "scale.json", scenes::format_json(json));
  scenes::write_file(folder / "scale.csv", csv_of(rows));

  Section section("scale", "Scaling: frames a second against links (figure 4.8)",
                  "plumb scale --sweeps " + std::to_string(options.sweeps) + " --out " + options.out,
                  machine);
  section.add_text(what_text(options));
  section.add_chart(folder, "scale_frames",
                    {"frames a second against links", "links", "frames/s",
                     series_of(rows, [](const Row& r) { return r.frames_per_s(); })});
  section.add_chart(folder, "scale_rods",
                    {"time per rod and frame", "links", "ns",
                     series_of(rows, [](const Row& r) { return r.ns_per_rod(); })});
  section.add_chart(folder, "scale_stretch",
                    {"stretch after 1 s", "links", "largest stretch, %",
                     series_of(rows, [](const Row& r) { return 100 * r.stretch.max; })});
  section.add_table(scale_table(rows));
  section.add_heading("The thesis's five links");
  section.add_text("Section 4.4.2 gives two frame rates, drawing included, on an Athlon XP 1800+ of 2001.");
  section.add_table(thesis_table(five));
  section.publish(folder);
}

/// All precisions, on one thread and on all where that makes a difference. Throws if the threads do.
std::vector<Row> measure_rows(const ScaleOptions& options, Progress& progress) {
  std::vector<Row> rows;
  std::uint64_t done = 0;
  for (const Precision precision : options.precisions) {
    for (const std::uint32_t links : options.links) {
      rows.push_back(measure_row(links, options.sweeps, precision, false, options));
      const Row alone = rows.back();
      const Row together = measure_row(links, options.sweeps, precision, true, options);
      if (together.state_hash != alone.state_hash) {
        throw CheckFailed(std::to_string(links) + " links end in different states on one thread and on all");
      }
      if (together.threads > 1) rows.push_back(together);
      progress.show(++done, options.precisions.size() * options.links.size());
    }
  }
  return rows;
}

int scale(const ScaleOptions& options) {
  if (options.repetitions == 0) throw InputError("--repetitions must be at least 1");
  if (!options.out.empty()) {
    require_gnuplot();
    make_folder(options.out);
  }
  std::vector<Row> rows;
  std::vector<Row> five;
  {
    Progress progress("measuring", options.quiet);
    rows = measure_rows(options, progress);
    for (const Precision precision : options.precisions) {
      for (const std::uint32_t sweeps : {5u, 1000u})
        five.push_back(measure_row(5, sweeps, precision, false, options));
    }
  }
  std::printf("%s\n%s\n%s", what_text(options).c_str(), scale_table(rows).to_text().c_str(),
              thesis_table(five).to_text().c_str());
  if (options.out.empty()) return fine;
  publish(options, rows, five, scenes::describe_machine());
  if (!options.quiet) std::printf("\nPage: %s/index.html\n", options.out.c_str());
  return fine;
}

std::vector<std::uint32_t> parse_links(const std::string& text) {
  std::vector<std::uint32_t> out;
  for (const std::string& item : CLI::detail::split(text, ',')) {
    const auto links = scenes::parse_number<std::uint32_t>(item);
    if (!links || *links == 0)
      throw CLI::ValidationError("--links", "'" + item + "' is not a number of links");
    out.push_back(*links);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

void add_scale_command(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("scale", "Measure frames a second against links (thesis figure 4.8)");
  auto options = std::make_shared<ScaleOptions>();
  ScaleOptions& o = *options;
  command
      ->add_option_function<std::string>(
          "--links", [&o](const std::string& text) { o.links = parse_links(text); },
          "Lengths of chain [5,10,20,50,...,100000]")
      ->type_name("N1,N2,...");
  add_count(*command, "--sweeps", o.sweeps, "Passes over all rods a frame [5]");
  add_count(*command, "--repetitions", o.repetitions, "Timed repetitions [5]");
  add_seconds(*command, "--seconds", o.seconds, "Least time of a repetition [0.03]");
  add_words(
      *command, "--precision", {"float", "double", "both"},
      [&o](const std::string& word) {
        if (word == "both") return;
        o.precisions = {word == "float" ? Precision::single : Precision::double_};
      },
      "Arithmetic [both]");
  command->add_option("--out", o.out, "Write a page with charts, JSON and CSV into this folder")
      ->type_name("DIR");
  command->add_flag("--quiet", o.quiet, "No progress bar");
  command->footer("Examples:\n  plumb scale --out out\n  plumb scale --links 5,50,500 --sweeps 1000");
  command->callback([options, &action] { action = [options] { return scale(*options); }; });
}

}  // namespace plumb::tools
