#include "scenes/runs/counters.hpp"

#include <type_traits>

#include "scenes/basics/numbers.hpp"

namespace plumb::scenes {
namespace {

constexpr Counter table[] = {
    {"steps", &StepReport::substeps, "substeps of the world"},
    {"sweeps", &StepReport::block_sweeps, "sweeps over a block"},
    {"rod_projections", &StepReport::rod_projections, "rods projected"},
    {"within_tolerance", &StepReport::skipped_within_tolerance, "blocks not swept, within tolerance",
     "skipped"},
    {"mid_guarded", &StepReport::mid_guarded, "substeps in which gradient mid did not converge"},
    {"frozen_islands", &StepReport::frozen_islands, "islands that went non-finite"},
    {"direct_substeps", &StepReport::direct_substeps, "substeps of islands solved directly"},
    {"newton", &StepReport::newton, "Newton steps"},
    {"halvings", &StepReport::halvings, "substeps cut in two"},
    {"fallbacks", &StepReport::fallbacks, "substeps that fell back to a way that damps"},
    {"repeated_steps", &StepReport::repeated_steps, "steps repeated to be accurate"},
    {"elastic_substeps", &StepReport::elastic_substeps, "substeps with elastic rods"},
    {"unsolved", &StepReport::unsolved, "substeps not solved"},
    {"inaccurate_steps", &StepReport::inaccurate_steps, "steps taken though not accurate enough"},
    {"capped_steps", &StepReport::capped_steps, "steps that reached the most work"},
    {"step_us", &StepReport::step_us, "time of steps with a budget, us", "budget"},
    {"asked_us", &StepReport::asked_us, "time that all substeps would have taken, us", "budget"},
    {"broken_rods", &StepReport::broken_rods, "rods that broke"},
    {"largest_gap", &StepReport::largest_gap, "largest gap at a joint, m"},
    {"rms_gap", &StepReport::rms_gap, "RMS gap at joints, m"},
    {"points", &StepReport::contact_points, "most points touched at once", "contact"},
    {"guarded_energy", &StepReport::guarded_energy, "substeps kept from gaining energy by contact",
     "contact"},
    {"trimmed_energy", &StepReport::trimmed_energy, "substeps kept from gaining a little energy", "contact"},
    {"missed_contacts", &StepReport::missed_contacts, "substeps that left something in ground", "contact"},
    {"awake_islands", &StepReport::awake_islands, "islands awake at last"},
    {"fell_asleep", &StepReport::fell_asleep, "islands that fell asleep"},
};

}  // namespace

std::span<const Counter> counters() {
  return table;
}

Json value_of(const Counter& counter, const StepReport& report) {
  return std::visit([&](auto member) { return Json(report.*member); }, counter.member);
}

std::string text_of(const Counter& counter, const StepReport& report) {
  const auto text = [&](auto member) {
    const auto value = report.*member;
    if constexpr (std::is_floating_point_v<decltype(value)>)
      return short_number(value);
    else
      return std::to_string(value);
  };
  return std::visit(text, counter.member);
}

bool is_counted(const Counter& counter, const StepReport& report) {
  return std::visit([&](auto member) { return report.*member != 0; }, counter.member);
}

std::string flat_name(const Counter& counter) {
  return counter.group.empty() ? std::string(counter.name)
                               : std::string(counter.group) + "_" + std::string(counter.name);
}

void add_counters(Json& object, std::string_view group, const StepReport& report) {
  for (const Counter& counter : table)
    if (counter.group == group) object[counter.name] = value_of(counter, report);
}

}  // namespace plumb::scenes
