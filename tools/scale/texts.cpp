#include <algorithm>
#include <cmath>

#include "scale/output.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::plain_number;
using scenes::short_number;

/// Exponents that differ by less count as alike: timing on a busy machine is no better.
constexpr double slope_room = 0.1;

std::string count_text(double links) {
  return short_number(links, 7) + (links == 1 ? " link" : " links");
}

std::string with_slopes(const std::string& one, const std::optional<double>& slope) {
  return one + (slope ? " (slope " + plain_number(*slope) + ")" : " (too few lengths for a slope)");
}

/// Says that both are alike, or which grows more slowly.
std::string better_of(double springs, double relax) {
  if (std::abs(springs - relax) < slope_room) return "both scale alike";
  return springs < relax ? "springs scale better" : "relaxation scales better";
}

}  // namespace

Comparison compare(const ScaleOptions& options, const ScaleResults& results) {
  Comparison out;
  const ScaleSeries springs{.method = Method::springs};
  // Springs are in double, and the thesis sweeps rod after rod. This series is the same where it was
  // measured.
  ScaleSeries relax{.method = Method::relax};
  if (std::find(options.orders.begin(), options.orders.end(), relax.order) == options.orders.end())
    relax.order = options.orders.front();
  if (std::find(options.precisions.begin(), options.precisions.end(), relax.precision) ==
      options.precisions.end())
    relax.precision = options.precisions.front();
  const std::vector<Timing> s = timings_of(results.cells, springs), r = timings_of(results.cells, relax);
  out.springs_slope = fit_longer_half(s);
  out.relax_slope = fit_longer_half(r);
  out.springs_level = level_until(s, level_factor);
  out.relax_level = level_until(r, level_factor);
  for (const ScaleCell& cell : results.cells) {
    if (!is_whole(cell)) continue;
    if (cell.series == springs) out.springs_stretch = std::max(out.springs_stretch, cell.stretch.max);
    if (cell.series == relax) out.relax_stretch = std::max(out.relax_stretch, cell.stretch.max);
  }
  for (const auto& [links, springs_s] : s)
    for (const auto& [same, relax_s] : r)
      if (links == same) {
        out.links = links;
        out.springs_ns = 1e9 * springs_s / links;
        out.relax_ns = 1e9 * relax_s / links;
      }
  return out;
}

std::string conclusion_of(const Comparison& c) {
  if (!c.springs_slope || !c.relax_slope || c.links == 0)
    return "The thesis concludes that springs are \"much more scaleable\" (section 4.4.3); too few lengths "
           "of springs and relaxation were measured here to say.";
  const bool springs_faster = c.springs_ns < c.relax_ns;
  const double times = springs_faster ? c.relax_ns / c.springs_ns : c.springs_ns / c.relax_ns;
  const double difference = *c.springs_slope - *c.relax_slope;
  std::string out =
      "The thesis sees springs level until about 40 links and relaxation fall from the start, and concludes "
      "that springs are \"much more scaleable\" (section 4.4.3). Here frames per second of springs are level "
      "(to " +
      plain_number(100 * (level_factor - 1), 2) + " %) until " + count_text(c.springs_level) +
      ", of relaxation until " + count_text(c.relax_level) +
      "; over the longer half of their lengths the time of a frame grows as links to the power " +
      plain_number(*c.springs_slope) + " (springs) and " + plain_number(*c.relax_slope) +
      " (relaxation): " + better_of(*c.springs_slope, *c.relax_slope) + ". At " + short_number(c.links, 7) +
      " links a rod takes " + plain_number(c.springs_ns) + " ns with springs and " +
      plain_number(c.relax_ns) + " ns relaxed, so " + (springs_faster ? "springs are " : "relaxation is ") +
      plain_number(times, 2) + " times as fast. The thesis's conclusion ";
  out += difference < -slope_room ? "holds" : "does not hold";
  return out + " for a frame of fixed settings. With these settings rods stretch by up to " +
         plain_number(100 * c.springs_stretch) + " % (springs) and " + plain_number(100 * c.relax_stretch) +
         " % (relaxed).";
}

std::string conclusion_at_equal_error(const ScaleOptions& options, const ScaleResults& results,
                                      ChainFamily family) {
  const auto slope = [&](Method method) { return fit_slope(timings_of(results.errors, family, method)); };
  std::string out = "At " + short_number(100 * options.target) + " % of error, " + family_text(family) + ": ";
  std::string methods;
  for (const Method method : methods_of(results, family))
    append_item(methods, with_slopes(std::string(to_string(method)), slope(method)));
  out += methods + ".";
  const auto springs = slope(Method::springs), relax = slope(Method::relax);
  if (springs && relax) out += " Of springs and relaxation, " + better_of(*springs, *relax) + ".";
  // The sentence is about the longest chain that both reach.
  const std::vector<Timing> s = timings_of(results.errors, family, Method::springs);
  const std::vector<Timing> r = timings_of(results.errors, family, Method::relax);
  for (auto it = s.rbegin(); it != s.rend(); ++it) {
    const auto same = std::find_if(r.begin(), r.end(), [&](const Timing& t) { return t.first == it->first; });
    if (same == r.end()) continue;
    const bool springs_faster = it->second < same->second;
    const double times = springs_faster ? same->second / it->second : it->second / same->second;
    out += " At " + short_number(it->first, 7) + " links, the longest that both reach, " +
           (springs_faster ? "springs are " : "relaxation is ") + plain_number(times, 2) +
           " times as fast to that error.";
    break;
  }
  if (r.size() > s.size())
    out += " Springs reach it at " + std::to_string(s.size()) + " of the lengths, relaxation at " +
           std::to_string(r.size()) + ".";
  return out;
}

std::string scale_text(const ScaleOptions& options) {
  return "Chains of equal masses, horizontal at first, in frames of 1/60 s, without substeps where a chain "
         "survives that and in twice as many until it does: times of a frame, mean over the first simulated "
         "second, the least of " +
         std::to_string(options.repetitions) +
         " repetitions where they are short. Settings are fixed; relaxation takes " +
         std::to_string(options.sweeps) +
         " sweeps a frame, Gauss–Seidel unless a name says jacobi; springs are as stiff as semi-implicit "
         "Euler bears. That fixes the time per rod, "
         "not how well rods keep their length: relaxed, the largest stretch grows with the chain until, in "
         "the longest, most rods still fall freely after a second. A chain is stepped for " +
         short_number(options.cell_s) +
         " s of wall-clock time at most and timed over the frames done by then; a dash: those would be fewer "
         "than ten, or the method does not move it. All methods "
         "but relaxation in double on one thread; \"threads\" where all of them were used. Slopes are "
         "exponents of links, fitted to the longer half of a method's lengths; level until: the longest "
         "chain whose frames take no more than " +
         plain_number(level_factor) + " times those of the shortest.";
}

std::string error_text(const ScaleOptions& options, const ScaleResults& results, ChainFamily family) {
  std::string moved;
  for (const std::uint32_t links : error_links_of(family, options))
    for (const EqualErrorCell& cell : results.errors)
      if (cell.family == family && cell.links == links) {
        append_item(moved, plain_number(100 * cell.moved) + " % of its length at " + std::to_string(links));
        break;
      }
  return "The cheapest setting found of each method, one thread, that brings " + family_text(family) +
         " to within " + short_number(100 * options.target) +
         " % of the chain's length of the truth after a second (RMS over particles). In that second a chain "
         "moves by " +
         moved +
         (family == ChainFamily::equal_links ? ", so that the longer it is, the less is asked." : ".");
}

}  // namespace plumb::tools
