// bench_direct measures what method direct costs per rod, and how long it takes to a given error. It compares
// it with scalar solves, relaxation and other libraries.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "direct/newton_cost.hpp"
#include "direct/sections.hpp"
#include "scenes/runs/machine.hpp"
#include "support/check.hpp"
#include "support/flags.hpp"
#include "support/output.hpp"
#include "support/quiet.hpp"
#include "support/run_main.hpp"

namespace plumb::bench {
namespace {

constexpr const char* usage =
    "bench_direct [--full] [--only SECTIONS] [--rounds N] [--csv FILE] [--summary FILE]\n"
    "  --full             a net that folds and longer searches: about half an hour\n"
    "  --only SECTIONS    some of lanes, line, laws, wires, targets, loops; more than one with commas [all]\n"
    "  --rounds N         samples of each contestant of lanes, line, laws and wires, at least 2 [25]\n"
    "  --csv FILE         all numbers\n"
    "  --summary FILE     the tables that are printed at the end, as Markdown\n";

std::string machine_text() {
  const scenes::Machine machine = scenes::describe_machine();
  return machine.cpu + ", " + machine.isa + ", one thread; " + machine.compiler + ", `" + machine.flags +
         "`, commit " + machine.commit + ".";
}

int run(int argc, char** argv) {
  Flags flags(argc, argv);
  if (flags.take("--help")) {
    std::printf("%s", usage);
    return 0;
  }
  Plan plan;
  plan.full = flags.take("--full");
  plan.rounds = flags.take_count("--rounds", plan.rounds, 2);
  const std::string only = flags.take_value("--only").value_or("lanes,line,laws,wires,targets,loops");
  const std::string list = std::string(1, ',').append(only).append(1, ',');
  std::optional<scenes::OutputFile> csv = open_output(flags.take_value("--csv").value_or("")),
                                    summary = open_output(flags.take_value("--summary").value_or(""));
  if (flags.rest().size() > 1) throw std::invalid_argument("unknown: " + flags.rest()[1] + "\n" + usage);
  const auto wants = [&](const char* section) {
    return list.find(std::string(1, ',').append(section).append(1, ',')) != std::string::npos;
  };

  const double quiet = work_of_two_threads();
  Section all;
  if (wants("lanes")) all += lanes_section(plan);
  if (wants("line")) all += line_section(plan);
  if (wants("laws")) all += laws_section(plan);
  if (wants("wires")) all += wires_section(plan);
  if (wants("targets")) all += targets_section(plan);
  if (wants("loops")) all += loops_section(plan);
  const std::string text = machine_text() + "\n\n" + quiet_text(quiet) + "\n" + all.text;
  std::printf("%s", text.c_str());
  finish_output(summary, text);
  finish_output(csv, csv_header + all.csv);
  return 0;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_direct", plumb::bench::run, argc, argv);
}
