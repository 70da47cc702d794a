#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "direct/comparison.hpp"
#include "direct/goal.hpp"
#include "direct/peers.hpp"
#include "direct/search.hpp"
#include "direct/sections.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/sheet.hpp"

namespace plumb::bench {
namespace {

using scenes::plain_number;
using scenes::short_number;

constexpr std::uint32_t ensemble_chains = 64;

const std::vector<Target> usual_targets{
    {"5 %, 5 %", 0.05, 0.05}, {"1 %, 1 %", 0.01, 0.01}, {"1 %, 0.1 %", 0.01, 0.001}};
const Target finest_target{"1 %, 1e-6", 0.01, 1e-6};

/// Holds an answer with what is compared with it.
struct Row {
  std::string scene;
  Answer answer;
  double ensemble_ms = 0;  ///< ms per chain and simulated second
  std::string ensemble_setting{};
  Peer peer{"", 0};
  double truth_error = 0;
  bool is_ensemble = false;  ///< the peer's time is that of a chain of many
};

Problem chain_problem(std::uint32_t links, double end_mass) {
  Problem problem{.name = "N" + std::to_string(links) + " r" + short_number(end_mass),
                  .scene = scenes::make_chain({.links = links, .end_mass = end_mass})};
  problem.diagonal = bounding_diagonal(problem.scene);
  return problem;
}

/// Compares a truth with that of a Taylor series, if tests hold one. The two must agree.
void compare_with_file(const Problem& problem, std::uint32_t links, double end_mass, std::string& notes) {
  const std::filesystem::path path =
      std::filesystem::path(PLUMB_BENCH_TRUTHS) /
      ("chain_N" + std::to_string(links) + "_r" + short_number(end_mass) + ".csv");
  if (!std::filesystem::exists(path)) return;
  for (const Frame& frame : scenes::read_trajectory(path))
    if (frame.t == problem.duration)
      notes += problem.name + ": " + short_number(position_error(problem, frame.positions), 2) + ". ";
}

/// Times the answers' best direct settings again by turns, for many equal chains at once.
void time_ensembles(const Scene& ensemble, double chains, std::vector<Row>& rows, std::size_t first,
                    double budget_s) {
  Problem problem{.name = "", .scene = ensemble};
  for (std::size_t i = first; i < rows.size(); ++i) {
    Row& row = rows[i];
    if (!row.answer.fixed) continue;
    std::vector<Trial> trials{*row.answer.fixed};
    // In lanes the other gradient may be the cheaper one.
    for (const Trial& other : row.answer.others) trials.push_back(other);
    for (Trial& trial : trials) trial.ms *= chains / 4;
    time_again(problem, trials, budget_s);
    for (const Trial& trial : trials) {
      const double ms = trial.ms / chains;
      if (row.ensemble_ms != 0 && ms >= row.ensemble_ms) continue;
      row.ensemble_ms = ms;
      row.ensemble_setting = trial.setting.name();
    }
  }
}

Sheet answer_sheet(const std::vector<Row>& rows) {
  Sheet sheet({"scene", "stretch, error", "ms", "setting", "its error", "its stretch", "peer, elsewhere",
               "peer's ms", "peer / this", "ms per chain, many", "peer / that", "relaxed, ms"});
  for (const Row& row : rows) {
    const Trial* best = row.answer.best();
    if (!best) {
      sheet.add_row({row.scene, row.answer.target.name, "not met", "", "", "", "", "", "", "", "", ""});
      continue;
    }
    const Answer& a = row.answer;
    sheet.add_row({row.scene, a.target.name, number(best->ms), best->setting.name(),
                   short_number(best->error, 2), short_number(best->stretch, 2), std::string(row.peer.name),
                   number(row.peer.ms), row.is_ensemble ? "" : ratio(row.peer.ms, best->ms),
                   number(row.ensemble_ms), ratio(row.peer.ms, row.ensemble_ms),
                   a.relaxed ? number(a.relaxed->ms)
                   : a.fixed ? "> " + number(relax_cap * a.fixed->ms)
                             : ""});
  }
  return sheet;
}

Sheet automatic_sheet(const std::vector<Row>& rows) {
  Sheet sheet({"scene", "stretch, error", "best fixed, ms", "of gradient mid", "automatic, accuracy",
               "setting", "ratio", "automatic, substeps", "setting ", "ratio "});
  for (const Row& row : rows) {
    const Trial* best = row.answer.best();
    if (!best) continue;
    std::vector<std::string> cells{row.scene, row.answer.target.name, number(best->ms),
                                   row.answer.mid ? number(row.answer.mid->ms) : "none"};
    for (const auto* trial : {&row.answer.automatic, &row.answer.automatic_substeps}) {
      cells.push_back(*trial ? number((*trial)->ms) : "none");
      cells.push_back(*trial ? (*trial)->setting.name() : "");
      cells.push_back(*trial ? ratio((*trial)->ms, best->ms) : "");
    }
    sheet.add_row(cells);
  }
  return sheet;
}

void add_goals(const std::vector<Row>& rows, Goals& goals) {
  Worst one, many, automatic, with_accuracy;
  for (const Row& row : rows) {
    const std::string name = row.scene + ", " + row.answer.target.name;
    const Trial* best = row.answer.best();
    if (!best) continue;
    const auto add = [&](Worst& worst, double ratio, double goal) {
      worst.add(ratio, ratio >= goal, ratio < worst.value, name);
    };
    if (row.peer.ms > 0 && !row.is_ensemble) add(one, row.peer.ms / best->ms, 5);
    if (row.peer.ms > 0 && row.ensemble_ms > 0) add(many, row.peer.ms / row.ensemble_ms, 20);
    const auto add_automatic = [&](Worst& worst, double ms) {
      const double ratio = ms / best->ms;
      worst.add(ratio, ratio <= 1.3, ratio > worst.value, name);
    };
    const auto ms_of = [](const std::optional<Trial>& trial) { return trial ? trial->ms : INFINITY; };
    add_automatic(automatic, std::min(ms_of(row.answer.automatic), ms_of(row.answer.automatic_substeps)));
    add_automatic(with_accuracy, ms_of(row.answer.automatic));
    if (row.scene == "N1000 r1000" && row.answer.target.error == 0.001)
      goals.at_most(name + ": ms per simulated second", best->ms, 20);
  }
  goals.at_least("peer / one chain (" + one.text() + ")", one.value, 5);
  goals.at_least("peer / one chain of many (" + many.text() + ")", many.value, 20);
  goals.at_most("automatic / best fixed (" + automatic.text() + ")", automatic.value, 1.3);
  goals.at_most("automatic with accuracy / best fixed (" + with_accuracy.text() + ")", with_accuracy.value,
                1.3);
}

void append_rows(std::string& csv, const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    const auto add = [&](const char* what, double ms, const std::string& setting) {
      append_csv(csv, {"targets", row.scene, row.answer.target.name}, what, ms, setting);
    };
    const auto add_trial = [&](const char* what, const std::optional<Trial>& trial) {
      if (trial) add(what, trial->ms, trial->setting.name());
    };
    add_trial("direct", row.answer.fixed);
    add_trial("relax", row.answer.relaxed);
    add_trial("automatic_accuracy", row.answer.automatic);
    add_trial("automatic_substeps", row.answer.automatic_substeps);
    if (row.ensemble_ms > 0) add("per_chain_of_many", row.ensemble_ms, row.ensemble_setting);
    if (row.peer.ms > 0) add("peer_elsewhere", row.peer.ms, std::string(row.peer.name));
  }
}

// Nets hang from one corner only. Between two corners a net's upper row begins straight, and no finite pull
// holds it.

/// Makes a net that hangs from one corner only, and folds.
Scene folding_net(std::uint32_t side) {
  Scene scene = scenes::make_net(side, side);
  Particle& corner = scene.particles[side - 1];
  corner.fixed = false;
  corner.mass = 1;
  return scene;
}

std::string frame_text(const FrameEffort& frame) {
  Sheet sheet({"one frame of N1000 r1000, 1 s on", "ms", "setting: stretch left"});
  sheet.add_row({"direct", number(frame.direct_ms), "mid double: " + short_number(frame.direct_stretch, 2)});
  sheet.add_row({"relaxed, plain", effort_text(frame.plain), effort_setting(frame.plain)});
  sheet.add_row({"over-relaxed", effort_text(frame.over), effort_setting(frame.over)});
  return sheet.to_markdown();
}

/// Holds what the section on times to an error shows.
struct Targets {
  std::vector<Row> rows;
  std::string notes;  ///< how far truths are from those of Taylor series
  Comparison longest;
  FrameEffort frame;
};

/// Measures the longest and heaviest chain, to a finer target.
void measure_finest(const Problem& problem, const Plan& plan, Targets& out) {
  for (const Answer& answer : search(problem, {finest_target}, {.trial_s = 1, .relax = false}))
    out.rows.push_back({.scene = problem.name, .answer = answer, .truth_error = problem.truth_error});
  out.longest = compare(problem, finest_target.error, plan, 1, false);
  out.longest.plain_scalar_ms = scalar_ms(problem, out.longest.plain);
  out.longest.over_scalar_ms = scalar_ms(problem, out.longest.over);
  out.frame = frame_effort(problem, finest_target.error, plan.full ? 20 : 2);
}

void measure_chain(std::uint32_t links, double end_mass, const Plan& plan, Targets& out) {
  Problem problem = chain_problem(links, end_mass);
  std::fprintf(stderr, "%s\n", problem.name.c_str());
  const bool finest = links == 1000 && end_mass == 1000;
  find_truth(problem, finest ? 1e-8 : 1e-6, plan.full ? 30 : finest ? 4 : 0.5);
  compare_with_file(problem, links, end_mass, out.notes);
  const std::size_t first = out.rows.size();
  const PeerRow* peers = find_peer(links, end_mass);
  for (const Answer& answer : search(problem, usual_targets, {.retime_s = 0.15})) {
    const Peer peer = peers ? peers->targets[out.rows.size() - first] : Peer{"", 0};
    out.rows.push_back(
        {.scene = problem.name, .answer = answer, .peer = peer, .truth_error = problem.truth_error});
  }
  const Scene many = scenes::make_ensemble({.chains = ensemble_chains, .links = links, .end_mass = end_mass});
  time_ensembles(many, ensemble_chains, out.rows, first, 0.15);
  if (finest) measure_finest(problem, plan, out);
}

void measure_ensemble(Targets& out) {
  std::fprintf(stderr, "1000 chains of 32 links\n");
  Problem problem = chain_problem(32, 10);
  problem.name = "N32 r10, 1000 of them";
  find_truth(problem, 1e-6, 0.5);
  const std::size_t first = out.rows.size();
  for (const Answer& answer : search(problem, usual_targets, {.retime_s = 0.1}))
    out.rows.push_back({.scene = problem.name,
                        .answer = answer,
                        .peer = peer_ensemble,
                        .truth_error = problem.truth_error,
                        .is_ensemble = true});
  time_ensembles(scenes::make_ensemble({.chains = 1000, .links = 32, .end_mass = 10}), 1000, out.rows, first,
                 0.5);
}

void add_goals(const Comparison& longest, const FrameEffort& frame, Goals& goals) {
  const std::string scene = "N1000 r1000, 1e-6 at 1 s: ", frames = "N1000 r1000, a frame's rods to 1e-6: ";
  goals.at_least(scene + "relaxed, rod after rod / direct", over(longest.plain_scalar_ms, longest.direct),
                 1000);
  goals.at_least(scene + "over-relaxed, rod after rod / direct", over(longest.over_scalar_ms, longest.direct),
                 400);
  goals.at_least(scene + "relaxed / direct", over(longest.plain.ms, longest.direct), 0);
  goals.at_least(scene + "over-relaxed / direct", over(longest.over.ms, longest.direct), 0);
  goals.at_least(frames + "relaxed / direct", frame.plain.ms / frame.direct_ms, 0);
  goals.at_least(frames + "over-relaxed / direct", frame.over.ms / frame.direct_ms, 0);
}

std::string text_of(const Targets& targets, const Goals& goals) {
  double truth_error = 0;
  for (const Row& row : targets.rows) truth_error = std::max(truth_error, row.truth_error);
  return "\n## Time to an error\n\nChains of N links, last particle r times as heavy, straight to the side "
         "at "
         "first; one simulated second. Targets are the largest stretch at any frame's end and the RMS "
         "distance "
         "to the truth after that second, relative to the chain's length. ms per simulated second, stepping "
         "alone, least of several runs; the cheapest setting found among method direct (gradients old and "
         "mid, "
         "float and double, frames per second x substeps or accuracy) and relaxation, which is tried up to " +
         short_number(relax_cap) +
         " times what direct takes. Peers' times were measured elsewhere, on another machine (Zen 5, 3.75 "
         "GHz): "
         "their ratios are not of one run. `many`: " +
         std::to_string(ensemble_chains) +
         " equal chains in one world (1000 in the last rows, where the peer's time is that of the same scene "
         "per chain, at 1.1 % RMS stretch and with no error known).\n\nTruths are extrapolated from direct "
         "runs with doubling substeps and known to " +
         short_number(truth_error, 2) +
         " at worst; they differ from those of Taylor series by: " + targets.notes + "\n\n" +
         answer_sheet(targets.rows).to_markdown() + "\n" + goals.to_markdown() +
         "\n### Relaxation to 1e-6\n\n" + comparison_text +
         comparison_sheet({targets.longest}).to_markdown() + "\n" + frame_text(targets.frame) +
         "\n## Automatic\n\nMethod automatic is given frames, precision and either an accuracy or substeps; "
         "gradient and method are its own choice. The fixed ones are the cheapest of runs with either, and "
         "of "
         "relaxation.\n\n" +
         automatic_sheet(targets.rows).to_markdown();
}

}  // namespace

Section targets_section(const Plan& plan) {
  Targets targets;
  for (const std::uint32_t links : {5u, 20u, 100u, 1000u})
    for (const double end_mass : {1.0, 10.0, 1000.0}) measure_chain(links, end_mass, plan, targets);
  measure_ensemble(targets);
  Goals goals;
  add_goals(targets.rows, goals);
  add_goals(targets.longest, targets.frame, goals);
  Section out;
  append_rows(out.csv, targets.rows);
  append_csv(out.csv, "targets", targets.longest);
  out.text = text_of(targets, goals);
  return out;
}

Section loops_section(const Plan& plan) {
  Section out;
  std::vector<Comparison> comparisons;
  Goals goals;
  const auto add = [&](const std::string& name, const Scene& scene, const std::vector<double>& errors,
                       double goal, bool by_lines = false) {
    std::fprintf(stderr, "%s\n", name.c_str());
    Problem problem{.name = name, .scene = scene, .duration = 0.5};
    problem.diagonal = bounding_diagonal(scene);
    find_truth(problem, errors.back() / 10, plan.full ? 120 : 4, 2);
    for (const double error : errors) {
      comparisons.push_back(compare(problem, error, plan, plan.full ? 60 : 2, by_lines));
      const Comparison& c = comparisons.back();
      append_csv(out.csv, "loops", c);
      const std::string what = name + " to " + short_number(error) + ": ";
      goals.at_least(what + "relaxed / direct", over(c.plain.ms, c.direct), goal);
      goals.at_least(what + "over-relaxed / direct", over(c.over.ms, c.direct), 0);
    }
  };
  const auto add_net = [&](const std::string& name, const Scene& scene, double goal) {
    add(name, scene, goal > 0 ? std::vector{1e-4, 1e-6} : std::vector{1e-4}, goal, true);
  };
  add("ring of 24", scenes::make_ring({.links = 24}), {1e-4}, 0);
  add("truss of 100 bays", scenes::make_truss({.bays = 100}), {1e-4}, 50);
  add("truss of 100 bays, swinging", scenes::make_truss({.bays = 100, .fixed = 2}), {1e-4}, 50);
  if (plan.full) add_net("net 16 x 16, one corner", folding_net(16), 0);
  for (const std::uint32_t side : {32u, 64u, 128u})
    add_net("net " + std::to_string(side) + " x " + std::to_string(side) + ", one side",
            scenes::make_net({.width = side, .height = side, .level = 1}), side == 128 ? 10 : 0);
  out.text = "\n## Loops\n\nTo a position error, relative to the diagonal, at 0.5 s. " +
             std::string(comparison_text) + comparison_sheet(comparisons).to_markdown() + "\n" +
             goals.to_markdown();
  return out;
}

}  // namespace plumb::bench
