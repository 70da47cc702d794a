// plumb scale measures frames per second against links for every method, as in the thesis's figures 4.7
// and 4.8. It also measures what each method costs at equal error.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "plot/gnuplot.hpp"
#include "plot/page.hpp"
#include "plumb/error.hpp"
#include "scale/output.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {
namespace {

constexpr ChainFamily both_families[] = {ChainFamily::equal_links, ChainFamily::equal_length};

bool has(const std::vector<Method>& methods, Method method) {
  return std::find(methods.begin(), methods.end(), method) != methods.end();
}

std::string name_of_method(Method method) {
  return std::string(to_string(method));
}

ScaleResults measure(const ScaleOptions& options) {
  ScaleResults results;
  Progress progress("measuring", options.quiet);
  std::uint64_t done = 0;
  // A search at equal error takes about as long as this many cells. The progress bar needs no more.
  const std::uint64_t search = 5 * 2;
  const std::uint64_t all =
      all_series(options).size() * options.links.size() + search * options.error_links.size();
  results.cells = measure_cells(options, [&] { progress.show(++done, all); });
  if (const auto links = find_differing(results.cells))
    throw CheckFailed(std::to_string(*links) + " links end in different states on one thread and on all");
  for (const ChainFamily family : both_families)
    for (const std::uint32_t links : error_links_of(family, options)) {
      for (const EqualErrorCell& cell :
           measure_at_equal_error(family, links, options.methods, options.target, options.path_s))
        results.errors.push_back(cell);
      progress.show(done += search / 2, all);
    }
  if (!has(options.methods, Method::relax)) return results;
  for (const Precision precision : options.precisions)
    for (const std::uint32_t sweeps : {5u, 1000u}) {
      const ScaleSeries series{.method = Method::relax, .precision = precision};
      Settings settings = settings_of(series, options);
      settings.stop.sweeps = sweeps;
      double ignored = 0;
      results.five.push_back(measure_cell(series, 5, settings, options, ignored));
    }
  return results;
}

const char* const five_text =
    "Section 4.4.2 gives two frame rates, drawing included, on an Athlon XP 1800+ of 2001.";

void print(const ScaleOptions& options, const ScaleResults& results) {
  std::printf("%s\n\nFrames a second:\n%s\nNanoseconds per rod and frame:\n%s\n%s\n",
              scale_text(options).c_str(), frames_table(options, results).to_text().c_str(),
              rods_table(options, results).to_text().c_str(),
              slope_table(options, results).to_text().c_str());
  if (!results.five.empty())
    std::printf("%s\n%s\n", relax_table(results).to_text().c_str(),
                five_links_table(results).to_text().c_str());
  std::printf("%s\n", conclusion_of(compare(options, results)).c_str());
  if (options.error_links.empty()) return;
  for (const ChainFamily family : both_families)
    std::printf("\n%s\n%s\n%s\n%s\n", error_text(options, results, family).c_str(),
                error_table(options, results, family).to_text().c_str(),
                setting_table(results, family).to_text().c_str(),
                conclusion_at_equal_error(options, results, family).c_str());
}

void publish(const ScaleOptions& options, const ScaleResults& results, const std::string& typed) {
  const std::filesystem::path folder = options.out;
  const scenes::Machine machine = scenes::describe_machine();
  scenes::Json json{{"machine", scenes::machine_json(machine)}};
  json.update(scale_json(options, results));
  scenes::write_file(folder / "scale.json", scenes::format_json(json));
  scenes::write_file(folder / "scale.csv", scale_csv(results));

  Section section("scale", "Scaling: frames a second against links (figures 4.7 and 4.8)",
                  "plumb scale" + typed, machine);
  section.add_text(scale_text(options));
  section.add_text(conclusion_of(compare(options, results)));
  section.add_chart(folder, "scale_frames", frames_chart(options, results));
  section.add_table(frames_table(options, results));
  section.add_chart(folder, "scale_rods", rods_chart(options, results));
  section.add_table(rods_table(options, results));
  section.add_table(slope_table(options, results));
  if (!options.error_links.empty()) {
    section.add_heading("At equal error");
    for (const ChainFamily family : both_families) {
      const std::string file =
          family == ChainFamily::equal_links ? "scale_error_links" : "scale_error_length";
      section.add_text(error_text(options, results, family));
      section.add_text(conclusion_at_equal_error(options, results, family));
      section.add_chart(folder, file, error_chart(options, results, family));
      section.add_table(error_table(options, results, family));
      section.add_table(setting_table(results, family));
    }
  }
  section.add_heading("Stretch");
  section.add_chart(folder, "scale_stretch", stretch_chart(options, results));
  if (!results.five.empty()) {
    section.add_table(relax_table(results));
    section.add_heading("The thesis's five links");
    section.add_text(five_text);
    section.add_table(five_links_table(results));
  }
  section.publish(folder);
}

int scale(const ScaleOptions& options, const std::string& typed) {
  if (options.repetitions == 0) throw InputError("--repetitions must be at least 1");
  if (!options.out.empty()) {
    require_gnuplot();
    make_folder(options.out);
  }
  const ScaleResults results = measure(options);
  print(options, results);
  if (options.out.empty()) return fine;
  publish(options, results, typed);
  if (!options.quiet) std::printf("\nPage: %s/index.html\n", options.out.c_str());
  return fine;
}

std::vector<std::uint32_t> parse_links(const std::string& text) {
  std::vector<std::uint32_t> out;
  for (const std::string& item : scenes::split_list(text)) {
    const auto links = scenes::parse_number<std::uint32_t>(item);
    if (!links || *links == 0) throw BadValue("'" + item + "' is not a number of links");
    out.push_back(*links);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<Method> parse_methods(const std::string& text) {
  std::vector<Method> out;
  try {
    for (const Method method : scenes::named(text, methods_of_table(), name_of_method))
      if (!has(out, method)) out.push_back(method);
  } catch (const std::invalid_argument& error) {
    throw BadValue(error.what());
  }
  return out;
}

void add_links(Command& command, const std::string& name, std::vector<std::uint32_t>& target,
               const std::string& help) {
  command.add_option(
      name, "N1,N2,...", [&target](const std::string& text) { target = parse_links(text); }, help);
}

}  // namespace

void add_scale_command(Command& plumb) {
  Command command =
      plumb.add_command("scale", "Measure frames a second against links (thesis figures 4.7 and 4.8)");
  auto options = std::make_shared<ScaleOptions>();
  ScaleOptions& o = *options;
  // It is declared before the lists, so that these can still be given.
  command.add_flag(
      "--quick",
      [&o] {
        o.links = {1, 5, 20, 50, 100, 1000, 10000, 100000};
        o.error_links = {5, 20, 100};
        o.seconds = 0.005;
        o.cell_s = 0.2;
        o.path_s = 0.05;
      },
      "Ten seconds: fewer lengths, shorter repetitions");
  std::string methods;
  for (const Method method : o.methods) scenes::append_item(methods, to_string(method), "|");
  command.add_option(
      "--methods", "M1,M2,...", [&o](const std::string& text) { o.methods = parse_methods(text); },
      "Of " + methods + ", separated by commas [all]");
  add_links(command, "--links", o.links, "Lengths of chain [1,2,5,10,...,1000000]");
  add_links(command, "--error-links", o.error_links, "Lengths at equal error [5,20,100,1000]");
  add_positive(command, "--target", o.target,
               "Position error at equal error, relative to the chain's length [0.01]");
  add_count(command, "--sweeps", o.sweeps, "Passes over all rods a frame, relaxed [5]");
  add_count(command, "--repetitions", o.repetitions, "Timed repetitions [5]");
  add_seconds(command, "--seconds", o.seconds, "Least time of a repetition [0.02]");
  add_seconds(command, "--cell", o.cell_s, "Most time to step a chain; above, a method ends [0.6]");
  add_choice_or_both(command, "--precision", o.precisions, "Arithmetic of relaxation");
  add_choice_or_both(command, "--order", o.orders, "Order of relaxation's sweeps");
  command.add_option("--out", "DIR", o.out, "Write a page with charts, JSON and CSV into this folder");
  command.add_flag("--quiet", o.quiet, "No progress bar");
  command.set_footer(
      "Examples:\n  plumb scale --out out\n  plumb scale --quick --methods relax,springs\n"
      "  plumb scale --links 5,50,500 --sweeps 1000");
  command.set_action([options, command] { return scale(*options, command.typed()); });
}

}  // namespace plumb::tools
