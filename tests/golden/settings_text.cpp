#include "golden/settings_text.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <type_traits>

#include "golden/table.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::golden {
namespace {

template <class Enum>
const std::vector<Enum> all_of = {};
template <>
const std::vector<Method> all_of<Method> = {Method::automatic, Method::relax,       Method::direct,
                                            Method::springs,   Method::multipliers, Method::featherstone};
template <>
const std::vector<Gradient> all_of<Gradient> = {Gradient::new_, Gradient::old, Gradient::mid};
template <>
const std::vector<MassModel> all_of<MassModel> = {MassModel::lumped, MassModel::consistent};
template <>
const std::vector<Weights> all_of<Weights> = {Weights::mass, Weights::equal};
template <>
const std::vector<SweepOrder> all_of<SweepOrder> = {SweepOrder::gauss_seidel, SweepOrder::jacobi};
template <>
const std::vector<Precision> all_of<Precision> = {Precision::single, Precision::double_};
template <>
const std::vector<LayoutChoice> all_of<LayoutChoice> = {LayoutChoice::automatic, LayoutChoice::aos,
                                                        LayoutChoice::soa, LayoutChoice::aosoa};
template <>
const std::vector<Integrator> all_of<Integrator> = {
    Integrator::explicit_euler, Integrator::semi_implicit_euler,    Integrator::rk2, Integrator::rk4,
    Integrator::implicit_euler, Integrator::adaptive_implicit_euler};
template <>
const std::vector<SpringModel> all_of<SpringModel> = {SpringModel::rigid_rods, SpringModel::particles};
template <>
const std::vector<Stabilization> all_of<Stabilization> = {Stabilization::none, Stabilization::baumgarte,
                                                          Stabilization::projection};

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

template <class T>
T value_of(const std::string& text) {
  if constexpr (IsOptional<T>::value) {
    if (text == "none") return {};
    return value_of<typename T::value_type>(text);
  } else if constexpr (std::is_enum_v<T>) {
    for (const T value : all_of<T>)
      if (to_string(value) == text) return value;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (text == "0" || text == "1") return text == "1";
  } else {
    if (const auto value = scenes::parse_number<T>(text)) return *value;
  }
  throw InputError("'" + text + "' is no value for it");
}

using Setter = std::function<void(Settings&, const std::string&)>;

/// What puts a value into the field that `field(settings)` refers to.
template <class Field>
Setter setter(Field field) {
  return [field](Settings& settings, const std::string& text) {
    auto& target = field(settings);
    target = value_of<std::remove_reference_t<decltype(target)>>(text);
  };
}

const std::map<std::string, Setter>& setters() {
  static const std::map<std::string, Setter> all = {
      {"method", setter([](Settings & s) -> auto& { return s.method; })},
      {"precision", setter([](Settings & s) -> auto& { return s.precision; })},
      {"gradient", setter([](Settings & s) -> auto& { return s.gradient; })},
      {"mass", setter([](Settings & s) -> auto& { return s.mass; })},
      {"weights", setter([](Settings & s) -> auto& { return s.weights; })},
      {"order", setter([](Settings & s) -> auto& { return s.order; })},
      {"omega", setter([](Settings & s) -> auto& { return s.omega; })},
      {"substeps", setter([](Settings & s) -> auto& { return s.substeps; })},
      {"time_order", setter([](Settings & s) -> auto& { return s.time_order; })},
      {"accuracy", setter([](Settings & s) -> auto& { return s.accuracy; })},
      {"sweeps", setter([](Settings & s) -> auto& { return s.stop.sweeps; })},
      {"tolerance", setter([](Settings & s) -> auto& { return s.stop.tolerance; })},
      {"integrator", setter([](Settings & s) -> auto& { return s.integrator; })},
      {"springs", setter([](Settings & s) -> auto& { return s.springs.model; })},
      {"stiffness", setter([](Settings & s) -> auto& { return s.springs.stiffness; })},
      {"damping_ratio", setter([](Settings & s) -> auto& { return s.springs.damping_ratio; })},
      {"stabilization", setter([](Settings & s) -> auto& { return s.multipliers.stabilization; })},
      {"baumgarte_rate", setter([](Settings & s) -> auto& { return s.multipliers.baumgarte_rate; })},
      {"sleep", setter([](Settings & s) -> auto& { return s.sleep; })},
      {"layout", setter([](Settings & s) -> auto& { return s.layout; })},
  };
  return all;
}

std::vector<std::string> keys_of(Method method, bool has_more_than_rods) {
  std::vector<std::string> keys{"method", "mass", "substeps"};
  const auto add = [&](std::initializer_list<const char*> more) {
    keys.insert(keys.end(), more.begin(), more.end());
  };
  const bool automatic = method == Method::automatic;
  if (automatic || method == Method::relax) add({"weights", "order", "omega", "sweeps", "layout"});
  if (automatic || method == Method::direct) add({"accuracy"});
  if (automatic || method == Method::relax || method == Method::direct)
    add({"precision", "gradient", "tolerance"});
  if (method == Method::direct) add({"time_order"});
  if (method == Method::springs) add({"integrator", "springs", "stiffness", "damping_ratio", "accuracy"});
  if (method == Method::multipliers) add({"integrator", "stabilization", "baumgarte_rate"});
  if (method == Method::featherstone) add({"integrator"});
  if (has_more_than_rods) add({"sleep"});
  return keys;
}

template <class Enum>
Choices choices(const char* key) {
  Choices out{key, {}};
  for (const Enum value : all_of<Enum>) out.values.emplace_back(to_string(value));
  return out;
}

}  // namespace

Settings parse_settings(std::string_view text, bool has_more_than_rods) {
  Settings settings;
  std::vector<std::string> given;
  for (const std::string& item : split(text, ' ')) {
    const std::size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const auto found = setters().find(key);
    if (equals == std::string::npos || found == setters().end())
      throw InputError("'" + item + "' sets nothing");
    if (std::find(given.begin(), given.end(), key) != given.end()) throw InputError(key + " is given twice");
    try {
      found->second(settings, item.substr(equals + 1));
    } catch (const InputError& error) {
      throw InputError(key + ": " + error.what());
    }
    given.push_back(key);
  }
  std::vector<std::string> wanted = keys_of(settings.method, has_more_than_rods);
  std::sort(wanted.begin(), wanted.end());
  std::sort(given.begin(), given.end());
  for (const std::string& key : wanted)
    if (!std::binary_search(given.begin(), given.end(), key)) throw InputError(key + " is not given");
  for (const std::string& key : given)
    if (!std::binary_search(wanted.begin(), wanted.end(), key))
      throw InputError(key + " is not read by method " + std::string(to_string(settings.method)));
  return settings;
}

std::vector<Choices> list_choices() {
  return {choices<Method>("method"),       choices<Gradient>("gradient"),
          choices<MassModel>("mass"),      choices<Weights>("weights"),
          choices<SweepOrder>("order"),    choices<Precision>("precision"),
          choices<LayoutChoice>("layout"), choices<Integrator>("integrator"),
          choices<SpringModel>("springs"), choices<Stabilization>("stabilization"),
          {"time_order", {"2", "4", "6"}}, {"sleep", {"0", "1"}}};
}

}  // namespace plumb::golden
