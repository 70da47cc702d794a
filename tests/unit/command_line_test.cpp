#include "cli/command_line.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/options.hpp"
#include "plumb/error.hpp"

namespace plumb::tools {
namespace {

struct Throw {
  std::string target;
  double speed = 1;
  bool quiet = false;
  std::string typed;
};

/// The exit status of `plumb ARGUMENTS`, where plumb knows `throw TARGET`, which knows `again`.
int run(std::vector<std::string> arguments, Throw& out) {
  CommandLine line("plumb", "about", "1", "");
  Command top = line.top();
  Command command = top.add_command("throw", "Throw");
  add_scene(command, out.target);
  const Option speed = add_positive(command, "--speed", out.speed, "Speed");
  const Option still = command.add_flag(
      "--still", [&out] { out.speed = 0; }, "No speed");
  still.excludes(speed);
  command.add_flag("--quiet", out.quiet, "Quiet");
  command.set_action([&out, command] {
    out.typed = command.typed();
    return 3;
  });
  Command again = top.add_command("again", "Again");
  Command inner = again.add_command("inner", "Inner");
  again.set_action([] { return 4; });
  inner.set_action([] { return 5; });
  arguments.insert(arguments.begin(), "plumb");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return line.run(static_cast<int>(argv.size()), argv.data());
}

std::string message_of(const std::vector<std::string>& arguments) {
  Throw ignored;
  try {
    run(arguments, ignored);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CommandLine, TakesValuesAndRunsTheCommand) {
  Throw t;
  EXPECT_EQ(run({"throw", "ball", "--speed", "1/4", "--quiet"}, t), 3);
  EXPECT_EQ(t.target, "ball");
  EXPECT_EQ(t.speed, 0.25);
  EXPECT_TRUE(t.quiet);
  EXPECT_EQ(t.typed, " SCENE ball --speed 1/4");
  EXPECT_EQ(run({"throw", "ball", "--still"}, t), 3);
  EXPECT_EQ(t.speed, 0);
}

TEST(CommandLine, RunsTheInnermostCommand) {
  Throw ignored;
  EXPECT_EQ(run({"again"}, ignored), 4);
  EXPECT_EQ(run({"again", "inner"}, ignored), 5);
}

TEST(CommandLine, RefusesWithTheNameOfTheOption) {
  EXPECT_EQ(message_of({"throw", "ball", "--speed", "-1"}), "--speed: must be positive");
  EXPECT_EQ(message_of({"throw", "ball", "--speed", "fast"}), "--speed: 'fast' is not a finite number");
  EXPECT_EQ(message_of({"throw", "ball", "--speed", "2", "--still"}), "--speed excludes --still");
  EXPECT_EQ(message_of({"throw"}), "SCENE is required");
  EXPECT_EQ(message_of({"trow"}), "no command 'trow'; known are throw, again");
  EXPECT_EQ(message_of({}), "no command given; `plumb --help` lists them");
}

// The words of --method are the rows of the kernel's table, and so are those of the message that refuses one.
TEST(CommandLine, KnowsTheMethodsOfTheTable) {
  Settings settings;
  const auto run_method = [&settings](std::string method) {
    CommandLine line("plumb", "about", "1", "");
    Command command = line.top().add_command("run", "Run");
    add_solver_options(command, settings);
    command.set_action([] { return 0; });
    std::string words[] = {"plumb", "run", "--method", std::move(method)};
    char* argv[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data()};
    return line.run(4, argv);
  };
  std::string list;
  for (const MethodInfo& info : all_methods()) {
    EXPECT_EQ(run_method(std::string(info.name)), 0);
    EXPECT_EQ(settings.method, info.method);
    EXPECT_NE(methods_help().find("  " + std::string(info.name) + " "), std::string::npos);
    list += (list.empty() ? "" : "|") + std::string(info.name);
  }
  try {
    run_method("magic");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), "--method: 'magic' is not one of " + list);
  }
}

}  // namespace
}  // namespace plumb::tools
