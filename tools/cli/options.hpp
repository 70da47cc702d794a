#pragma once

#include <concepts>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cli/command_line.hpp"
#include "plumb/settings.hpp"
#include "scenes/basics/length_rate.hpp"
#include "scenes/basics/numbers.hpp"

/// Several commands share these options. All refuse nonsense with one clear line.
namespace plumb::tools {

/// Adds an option that takes one of a few words. A refusal says which.
Option add_words(Command& command, const std::string& name, const std::vector<std::string>& words, Take take,
                 const std::string& help);

/// Adds an option whose words are the names of enum values. The target is an Enum or an optional one.
template <class Enum, class Target>
Option add_choice(Command& command, const std::string& name, Target& target, const std::vector<Enum>& list,
                  const std::string& help) {
  std::vector<std::string> words;
  for (const Enum value : list) words.emplace_back(to_string(value));
  const auto take = [list, &target](const std::string& word) {
    for (const Enum value : list) {
      if (to_string(value) == word) target = value;
    }
  };
  if constexpr (std::is_same_v<Enum, Target>)
    return add_words(command, name, words, take, help + " [" + std::string(to_string(target)) + "]");
  return add_words(command, name, words, take, help);
}
template <class Enum, class Target>
Option add_choice(Command& command, const std::string& name, Target& target,
                  std::initializer_list<Enum> values, const std::string& help) {
  return add_choice(command, name, target, std::vector<Enum>(values), help);
}

/// Adds an option whose words are the names of enum values, or `both`, which leaves the target as it is: with
/// all of them.
template <class Enum>
Option add_choice_or_both(Command& command, const std::string& name, std::vector<Enum>& target,
                          const std::string& help) {
  std::vector<std::string> words;
  for (const Enum value : target) words.emplace_back(to_string(value));
  words.emplace_back("both");
  const auto take = [list = target, &target](const std::string& word) {
    for (const Enum value : list)
      if (to_string(value) == word) target = {value};
  };
  return add_words(command, name, words, take, help + " [both]");
}

/// Whole numbers from the least to the most.
template <std::unsigned_integral Number>
struct Whole {
  Number least = 0;
  Number most = std::numeric_limits<Number>::max();
};

/// Reads a whole number of a range. Throws BadValue.
template <std::unsigned_integral Number>
Number whole_number(const std::string& text, Whole<Number> range) {
  const auto value = scenes::parse_number<Number>(text);
  if (!value || *value < range.least || *value > range.most)
    throw BadValue("'" + text + "' is not a whole number from " + std::to_string(range.least) + " to " +
                   std::to_string(range.most));
  return *value;
}

/// Adds an option that takes a whole number.
Option add_count(Command& command, const std::string& name, unsigned& target, const std::string& help,
                 Whole<unsigned> range = {});

/// Adds an option that takes a positive number of seconds, as a decimal or a fraction such as 1/60.
Option add_seconds(Command& command, const std::string& name, double& target, const std::string& help);

/// Adds an option that takes a positive number without a unit.
Option add_positive(Command& command, const std::string& name, double& target, const std::string& help);

/// Adds --save-at, which takes times in seconds, separated by commas.
Option add_save_at(Command& command, std::vector<double>& times, const std::string& help);

/// Adds --winch, which takes rods and the rates of their lengths.
Option add_winches(Command& command, std::vector<scenes::LengthRate>& rates);

/// Refuses two options that name the same file to write, with both of their names. Empty names are none.
void require_different_files(const std::vector<std::pair<std::string, std::string>>& files);

/// Adds --layout, --precision, --threads and --isa, which say how a scene lies in memory and what works on
/// it.
void add_layout_options(Command& command, Settings& settings);

/// Adds --method and all options that say how a scene is solved, such as --substeps, --sweeps and --gradient.
void add_solver_options(Command& command, Settings& settings);

/// Returns the option of a setting that the kernel names (MethodInfo::reads), such as --budget-us.
std::string option_of(std::string_view setting);

/// Lists methods and what they move, a line each. Help texts end with all those of the kernel's table.
std::string methods_help(const std::vector<MethodInfo>& methods = all_methods());

/// Adds the scene argument with its help.
Option add_scene(Command& command, std::string& spec);

/// Lists the generator of a scene with its parameters, or all of them where it has none, for the end of a
/// help text.
std::string generators_help(std::string_view spec = {});

}  // namespace plumb::tools
