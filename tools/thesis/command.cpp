// plumb thesis repeats the experiment of the thesis's section 4.4 with numbers. It measures error and time
// against sweeps on chains with a heavy last link. Corrections are weighted by mass, or equal.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "plot/gnuplot.hpp"
#include "plot/page.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/runs/report.hpp"
#include "scenes/spec.hpp"
#include "thesis/experiment.hpp"
#include "thesis/pictures.hpp"
#include "thesis/table.hpp"

namespace plumb::tools {
namespace {

using scenes::plain_number;
using scenes::short_number;

constexpr std::uint32_t substeps = 8;
const std::vector<std::uint32_t> sweep_counts = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
const std::vector<std::uint32_t> substep_counts = {1, 2, 4, 8, 16, 32, 64};
const std::vector<double> end_masses = {1, 2, 10};

struct ThesisOptions {
  std::string out;
  bool quiet = false;
};

/// Holds all that was measured on one chain.
struct ChainResults {
  std::string spec;
  std::string name;
  Truth truth;
  std::vector<Measured> by_sweeps;  ///< Variants, within them the numbers of sweeps.
  /// Variants, within them the numbers of substeps, swept to a strain of 1e-7.
  std::vector<Measured> by_substeps;
};

struct MassResults {
  double end_mass = 0;
  /// Distance of the true motion from that with end mass 1, relative to the diagonal.
  double distance_true = 0;
  double distance_mass = 0;
  double distance_equal = 0;
  double rest_mass = 0;  ///< Time to rest with weights by mass, in s.
  double rest_equal = 0;
};

/// Holds all that is shown.
struct ThesisResults {
  std::vector<ChainResults> chains;
  std::vector<MassResults> masses;
  ThesisNumbers numbers;
};

Truth chain_truth() {
  return {.frames = scenes::parse_trajectory(chain_truth_csv(), "truth of the chain"), .uncertainty = 1e-9};
}

Settings settings_of(const Variant& variant, std::uint32_t substep_count, StopRule stop) {
  Settings settings{.method = Method::relax};
  settings.weights = variant.weights;
  settings.gradient = variant.gradient;
  settings.substeps = substep_count;
  settings.stop = stop;
  settings.threads = 1;
  return settings;
}

std::string percent_text(double share) {
  return plain_number(100 * share);
}

std::string error_text(const Measured& m) {
  return m.stable ? percent_text(m.error) : "unstable";
}

ChainResults measure_chain(std::string spec, std::string name, Truth truth,
                           const std::function<void()>& tick) {
  const Scene scene = scenes::load_scene(spec);
  ChainResults out{.spec = std::move(spec),
                   .name = std::move(name),
                   .truth = std::move(truth),
                   .by_sweeps = {},
                   .by_substeps = {}};
  for (const std::uint32_t sweeps : sweep_counts) {
    for (const Variant& variant : all_variants()) {
      out.by_sweeps.push_back(
          measure(scene, out.truth,
                  settings_of(variant, substeps, {.sweeps = sweeps, .tolerance = {}, .budget_us = {}})));
      tick();
    }
  }
  for (const std::uint32_t count : substep_counts) {
    for (const Variant& variant : all_variants()) {
      const StopRule stop{.sweeps = 5000, .tolerance = 1e-7, .budget_us = {}};
      out.by_substeps.push_back(measure(scene, out.truth, settings_of(variant, count, stop)));
      tick();
    }
  }
  return out;
}

MassResults measure_mass(double end_mass) {
  const Scene light = scenes::make_chain(5);
  Scene heavy = scenes::make_chain(5, 0.1, end_mass);
  const StopRule stop{.sweeps = 100, .tolerance = {}, .budget_us = {}};
  const Settings mass = settings_of({Weights::mass, Gradient::new_}, substeps, stop);
  const Settings equal = settings_of({Weights::equal, Gradient::new_}, substeps, stop);
  const Settings fine_steps =
      settings_of({Weights::mass, Gradient::mid}, 128, {.sweeps = 10000, .tolerance = 1e-9, .budget_us = {}});
  MassResults out{.end_mass = end_mass,
                  .distance_true = distance_of_motions(light, heavy, fine_steps),
                  .distance_mass = distance_of_motions(light, heavy, mass),
                  .distance_equal = distance_of_motions(light, heavy, equal)};
  heavy.drag = 0.5;
  out.rest_mass = time_to_rest(heavy, mass, 120);
  out.rest_equal = time_to_rest(heavy, equal, 120);
  return out;
}

std::vector<std::string> header_with(const char* first, const char* last) {
  std::vector<std::string> header{first};
  for (const Variant& variant : all_variants()) header.push_back(name_of(variant));
  if (last) header.emplace_back(last);
  return header;
}

/// Returns errors in per cent of the chain's length, with a row for each count.
Table error_table(const char* first, const std::vector<std::uint32_t>& counts,
                  const std::vector<Measured>& results) {
  Table table(header_with(first, "µs a frame"));
  const std::size_t variants = all_variants().size();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    std::vector<std::string> row{std::to_string(counts[i])};
    for (std::size_t v = 0; v < variants; ++v) row.push_back(error_text(results[i * variants + v]));
    // The time is that of the first variant: weights by mass, gradient new.
    row.push_back(plain_number(results[i * variants].us_per_frame));
    table.add_row(std::move(row));
  }
  return table;
}

Table mass_table(const std::vector<MassResults>& results) {
  Table table({"end mass, kg", "true change", "change, mass", "change, equal", "rest, mass", "rest, equal"});
  const auto rest = [](double t) { return t < 0 ? std::string("over 120 s") : plain_number(t) + " s"; };
  for (const MassResults& m : results) {
    table.add_row({short_number(m.end_mass), percent_text(m.distance_true) + " %",
                   percent_text(m.distance_mass) + " %", percent_text(m.distance_equal) + " %",
                   rest(m.rest_mass), rest(m.rest_equal)});
  }
  return table;
}

/// Returns a line for each variant, through x(result) and its error.
template <class X>
std::vector<Series> series_of(const std::vector<Measured>& results, X x) {
  static const std::vector<std::string> colors = {"#1f5fa8", "#2a9d5c", "#7b4fb5",
                                                  "#d1495b", "#e08e2b", "#8a5a44"};
  const std::vector<Variant> variants = all_variants();
  std::vector<Series> out;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    Series series{.name = name_of(variants[v]),
                  .points = {},
                  .color = colors[v],
                  .dashed = variants[v].weights == Weights::equal};
    for (std::size_t i = v; i < results.size(); i += variants.size()) {
      if (results[i].stable) series.points.emplace_back(x(results[i]), 100 * results[i].error);
    }
    out.push_back(std::move(series));
  }
  return out;
}

/// Returns the least and the largest error of one kind of weights, where steps are smallest and rods are
/// swept to their length.
std::pair<double, double> errors_at_last(const ChainResults& chain, Weights weights) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Measured& m : chain.by_substeps) {
    if (m.settings.substeps != substep_counts.back() || m.settings.weights != weights || !m.stable) continue;
    least = std::min(least, m.error);
    most = std::max(most, m.error);
  }
  return {least, most};
}

/// Says in words what the numbers show.
std::string conclusion_of(const ChainResults& chain) {
  const auto mass = errors_at_last(chain, Weights::mass);
  const auto equal = errors_at_last(chain, Weights::equal);
  return chain.name + ", " + std::to_string(substep_counts.back()) +
         " substeps, swept until rods keep their length: weighted by mass the error is " +
         percent_text(mass.first) + " to " + percent_text(mass.second) +
         " %, by gradient, and falls with the step; with equal weights it stays at " +
         percent_text(equal.first) + " to " + percent_text(equal.second) +
         " %, since that is another motion.";
}

std::string truth_text(const ChainResults& chain) {
  return "The truth is known to " + short_number(chain.truth.uncertainty, 2) + " of the chain's length.";
}

const char* const mass_text =
    "Five links, the last particle 1, 2 or 10 kg. Change: how far the motion at 1 s is from that with 1 kg, "
    "of the "
    "chain's length, in truth and with each kind of weights (8 substeps of 100 sweeps, gradient new). Rest: "
    "time until "
    "nothing moves faster than 1 cm/s, with a drag of 0.5 per second.";

const char* const stiff_text =
    "The thesis's stiff equation, y' = -k y (eq. 3.13). Forward Euler multiplies y by 1 - hk in a step and "
    "is "
    "stable for hk < 2 (eq. 3.15); backward Euler divides it by 1 + hk and is stable in every step.";

void publish(const ThesisOptions& options, const ThesisResults& results, const scenes::Machine& machine) {
  const std::vector<ChainResults>& chains = results.chains;
  Section section("thesis", "A heavy last link: weighted against equal corrections",
                  "plumb thesis --out " + options.out, machine);
  section.add_live();
  section.add_text(
      "When a rod between two particles is too long, relaxation moves both ends. Shares by inverse mass "
      "(thesis eq. 4.7, "
      "\"mass\") against half each (eq. 4.6, \"equal\"), with the correction's direction taken at the new "
      "position (the "
      "thesis's), the old one or the middle. Chains start horizontal and at rest; frames are 1/60 s; errors "
      "are RMS "
      "distances to the truth at 1 s in per cent of the chain's length. Arithmetic is double.");
  for (const ChainResults& chain : chains) section.add_text(conclusion_of(chain));
  section.add_heading("What the thesis saw");
  section.add_text(thesis_table_text(results.numbers));
  section.add_table(thesis_table(thesis_rows(results.numbers)));
  for (const ChainResults& chain : chains) {
    const std::string file = "thesis_" + chain.spec.substr(0, chain.spec.find(':'));
    section.add_heading(chain.name + ": error against sweeps");
    section.add_text(truth_text(chain) + " " + std::to_string(substeps) +
                     " substeps a frame. The time is that of weights mass, gradient new.");
    section.add_table(error_table("sweeps", sweep_counts, chain.by_sweeps));
    section.add_chart(
        options.out, file + "_sweeps",
        {chain.name + ": error against sweeps", "sweeps in a substep", "error at 1 s, % of length",
         series_of(chain.by_sweeps, [](const Measured& m) { return double(m.settings.stop.sweeps); })});
    section.add_chart(options.out, file + "_time",
                      {chain.name + ": error against time", "µs a frame", "error at 1 s, % of length",
                       series_of(chain.by_sweeps, [](const Measured& m) { return m.us_per_frame; })});
    section.add_heading(chain.name + ": error against steps");
    section.add_text(
        "Swept until no rod is stretched by more than 1e-7 (at most 5000 sweeps): what is left is the error "
        "of the step.");
    section.add_table(error_table("substeps", substep_counts, chain.by_substeps));
    section.add_chart(
        options.out, file + "_substeps",
        {chain.name + ": error against steps", "substeps a frame", "error at 1 s, % of length",
         series_of(chain.by_substeps, [](const Measured& m) { return double(m.settings.substeps); })});
  }
  section.add_heading("The pull of the heavy link");
  section.add_text(mass_text);
  section.add_table(mass_table(results.masses));
  section.add_heading("Stiff equations");
  section.add_text(stiff_text);
  section.add_chart(options.out, "thesis_stiff", stiff_chart());
  section.add_chart(options.out, "thesis_amplification", amplification_chart());
  section.add_table(stiff_table());
  section.add_heading("Velocities of Verlet and of Runge-Kutta");
  section.add_text(velocity_text());
  section.add_chart(options.out, "thesis_velocity", velocity_chart());
  section.add_table(velocity_table());
  section.publish(options.out);
}

scenes::Json measured_json(const Measured& m) {
  scenes::Json json{{"weights", std::string(to_string(m.settings.weights))},
                    {"gradient", std::string(to_string(gradient_of(m.settings)))},
                    {"substeps", m.settings.substeps},
                    {"sweeps", m.settings.stop.sweeps}};
  json["tolerance"] = m.settings.stop.tolerance;
  json["stable"] = m.stable;
  json["error"] = m.error;
  json["stretch_rms"] = m.stretch_rms;
  json["us_per_frame"] = m.us_per_frame;
  return json;
}

void write_json(const ThesisOptions& options, const ThesisResults& results, const scenes::Machine& machine) {
  scenes::Json json{{"machine", scenes::machine_json(machine)}};
  json["thesis"] = thesis_rows_json(thesis_rows(results.numbers));
  for (const ChainResults& chain : results.chains) {
    scenes::Json entry{{"scene", chain.spec}, {"truth_uncertainty", chain.truth.uncertainty}};
    for (const Measured& m : chain.by_sweeps) entry["by_sweeps"].push_back(measured_json(m));
    for (const Measured& m : chain.by_substeps) entry["by_substeps"].push_back(measured_json(m));
    json["chains"].push_back(entry);
  }
  for (const MassResults& m : results.masses) {
    json["end_mass"].push_back({{"kg", m.end_mass},
                                {"change_true", m.distance_true},
                                {"change_mass", m.distance_mass},
                                {"change_equal", m.distance_equal},
                                {"rest_s_mass", m.rest_mass},
                                {"rest_s_equal", m.rest_equal}});
  }
  json["stiff_equation"] = stiff_json();
  json["velocity_error"] = velocity_json();
  scenes::write_file(options.out + "/thesis.json", scenes::format_json(json));
}

int thesis(const ThesisOptions& options) {
  if (!options.out.empty()) {
    require_gnuplot();
    make_folder(options.out);
  }
  ThesisResults results;
  {
    Progress progress("measuring", options.quiet);
    const std::uint64_t all = 2 * all_variants().size() * (sweep_counts.size() + substep_counts.size());
    std::uint64_t done = 0;
    const auto tick = [&] { progress.show(++done, all); };
    results.chains.push_back(
        measure_chain("thesis5", "Five links, end mass 2", converge(scenes::make_thesis5(), 1024), tick));
    results.chains.push_back(
        measure_chain("chain:links=20,end_mass=10", "20 links, end mass 10", chain_truth(), tick));
    for (const double end_mass : end_masses) results.masses.push_back(measure_mass(end_mass));
    results.numbers = measure_thesis_numbers();
  }
  Settings one_thread;
  one_thread.threads = 1;
  const scenes::Machine machine = scenes::describe_machine(World(scenes::make_thesis5(), one_thread).info());

  for (const ChainResults& chain : results.chains) {
    std::printf("%s: error at 1 s in %% of the length, %u substeps a frame. %s\n%s\n", chain.name.c_str(),
                substeps, truth_text(chain).c_str(),
                error_table("sweeps", sweep_counts, chain.by_sweeps).to_text().c_str());
    std::printf("%s: the same, swept to a stretch of 1e-7. Times are of mass, new.\n%s\n", chain.name.c_str(),
                error_table("substeps", substep_counts, chain.by_substeps).to_text().c_str());
  }
  std::printf("%s\n%s\n", mass_text, mass_table(results.masses).to_text().c_str());
  std::printf("%s\n%s\n", thesis_table_text(results.numbers).c_str(),
              thesis_table(thesis_rows(results.numbers)).to_text().c_str());
  std::printf("%s\n%s\n%s\n%s\n", stiff_text, stiff_table().to_text().c_str(), velocity_text().c_str(),
              velocity_table().to_text().c_str());
  for (const ChainResults& chain : results.chains) std::printf("%s\n", conclusion_of(chain).c_str());
  if (options.out.empty()) return fine;
  write_json(options, results, machine);
  publish(options, results, machine);
  if (!options.quiet) std::printf("\nPage: %s/index.html\n", options.out.c_str());
  return fine;
}

}  // namespace

void add_thesis_command(Command& plumb) {
  Command command =
      plumb.add_command("thesis", "Repeat the thesis's experiment on heavy last links, with numbers");
  auto options = std::make_shared<ThesisOptions>();
  command.add_option("--out", "DIR", options->out,
                     "Write a page with charts, and the numbers, into this folder");
  command.add_flag("--quiet", options->quiet, "No progress bar");
  command.set_footer("Example:\n  plumb thesis --out out");
  command.set_action([options] { return thesis(*options); });
}

}  // namespace plumb::tools
