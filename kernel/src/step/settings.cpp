#include "plumb/settings.hpp"

#include <cmath>
#include <string>
#include <string_view>

#include "plumb/error.hpp"
#include "scene/refuse.hpp"
#include "step/methods.hpp"

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

// The comparisons are negated, so that they refuse NaN too.
void require_positive(std::string_view name, double value, std::string_view unit) {
  if (!(value > 0 && std::isfinite(value))) refuse(name, " must be positive and finite, got ", value, unit);
}
void require_not_negative(std::string_view name, double value, std::string_view unit) {
  if (!(value >= 0 && std::isfinite(value))) refuse(name, " must be 0 or more and finite, got ", value, unit);
}

void validate_contact(const ContactSettings& contact) {
  require_positive("length scale", contact.length_scale, "");
  require_positive("contact margin", contact.margin, " m");
  require_not_negative("contact slop", contact.slop, " m");
  if (!(contact.recovery >= 0 && contact.recovery <= 1))
    refuse("contact recovery must be from 0 to 1, got ", contact.recovery);
  require_not_negative("bounce speed", contact.bounce_speed, " m/s");
  require_positive("contact tolerance", contact.tolerance, " m");
  require_positive("sweep tolerance", contact.sweep_tolerance, "");
  require_not_negative("sleep speed", contact.sleep_speed, " m/s");
}

/// Refuses by name what the method does not read, and says which methods read it.
void validate_reads(const Settings& settings, const detail::MethodRow& method) {
  for (const detail::SettingRow& row : detail::setting_rows()) {
    if (contains(method.reads, row.id) || !row.is_set(settings)) continue;
    std::string readers;
    for (const detail::MethodRow& other : detail::method_rows())
      if (contains(other.reads, row.id)) readers += (readers.empty() ? "" : ", ") + std::string(other.name);
    detail::throw_unread(row.name, {"method ", method.name, " does not read ", row.name, "; it is read by ",
                                    readers.empty() ? "no method of this program" : readers});
  }
}

}  // namespace

void validate(const Settings& settings) {
  if (!(settings.omega > 0 && settings.omega < 2)) refuse("omega must be in (0, 2), got ", settings.omega);
  if (settings.substeps == 0 || settings.substeps > most_substeps) {
    refuse("substeps must be from 1 to ", most_substeps, ", got ", settings.substeps);
  }
  if (settings.most_work == 0) refuse("most work must be at least 1, got 0");
  validate(settings.stop);
  if (settings.isa) validate_isa(*settings.isa);
  validate_contact(settings.contact);
  require_not_negative("sleep time", settings.sleep_time, " s");
  if (settings.accuracy) require_positive("accuracy", *settings.accuracy, "");
  if (settings.time_order != 2 && settings.time_order != 4 && settings.time_order != 6)
    refuse("time order must be 2, 4 or 6, got ", settings.time_order);
  require_positive("stiffness", settings.springs.stiffness, " N/m");
  require_not_negative("damping ratio", settings.springs.damping_ratio, "");
  require_positive("baumgarte rate", settings.multipliers.baumgarte_rate, " 1/s");
  const detail::MethodRow& method = detail::method_row(settings.method);
  validate_reads(settings, method);
  if (method.validate) method.validate(settings);
}

void validate(const StopRule& rule) {
  if (rule.sweeps == 0) refuse("sweeps must be at least 1, got 0");
  if (rule.tolerance) require_positive("tolerance", *rule.tolerance, "");
  if (rule.budget_us) require_positive("budget", *rule.budget_us, " us");
}

Gradient gradient_of(const Settings& settings) {
  return settings.gradient.value_or(settings.method == Method::relax ? Gradient::new_ : Gradient::mid);
}

Integrator integrator_of(const Settings& settings) {
  return settings.integrator.value_or(settings.method == Method::springs ? Integrator::implicit_euler
                                                                         : Integrator::rk4);
}

MassModel mass_model_of(const Settings& settings) {
  return settings.mass.value_or(settings.method == Method::relax ? MassModel::lumped : MassModel::consistent);
}

// Names are those of the command line. No switch has a default, so that the compiler reports a missing case.

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
  for (const detail::MethodRow& row : detail::method_rows())  // methods that a program registered itself
    if (row.method == method) return row.name;
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

std::string_view to_string(Integrator integrator) {
  switch (integrator) {
    case Integrator::explicit_euler:
      return "explicit-euler";
    case Integrator::semi_implicit_euler:
      return "semi-implicit-euler";
    case Integrator::rk2:
      return "rk2";
    case Integrator::rk4:
      return "rk4";
    case Integrator::implicit_euler:
      return "implicit-euler";
    case Integrator::adaptive_implicit_euler:
      return "adaptive-implicit-euler";
  }
  return "unknown";
}

std::string_view to_string(SpringModel model) {
  switch (model) {
    case SpringModel::rigid_rods:
      return "rods";
    case SpringModel::particles:
      return "particles";
  }
  return "unknown";
}

std::string_view to_string(Stabilization stabilization) {
  switch (stabilization) {
    case Stabilization::none:
      return "none";
    case Stabilization::baumgarte:
      return "baumgarte";
    case Stabilization::projection:
      return "projection";
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
