#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

/// A command line has commands, each with options. This header holds what plumb needs of CLI11 and costs
/// nothing to include. CLI11 itself takes seconds to compile, and command_line.cpp alone includes it.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace plumb::tools {

/// An action does what the command line asks for and returns the exit status.
using Action = std::function<int()>;

/// Takes the text that a user gave an option. Throws BadValue.
using Take = std::function<void(const std::string&)>;

/// An option refuses its value with this. The message that the user sees has the option's name before the
/// reason.
class BadValue : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An option belongs to a command and answers what is asked of it after it was declared.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  bool given() const;
  std::string name() const;
  Option required() const;
  Option excludes(Option other) const;
  friend bool operator==(Option, Option) = default;

 private:
  CLI::Option* option_;
};

/// A command declares itself through this. Help shows options in the order in which they are declared, and
/// their values are taken in that order too.
class Command {
 public:
  Command(CLI::App* app, Action* chosen) : app_(app), chosen_(chosen) {}

  /// Adds a command within this one, chosen by `name`.
  Command add_command(const std::string& name, const std::string& help) const;

  /// Adds an option with one value, which help calls `value`.
  Option add_option(const std::string& name, const std::string& value, Take take,
                    const std::string& help) const;
  /// Adds such an option and keeps its text as it is.
  Option add_option(const std::string& name, const std::string& value, std::string& target,
                    const std::string& help) const;
  Option add_flag(const std::string& name, bool& target, const std::string& help) const;
  Option add_flag(const std::string& name, std::function<void()> then, const std::string& help) const;

  /// Calls `check` when all values are taken, to refuse those that do not go together.
  void check(std::function<void()> check) const;
  /// Sets what help ends with.
  void set_footer(const std::string& text) const;
  /// Sets what makes the text that help ends with. It is asked once values are taken.
  void set_footer(std::function<std::string()> text) const;
  /// Sets what the command does.
  void set_action(Action action) const;

  /// Returns the options that were given, as the user typed them. It leaves out --quiet, which changes no
  /// results.
  std::string typed() const;

 private:
  CLI::App* app_;
  Action* chosen_;  ///< Action of the command line that was chosen.
};

/// This is the whole command line.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& about, const std::string& version,
              const std::string& footer);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Command top();

  /// Does what the line says: it shows help or the version, or runs a command, and returns its exit status.
  /// Throws InputError if the line cannot be understood, and what the command throws.
  int run(int argc, char** argv);

 private:
  /// Throws InputError on a command or an option that is not known, with the one that was meant.
  void require_known(int argc, char** argv) const;

  std::unique_ptr<CLI::App> app_;
  Action chosen_;
};

}  // namespace plumb::tools
