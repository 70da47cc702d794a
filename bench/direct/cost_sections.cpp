#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "contest/case.hpp"
#include "direct/goal.hpp"
#include "direct/newton_cost.hpp"
#include "direct/sections.hpp"
#include "scenes/basics/numbers.hpp"
#include "support/sheet.hpp"

namespace plumb::bench {
namespace {

using scenes::plain_number;
using scenes::short_number;

std::string contestant(const NewtonCost& cost) {
  return cost.alone ? "alone" : std::string(to_string(cost.isa));
}

void append_csv(std::string& csv, const char* section, const std::vector<NewtonCost>& costs) {
  for (const NewtonCost& cost : costs) {
    const std::string start =
        std::string(section) + ",links:" + std::to_string(cost.links) + "," + contestant(cost) + ",";
    const std::string setting =
        std::string(to_string(cost.gradient)) + " " + std::string(number_name(cost.precision)) + "\n";
    csv += start + "substep," + short_number(cost.substep_ns) + ",ns per rod," + setting;
    csv += start + "newton_step," + short_number(cost.newton_ns) + ",ns per rod," + setting;
    csv += start + "newton_kernel," + short_number(cost.kernel_ns) + ",ns per rod," + setting;
    csv += start + "newton_per_substep," + short_number(cost.newton_per_substep) + ",," + setting;
  }
}

/// Makes one row per contestant. Ratios are to the contestant of the same numbers and gradient that is alone.
Sheet cost_sheet(const std::vector<NewtonCost>& costs) {
  Sheet sheet({"", "links", "gradient", "numbers", "substep", "Newton steps", "per Newton step", "kernel",
               "substep, alone / this", "kernel, alone / this", "substep, scalar / this", "halvings"});
  for (const NewtonCost& cost : costs) {
    const NewtonCost *alone = nullptr, *scalar = nullptr;
    for (const NewtonCost& other : costs) {
      if (other.links != cost.links || other.gradient != cost.gradient || other.precision != cost.precision)
        continue;
      if (other.alone) alone = &other;
      if (!other.alone && other.isa == Isa::scalar) scalar = &other;
    }
    sheet.add_row({contestant(cost), std::to_string(cost.links), std::string(to_string(cost.gradient)),
                   std::string(number_name(cost.precision)), plain_number(cost.substep_ns),
                   plain_number(cost.newton_per_substep), plain_number(cost.newton_ns),
                   plain_number(cost.kernel_ns), plain_number(alone->substep_ns / cost.substep_ns),
                   plain_number(alone->kernel_ns / cost.kernel_ns),
                   plain_number(scalar->substep_ns / cost.substep_ns), std::to_string(cost.halvings)});
  }
  return sheet;
}

struct NamedLaw {
  const char* name;
  RodLaw law;
};
/// The first is what others are compared with.
const std::vector<NamedLaw>& named_laws() {
  static const std::vector<NamedLaw> laws{
      {"rigid", {}},
      {"elastic", {.stiffness = 1e5}},
      {"damped", {.stiffness = 1e5, .damping = 10}},
      {"elastic cables", {.stiffness = 1e5, .one_sided = true}},
      {"rigid cables", {.one_sided = true}},
  };
  return laws;
}
constexpr std::array form_names{"alone", "in lanes", "in segments"};

/// Returns ns per rod of a Newton step with its share of a substep that takes `count` of them.
double step_ns(const NewtonCost& cost, double count) {
  return (cost.substep_ns - cost.newton_per_substep * cost.kernel_ns) / count + cost.kernel_ns;
}

/// Adds the rows of one way of stepping, and a goal for each law.
void add_costs(const LawCosts& of, const std::string& setting, Sheet& sheet, Goals& goals, std::string& csv) {
  const char* const form = form_names.at(static_cast<std::size_t>(of.form));
  const NewtonCost& rigid = of.costs.front();
  for (std::size_t k = 0; k < of.costs.size(); ++k) {
    const NewtonCost& cost = of.costs[k];
    const std::string name = named_laws()[k].name;
    const double count = rigid.newton_per_substep, ns = step_ns(cost, count);
    const double ratio = ns / step_ns(rigid, count);
    sheet.add_row({setting, form, name, plain_number(cost.newton_per_substep), plain_number(ns),
                   plain_number(cost.kernel_ns), plain_number(ratio),
                   plain_number(cost.kernel_ns / rigid.kernel_ns), std::to_string(cost.halvings)});
    const std::string start = "laws," + std::string(form) + "," + name + ",";
    csv += start + "newton_step," + short_number(ns) + ",ns per rod," + setting + "\n";
    csv += start + "newton_kernel," + short_number(cost.kernel_ns) + ",ns per rod," + setting + "\n";
    csv += start + "newton_per_substep," + short_number(cost.newton_per_substep) + ",," + setting + "\n";
    if (k > 0) goals.at_most(setting + ", " + form + ": " + name + " / rigid", ratio, 1.15);
  }
}

}  // namespace

Section lanes_section(const Plan& plan) {
  std::fprintf(stderr, "lanes\n");
  const std::vector<NewtonCost> costs = measure_lanes(plan.rounds);
  Section out;
  append_csv(out.csv, "lanes", costs);
  Goals goals;
  for (const Precision precision : {Precision::single, Precision::double_}) {
    const std::string numbers(number_name(precision));
    const NewtonCost* alone = find_cost(costs, precision, Gradient::old, true, Isa::scalar);
    const NewtonCost* best = find_cost(costs, precision, Gradient::old, false, best_isa());
    goals.at_least("old, " + numbers + ": substep alone / in lanes", alone->substep_ns / best->substep_ns, 6);
    const NewtonCost* mid = find_cost(costs, precision, Gradient::mid, false, best_isa());
    const double goal = precision == Precision::single ? 6 : 10;
    goals.at_most("mid, " + numbers + ": ns per rod and Newton step, all of a step included", mid->newton_ns,
                  goal);
    goals.at_most("mid, " + numbers + ": ns per rod, Newton kernel", mid->kernel_ns, goal);
  }
  out.text =
      "\n## Lanes against scalar\n\n256 chains of 32 links, last particle ten times as heavy, substeps of "
      "1/480 s. ns per rod, least of the rounds: a substep, the same per Newton step, and the Newton kernel "
      "called alone on prepared state. `alone`: one chain after the other, one number at a time.\n\n" +
      cost_sheet(costs).to_markdown() + "\n" + goals.to_markdown();
  return out;
}

Section line_section(const Plan& plan) {
  Section out;
  std::vector<NewtonCost> costs;
  Goals goals;
  for (const std::uint32_t links : {1000u, 10000u}) {  // longer chains do not converge as a whole in float
    std::fprintf(stderr, "line of %u\n", links);
    const auto more = measure_long_chain(links, std::max(plan.rounds, 2u));
    for (const Precision precision : {Precision::single, Precision::double_}) {
      const NewtonCost* alone = find_cost(more, precision, Gradient::old, true, Isa::scalar);
      const NewtonCost* best = find_cost(more, precision, Gradient::old, false, best_isa());
      const std::string name = std::to_string(links) + " links, " + std::string(number_name(precision)) +
                               ": substep as a whole / in segments";
      goals.at_least(name, alone->substep_ns / best->substep_ns, links == 1000 ? 3 : 0);
    }
    costs.insert(costs.end(), more.begin(), more.end());
  }
  append_csv(out.csv, "line", costs);
  out.text =
      "\n## One long chain\n\nGradient old, last particle ten times as heavy, substeps of 1/480 s. The "
      "baseline, `alone`, eliminates the line as a whole, one number at a time, as plumb did before lines "
      "were cut into segments (and does where both ends are fixed); `scalar` cuts it too.\n\n" +
      cost_sheet(costs).to_markdown() + "\n" + goals.to_markdown();
  return out;
}

Section laws_section(const Plan& plan) {
  Section out;
  Sheet sheet({"", "chains", "rods", "Newton steps", "per Newton step", "kernel", "step, this / rigid",
               "kernel, this / rigid", "halvings"});
  Goals goals;
  std::vector<RodLaw> laws;
  for (const NamedLaw& named : named_laws()) laws.push_back(named.law);
  for (const Gradient gradient : {Gradient::old, Gradient::mid})
    for (const Precision precision : {Precision::single, Precision::double_}) {
      const std::string setting =
          std::string(to_string(gradient)) + " " + std::string(number_name(precision));
      std::fprintf(stderr, "laws, %s\n", setting.c_str());
      for (const LawCosts& of : measure_laws(precision, gradient, laws, plan.rounds))
        add_costs(of, setting, sheet, goals, out.csv);
    }
  out.text =
      "\n## Rods that give\n\nChains as above, 16 of 32 links alone and in lanes, one of 1000 in segments, "
      "with "
      "rods that give 10^5 N/m. ns per rod, least of the rounds: the Newton kernel alone on prepared state, "
      "and "
      "the same with its share of all else in a substep of as many Newton steps as rigid rods take. Substeps "
      "are "
      "of 1/480 s.\n\n" +
      sheet.to_markdown() + "\n" + goals.to_markdown();
  return out;
}

}  // namespace plumb::bench
