#pragma once

#include <stdexcept>
#include <string>

#include "cli/command_line.hpp"

/// Each command has a file and adds itself to the command line, with what it does when chosen.
namespace plumb::tools {

void add_run_command(Command& plumb);
void add_fall_command(Command& plumb);
void add_frontier_command(Command& plumb);
void add_humanoid_command(Command& plumb);
void add_info_command(Command& plumb);
void add_profile_command(Command& plumb);
void add_scale_command(Command& plumb);
void add_stability_command(Command& plumb);
void add_thesis_command(Command& plumb);
void add_truth_command(Command& plumb);
void add_view_command(Command& plumb);

/// These are the exit statuses.
inline constexpr int fine = 0;
inline constexpr int check_failed = 1;
inline constexpr int bad_input = 2;

/// A command throws this if what it measured is not what it must be. The message says what.
class CheckFailed : public std::runtime_error {
 public:
  explicit CheckFailed(const std::string& what) : std::runtime_error("check failed: " + what) {}
};

}  // namespace plumb::tools
