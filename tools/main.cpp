// The plumb command. Data goes to stdout, progress and messages to stderr; exit status 0 is fine, 1 a check
// that failed, 2 bad usage or input.
#include <algorithm>
#include <cstdio>
#include <exception>

#include "commands.hpp"
#include "plumb/error.hpp"
#include "plumb/reference/methods.hpp"
#include "scenes/lists.hpp"
#include "scenes/machine.hpp"

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
  CLI::App app("plumb: articulated things made of particles and rods", "plumb");
  const scenes::Machine machine = scenes::describe_machine();
  app.set_version_flag("--version", "plumb " + scenes::version() + " (commit " + machine.commit + ", " +
                                        machine.compiler + ", " + machine.isa + ")");
  app.get_formatter()->column_width(30);
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  plumb run chain:links=20,end_mass=10 --substeps 8 --sweeps 20\n"
      "  plumb run tools/scenes/net.json --tolerance 1e-3 --report net-report.json\n"
      "  plumb info net:width=64,height=64\n"
      "  plumb humanoid --experiments --out out\n"
      "  plumb thesis --out out\n"
      "  plumb frontier --out out\n"
      "  plumb stability --out out\n"
      "  plumb profile --out out\n"
      "  plumb truth chain:links=20,end_mass=10 --save-at 0.5,1 --out truth.csv\n\n" +
      tools::generators_help() + "\n`plumb COMMAND --help` tells the options of a command.");

  register_reference_methods();
  tools::Action action;
  tools::add_run_command(app, action);
  tools::add_info_command(app, action);
  tools::add_humanoid_command(app, action);
  tools::add_frontier_command(app, action);
  tools::add_thesis_command(app, action);
  tools::add_scale_command(app, action);
  tools::add_profile_command(app, action);
  tools::add_stability_command(app, action);
  tools::add_truth_command(app, action);
  try {
    if (argc < 2) return complain("no command given; `plumb --help` lists them");
    const std::string first = argv[1];
    // CLI11 would only say that a command is missing.
    std::string known;
    bool found = first.starts_with('-');
    for (const CLI::App* command : app.get_subcommands({})) {
      scenes::append_item(known, command->get_name());
      found = found || command->get_name() == first;
    }
    if (!found) return complain("no command '" + first + "'; known are " + known);
    app.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    return complain(error.what());
  } catch (const tools::CheckFailed& error) {
    complain(error.what());
    return tools::check_failed;
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this scene");
  } catch (const std::exception& error) {
    return complain(error.what());
  }
}
