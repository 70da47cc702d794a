#include "scenes/runs/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "plumb/world.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/runs/counters.hpp"
#include "scenes/runs/run.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

using Read = nlohmann::ordered_json;

/// As another program reads it.
Read parsed(const Json& json) {
  return Read::parse(format_json(json));
}

std::set<std::string> keys(const Read& object) {
  std::set<std::string> out;
  for (const auto& item : object.items()) out.insert(item.key());
  return out;
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

RunPlan short_plan() {
  RunPlan plan{.duration = 0.1};
  plan.settings.method = Method::relax;
  plan.settings.substeps = 2;
  plan.settings.stop.sweeps = 7;
  plan.settings.threads = 1;
  return plan;
}

TEST(Report, HasEveryField) {
  const RunPlan plan = short_plan();
  const RunResult result = run_scene(make_chain(5, 0.1, 10), plan);
  const Read report =
      parsed(report_json("chain:links=5,end_mass=10", plan, result, describe_machine(result.info)));
  EXPECT_EQ(keys(report), (std::set<std::string>{"scene",
                                                 "method",
                                                 "settings",
                                                 "machine",
                                                 "rods",
                                                 "particles",
                                                 "islands",
                                                 "start",
                                                 "frames",
                                                 "steps",
                                                 "sweeps",
                                                 "newton",
                                                 "rod_projections",
                                                 "wall_s",
                                                 "ns_per_rod_frame",
                                                 "stretch",
                                                 "energy",
                                                 "position_error",
                                                 "tension",
                                                 "tension_error",
                                                 "stopped_by",
                                                 "skipped",
                                                 "mid_guarded",
                                                 "frozen_islands",
                                                 "projected_position",
                                                 "unprojected_islands",
                                                 "projected_velocity",
                                                 "state_hash",
                                                 "relaxed_rods",
                                                 "direct_rods",
                                                 "direct_gradient",
                                                 "changes_gradient",
                                                 "direct_time_order",
                                                 "direct_substeps",
                                                 "halvings",
                                                 "fallbacks",
                                                 "repeated_steps",
                                                 "elastic_substeps",
                                                 "unsolved",
                                                 "largest_gap",
                                                 "rms_gap",
                                                 "inaccurate_steps",
                                                 "capped_steps",
                                                 "broken_rods",
                                                 "awake_islands",
                                                 "fell_asleep",
                                                 "budget",
                                                 "problems",
                                                 "contact"}));
  EXPECT_EQ(keys(report["settings"]), (std::set<std::string>{"method",
                                                             "duration",
                                                             "winch",
                                                             "most_work",
                                                             "sleep_time",
                                                             "length_scale",
                                                             "tensions",
                                                             "contacts",
                                                             "dt",
                                                             "substeps",
                                                             "sweeps",
                                                             "tolerance",
                                                             "budget_us",
                                                             "step_budget_us",
                                                             "time_order",
                                                             "accuracy",
                                                             "order",
                                                             "omega",
                                                             "weights",
                                                             "gradient",
                                                             "mass",
                                                             "integrator",
                                                             "springs",
                                                             "stiffness",
                                                             "damping_ratio",
                                                             "stabilization",
                                                             "baumgarte_rate",
                                                             "layout",
                                                             "precision",
                                                             "threads",
                                                             "isa"}));
  EXPECT_EQ(keys(report["machine"]),
            (std::set<std::string>{"cpu", "isa", "threads", "compiler", "flags", "commit"}));
  EXPECT_EQ(keys(report["stretch"]), (std::set<std::string>{"rms", "max", "max_rod"}));
  EXPECT_EQ(keys(report["energy"]), (std::set<std::string>{"initial", "final", "drift_max"}));

  EXPECT_EQ(report["scene"], "chain:links=5,end_mass=10");
  EXPECT_EQ(report["method"], "relax");
  EXPECT_EQ(report["settings"]["method"], "relax");
  EXPECT_EQ(report["settings"]["isa"], "auto");
  EXPECT_TRUE(report["settings"]["tolerance"].is_null());
  EXPECT_EQ(report["rods"], 5);
  EXPECT_EQ(report["particles"], 6);
  EXPECT_EQ(report["islands"], 1);
  EXPECT_EQ(report["frames"], 6);
  EXPECT_EQ(report["steps"], 12);
  EXPECT_EQ(report["sweeps"], 12 * 7);
  EXPECT_EQ(report["rod_projections"], 12 * 7 * 5);
  EXPECT_EQ(report["stopped_by"], "sweeps");
  EXPECT_EQ(report["frozen_islands"], 0);
  EXPECT_TRUE(report["position_error"].empty());
  EXPECT_TRUE(report["tension"].is_null());
  EXPECT_TRUE(report["tension_error"].empty());
  EXPECT_GT(report["wall_s"].get<double>(), 0);
  EXPECT_NEAR(report["ns_per_rod_frame"].get<double>(), report["wall_s"].get<double>() * 1e9 / 30, 1e-6);
  EXPECT_EQ(report["state_hash"].get<std::string>().size(), 18u);
}

/// Stands for a value of any type where an aggregate is initialised.
struct Anything {
  template <class T>
  operator T() const;
};

/// How many members an aggregate has: the most values with which it can be initialised.
template <class Aggregate, class... Values>
constexpr std::size_t count_members() {
  if constexpr (requires { Aggregate{Values{}..., Anything{}}; })
    return count_members<Aggregate, Values..., Anything>();
  else
    return sizeof...(Values);
}

TEST(Report, SaysWhatABudgetDid) {
  const Scene scene = make_chain(5);
  RunPlan plan = short_plan();
  plan.settings.substeps = 4;
  plan.step_budget_us = 1e12;
  const RunResult result = run_scene(scene, plan);
  const Read report = parsed(report_json("chain:links=5", plan, result, describe_machine(result.info)));
  const Read& enough = report["budget"];
  EXPECT_EQ(keys(enough), (std::set<std::string>{"late_frames", "longest_step_us", "step_us", "asked_us"}));
  EXPECT_EQ(enough["late_frames"], 0);
  EXPECT_LE(enough["longest_step_us"].get<double>(), enough["step_us"].get<double>());
  plan.step_budget_us = 1e-6;
  const RunResult late = run_scene(scene, plan);
  EXPECT_EQ(late.late_frames, late.frames);
  EXPECT_EQ(late.total.substeps, late.frames) << "not even the first guesses that more fit";
}

// A member that no row names would be in no output. StepReport::stopped_by is a word and has no row.
TEST(Counters, HaveARowForEveryMemberOfStepReport) {
  EXPECT_EQ(counters().size(), count_members<StepReport>() - 1) << "add a row to scenes/runs/counters.cpp";
  std::set<std::string> names;
  for (const Counter& counter : counters()) {
    EXPECT_TRUE(names.insert(flat_name(counter)).second) << counter.name;
    EXPECT_FALSE(counter.meaning.empty()) << counter.name;
  }
}

// A row that names the wrong member would show another's count.
TEST(Counters, EachReadAMemberOfItsOwn) {
  for (const Counter& counter : counters()) {
    StepReport report;
    std::visit([&](auto member) { report.*member = 3; }, counter.member);
    for (const Counter& other : counters()) {
      EXPECT_EQ(is_counted(other, report), &other == &counter) << counter.name << ", " << other.name;
      EXPECT_EQ(text_of(other, report), &other == &counter ? "3" : "0") << counter.name;
    }
  }
}

// Six frames of a chain that lies straight and starts at rest: its potential energy is zero at y = 0, and
// under gravity alone the total stays there but for what the method loses, which is less than all there is to
// lose.
TEST(Report, EnergyIsRelativeToItsRange) {
  const Scene scene = make_chain(5, 0.1, 10);
  const RunPlan plan = short_plan();
  const RunResult result = run_scene(scene, plan);
  const Read report = parsed(report_json("", plan, result, describe_machine()));
  EXPECT_EQ(report["energy"]["initial"], 0);
  EXPECT_NEAR(report["energy"]["final"].get<double>(), result.energy.final / energy_range(scene), 1e-15);
  EXPECT_LE(std::abs(report["energy"]["final"].get<double>()), report["energy"]["drift_max"].get<double>());
  EXPECT_LT(report["energy"]["drift_max"].get<double>(), 1);
}

TEST(Report, ValuesWithoutMeaningAreNull) {
  Scene scene = make_chain(2);
  scene.gravity = {};
  const RunPlan plan = short_plan();
  RunResult result = run_scene(scene, plan);
  result.stretch.max = std::numeric_limits<double>::infinity();
  result.info.rods = 0;
  const Read report = parsed(report_json("", plan, result, describe_machine()));
  EXPECT_TRUE(report["energy"]["drift_max"].is_null());
  EXPECT_TRUE(report["stretch"]["max"].is_null());
  EXPECT_TRUE(report["ns_per_rod_frame"].is_null());
}

TEST(Report, HashIsHexadecimal) {
  EXPECT_EQ(hash_text(0), "0x0000000000000000");
  EXPECT_EQ(hash_text(0x0123456789abcdefu), "0x0123456789abcdef");
}

TEST(Run, FramesEndAtMultiplesOfDt) {
  EXPECT_EQ(frame_at(0.5, 1.0 / 60), 30u);
  EXPECT_EQ(frame_at(0.1, 1.0 / 60), 6u);
  EXPECT_EQ(frame_at(0, 1.0 / 60), 0u);
  EXPECT_FALSE(frame_at(0.51, 1.0 / 60));
  EXPECT_FALSE(frame_at(-1, 1.0 / 60));
  EXPECT_EQ(message_of([] { count_frames({.duration = 1, .dt = 0.3}); }),
            "the duration, 1 s, is not a whole number of frames of 0.3 s; 3 frames would be 0.9 s");
  EXPECT_EQ(message_of([] { count_frames({.duration = 1, .dt = 0}); }), "dt must be positive and finite");
  EXPECT_EQ(message_of([] { count_frames({.duration = -1, .dt = 1}); }),
            "the duration must be positive and finite");
}

TEST(Run, SavesTheFramesAskedForUnderTheTimesAskedFor) {
  const Scene scene = make_chain(2);
  std::vector<double> times;
  RunObserver observer;
  observer.save = [&](const Frame& frame) { times.push_back(frame.t); };
  run_scene(scene, short_plan(), {}, observer);
  ASSERT_EQ(times.size(), 7u);  // the start and six frames
  EXPECT_EQ(times.front(), 0);
  EXPECT_NEAR(times.back(), 0.1, 1e-15);

  times.clear();
  observer.save_at = {0.1, 0.05, 0.1};
  run_scene(scene, short_plan(), {}, observer);
  EXPECT_EQ(times, (std::vector<double>{0.05, 0.1}));

  observer.save_at = {0.03};
  EXPECT_EQ(message_of([&] { run_scene(scene, short_plan(), {}, observer); }),
            "no frame ends at the time to save, 0.03 s: frames are 0.0166666666667 s long");
  observer.save_at = {0.2};
  EXPECT_EQ(message_of([&] { run_scene(scene, short_plan(), {}, observer); }),
            "the time to save, 0.2 s, is after the end at 0.1 s");
}

TEST(Run, ComparesTensionsAndNamesTheLargest) {
  const Scene scene = make_chain(2);
  RunPlan plan = short_plan();
  plan.settings = {.method = Method::direct, .tensions = true};
  std::vector<Frame> truth;
  RunObserver observer;
  observer.save = [&](const RunFrame& frame) {
    truth.push_back(frame);
    EXPECT_EQ(frame.forces.reactions.size(), scene.particles.size());
  };
  observer.save_at = {0.1};
  const RunResult first = run_scene(scene, plan, {}, observer);
  EXPECT_TRUE(first.tension_error.empty());
  EXPECT_EQ(first.most_tense_rod, 0u) << "all hangs from it";
  EXPECT_GE(first.largest_tension, truth[0].tensions[0]);
  truth[0].tensions[1] += 1;
  const RunResult result = run_scene(scene, plan, truth);
  ASSERT_EQ(result.tension_error.size(), 1u);
  EXPECT_NEAR(result.tension_error[0].rms_n, 1 / std::sqrt(2), 1e-14);
}

TEST(Run, ComparesWithTheTimesOfTheTruthThatItReaches) {
  const Scene scene = make_chain(2);
  std::vector<Frame> truth;
  RunObserver observer;
  observer.save = [&](const Frame& frame) { truth.push_back(frame); };
  observer.save_at = {0.05, 0.1};
  const RunResult first = run_scene(scene, short_plan(), {}, observer);
  EXPECT_TRUE(first.position_error.empty());
  // A third time beyond the end, and one between frames, are passed over; the first is put 0.3 m off.
  truth.push_back(truth.back());
  truth.back().t = 5;
  truth.insert(truth.begin(), truth.front());
  truth.front().t = 0.03;
  for (Vec3& p : truth[1].positions) p += Vec3{0.3, 0, 0};

  const RunResult result = run_scene(scene, short_plan(), truth);
  ASSERT_EQ(result.position_error.size(), 2u);
  EXPECT_EQ(result.position_error[0].t, 0.05);
  EXPECT_NEAR(result.position_error[0].rms_m, 0.3, 1e-14);
  EXPECT_NEAR(result.position_error[0].relative, 0.3 / 0.2, 1e-13);
  EXPECT_EQ(result.position_error[1].rms_m, 0);
  EXPECT_EQ(result.state_hash, first.state_hash);

  truth.resize(1);
  EXPECT_EQ(
      message_of([&] { run_scene(scene, short_plan(), truth); }),
      "nothing to compare: none of the truth's times (0.03 s) is the end of a frame of 0.0166666666667 s "
      "within 0.1 s");
  EXPECT_EQ(message_of([&] { run_scene(make_chain(3), short_plan(), truth); }),
            "the truth has 3 particles, the scene 4");
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
