#include "thesis/table.hpp"

#include <cmath>
#include <limits>

#include "plumb/reference/springs.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb::tools {
namespace {

using scenes::plain_number;
using scenes::short_number;

/// Section 4.4.1 has these numbers, about: N/m, and steps per second.
constexpr double thesis_limit = 2.7;
constexpr double thesis_fps = 602;
/// Section 4.4.2 has these frames per second, with 5 and with 1000 sweeps.
constexpr double thesis_five_fps = 597, thesis_thousand_fps = 30;

Scene light_end() {
  return scenes::make_chain(5);
}

Settings relaxed(Weights weights, std::uint32_t substeps, std::uint32_t sweeps) {
  Settings settings{.method = Method::relax};
  settings.weights = weights;
  settings.substeps = substeps;
  settings.stop.sweeps = sweeps;
  settings.threads = 1;
  return settings;
}

Settings accurate() {
  Settings settings{.method = Method::direct, .gradient = Gradient::mid, .substeps = 128};
  settings.threads = 1;
  return settings;
}

RestTimes measure_rest(Scene heavy, Scene light, double drag, std::uint32_t substeps, std::uint32_t sweeps) {
  heavy.drag = light.drag = drag;
  RestTimes out{.limit = 120};
  const Settings mass = relaxed(Weights::mass, substeps, sweeps);
  const Settings equal = relaxed(Weights::equal, substeps, sweeps);
  out.mass = time_to_rest(heavy, mass, out.limit);
  out.mass_light = time_to_rest(light, mass, out.limit);
  out.equal = time_to_rest(heavy, equal, out.limit);
  out.equal_light = time_to_rest(light, equal, out.limit);
  Settings fine = accurate();
  fine.substeps = 16;
  // Without drag nothing ever comes to rest in truth.
  out.truth = drag > 0 ? time_to_rest(heavy, fine, out.limit) : -1;
  return out;
}

std::string percent(double share) {
  return plain_number(100 * share) + " %";
}

std::string millimetres(double m) {
  return plain_number(1e3 * m) + " mm";
}

std::string rest_text(double t, double limit) {
  return t < 0 ? "over " + short_number(limit) + " s" : plain_number(t) + " s";
}

/// Two numbers are alike if neither is more than twice the other.
constexpr double alike = 2;
bool are_alike(double a, double b) {
  return a > 0 && b > 0 && a <= alike * b && b <= alike * a;
}

/// Returns seconds to compare by. Those that never came to rest come last.
double rest_of(double t) {
  return t < 0 ? std::numeric_limits<double>::infinity() : t;
}

ThesisRow rest_row(const std::string& what, const RestTimes& t) {
  const auto text = [&](double s) { return rest_text(s, t.limit); };
  return {.what = what,
          .thesis = "\"a longer period before becoming motionless\" by mass, not with equal weights",
          .where = "4.4.2",
          .ours = "by mass " + text(t.mass) + " (light end " + text(t.mass_light) + "), equal " +
                  text(t.equal) + " (" + text(t.equal_light) + "), truth " + text(t.truth),
          // Times differ if one is longer by a tenth. Less depends on the swing in which the last speed was
          // above the limit.
          .agrees = rest_of(t.mass) > 1.1 * rest_of(t.equal) && rest_of(t.mass) > 1.1 * rest_of(t.mass_light),
          .values = {{"mass_s", t.mass},
                     {"mass_light_s", t.mass_light},
                     {"equal_s", t.equal},
                     {"equal_light_s", t.equal_light},
                     {"truth_s", t.truth}}};
}

ThesisRow limit_row(const std::string& integrator, const SpringLimit& limit) {
  return {.what = "stiffest stable springs, " + integrator + ", 602 steps/s",
          .thesis = "instability from \"around 0.027 N/cm\", that is 2.7 N/m",
          .where = "4.4.1",
          .ours = short_number(limit.predicted, 4) + " N/m predicted, " + short_number(limit.found, 4) +
                  " N/m found; 2.7 N/m would be links of " + plain_number(1e3 * thesis_limit / limit.found) +
                  " g",
          .agrees = {},
          .values = {{"predicted_N_per_m", limit.predicted}, {"found_N_per_m", limit.found}}};
}

/// The frames are another machine's, two decades later. That there are more neither agrees nor disagrees.
ThesisRow fps_row(const std::string& what, const char* where, double thesis, double ours) {
  return {.what = what,
          .thesis = short_number(thesis) + " frames/s",
          .where = where,
          .ours = plain_number(ours) + " frames/s",
          .agrees = {},
          .values = {{"thesis_frames_per_s", thesis}, {"frames_per_s", ours}}};
}

/// Shows how far the heavy end changes the motion.
void add_change_rows(const ThesisNumbers& n, std::vector<ThesisRow>& rows) {
  const PerWay& c = n.change;
  const auto near_truth = [&](double change) { return std::abs(change - c.truth) < 0.5 * c.truth; };
  rows.push_back({.what = "change of motion by the heavy end, weights by mass",
                  .thesis = "\"more control over the global motion\"",
                  .where = "4.4.2",
                  .ours = percent(c.mass) + " of the length at 1 s, truth " + percent(c.truth),
                  .agrees = near_truth(c.mass),
                  .values = {{"mass", c.mass}, {"truth", c.truth}}});
  rows.push_back({.what = "the same, equal weights",
                  .thesis = "\"difficult to observe any difference in mass\"",
                  .where = "4.4.2",
                  .ours = percent(c.equal),
                  .agrees = c.equal < 0.1 * c.truth,
                  .values = {{"equal", c.equal}}});
  rows.push_back({.what = "the same, springs of " + short_number(n.stiffness, 3) + " N/m",
                  .thesis = "\"in both simulations the larger mass ... could be noticed\"",
                  .where = "4.4.3",
                  .ours = percent(c.springs),
                  .agrees = c.springs > 0.5 * c.truth,
                  .values = {{"springs", c.springs}, {"stiffness_N_per_m", n.stiffness}}});
}

/// Shows times to rest, and errors.
void add_error_rows(const ThesisNumbers& n, std::vector<ThesisRow>& rows) {
  rows.push_back(rest_row("time to rest, drag 0.5/s", n.drag));
  rows.push_back(rest_row("time to rest, no drag, 5 sweeps", n.numerical));
  rows.push_back(
      {.what = "error at 1 s against truth",
       .thesis = "\"similar to those obtained with stiff springs\"",
       .where = "4.3",
       .ours = "by mass " + percent(n.error.mass) + ", equal " + percent(n.error.equal) + ", springs " +
               percent(n.error.springs) + "; of " + short_number(n.stiff, 2) + " N/m " +
               percent(n.stiff_error),
       .agrees = are_alike(n.error.mass, n.error.springs) || are_alike(n.error.mass, n.stiff_error),
       .values = {{"mass", n.error.mass},
                  {"equal", n.error.equal},
                  {"springs", n.error.springs},
                  {"stiff_springs", n.stiff_error},
                  {"stiff_N_per_m", n.stiff},
                  {"truth_known_to", n.error.truth}}});
}

/// Shows how far springs open and rods stretch.
void add_gap_rows(const ThesisNumbers& n, std::vector<ThesisRow>& rows) {
  const HangingGaps& h = n.hanging;
  rows.push_back({.what = "gaps of springs, hanging at rest",
                  .thesis = "\"worst at\" the top joint, which bears all links (figure 4.5)",
                  .where = "4.4.1",
                  .ours = "largest " + millimetres(h.largest) + ", RMS " + millimetres(h.rms) +
                          "; weight/stiffness " + millimetres(h.top_load) + " on top, " +
                          millimetres(h.bottom_load) + " below; spring " + std::to_string(h.widest + 1) +
                          " from the top gives most",
                  .agrees = h.widest == 0 && std::abs(h.largest - h.top_load) < 0.01 * h.top_load,
                  .values = {{"largest_m", h.largest},
                             {"rms_m", h.rms},
                             {"top_load_m", h.top_load},
                             {"bottom_load_m", h.bottom_load},
                             {"widest_spring", h.widest}}});
  rows.push_back({.what = "gaps in motion, springs against relaxation",
                  .thesis = "gaps \"noticeable\" with springs, \"never any\" relaxed",
                  .where = "4.4.2-3",
                  .ours = "springs " + millimetres(n.moving.largest) + ", RMS " + millimetres(n.moving.rms) +
                          "; rods relaxed are off by " + millimetres(n.link * n.five.stretch_max) + ", RMS " +
                          millimetres(n.link * n.five.stretch_rms) + " (5 sweeps), " +
                          millimetres(n.link * n.thousand.stretch_max) + " (1000)",
                  // A gap of less than a twentieth of a link is hard to see.
                  .agrees = n.moving.largest > 0.05 * n.link && n.five.stretch_max < 0.05,
                  .values = {{"springs_largest_m", n.moving.largest},
                             {"springs_rms_m", n.moving.rms},
                             {"five_sweeps_largest_m", n.link * n.five.stretch_max},
                             {"five_sweeps_rms_m", n.link * n.five.stretch_rms},
                             {"thousand_sweeps_largest_m", n.link * n.thousand.stretch_max}}});
}

/// Shows how stiff springs can be.
void add_stiffness_rows(const ThesisNumbers& n, std::vector<ThesisRow>& rows) {
  rows.push_back({.what = "stiffness that keeps the top joint to 1 % of a link",
                  .thesis = "\"could never be increased enough\"",
                  .where = "4.4.3",
                  .ours = short_number(n.one_percent, 3) + " N/m: " +
                          short_number(std::ceil(n.explicit_steps)) + " steps/s of forward Euler, " +
                          short_number(std::ceil(n.semi_implicit_steps)) + " of semi-implicit",
                  .agrees = n.explicit_steps > thesis_fps,
                  .values = {{"stiffness_N_per_m", n.one_percent},
                             {"forward_euler_steps_per_s", n.explicit_steps},
                             {"semi_implicit_euler_steps_per_s", n.semi_implicit_steps}}});
  rows.push_back(limit_row("forward Euler", n.forward));
  rows.push_back(limit_row("semi-implicit Euler", n.semi_implicit));
}

/// Shows frames per second.
void add_speed_rows(const ThesisNumbers& n, std::vector<ThesisRow>& rows) {
  rows.push_back(fps_row("springs, forward Euler, a step a frame", "4.4.1", thesis_fps, n.springs_fps));
  rows.push_back(fps_row("relaxation, 5 sweeps a frame", "4.4.2", thesis_five_fps, n.five_fps));
  rows.push_back(fps_row("relaxation, 1000 sweeps a frame", "4.4.2", thesis_thousand_fps, n.thousand_fps));
  const double ratio = n.springs_fps / n.five_fps;
  rows.push_back({.what = "springs to 5 sweeps",
                  .thesis = "\"similar\": 602 to 597, a ratio of 1.01",
                  .where = "4.4.3",
                  .ours = plain_number(ratio),
                  .agrees = are_alike(ratio, thesis_fps / thesis_five_fps),
                  .values = {{"ratio", ratio}}});
  // The thesis's frames are drawn too, a cost that 5 sweeps share with 1000.
  const double sweeps_ratio = n.five_fps / n.thousand_fps;
  rows.push_back({.what = "5 to 1000 sweeps",
                  .thesis = "597 to 30, a ratio of 19.9",
                  .where = "4.4.2",
                  .ours = plain_number(sweeps_ratio),
                  .agrees = are_alike(sweeps_ratio, thesis_five_fps / thesis_thousand_fps),
                  .values = {{"five_to_thousand", sweeps_ratio}}});
}

}  // namespace

ThesisNumbers measure_thesis_numbers() {
  ThesisNumbers n;
  const Scene heavy = scenes::make_thesis5(), light = light_end();
  n.link = 0.1;
  n.forward = find_spring_limit(heavy, Integrator::explicit_euler, 1 / thesis_fps);
  n.semi_implicit = find_spring_limit(heavy, Integrator::semi_implicit_euler, 1 / thesis_fps);
  n.spring_limit = n.forward.predicted;
  n.stiffness = 0.5 * n.spring_limit;
  const auto substeps = static_cast<std::uint32_t>(std::lround(n.frames / 60));
  const Settings springs = spring_settings(Integrator::explicit_euler, n.stiffness, substeps);
  const Settings mass = relaxed(Weights::mass, 8, 100), equal = relaxed(Weights::equal, 8, 100);
  n.change = {.truth = distance_of_motions(light, heavy, accurate()),
              .mass = distance_of_motions(light, heavy, mass),
              .equal = distance_of_motions(light, heavy, equal),
              .springs = distance_of_motions(light, heavy, springs)};

  const Truth truth = converge(heavy, 1024);
  Settings stiff = spring_settings(Integrator::semi_implicit_euler, 1, 128);
  // The fastest vibration turns by half a radian a step, well below the limit of 2.
  n.stiff = std::pow(0.5 * 60 * stiff.substeps / spring_stability(heavy, stiff).frequency, 2);
  stiff.springs.stiffness = n.stiff;
  n.error = {.truth = truth.uncertainty,
             .mass = measure(heavy, truth, mass).error,
             .equal = measure(heavy, truth, equal).error,
             .springs = measure(heavy, truth, springs).error};
  n.stiff_error = measure(heavy, truth, stiff).error;

  n.drag = measure_rest(heavy, light, 0.5, 8, 100);
  n.numerical = measure_rest(heavy, light, 0, 1, 5);

  n.hanging = measure_hanging_gaps(heavy, n.stiffness);
  n.moving = measure_moving_gaps(heavy, springs);
  n.five = measure(heavy, truth, relaxed(Weights::mass, substeps, 5));
  n.thousand = measure(heavy, truth, relaxed(Weights::mass, 1, 1000));
  n.one_percent = n.hanging.top_load * n.stiffness / (0.01 * n.link);
  n.explicit_steps =
      1 / spring_stability(heavy, spring_settings(Integrator::explicit_euler, n.one_percent)).largest_step;
  n.semi_implicit_steps =
      1 /
      spring_stability(heavy, spring_settings(Integrator::semi_implicit_euler, n.one_percent)).largest_step;

  n.springs_fps =
      frames_per_second(heavy, spring_settings(Integrator::explicit_euler, n.stiffness), 1 / thesis_fps);
  n.five_fps = frames_per_second(heavy, relaxed(Weights::mass, 1, 5), 1 / thesis_fps);
  n.thousand_fps = frames_per_second(heavy, relaxed(Weights::mass, 1, 1000), 1 / thesis_fps);
  return n;
}

std::vector<ThesisRow> thesis_rows(const ThesisNumbers& n) {
  std::vector<ThesisRow> rows;
  add_change_rows(n, rows);
  add_error_rows(n, rows);
  add_gap_rows(n, rows);
  add_stiffness_rows(n, rows);
  add_speed_rows(n, rows);
  return rows;
}

Table thesis_table(const std::vector<ThesisRow>& rows) {
  Table table({"five links, the last 2 kg", "thesis", "section", "here", "agrees"});
  for (const ThesisRow& row : rows)
    table.add_row(
        {row.what, row.thesis, row.where, row.ours, row.agrees ? (*row.agrees ? "yes" : "no") : no_value});
  return table;
}

scenes::Json thesis_rows_json(const std::vector<ThesisRow>& rows) {
  scenes::Json list = scenes::Json::array();
  for (const ThesisRow& row : rows) {
    scenes::Json entry{{"what", row.what},
                       {"thesis", row.thesis},
                       {"section", row.where},
                       {"here", row.ours},
                       {"agrees", row.agrees}};
    for (const auto& [name, value] : row.values) entry["values"][name] = value;
    list.push_back(entry);
  }
  return list;
}

std::string thesis_table_text(const ThesisNumbers& n) {
  return "The thesis's words and figures beside what five links of 10 cm and 1 kg, the last particle of 2 "
         "kg, "
         "do here, from horizontal. By mass, equal: relaxation, 8 substeps of 100 sweeps, gradient new. "
         "Springs: rigid rods, damped at a tenth of critical, by forward Euler in " +
         short_number(n.frames) + " steps a second with half the stiffness that is stable then (" +
         short_number(n.stiffness, 3) +
         " N/m). Rest: no particle faster than 1 cm/s. The thesis does not give the mass of its links; the "
         "limit grows with it in proportion. Similar means by less than a factor of " +
         short_number(alike) + "; frames per second of another machine are not judged.";
}

}  // namespace plumb::tools
