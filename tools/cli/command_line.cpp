#include "cli/command_line.hpp"

#include <CLI/CLI.hpp>
#include <utility>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"

namespace plumb::tools {

bool Option::given() const {
  return option_->count() > 0;
}

std::string Option::name() const {
  return option_->get_name();
}

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::excludes(Option other) const {
  option_->excludes(other.option_);
  return *this;
}

Command Command::add_command(const std::string& name, const std::string& help) const {
  return {app_->add_subcommand(name, help), chosen_};
}

Option Command::add_option(const std::string& name, const std::string& value, Take take,
                           const std::string& help) const {
  const auto named = [name, take = std::move(take)](const std::string& text) {
    try {
      take(text);
    } catch (const BadValue& error) {
      throw InputError(name + ": " + error.what());
    }
  };
  return Option(app_->add_option_function<std::string>(name, named, help)->type_name(value));
}

Option Command::add_option(const std::string& name, const std::string& value, std::string& target,
                           const std::string& help) const {
  return add_option(
      name, value, [&target](const std::string& text) { target = text; }, help);
}

Option Command::add_flag(const std::string& name, bool& target, const std::string& help) const {
  return Option(app_->add_flag(name, target, help));
}

Option Command::add_flag(const std::string& name, std::function<void()> then, const std::string& help) const {
  return Option(app_->add_flag_callback(name, std::move(then), help));
}

void Command::check(std::function<void()> check) const {
  app_->parse_complete_callback(std::move(check));
}

void Command::set_footer(const std::string& text) const {
  app_->footer(text);
}

void Command::set_action(Action action) const {
  // A command within a command is called back first, and is the one that was meant.
  app_->callback([chosen = chosen_, action = std::move(action)] {
    if (!*chosen) *chosen = action;
  });
}

std::string Command::typed() const {
  std::string out;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || name == "--quiet") continue;
    out += " " + name;
    if (option->get_expected_max() > 0) out += " " + option->results().front();
  }
  return out;
}

CommandLine::CommandLine(const std::string& name, const std::string& about, const std::string& version,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(about, name)) {
  app_->set_version_flag("--version", version);
  app_->get_formatter()->column_width(30);
  app_->require_subcommand(1);
  app_->footer(footer);
}

CommandLine::~CommandLine() = default;

Command CommandLine::top() {
  return {app_.get(), &chosen_};
}

int CommandLine::run(int argc, char** argv) {
  if (argc < 2) throw InputError("no command given; `plumb --help` lists them");
  const std::string first = argv[1];
  // CLI11 would only say that a command is missing.
  std::string known;
  bool found = first.starts_with('-');
  for (const CLI::App* command : app_->get_subcommands({})) {
    scenes::append_item(known, command->get_name());
    found = found || command->get_name() == first;
  }
  if (!found) throw InputError("no command '" + first + "'; known are " + known);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app_->exit(error);  // It handles --help and --version.
    throw InputError(error.what());
  }
  return chosen_();
}

}  // namespace plumb::tools
