#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>

#include "cli/options.hpp"

/// The commands, one file each. Each adds itself to the command line and, when chosen, puts what is to be
/// done into `action`.
namespace plumb::tools {

void add_run_command(CLI::App& app, Action& action);
void add_frontier_command(CLI::App& app, Action& action);
void add_humanoid_command(CLI::App& app, Action& action);
void add_info_command(CLI::App& app, Action& action);
void add_profile_command(CLI::App& app, Action& action);
void add_scale_command(CLI::App& app, Action& action);
void add_stability_command(CLI::App& app, Action& action);
void add_thesis_command(CLI::App& app, Action& action);
void add_truth_command(CLI::App& app, Action& action);

/// Exit statuses.
inline constexpr int fine = 0;
inline constexpr int check_failed = 1;
inline constexpr int bad_input = 2;

/// What was measured is not what it must be; the message says what.
class CheckFailed : public std::runtime_error {
 public:
  explicit CheckFailed(const std::string& what) : std::runtime_error("check failed: " + what) {}
};

}  // namespace plumb::tools
