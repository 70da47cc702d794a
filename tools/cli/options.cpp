#include "cli/options.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;

/// The cap on sweeps when a tolerance or a budget is to stop them.
constexpr std::uint32_t sweeps_when_stopped_otherwise = 10000;

CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& unit,
                        std::function<void(double)> take, const std::string& help) {
  CLI::Option* option = app.add_option_function<std::string>(
      name,
      [name, take = std::move(take)](const std::string& text) {
        const auto value = scenes::parse_fraction(text);
        if (!value) throw CLI::ValidationError(name, "'" + text + "' is not a finite number");
        take(*value);
      },
      help);
  return option->type_name(unit);
}

}  // namespace

CLI::Option* add_words(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                       std::function<void(const std::string&)> take, const std::string& help) {
  std::string list;
  for (const std::string& word : words) append_item(list, word, "|");
  CLI::Option* option = app.add_option_function<std::string>(
      name,
      [name, words, list, take = std::move(take)](const std::string& word) {
        if (std::find(words.begin(), words.end(), word) == words.end()) {
          throw CLI::ValidationError(name, "'" + word + "' is not one of " + list);
        }
        take(word);
      },
      help);
  return option->type_name(list);
}

CLI::Option* add_count(CLI::App& app, const std::string& name, unsigned& target, const std::string& help) {
  CLI::Option* option = app.add_option_function<std::string>(
      name,
      [name, &target](const std::string& text) {
        const auto value = scenes::parse_number<unsigned>(text);
        if (!value) throw CLI::ValidationError(name, "'" + text + "' is not a whole number");
        target = *value;
      },
      help);
  return option->type_name("N");
}

CLI::Option* add_seconds(CLI::App& app, const std::string& name, double& target, const std::string& help) {
  return add_number(
      app, name, "S",
      [name, &target](double value) {
        if (!(value > 0)) throw CLI::ValidationError(name, "must be positive");
        target = value;
      },
      help);
}

CLI::Option* add_positive(CLI::App& app, const std::string& name, double& target, const std::string& help) {
  return add_number(
      app, name, "T",
      [name, &target](double value) {
        if (!(value > 0)) throw CLI::ValidationError(name, "must be positive");
        target = value;
      },
      help);
}

CLI::Option* add_save_at(CLI::App& app, std::vector<double>& times, const std::string& help) {
  CLI::Option* option = app.add_option_function<std::string>(
      "--save-at",
      [&times](const std::string& text) {
        for (const std::string& item : CLI::detail::split(text, ',')) {
          const auto t = scenes::parse_fraction(item);
          if (!t) throw CLI::ValidationError("--save-at", "'" + item + "' is not a finite number");
          times.push_back(*t);
        }
      },
      help);
  return option->type_name("T1,T2,...");
}

void add_layout_options(CLI::App& app, Settings& settings) {
  add_choice(app, "--layout", settings.layout,
             {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa},
             "How particles lie in memory");
  add_choice(app, "--precision", settings.precision, {Precision::single, Precision::double_}, "Arithmetic");
  add_count(app, "--threads", settings.threads, "Threads; 0: all there are [0]");
  std::vector<std::string> isas{"auto"};
  for (const Isa isa : all_isas()) isas.emplace_back(to_string(isa));
  add_words(
      app, "--isa", isas,
      [&settings](const std::string& word) {
        settings.isa.reset();
        for (const Isa isa : all_isas()) {
          if (word == to_string(isa)) settings.isa = isa;
        }
      },
      "Instruction set; the bits are the same with all [auto]");
}

void add_solver_options(CLI::App& app, Settings& settings) {
  settings.method = Method::automatic;
  CLI::Option* method = add_choice(app, "--method", settings.method,
                                   {Method::automatic, Method::relax, Method::direct, Method::springs,
                                    Method::multipliers, Method::featherstone},
                                   "How rods are kept at their length: the better of one after the other "
                                   "(relax) and all at once (direct), "
                                   "or the thesis's other methods; options of sweeps alone mean relax");
  add_count(app, "--substeps", settings.substeps, "Integrations per frame [1]");
  add_number(
      app, "--accuracy", "A", [&settings](double value) { settings.accuracy = value; },
      "Methods direct and auto, and springs by adaptive-implicit-euler: choose substeps so that the error "
      "grows by at most this share of the scene a second");
  CLI::Option* sweeps =
      add_count(app, "--sweeps", settings.stop.sweeps,
                "Most passes over all rods in a substep [10; 10000 with --tolerance or --budget-us]");
  // Callbacks run in the order of the options here, so `sweeps` is known by the time these are.
  const auto lift_cap = [sweeps, &settings] {
    if (sweeps->count() == 0) settings.stop.sweeps = sweeps_when_stopped_otherwise;
  };
  CLI::Option* tolerance = add_number(
      app, "--tolerance", "T",
      [&settings, lift_cap](double value) {
        settings.stop.tolerance = value;
        lift_cap();
      },
      "Stop sweeping, and iterating on a net with method direct, when no rod is stretched by more, relative "
      "to "
      "its length");
  CLI::Option* budget = add_number(
      app, "--budget-us", "U",
      [&settings, lift_cap](double value) {
        settings.stop.budget_us = value;
        lift_cap();
      },
      "Stop sweeping after this many microseconds a frame; results then depend on the clock");
  CLI::Option* order = add_choice(app, "--order", settings.order,
                                  {SweepOrder::gauss_seidel, SweepOrder::jacobi}, "Order of a sweep");
  CLI::Option* omega = add_number(
      app, "--omega", "W", [&settings](double value) { settings.omega = value; },
      "Over-relaxation, between 0 and 2 [1]");
  CLI::Option* weights = add_choice(app, "--weights", settings.weights, {Weights::mass, Weights::equal},
                                    "Share of a correction each end takes: by inverse mass or half each");
  add_choice(app, "--gradient", settings.gradient, {Gradient::new_, Gradient::old, Gradient::mid},
             "Where a correction's direction is taken [mid; relax: new]");
  add_count(app, "--time-order", settings.time_order,
            "2, 4 or 6, for method direct with gradient old: 1, 5 or 9 times the work, and that power of the "
            "step [2]");
  add_choice(app, "--mass", settings.mass, {MassModel::lumped, MassModel::consistent},
             "How a rod's own mass acts: as points at its ends, or exactly [consistent; relax: lumped]");
  add_choice(
      app, "--integrator", settings.integrator,
      {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk2, Integrator::rk4,
       Integrator::implicit_euler, Integrator::adaptive_implicit_euler},
      "Of springs, multipliers and featherstone [rk4; springs: semi-implicit-euler]; the last two are of "
      "springs");
  add_choice(app, "--springs", settings.springs.model, {SpringModel::rigid_rods, SpringModel::particles},
             "What springs join: rigid rods at their joints, or particles");
  add_positive(app, "--stiffness", settings.springs.stiffness, "Of every spring, N/m [10000]");
  add_number(
      app, "--damping-ratio", "D", [&settings](double value) { settings.springs.damping_ratio = value; },
      "Of every spring, relative to critical [0.1]");
  add_choice(app, "--stabilization", settings.multipliers.stabilization,
             {Stabilization::none, Stabilization::baumgarte, Stabilization::projection},
             "What multipliers do against drift");
  add_positive(app, "--baumgarte-rate", settings.multipliers.baumgarte_rate,
               "At which baumgarte lets violations decay, 1/s [10]");
  const std::vector<CLI::Option*> of_relaxation{sweeps, tolerance, budget, order, omega, weights};
  app.parse_complete_callback([method, tolerance, of_relaxation, &settings] {
    for (const CLI::Option* option : of_relaxation) {
      if (option->count() == 0) continue;
      if (method->count() == 0) settings.method = Method::relax;
      if (option == tolerance && settings.method == Method::direct) continue;
      if (settings.method != Method::relax && settings.method != Method::automatic)
        throw CLI::ValidationError(
            option->get_name(),
            "is of method relax; method " + std::string(to_string(settings.method)) + " has no sweeps");
    }
  });
}

CLI::Option* add_scene(CLI::App& app, std::string& spec) {
  return app.add_option("SCENE", spec, "A scene file (.json) or a generator; see below")
      ->required()
      ->type_name("");
}

std::string typed_options(const CLI::App& command) {
  std::string out;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || name == "--quiet") continue;
    out += " " + name;
    if (option->get_expected_max() > 0) out += " " + option->results().front();
  }
  return out;
}

std::string generators_help() {
  std::string out = "Scenes: a JSON file, or a generator with the parameters that differ from these:\n";
  for (const scenes::GeneratorHelp& help : scenes::list_generators()) {
    out += "  " + help.name + (help.parameters.empty() ? "" : ":" + help.parameters) + "\n      " +
           help.summary + "\n";
  }
  return out;
}

}  // namespace plumb::tools
