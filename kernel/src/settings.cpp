#include "plumb/settings.hpp"

#include <cmath>
#include <string>

#include "plumb/error.hpp"
#include "refuse.hpp"

namespace plumb {
namespace {

using detail::refuse;

constexpr std::uint32_t most_substeps = 1'000'000;

void validate_isa(Isa isa) {
  if (is_supported(isa)) return;
  std::string list;
  for (const Isa each : all_isas())
    if (is_supported(each)) list += (list.empty() ? "" : ", ") + std::string(to_string(each));
  refuse("this machine or build does not run instruction set ", to_string(isa), "; it runs ", list);
}

}  // namespace

void validate(const Settings& settings) {
  if (!(settings.omega > 0 && settings.omega < 2)) refuse("omega must be in (0, 2), got ", settings.omega);
  if (settings.substeps == 0 || settings.substeps > most_substeps) {
    refuse("substeps must be from 1 to ", most_substeps, ", got ", settings.substeps);
  }
  validate(settings.stop);
  if (settings.isa) validate_isa(*settings.isa);
  if (settings.method != Method::automatic && settings.method != Method::relax &&
      settings.method != Method::direct) {
    throw NotBuiltError("method " + std::string(to_string(settings.method)) + " is not built yet");
  }
  if (settings.accuracy && !(*settings.accuracy > 0 && std::isfinite(*settings.accuracy)))
    refuse("accuracy must be positive and finite, got ", *settings.accuracy);
  if (settings.accuracy && settings.method == Method::relax)
    refuse("accuracy needs method direct or auto: relaxation is set by substeps and sweeps");
  if (mass_model_of(settings) == MassModel::consistent && settings.method == Method::relax)
    refuse("mass consistent needs method direct or auto: relaxation moves particles one by one");
}

void validate(const StopRule& rule) {
  if (rule.sweeps == 0) refuse("sweeps must be at least 1, got 0");
  // Negated comparisons, so that NaN is refused too.
  if (rule.tolerance && !(*rule.tolerance > 0 && std::isfinite(*rule.tolerance))) {
    refuse("tolerance must be positive and finite, got ", *rule.tolerance);
  }
  if (rule.budget_us && !(*rule.budget_us > 0 && std::isfinite(*rule.budget_us))) {
    refuse("budget must be positive and finite, got ", *rule.budget_us, " us");
  }
}

Gradient gradient_of(const Settings& settings) {
  return settings.gradient.value_or(settings.method == Method::relax ? Gradient::new_ : Gradient::mid);
}

MassModel mass_model_of(const Settings& settings) {
  return settings.mass.value_or(settings.method == Method::relax ? MassModel::lumped : MassModel::consistent);
}

// The names are those of the command line. No switch has a default, so that the compiler names a missing
// case.

std::string_view to_string(Method method) {
  switch (method) {
    case Method::automatic:
      return "auto";
    case Method::relax:
      return "relax";
    case Method::direct:
      return "direct";
    case Method::springs:
      return "springs";
    case Method::multipliers:
      return "multipliers";
    case Method::featherstone:
      return "featherstone";
  }
  return "unknown";
}

std::string_view to_string(Precision precision) {
  switch (precision) {
    case Precision::single:
      return "float";
    case Precision::double_:
      return "double";
  }
  return "unknown";
}

std::string_view to_string(Gradient gradient) {
  switch (gradient) {
    case Gradient::new_:
      return "new";
    case Gradient::old:
      return "old";
    case Gradient::mid:
      return "mid";
  }
  return "unknown";
}

std::string_view to_string(MassModel model) {
  switch (model) {
    case MassModel::lumped:
      return "lumped";
    case MassModel::consistent:
      return "consistent";
  }
  return "unknown";
}

std::string_view to_string(Weights weights) {
  switch (weights) {
    case Weights::mass:
      return "mass";
    case Weights::equal:
      return "equal";
  }
  return "unknown";
}

std::string_view to_string(SweepOrder order) {
  switch (order) {
    case SweepOrder::gauss_seidel:
      return "gauss-seidel";
    case SweepOrder::jacobi:
      return "jacobi";
  }
  return "unknown";
}

std::string_view to_string(LayoutChoice layout) {
  switch (layout) {
    case LayoutChoice::automatic:
      return "auto";
    case LayoutChoice::aos:
      return "aos";
    case LayoutChoice::soa:
      return "soa";
    case LayoutChoice::aosoa:
      return "aosoa";
  }
  return "unknown";
}

}  // namespace plumb
