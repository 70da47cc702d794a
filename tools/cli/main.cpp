// This is the plumb command. Data goes to stdout, progress and messages to stderr. Exit status 0 is fine, 1
// is a check that failed, and 2 is bad usage or input.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "plumb/error.hpp"
#include "plumb/reference/methods.hpp"
#include "scenes/runs/machine.hpp"

namespace {

int complain(std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fprintf(stderr, "plumb: %s\n", message.c_str());
  return plumb::tools::bad_input;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace plumb;
  const scenes::Machine machine = scenes::describe_machine();
  const std::string footer =
      "Examples:\n"
      "  plumb run chain:links=20,end_mass=10 --method relax --substeps 8 --sweeps 20\n"
      "  plumb run tools/scenes/net.json --method relax --tolerance 1e-2 --report net-report.json\n"
      "  plumb info net:width=64,height=64\n"
      "  plumb view\n"
      "  plumb humanoid --experiments --out out\n"
      "  plumb fall --out out\n"
      "  plumb thesis --out out\n"
      "  plumb frontier --out out\n"
      "  plumb stability --out out\n"
      "  plumb profile --out out\n"
      "  plumb truth chain:links=20,end_mass=10 --save-at 0.5,1 --out truth.csv\n\n" +
      tools::generators_help() + "\n`plumb COMMAND --help` tells the options of a command.";

  register_reference_methods();
  try {
    tools::CommandLine line("plumb", "plumb: articulated things made of particles and rods",
                            "plumb " + scenes::version() + " (commit " + machine.commit + ", " +
                                machine.compiler + ", " + machine.isa + ")",
                            footer);
    tools::Command top = line.top();
    tools::add_run_command(top);
    tools::add_info_command(top);
    tools::add_humanoid_command(top);
    tools::add_fall_command(top);
    tools::add_frontier_command(top);
    tools::add_thesis_command(top);
    tools::add_scale_command(top);
    tools::add_profile_command(top);
    tools::add_stability_command(top);
    tools::add_truth_command(top);
    tools::add_view_command(top);
    return line.run(argc, argv);
  } catch (const tools::CheckFailed& error) {
    complain(error.what());
    return tools::check_failed;
  } catch (const UnreadSetting& error) {
    return complain(tools::option_of(error.setting()) + ": " + error.what());
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this scene");
  } catch (const std::exception& error) {
    return complain(error.what());
  }
}
