#include "direct/comparison.hpp"

#include <cmath>
#include <limits>

#include "scenes/basics/numbers.hpp"

namespace plumb::bench {

using scenes::plain_number;
using scenes::short_number;

std::string number(double value) {
  return value == 0 || !std::isfinite(value) ? "" : plain_number(value);
}
std::string ratio(double above, double below) {
  return number(below > 0 ? above / below : 0);
}

void append_csv(std::string& csv, const Subject& subject, const std::string& what, double ms,
                const std::string& setting) {
  csv += std::string(subject.section) + ",\"" + subject.scene + "\",\"" + subject.target + "\"," + what +
         "," + short_number(ms) + ",ms per simulated second," + setting + "\n";
}

const char* const comparison_text =
    "Relaxation in double by paths along which substeps or sweeps double; `~` where the dearest run did not "
    "come that far, and the time is extrapolated at the slope of its last two doublings (error as work to "
    "the power -slope, at most 2).\n\n";

Comparison compare(const Problem& problem, double error, const Plan& plan, double direct_s, bool by_lines) {
  Comparison c{.scene = problem.name, .error = error, .truth_error = problem.truth_error};
  c.direct = direct_effort(problem, error, direct_s, by_lines);
  const double first_s = plan.full ? 0.3 : 0.03, most_s = plan.full ? 10 : 0.5;
  c.plain = relax_effort(problem, error, false, first_s, most_s);
  c.over = relax_effort(problem, error, true, first_s, most_s);
  return c;
}

double scalar_ms(const Problem& problem, const Effort& effort) {
  Setting scalar = effort.last.setting;
  scalar.settings.isa = Isa::scalar;
  const double anything = std::numeric_limits<double>::infinity();
  return effort.ms * run_trial(problem, scalar, anything).ms / effort.last.ms;
}

std::string effort_text(const Effort& effort) {
  if (!std::isfinite(effort.ms)) return "out of reach";
  return (effort.extrapolated ? "~ " : "") + plain_number(effort.ms);
}
std::string effort_setting(const Effort& effort) {
  std::string out = effort.last.setting.name() + ": " + short_number(effort.last.error, 2);
  if (effort.extrapolated) out += ", slope " + short_number(effort.slope, 2);
  return out;
}

Sheet comparison_sheet(const std::vector<Comparison>& comparisons) {
  Sheet sheet({"scene", "error", "direct, ms", "setting", "relaxed, plain", "last run", "over-relaxed",
               "last run ", "plain / direct", "over-relaxed / direct", "truth known to"});
  for (const Comparison& c : comparisons) {
    const double ms = c.direct ? c.direct->ms : 0;
    sheet.add_row({c.scene, short_number(c.error), number(ms),
                   c.direct ? c.direct->setting.name() : "not met", effort_text(c.plain),
                   effort_setting(c.plain), effort_text(c.over), effort_setting(c.over),
                   ratio(c.plain.ms, ms), ratio(c.over.ms, ms), short_number(c.truth_error, 2)});
  }
  return sheet;
}

void append_csv(std::string& csv, const char* section, const Comparison& c) {
  const Subject subject{section, c.scene, short_number(c.error)};
  if (c.direct) append_csv(csv, subject, "direct", c.direct->ms, c.direct->setting.name());
  for (const Effort* effort : {&c.plain, &c.over}) {
    const std::string name = effort == &c.plain ? "relax" : "over_relaxed";
    append_csv(csv, subject, name + (effort->extrapolated ? "_extrapolated" : ""), effort->ms,
               effort->last.setting.name());
  }
}

double over(double above, const std::optional<Trial>& below) {
  return below ? above / below->ms : 0;
}

}  // namespace plumb::bench
