#include "cli/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cctype>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/nearest.hpp"

namespace plumb::tools {
namespace {

std::string dashed(const std::string& name) {
  return (name.size() == 1 ? "-" : "--") + name;
}

bool is_option(std::string_view argument) {
  const std::size_t letter = argument.find_first_not_of('-');
  return argument.starts_with('-') && letter < 3 &&
         std::isalpha(static_cast<unsigned char>(argument[letter])) != 0;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands(std::function<bool(const CLI::App*)>());
}

/// Returns a command within another, or nothing.
const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : commands_of(app))
    if (command->get_name() == name) return command;
  return nullptr;
}

[[noreturn]] void refuse_option(const std::string& typed, const std::string& command,
                                const std::vector<std::string>& known) {
  throw InputError("no option '" + typed + "'; `" + command + " --help` lists those there are" +
                   scenes::did_you_mean(typed.starts_with("--") ? typed : "-" + typed, known));
}

/// Refuses an option that the command does not have. CLI11 would name what follows it, too, in another order.
void require_options(const CLI::App& command, const std::string& name, int argc, char** argv, int first) {
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options())
    for (const auto& names : {option->get_lnames(), option->get_snames()})
      for (const std::string& each : names) known.push_back(dashed(each));
  for (int i = first; i < argc; ++i) {
    const std::string typed = std::string(argv[i]).substr(0, std::string_view(argv[i]).find('='));
    if (typed == "--") return;
    if (!is_option(typed)) continue;
    const CLI::Option* const option = command.get_option_no_throw(typed);
    if (option == nullptr) refuse_option(typed, name, known);
    if (option->get_expected_max() > 0 && typed == argv[i]) ++i;  // its value may begin with a dash
  }
}

}  // namespace

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

void Command::set_footer(std::function<std::string()> text) const {
  app_->footer(std::string());  // that of the whole command would follow
  app_->footer(std::move(text));
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
  require_known(argc, argv);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ExtrasError&) {
    throw InputError("nothing takes '" + app_->remaining(true).front() + "'");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app_->exit(error);  // It handles --help and --version.
    throw InputError(error.what());
  }
  return chosen_();
}

void CommandLine::require_known(int argc, char** argv) const {
  const std::string first = argv[1];
  if (first.starts_with('-')) return require_options(*app_, app_->get_name(), argc, argv, 1);
  // CLI11 would only say that a command is missing.
  std::vector<std::string> known;
  for (const CLI::App* command : commands_of(*app_)) known.push_back(command->get_name());
  const CLI::App* command = find_command(*app_, first);
  if (command == nullptr)
    throw InputError("no command '" + first + "'; known are " + scenes::joined(known) +
                     scenes::did_you_mean(first, known));
  std::string name = app_->get_name() + " " + first;
  int next = 2;
  for (; next < argc; ++next) {
    const CLI::App* const inner = find_command(*command, argv[next]);
    if (inner == nullptr) break;
    command = inner;
    name += std::string(" ") + argv[next];
  }
  require_options(*command, name, argc, argv, next);
}

}  // namespace plumb::tools
