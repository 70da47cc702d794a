#include "view/exhibit/choices.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>

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
    throw InputError(std::string(name) + " must be a whole number, not '" + std::string(text) + "'");
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

Settings relaxed(Weights weights) {
  return {.method = Method::relax,
          .gradient = Gradient::mid,
          .weights = weights,
          .substeps = 4,
          .stop = {.sweeps = 10}};
}

Settings direct() {
  return {.method = Method::direct, .substeps = 8};
}

Settings relaxed_by(Gradient gradient) {
  Settings out = relaxed(Weights::mass);
  out.gradient = gradient;
  return out;
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

Settings readable(const Settings& settings) {
  const std::vector<MethodInfo> all = all_methods();
  const auto info = std::find_if(all.begin(), all.end(),
                                 [&](const MethodInfo& each) { return each.method == settings.method; });
  const auto reads = [&](std::string_view name) {
    return info != all.end() && std::find(info->reads.begin(), info->reads.end(), name) != info->reads.end();
  };
  Settings out = settings;
  if (!reads("gradient")) out.gradient.reset();
  if (!reads("weights")) out.weights = {};
  if (!reads("order")) out.order = {};
  if (!reads("sweeps")) out.stop.sweeps = StopRule{}.sweeps;
  if (!reads("tolerance")) out.stop.tolerance.reset();
  if (!reads("accuracy")) out.accuracy.reset();
  if (!reads("tensions")) out.tensions = false;
  return out;
}

std::vector<Comparison> comparisons() {
  return {{"mass against equal",
           "Corrections by mass follow the truth. Equal ones move otherwise, whatever the end weighs.",
           {{"direct", direct()}, {"by mass", relaxed(Weights::mass)}, {"equal", relaxed(Weights::equal)}}},
          {"relax against direct",
           "One rod after the other, few times, against all rods at once.",
           {{"direct", direct()}, {"relaxed", relaxed(Weights::mass)}}},
          {"gradients",
           "Where a correction's direction is taken decides how much energy a step loses.",
           {{"direct", direct()},
            {"new", relaxed_by(Gradient::new_)},
            {"old", relaxed_by(Gradient::old)},
            {"mid", relaxed_by(Gradient::mid)}}},
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

}  // namespace plumb::view
