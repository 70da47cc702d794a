#include "cli/command_line.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/options.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/nearest.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
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
  EXPECT_EQ(message_of({"drop"}), "no command 'drop'; known are throw, again");
  EXPECT_EQ(message_of({}), "no command given; `plumb --help` lists them");
}

// A slip is named alone, whatever follows it, with the name that was meant.
TEST(CommandLine, NamesWhatWasMeant) {
  EXPECT_EQ(message_of({"trow"}), "no command 'trow'; known are throw, again. Did you mean throw?");
  EXPECT_EQ(message_of({"throw", "ball", "--sped", "4"}),
            "no option '--sped'; `plumb throw --help` lists those there are. Did you mean --speed?");
  EXPECT_EQ(message_of({"throw", "ball", "-speed", "4"}),
            "no option '-speed'; `plumb throw --help` lists those there are. Did you mean --speed?");
  EXPECT_EQ(message_of({"throw", "--stil=1"}),
            "no option '--stil'; `plumb throw --help` lists those there are. Did you mean --still?");
  EXPECT_EQ(message_of({"again", "inner", "--colour"}),
            "no option '--colour'; `plumb again inner --help` lists those there are");
  EXPECT_EQ(message_of({"--versoin"}),
            "no option '--versoin'; `plumb --help` lists those there are. Did you mean --version?");
  EXPECT_EQ(message_of({"throw", "ball", "stone"}), "nothing takes 'stone'");
  EXPECT_EQ(message_of({"throw", "ball", "--speed", "-x"}), "--speed: '-x' is not a finite number");
}

TEST(CommandLine, CountsLettersThatDiffer) {
  EXPECT_EQ(scenes::letters_apart("", "abc"), 3u);
  EXPECT_EQ(scenes::letters_apart("kitten", "sitting"), 3u) << "two changed, one added";
  EXPECT_EQ(scenes::letters_apart("rnu", "run"), 1u) << "neighbours swapped";
  EXPECT_EQ(scenes::letters_apart("ca", "abc"), 3u) << "none changes between swapped neighbours";
  EXPECT_EQ(scenes::did_you_mean("nte", {"chain", "net", "ten"}), ". Did you mean net?");
  EXPECT_EQ(scenes::did_you_mean("x", {"y"}), "") << "too short to tell";
  EXPECT_EQ(scenes::did_you_mean("rope", {"pile", "wire"}), "");
}

// The kernel names settings in words, and the command by what is typed.
TEST(CommandLine, HasAnOptionForEachSetting) {
  CommandLine line("plumb", "about", "1", "");
  Settings settings;
  Command command = line.top().add_command("run", "Run");
  add_solver_options(command, settings);
  add_layout_options(command, settings);
  command.set_action([] { return 0; });
  for (const MethodInfo& method : all_methods())
    for (const std::string_view setting : method.reads) {
      if (setting == "sleep" || setting == "tensions" || setting == "contacts") continue;  // no such options
      std::string words[] = {"plumb", "run", option_of(setting), "?"};
      char* argv[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data()};
      try {
        line.run(4, argv);
        ADD_FAILURE() << setting;
      } catch (const InputError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(option_of(setting) + ": ")) << error.what();
      }
    }
  EXPECT_EQ(option_of("budget"), "--budget-us");
  EXPECT_EQ(option_of("time order"), "--time-order");
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
}  // namespace plumb::tools::PLUMB_TEST_FILE
