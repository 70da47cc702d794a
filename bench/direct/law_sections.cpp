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

/// Adds the rows of one way of stepping, and a goal for each law.
void add_costs(const LawCosts& of, const std::string& setting, Sheet& sheet, Goals& goals, std::string& csv) {
  const char* const form = form_names.at(static_cast<std::size_t>(of.form));
  const NewtonCost& rigid = of.costs.front();
  for (std::size_t k = 0; k < of.costs.size(); ++k) {
    const NewtonCost& cost = of.costs[k];
    const std::string name = named_laws()[k].name;
    const double ratio = cost.newton_ns / rigid.newton_ns;
    sheet.add_row({setting, form, name, plain_number(cost.newton_per_substep), plain_number(cost.newton_ns),
                   plain_number(cost.kernel_ns), plain_number(ratio),
                   plain_number(cost.kernel_ns / rigid.kernel_ns), std::to_string(cost.halvings)});
    const std::string start = "laws," + std::string(form) + "," + name + ",";
    csv += start + "newton_step," + short_number(cost.newton_ns) + ",ns per rod," + setting + "\n";
    csv += start + "newton_kernel," + short_number(cost.kernel_ns) + ",ns per rod," + setting + "\n";
    csv += start + "newton_per_substep," + short_number(cost.newton_per_substep) + ",," + setting + "\n";
    if (k > 0) goals.at_most(setting + ", " + form + ": " + name + " / rigid", ratio, 1.15);
  }
}

}  // namespace

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
      "\n## Rods that give\n\nThe chains of the sections above, 256 of 32 links alone and in lanes, one of "
      "1000 in segments, with rods that give 10^5 N/m. ns per rod, least of the rounds: all of a substep per "
      "Newton step, and the Newton kernel alone on prepared state. Substeps are of 1/480 s.\n\n" +
      sheet.to_markdown() + "\n" + goals.to_markdown();
  return out;
}

}  // namespace plumb::bench
