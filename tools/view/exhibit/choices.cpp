#include "view/exhibit/choices.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <type_traits>
#include <utility>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::view {
namespace {

using scenes::parse_number;

template <class Enum>
Enum word(std::string_view name, std::string_view text, const std::vector<Enum>& values) {
  std::string known;
  for (const Enum value : values) {
    if (to_string(value) == text) return value;
    scenes::append_item(known, to_string(value));
  }
  throw InputError(std::string(name) + " '" + std::string(text) + "' is not one of " + known);
}

std::uint32_t count(std::string_view name, std::string_view text) {
  const auto value = parse_number<std::uint32_t>(text);
  if (!value)
    throw InputError(std::string(name) + " must be a whole number from 0 on, not '" + std::string(text) +
                     "'");
  return *value;
}

std::optional<double> share(std::string_view name, std::string_view text) {
  if (text == "off") return {};
  const auto value = parse_number<double>(text);
  if (!value)
    throw InputError(std::string(name) + " must be a number or off, not '" + std::string(text) + "'");
  return value;
}

std::string share_text(const std::optional<double>& value) {
  return value ? scenes::short_number(*value, 17) : "off";
}

std::vector<Method> methods() {
  std::vector<Method> out;
  for (const MethodInfo& info : all_methods()) out.push_back(info.method);
  return out;
}

const std::vector<Gradient> gradients{Gradient::new_, Gradient::old, Gradient::mid};

/// A setting that no page changes, as a text.
struct Rest {
  std::string_view name;
  std::string (*write)(const Settings&);
  void (*read)(Settings&, std::string_view text);
};

template <class Number>
Number number(std::string_view name, std::string_view text) {
  const auto value = parse_number<Number>(text);
  if (!value) throw InputError(std::string(name) + " must be a number, not '" + std::string(text) + "'");
  return *value;
}

template <class Enum>
std::string word_or_auto(const std::optional<Enum>& value) {
  return value ? std::string(to_string(*value)) : "auto";
}

std::string exact(double value) {
  return scenes::short_number(value, 17);
}

const std::vector<Integrator> integrators{
    Integrator::explicit_euler, Integrator::semi_implicit_euler,    Integrator::rk2, Integrator::rk4,
    Integrator::implicit_euler, Integrator::adaptive_implicit_euler};

/// Makes a row of a number that `member` finds in settings.
template <class Member>
Rest number_row(std::string_view name, Member) {
  return {name, [](const Settings& s) { return exact(Member{}(s)); },
          [](Settings& s, std::string_view text) { Member{}(s) = number<double>("a setting", text); }};
}
template <class Member>
Rest count_row(std::string_view name, Member) {
  using Number = std::remove_cvref_t<decltype(Member{}(std::declval<Settings&>()))>;
  return {name, [](const Settings& s) { return std::to_string(Member{}(s)); },
          [](Settings& s, std::string_view text) { Member{}(s) = number<Number>("a setting", text); }};
}

std::vector<Rest> words_of_rest() {
  return {
      {"precision", [](const Settings& s) { return std::string(to_string(s.precision)); },
       [](Settings& s, std::string_view text) {
         s.precision = word<Precision>("precision", text, {Precision::single, Precision::double_});
       }},
      {"mass", [](const Settings& s) { return word_or_auto(s.mass); },
       [](Settings& s, std::string_view text) {
         s.mass.reset();
         if (text != "auto")
           s.mass = word<MassModel>("mass", text, {MassModel::lumped, MassModel::consistent});
       }},
      {"integrator", [](const Settings& s) { return word_or_auto(s.integrator); },
       [](Settings& s, std::string_view text) {
         s.integrator.reset();
         if (text != "auto") s.integrator = word("integrator", text, integrators);
       }},
      {"springs", [](const Settings& s) { return std::string(to_string(s.springs.model)); },
       [](Settings& s, std::string_view text) {
         s.springs.model =
             word<SpringModel>("springs", text, {SpringModel::rigid_rods, SpringModel::particles});
       }},
      {"stabilization", [](const Settings& s) { return std::string(to_string(s.multipliers.stabilization)); },
       [](Settings& s, std::string_view text) {
         s.multipliers.stabilization =
             word<Stabilization>("stabilization", text,
                                 {Stabilization::none, Stabilization::baumgarte, Stabilization::projection});
       }},
      {"layout", [](const Settings& s) { return std::string(to_string(s.layout)); },
       [](Settings& s, std::string_view text) {
         s.layout = word<LayoutChoice>(
             "layout", text,
             {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa});
       }}};
}

std::vector<Rest> rest() {
  std::vector<Rest> out = words_of_rest();
  out.insert(out.end(), {number_row(
                             "omega", [](auto& s) -> auto& { return s.omega; }),
                         count_row(
                             "time_order", [](auto& s) -> auto& { return s.time_order; }),
                         count_row(
                             "most_work", [](auto& s) -> auto& { return s.most_work; }),
                         number_row(
                             "stiffness", [](auto& s) -> auto& { return s.springs.stiffness; }),
                         number_row(
                             "damping_ratio", [](auto& s) -> auto& { return s.springs.damping_ratio; }),
                         number_row(
                             "baumgarte_rate", [](auto& s) -> auto& { return s.multipliers.baumgarte_rate; }),
                         number_row(
                             "sleep_time", [](auto& s) -> auto& { return s.sleep_time; }),
                         number_row(
                             "length_scale", [](auto& s) -> auto& { return s.contact.length_scale; })});
  return out;
}

Settings relaxed(Weights weights) {
  return {.method = Method::relax,
          .gradient = Gradient::mid,
          .weights = weights,
          .substeps = 4,
          .stop = {.sweeps = 10}};
}

/// Sweeps for the thesis's comparison: as many substeps as the reference, and enough for an end of 1,000
/// times the mass of a link. In 12 s corrections by mass then stay nearer than equal ones at any end mass of
/// the page.
Settings relaxed_closely(Weights weights) {
  Settings out = relaxed(weights);
  out.substeps = 8;
  out.stop.sweeps = 20;
  return out;
}

Settings direct() {
  return {.method = Method::direct, .substeps = 8};
}

Settings accurate(double accuracy) {
  return {.method = Method::direct, .accuracy = accuracy};
}

Settings relaxed_by(Gradient gradient) {
  Settings out = relaxed(Weights::mass);
  out.gradient = gradient;
  return out;
}

bool does_read(Method method, std::string_view setting) {
  for (const MethodInfo& each : all_methods())
    if (each.method == method) return std::count(each.reads.begin(), each.reads.end(), setting) > 0;
  return false;
}

/// Returns the settings that a name of a side stands for: those of a comparison's, or of a method. Nothing
/// stands for other names.
std::optional<Settings> settings_named(std::string_view name) {
  while (name.ends_with(again)) name.remove_suffix(again.size());
  for (const Comparison& each : comparisons())
    for (const SideStart& side : each.sides)
      if (side.name == name) return side.settings;
  for (const Method method : methods())
    if (to_string(method) == name) return Settings{.method = method};
  return {};
}

}  // namespace

void set_choice(Settings& settings, std::string_view name, std::string_view text) {
  if (name == "method") {
    settings.method = word(name, text, methods());
  } else if (name == "gradient") {
    settings.gradient = text == "auto" ? std::nullopt : std::optional(word(name, text, gradients));
  } else if (name == "weights") {
    settings.weights = word<Weights>(name, text, {Weights::mass, Weights::equal});
  } else if (name == "order") {
    settings.order = word<SweepOrder>(name, text, {SweepOrder::gauss_seidel, SweepOrder::jacobi});
  } else if (name == "substeps") {
    settings.substeps = count(name, text);
  } else if (name == "sweeps") {
    settings.stop.sweeps = count(name, text);
  } else if (name == "tolerance") {
    settings.stop.tolerance = share(name, text);
  } else if (name == "accuracy") {
    settings.accuracy = share(name, text);
  } else {
    throw InputError("no setting '" + std::string(name) +
                     "'; known are method, gradient, weights, order, substeps, sweeps, tolerance, accuracy, "
                     "gravity, drag and end_mass");
  }
}

scenes::Json choices_json(const Settings& settings) {
  return {{"method", to_string(settings.method)},
          {"gradient", settings.gradient ? to_string(*settings.gradient) : "auto"},
          {"weights", to_string(settings.weights)},
          {"order", to_string(settings.order)},
          {"substeps", std::to_string(settings.substeps)},
          {"sweeps", std::to_string(settings.stop.sweeps)},
          {"tolerance", share_text(settings.stop.tolerance)},
          {"accuracy", share_text(settings.accuracy)}};
}

scenes::Json all_settings_json(const Settings& settings) {
  scenes::Json out = choices_json(settings);
  for (const Rest& each : rest()) out[each.name] = each.write(settings);
  return out;
}

void read_setting(Settings& settings, std::string_view name, std::string_view text) {
  for (const Rest& each : rest())
    if (each.name == name) {
      each.read(settings, text);
      return;
    }
  set_choice(settings, name, text);
}

Settings readable(const Settings& settings) {
  const auto reads = [&](std::string_view name) { return does_read(settings.method, name); };
  Settings out = settings;
  if (!reads("gradient")) out.gradient.reset();
  if (!reads("weights")) out.weights = {};
  if (!reads("order")) out.order = {};
  if (!reads("sweeps")) out.stop.sweeps = StopRule{}.sweeps;
  if (!reads("tolerance")) out.stop.tolerance.reset();
  if (!reads("accuracy")) out.accuracy.reset();
  if (!reads("tensions")) out.tensions = false;
  if (!reads("most work")) out.most_work = Settings{}.most_work;
  if (!reads("sleep time")) out.sleep_time = Settings{}.sleep_time;
  return out;
}

bool forget(Settings& settings, std::string_view setting) {
  const Settings usual;
  if (setting == "weights")
    settings.weights = usual.weights;
  else if (setting == "order")
    settings.order = usual.order;
  else if (setting == "sweeps")
    settings.stop.sweeps = usual.stop.sweeps;
  else if (setting == "tolerance")
    settings.stop.tolerance.reset();
  else
    return false;
  return true;
}

std::string name_now(const SideStart& side) {
  std::string out = side.name;
  const std::optional<Settings> named = settings_named(side.name);
  if (!named) return out;
  const Settings& now = side.settings;
  const auto add = [&out](const std::string& word) { out += " · " + word; };
  const auto changes = [&](std::string_view setting, const std::string& before, const std::string& after) {
    if (after != before && does_read(now.method, setting)) add(std::string(setting) + " " + after);
  };
  if (now.method != named->method) add(std::string(to_string(now.method)));
  changes("gradient", word_or_auto(named->gradient), word_or_auto(now.gradient));
  changes("weights", std::string(to_string(named->weights)), std::string(to_string(now.weights)));
  changes("accuracy", share_text(named->accuracy), share_text(now.accuracy));
  return out;
}

std::vector<Comparison> comparisons() {
  return {
      {"mass against equal",
       "Two worlds correct one rod or contact after the other. The pale reference solves all at once.",
       {{"direct", direct()},
        {"by mass", relaxed_closely(Weights::mass)},
        {"equal", relaxed_closely(Weights::equal)}},
       "Move End mass."},
      {"relax against direct",
       "One rod after the other, few times, against all rods at once.",
       {{"direct", direct()}, {"relaxed", relaxed(Weights::mass)}}},
      {"gradients",
       "Where a correction's direction is taken decides how much energy a step loses.",
       {{"direct", direct()},
        {"new", relaxed_by(Gradient::new_)},
        {"old", relaxed_by(Gradient::old)},
        {"mid", relaxed_by(Gradient::mid)}}},
      {"error against truth",
       "Distances are errors while the first world keeps its accuracy of 1e-7 and motions have not parted. "
       "Later they tell only how differences grow.",
       {{"truth", accurate(1e-7)}, {"direct", direct()}, {"relaxed", relaxed(Weights::mass)}}},
      {"one world", "A single world, by method auto.", {{"auto", {.substeps = 2}}}}};
}

Comparison comparison(std::string_view name) {
  std::string known;
  for (Comparison& each : comparisons()) {
    if (each.name == name) return each;
    scenes::append_item(known, each.name);
  }
  throw InputError("no comparison '" + std::string(name) + "'; known are " + known);
}

Comparison comparison_of(const std::vector<std::string>& names) {
  for (Comparison& each : comparisons())
    if (std::equal(each.sides.begin(), each.sides.end(), names.begin(), names.end(),
                   [](const SideStart& side, const std::string& name) { return side.name == name; }))
      return each;
  return {};
}

}  // namespace plumb::view
