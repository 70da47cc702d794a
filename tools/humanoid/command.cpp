// plumb humanoid shows the thesis's panel (section 4.5): a ball is thrown at a standing figure.
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "humanoid/experiment.hpp"
#include "humanoid/pictures.hpp"
#include "plot/page.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::tools {
namespace {

using scenes::BodyType;
using scenes::plain_number;
using scenes::short_number;

struct HumanoidOptions {
  HumanoidRun run;
  bool experiments = false;
  std::string report;
  std::string out;
  bool quiet = false;
  std::string typed;  ///< Options that the page repeats, as the user typed them.
};

std::string metres(double value) {
  return plain_number(value) + " m";
}

std::string rest_text(const std::optional<double>& rest) {
  return rest ? plain_number(*rest) + " s" : "not in time";
}

/// Returns the distance of `value` from `fine`, relative to `fine`.
std::optional<double> difference(double value, double fine) {
  if (value == fine) return 0;
  if (fine == 0 || !std::isfinite(value) || !std::isfinite(fine)) return {};
  return std::abs(value - fine) / std::abs(fine);
}

std::optional<double> rest_difference(const HumanoidComparison& c) {
  if (!c.usual.time_to_rest || !c.fine.time_to_rest) return {};
  return difference(*c.usual.time_to_rest, *c.fine.time_to_rest);
}

std::string percent(const std::optional<double>& share) {
  return share ? plain_number(100 * *share, 2) + " %" : no_value;
}

scenes::Json run_json(const HumanoidRun& run) {
  const Vec3 d = run.ball.direction;
  return {{"body", std::string(to_string(run.figure.body))},
          {"arms", run.figure.arms != 0},
          {"friction", run.figure.friction},
          {"joint_drag", run.figure.joint_drag},
          {"ball",
           {{"speed", run.ball.speed},
            {"direction", scenes::Json::array_of({d.x, d.y, d.z})},
            {"radius", run.ball.radius},
            {"mass", run.ball.mass},
            {"elasticity", run.ball.elasticity}}},
          {"dt", run.dt},
          {"substeps", run.substeps},
          {"duration_most", run.most},
          {"seed", run.seed}};
}

scenes::Json result_json(const HumanoidResult& result) {
  return {{"hit", result.hit},
          {"distance", result.distance},
          {"time_to_rest", result.time_to_rest},
          {"energy_received", result.energy_received},
          {"max_stretch", result.max_stretch},
          {"penetration", result.penetration},
          {"energy_before", result.energy_before},
          {"energy_after", result.energy_after},
          {"simulated", result.simulated},
          {"wall_s", result.wall_s},
          {"unsolved", result.unsolved},
          {"frozen_islands", result.frozen}};
}

scenes::Json measure_json(const HumanoidMeasure& m) {
  return {{"distance", m.distance}, {"time_to_rest", m.time_to_rest}, {"energy_received", m.energy_received}};
}

scenes::Json comparison_json(const HumanoidComparison& c) {
  return {{"figure", c.which.figure},
          {"case", c.which.name},
          {"run", run_json(c.which.run)},
          {"median", measure_json(c.usual)},
          {"median_finer", measure_json(c.fine)},
          {"difference",
           {{"distance", difference(c.usual.distance, c.fine.distance)},
            {"time_to_rest", rest_difference(c)},
            {"energy_received", difference(c.usual.energy_received, c.fine.energy_received)}}},
          {"max_stretch", c.max_stretch},
          {"penetration", c.penetration},
          {"sound", c.sound}};
}

/// Sets what the thesis says of each pair beside what was measured.
struct Claim {
  const char* figure;
  const char* text;
  bool first_farther;
};
constexpr Claim claims[] = {
    {"4.11", "a faster ball gives more energy, and the body goes farther", false},
    {"4.12", "a more elastic ball gives more energy, and the body goes farther", false},
    {"4.13", "a heavier ball gives more energy, and the body goes farther", false},
    {"4.14", "a light body goes farther than a heavy one", true}};

/// Returns the two cases of a figure of the thesis.
std::pair<const HumanoidComparison*, const HumanoidComparison*> pair_of(
    const std::vector<HumanoidComparison>& all, const char* figure) {
  std::pair<const HumanoidComparison*, const HumanoidComparison*> out{};
  for (const HumanoidComparison& c : all)
    if (c.which.figure == figure) (out.first ? out.second : out.first) = &c;
  return out;
}

Table claims_table(const std::vector<HumanoidComparison>& all) {
  const std::string substeps = ", " + std::to_string(finer) + " × substeps";
  Table table({"figure", "the thesis", "distances" + substeps, "energies" + substeps, "agrees"});
  for (const Claim& claim : claims) {
    const auto [first, second] = pair_of(all, claim.figure);
    const HumanoidMeasure& a = first->fine;
    const HumanoidMeasure& b = second->fine;
    const bool farther = claim.first_farther ? a.distance > b.distance : b.distance > a.distance;
    // The thesis says nothing about the energy of light and heavy bodies.
    const bool energy = claim.first_farther || b.energy_received > a.energy_received;
    table.add_row({claim.figure, claim.text, metres(a.distance) + ", " + metres(b.distance),
                   plain_number(a.energy_received) + " J, " + plain_number(b.energy_received) + " J",
                   !first->sound || !second->sound  ? "not sound"
                   : farther && energy              ? "yes"
                   : farther                        ? "distance only"
                   : energy && !claim.first_farther ? "energy only"
                                                    : "no"});
  }
  return table;
}

Table experiments_table(const std::vector<HumanoidComparison>& all) {
  Table table({"figure, case", "distance", "off", "to rest", "off", "energy received", "off", "max stretch",
               "penetration"});
  for (const HumanoidComparison& c : all)
    table.add_row({c.which.figure + " " + c.which.name + (c.sound ? "" : " (not sound)"),
                   metres(c.usual.distance), percent(difference(c.usual.distance, c.fine.distance)),
                   rest_text(c.usual.time_to_rest), percent(rest_difference(c)),
                   plain_number(c.usual.energy_received) + " J",
                   percent(difference(c.usual.energy_received, c.fine.energy_received)),
                   short_number(c.max_stretch, 2), metres(c.penetration)});
  return table;
}

std::string experiments_text(const HumanoidRun& usual) {
  return "A figure of nine limbs stands asleep until a ball meets its upper torso (thesis section 4.5.4); "
         "then nothing holds it up but friction in its joints, " +
         short_number(usual.figure.joint_drag) + " 1/s. Each number is the median of " +
         std::to_string(seeds_of_a_case) + " runs whose balls are aimed up to 1 cm apart, frames of " +
         short_number(usual.dt) + " s in " + std::to_string(usual.substeps) +
         " substeps; beside it, how far it is off the same in " + std::to_string(finer) +
         " times as many. Balls are of one density: of 5 kg at 20 m/s, or as said; light and heavy ones at "
         "15 m/s. "
         "Distance: of the body's centre of mass along the ground, from where it stood to where it rests. At "
         "rest: "
         "below " +
         short_number(rest_speed) + " m/s until it sleeps, " + short_number(rest_duration) +
         " s later. Energy received: of the body after the impact over before. The thesis gives no numbers "
         "for "
         "its sliders; those here are ours.";
}

PoseRow row_of(const std::string& title, const HumanoidRun& run, const HumanoidResult& result) {
  return {.title = title, .scene = make_scene(run), .poses = result.poses, .motion = result.motion};
}

std::string run_title(const HumanoidRun& run) {
  return std::string(to_string(run.figure.body)) + " body" + (run.figure.arms != 0 ? " with arms" : "") +
         ", ball of " + short_number(run.ball.mass, 3) + " kg at " + short_number(run.ball.speed, 3) +
         " m/s, elasticity " + short_number(run.ball.elasticity, 3);
}

Table run_table(const HumanoidRun& run, const HumanoidResult& r) {
  Table table({"humanoid", run_title(run)});
  table.add_row({"hit", r.hit ? "yes" : "no, the ball missed"});
  table.add_row({"distance", metres(r.distance)});
  table.add_row({"time to rest", r.hit ? rest_text(r.time_to_rest) : no_value});
  table.add_row({"energy received", plain_number(r.energy_received) + " J"});
  table.add_row(
      {"energy", short_number(r.energy_before) + " J before, " + short_number(r.energy_after) + " J after"});
  table.add_row({"max stretch", short_number(100 * r.max_stretch, 3) + " %"});
  table.add_row({"penetration", metres(r.penetration)});
  table.add_row(
      {"simulated", short_number(r.simulated, 4) + " s in " + short_number(1e3 * r.wall_s, 3) + " ms"});
  return table;
}

scenes::Machine machine_of(const HumanoidRun& run) {
  Settings one_thread;
  one_thread.method = Method::automatic;
  one_thread.threads = 1;
  return scenes::describe_machine(World(make_scene(run), one_thread).info());
}

void write_report(const HumanoidOptions& options, scenes::Json json) {
  if (options.report.empty()) return;
  json["machine"] = scenes::machine_json(machine_of(options.run));
  scenes::write_file(options.report, scenes::format_json(json));
}

Section section_of(const HumanoidOptions& options) {
  return Section("humanoid", "A ball thrown at a standing figure", "plumb humanoid" + options.typed,
                 machine_of(options.run));
}

int run_once(const HumanoidOptions& options) {
  const HumanoidRun& run = options.run;
  const HumanoidResult result = run_humanoid(run, !options.out.empty());
  const Table table = run_table(run, result);
  if (!options.quiet) std::printf("%s", table.to_text().c_str());
  write_report(options, {{"run", run_json(run)}, {"result", result_json(result)}});
  if (!options.out.empty()) {
    Section section = section_of(options);
    const PoseRow row = row_of(run_title(run), run, result);
    section.add_replay(replay_poses({&row, 1}, run.dt));
    section.add_svg(options.out, "humanoid_run", draw_poses({&row, 1}));
    section.add_table(table);
    section.publish(options.out);
  }
  if (!result.finite || result.frozen > 0) throw CheckFailed("the state is not finite");
  if (result.unsolved > 0)
    throw CheckFailed(std::to_string(result.unsolved) + " substeps could not be solved");
  return fine;
}

void publish_experiments(const HumanoidOptions& options, const std::vector<HumanoidComparison>& all) {
  Section section = section_of(options);
  section.add_live();
  section.add_text(experiments_text(options.run));
  section.add_table(experiments_table(all));
  section.add_table(claims_table(all));
  for (const Claim& claim : claims) {
    const auto [first, second] = pair_of(all, claim.figure);
    std::vector<PoseRow> rows;
    for (const HumanoidComparison* c : {first, second}) {
      HumanoidRun run = c->which.run;
      run.seed = 1;
      rows.push_back(row_of(c->which.name, run, c->shown));
    }
    section.add_heading(std::string("Figure ") + claim.figure + ": " + claim.text);
    std::string file = std::string("humanoid_") + claim.figure;
    file[file.find('.')] = '_';
    section.add_replay(replay_poses(rows, options.run.dt));
    section.add_svg(options.out, file, draw_poses(rows));
  }
  section.publish(options.out);
}

int run_experiments(const HumanoidOptions& options) {
  const std::vector<HumanoidCase> cases = thesis_cases(options.run);
  std::vector<HumanoidComparison> all;
  {
    Progress progress("throwing", options.quiet);
    std::uint64_t done = 0;
    const auto tick = [&] { progress.show(++done, runs_of_a_case * cases.size()); };
    for (const HumanoidCase& c : cases) all.push_back(compare(c, tick));
  }
  std::printf("%s\n\n%s\n%s", experiments_text(options.run).c_str(), experiments_table(all).to_text().c_str(),
              claims_table(all).to_text().c_str());
  scenes::Json json{{"usual", run_json(options.run)}};
  for (const HumanoidComparison& c : all) json["cases"].push_back(comparison_json(c));
  write_report(options, json);
  if (!options.out.empty()) {
    publish_experiments(options, all);
    if (!options.quiet) std::printf("\nPage: %s/index.html\n", options.out.c_str());
  }
  std::string unsound;
  for (const HumanoidComparison& c : all)
    if (!c.sound) scenes::append_item(unsound, c.which.name, "; ");
  if (!unsound.empty()) throw CheckFailed("not hit, not finite or not solved: " + unsound);
  return fine;
}

int humanoid(const HumanoidOptions& options) {
  if (!options.out.empty()) make_folder(options.out);
  return options.experiments ? run_experiments(options) : run_once(options);
}

void add_direction(Command& command, Vec3& target) {
  const auto take = [&target](const std::string& text) {
    std::vector<double> numbers;
    for (const std::string& item : scenes::split_list(text))
      if (const auto value = scenes::parse_number<double>(item)) numbers.push_back(*value);
    const Vec3 read = numbers.size() == 3 ? Vec3{numbers[0], numbers[1], numbers[2]} : Vec3{};
    if (numbers.size() != 3 || norm(read) == 0)
      throw BadValue("'" + text + "' is not a direction such as -1,0,0.5");
    target = read;
  };
  command.add_option("--ball-direction", "X,Y,Z", take,
                     "In which it flies; the figure looks towards +x, y is up [-1,0,0]");
}

struct Range {
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
};

/// Adds an option that takes a number within a range.
void add_number_within(Command& command, const std::string& name, double& target, Range range,
                       const std::string& help) {
  const auto take = [range, &target](const std::string& text) {
    const auto value = scenes::parse_fraction(text);
    if (!value || !(*value >= range.least && *value <= range.most))
      throw BadValue("'" + text + "' is not a number " +
                     (std::isfinite(range.most)
                          ? "from " + short_number(range.least) + " to " + short_number(range.most)
                          : "of at least " + short_number(range.least)));
    target = *value;
  };
  command.add_option(name, "T", take, help);
}

Option add_seed(Command& command, std::uint64_t& seed) {
  const auto take = [&seed](const std::string& text) { seed = whole_number<std::uint64_t>(text, {}); };
  return command.add_option(
      "--seed", "N", take,
      "Aims the ball up to 1 cm off, each seed elsewhere; 0: at the middle of the upper torso [0]");
}

}  // namespace

void add_humanoid_command(Command& plumb) {
  Command command =
      plumb.add_command("humanoid", "Throw a ball at a standing figure; say how far it goes (thesis 4.5)");
  auto options = std::make_shared<HumanoidOptions>();
  HumanoidOptions& o = *options;
  HumanoidRun& run = o.run;
  const std::array ball = {
      add_positive(command, "--ball-speed", run.ball.speed, "Where it meets the figure, m/s [10]"),
      add_positive(command, "--ball-radius", run.ball.radius,
                   "m [0.127: the thesis's 5, taken as inches; it gives no unit]"),
      add_positive(command, "--ball-mass", run.ball.mass, "kg [2.268, the thesis's 5 pounds]")};
  add_direction(command, run.ball.direction);
  add_number_within(command, "--elasticity", run.ball.elasticity, {0, 1},
                    "The ball's restitution, 0 to 1: what is left of the speed of an impact [0.5]");
  add_choice(command, "--body", run.figure.body, {BodyType::thin, BodyType::medium, BodyType::wide},
             "The thesis's builds: 116, 177 or 393 kg");
  command.add_flag(
      "--arms", [&run] { run.figure.arms = 1; },
      "A fuller figure: arms, hips beside each other, knees and elbows that bend one way");
  add_number_within(command, "--friction", run.figure.friction, {}, "Between body, ball and ground [0.6]");
  add_number_within(command, "--joint-drag", run.figure.joint_drag, {},
                    "Friction in all joints alike, 1/s: relative motion of limbs decays at this rate [3]");
  add_seconds(command, "--dt", run.dt, "Length of a frame [1/60]");
  add_count(
      command, "--substeps", run.substeps,
      "Integrations per frame; where a ball barely topples the figure, as this one at 7 m/s, distances are "
      "chance [8]");
  add_seconds(command, "--duration", run.most,
              "Most simulated time; a run ends when the figure sleeps again [10]");
  const Option seed = add_seed(command, run.seed);
  const Option experiments = command.add_flag(
      "--experiments", o.experiments,
      "The thesis's figures 4.11 to 4.14 with balls of their own, each case three times and in 8 times as "
      "many substeps");
  for (const Option option : ball) experiments.excludes(option);
  experiments.excludes(seed);
  command.add_option("--report", "OUT.json", o.report,
                     "Write what was thrown, what came of it and the machine to this file");
  command.add_option("--out", "DIR", o.out, "Write a page with replays and drawn poses into this folder");
  command.add_flag("--quiet", o.quiet, "Print nothing but errors; with --experiments no progress bar");
  command.set_footer(
      "Examples:\n"
      "  plumb humanoid --ball-speed 30 --body thin\n"
      "  plumb humanoid --ball-mass 20 --elasticity 0.9 --report hit.json --out out\n"
      "  plumb humanoid --experiments --out out");
  command.set_action([options, command] {
    options->typed = command.typed();
    return humanoid(*options);
  });
}

}  // namespace plumb::tools
