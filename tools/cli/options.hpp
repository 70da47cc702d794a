#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "plumb/settings.hpp"
#include "scenes/runs/run.hpp"

/// Options that several commands share. All refuse nonsense with one clear line, through CLI11's own errors.
namespace plumb::tools {

/// What main runs once the command line is understood; its result is the exit status.
using Action = std::function<int()>;

/// An option that takes one of a few words, and says which.
CLI::Option* add_words(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                       std::function<void(const std::string&)> take, const std::string& help);

/// An option whose words are the names of enum values, for an Enum or an optional one.
template <class Enum, class Target>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Target& target,
                        std::initializer_list<Enum> values, const std::string& help) {
  const std::vector<Enum> list(values);
  std::vector<std::string> words;
  for (const Enum value : list) words.emplace_back(to_string(value));
  const auto take = [list, &target](const std::string& word) {
    for (const Enum value : list) {
      if (to_string(value) == word) target = value;
    }
  };
  if constexpr (std::is_same_v<Enum, Target>)
    return add_words(app, name, words, take, help + " [" + std::string(to_string(target)) + "]");
  return add_words(app, name, words, take, help);
}

/// A whole number.
CLI::Option* add_count(CLI::App& app, const std::string& name, unsigned& target, const std::string& help);

/// A positive number of seconds, as a decimal or a fraction such as 1/60.
CLI::Option* add_seconds(CLI::App& app, const std::string& name, double& target, const std::string& help);

/// A positive number, without a unit.
CLI::Option* add_positive(CLI::App& app, const std::string& name, double& target, const std::string& help);

/// --save-at: times in seconds, separated by commas.
CLI::Option* add_save_at(CLI::App& app, std::vector<double>& times, const std::string& help);

/// --layout, --precision, --threads and --isa: how a scene lies in memory and what works on it.
void add_layout_options(CLI::App& app, Settings& settings);

/// --method, --substeps, --sweeps, --tolerance, --budget-us, --order, --omega, --weights, --gradient, --mass:
/// how it is solved.
void add_solver_options(CLI::App& app, Settings& settings);

/// The scene argument, with its help.
CLI::Option* add_scene(CLI::App& app, std::string& spec);

/// The options that were given, as the user typed them, but for --quiet, which changes no results.
std::string typed_options(const CLI::App& command);

/// The generators with their parameters, for the end of a help text.
std::string generators_help();

}  // namespace plumb::tools
