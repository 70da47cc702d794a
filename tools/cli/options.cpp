#include "cli/options.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/nearest.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;

/// This is the cap on sweeps where a tolerance or a budget is to stop them.
constexpr std::uint32_t sweeps_when_stopped_otherwise = 10000;

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  using std::filesystem::absolute;
  using std::filesystem::weakly_canonical;
  return !b.empty() && weakly_canonical(absolute(a)) == weakly_canonical(absolute(b));
}

Option add_number(Command& command, const std::string& name, const std::string& unit,
                  std::function<void(double)> take, const std::string& help) {
  const auto read = [take = std::move(take)](const std::string& text) {
    const auto value = scenes::parse_fraction(text);
    if (!value) throw BadValue("'" + text + "' is not a finite number");
    take(*value);
  };
  return command.add_option(name, unit, read, help);
}

Option add_positive_of(const std::string& unit, Command& command, const std::string& name, double& target,
                       const std::string& help) {
  const auto take = [&target](double value) {
    if (!(value > 0)) throw BadValue("must be positive");
    target = value;
  };
  return add_number(command, name, unit, take, help);
}

void add_method(Command& command, Settings& settings) {
  settings.method = Method::automatic;
  std::vector<Method> methods;
  for (const MethodInfo& info : all_methods()) methods.push_back(info.method);
  add_choice(command, "--method", settings.method, methods,
             "How rods are kept at their length; see the list of methods below");
}

void add_sweep_options(Command& command, Settings& settings) {
  const Option sweeps =
      add_count(command, "--sweeps", settings.stop.sweeps,
                "Most passes over all rods in a substep [10; 10000 with --tolerance or --budget-us]");
  // Values are taken in the order of the options here, so `sweeps` is known by the time these are.
  const auto lift_cap = [sweeps, &settings] {
    if (!sweeps.given() && settings.method != Method::direct)
      settings.stop.sweeps = sweeps_when_stopped_otherwise;
  };
  const auto take_tolerance = [&settings, lift_cap](double value) {
    settings.stop.tolerance = value;
    lift_cap();
  };
  const auto take_budget = [&settings, lift_cap](double value) {
    settings.stop.budget_us = value;
    lift_cap();
  };
  add_number(
      command, "--tolerance", "T", take_tolerance,
      "Stop sweeping, and iterating on a net with method direct, when no rod is stretched by more, relative "
      "to its length");
  add_number(command, "--budget-us", "U", take_budget,
             "Stop sweeping after this many microseconds a frame; results then depend on the clock");
  add_choice(command, "--order", settings.order, {SweepOrder::gauss_seidel, SweepOrder::jacobi},
             "Order of a sweep");
  add_number(
      command, "--omega", "W", [&settings](double value) { settings.omega = value; },
      "Over-relaxation, between 0 and 2 [1]");
  add_choice(command, "--weights", settings.weights, {Weights::mass, Weights::equal},
             "Share of a correction each end takes: by inverse mass or half each");
}

void add_bounds(Command& command, Settings& settings) {
  const auto take_work = [&settings](const std::string& text) {
    settings.most_work = whole_number<std::uint64_t>(text, {});
  };
  command.add_option("--most-work", "N", take_work,
                     "Newton steps, sweeps and substeps of an island in a frame, at most, beyond those that "
                     "are asked for [20000]");
  add_seconds(command, "--sleep-time", settings.sleep_time,
              "Time that an island is at rest before it sleeps, s [0.5]");
  add_positive(command, "--length-scale", settings.contact.length_scale,
               "Size of the things that touch, m: lengths and speeds of contact are in proportion [1]");
}

/// Returns the names of the methods that read a setting, as the kernel's table says.
std::string readers_of(std::string_view setting) {
  std::string out;
  for (const MethodInfo& info : all_methods())
    if (std::find(info.reads.begin(), info.reads.end(), setting) != info.reads.end())
      append_item(out, info.name);
  return out;
}

/// Adds the options of methods that integrate equations of motion.
void add_equation_options(Command& command, Settings& settings) {
  add_choice(command, "--integrator", settings.integrator,
             {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk2, Integrator::rk4,
              Integrator::implicit_euler, Integrator::adaptive_implicit_euler},
             "Of " + readers_of("integrator") +
                 " [rk4; springs: implicit-euler, which no stiffness breaks]; the last two are of springs");
  add_choice(command, "--springs", settings.springs.model, {SpringModel::rigid_rods, SpringModel::particles},
             "What springs join: rigid rods at their joints, or particles");
  add_positive(command, "--stiffness", settings.springs.stiffness, "Of every spring, N/m [10000]");
  add_number(
      command, "--damping-ratio", "D", [&settings](double value) { settings.springs.damping_ratio = value; },
      "Of every spring, relative to critical [0.1]");
  add_choice(command, "--stabilization", settings.multipliers.stabilization,
             {Stabilization::none, Stabilization::baumgarte, Stabilization::projection},
             "What multipliers do against drift");
  add_positive(command, "--baumgarte-rate", settings.multipliers.baumgarte_rate,
               "At which baumgarte lets violations decay, 1/s [10]");
}

}  // namespace

Option add_words(Command& command, const std::string& name, const std::vector<std::string>& words, Take take,
                 const std::string& help) {
  std::string list;
  for (const std::string& word : words) append_item(list, word, "|");
  const auto check = [words, list, take = std::move(take)](const std::string& word) {
    if (std::find(words.begin(), words.end(), word) == words.end())
      throw BadValue("'" + word + "' is not one of " + list + scenes::did_you_mean(word, words));
    take(word);
  };
  return command.add_option(name, list, check, help);
}

Option add_count(Command& command, const std::string& name, unsigned& target, const std::string& help,
                 Whole<unsigned> range) {
  const auto take = [&target, range](const std::string& text) { target = whole_number(text, range); };
  return command.add_option(name, "N", take, help);
}

Option add_seconds(Command& command, const std::string& name, double& target, const std::string& help) {
  return add_positive_of("S", command, name, target, help);
}

Option add_positive(Command& command, const std::string& name, double& target, const std::string& help) {
  return add_positive_of("T", command, name, target, help);
}

Option add_winches(Command& command, std::vector<scenes::LengthRate>& rates) {
  const auto take = [&rates](const std::string& text) {
    rates.clear();
    for (const std::string& item : scenes::split_list(text)) {
      const std::size_t colon = item.find(':');
      const auto rod = scenes::parse_number<std::uint32_t>(item.substr(0, colon));
      const auto rate =
          colon == std::string::npos ? std::nullopt : scenes::parse_number<double>(item.substr(colon + 1));
      if (!rod || !rate) throw BadValue("must be pairs of a rod and a rate, such as 0:-0.5");
      rates.push_back({*rod, *rate});
    }
  };
  return command.add_option(
      "--winch", "ROD:RATE,...", take,
      "Rods whose length changes all the time, at rates in m/s; below 0 they become shorter");
}

Option add_save_at(Command& command, std::vector<double>& times, const std::string& help) {
  const auto take = [&times](const std::string& text) {
    for (const std::string& item : scenes::split_list(text)) {
      const auto t = scenes::parse_fraction(item);
      if (!t) throw BadValue("'" + item + "' is not a finite number");
      times.push_back(*t);
    }
  };
  return command.add_option("--save-at", "T1,T2,...", take, help);
}

void add_layout_options(Command& command, Settings& settings) {
  add_choice(command, "--layout", settings.layout,
             {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa},
             "How particles lie in memory");
  add_choice(command, "--precision", settings.precision, {Precision::single, Precision::double_},
             "Arithmetic");
  add_count(command, "--threads", settings.threads, "Threads, at most 64; 0: all there are [0]",
            {.most = 64});
  std::vector<std::string> isas{"auto"};
  for (const Isa isa : all_isas()) isas.emplace_back(to_string(isa));
  add_words(
      command, "--isa", isas,
      [&settings](const std::string& word) {
        settings.isa.reset();
        for (const Isa isa : all_isas()) {
          if (word == to_string(isa)) settings.isa = isa;
        }
      },
      "Instruction set; the bits are the same with all [auto]");
}

void add_solver_options(Command& command, Settings& settings) {
  add_method(command, settings);
  add_count(command, "--substeps", settings.substeps, "Integrations per frame [1]");
  add_number(
      command, "--accuracy", "A", [&settings](double value) { settings.accuracy = value; },
      "Methods direct and auto, and springs by adaptive-implicit-euler: choose substeps so that the error "
      "grows by at most this share of the scene a second");
  add_bounds(command, settings);
  add_sweep_options(command, settings);
  add_choice(command, "--gradient", settings.gradient, {Gradient::new_, Gradient::old, Gradient::mid},
             "Where a correction's direction is taken [mid; relax: new; joints: old]");
  add_count(command, "--time-order", settings.time_order,
            "2, 4 or 6, for method direct with gradient old: 1, 5 or 9 times the work, and that power of the "
            "step [2]");
  add_choice(command, "--mass", settings.mass, {MassModel::lumped, MassModel::consistent},
             "How a rod's own mass acts: as points at its ends, or exactly [consistent; relax: lumped]");
  add_equation_options(command, settings);
}

std::string option_of(std::string_view setting) {
  if (setting == "budget") return "--budget-us";
  if (setting == "contact") return "--length-scale";
  std::string out = "--" + std::string(setting);
  std::replace(out.begin(), out.end(), ' ', '-');
  return out;
}

std::string methods_help(const std::vector<MethodInfo>& methods) {
  std::size_t widest = 0;
  for (const MethodInfo& info : methods) widest = std::max(widest, info.name.size());
  std::string out = "Methods, and what each moves:\n";
  for (const MethodInfo& info : methods) {
    const std::string name(info.name);
    out += "  " + name + std::string(widest + 2 - name.size(), ' ') + std::string(info.moves) + "\n";
  }
  return out;
}

Option add_scene(Command& command, std::string& spec) {
  return command.add_option("SCENE", "", spec, "A scene file (.json) or a generator; see below").required();
}

std::string generators_help(std::string_view spec) {
  const std::string_view named = spec.substr(0, spec.find(':'));
  std::string all, own;
  for (const scenes::GeneratorHelp& help : scenes::list_generators()) {
    const std::string text = "  " + help.name + (help.parameters.empty() ? "" : ":" + help.parameters) +
                             "\n      " + help.summary + "\n";
    all += text;
    if (help.name == named)
      own = "This scene, with its parameters as they are by default:\n" + text +
            "Every scene also takes stiffness, damping, strength and cables.\n";
  }
  if (!own.empty()) return own;
  return "Scenes: a JSON file, or a generator with the parameters that differ from these:\n" + all;
}

void require_different_files(const std::vector<std::pair<std::string, std::string>>& files) {
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t j = i + 1; j < files.size(); ++j)
      if (!files[i].second.empty() && same_file(files[i].second, files[j].second))
        throw InputError(files[i].first + " and " + files[j].first + " name the same file, " +
                         files[j].second);
}

}  // namespace plumb::tools
