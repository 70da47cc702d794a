// Runs that are stopped and go on from the snapshot that they left.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "cli/checkpoint.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/runs/run.hpp"
#include "scenes/runs/saved_run.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using scenes::RunFrame;
using scenes::RunObserver;
using scenes::RunPlan;
using scenes::RunResult;

/// Returns a file for the test that runs: others run at the same time.
std::string file_of_test() {
  return testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".snapshot";
}

class ResumedRuns : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file); }

  /// Runs to `duration`, and adds frames to `trajectory`. Frame `stop` raises a signal, as Ctrl-C does.
  RunResult run(const RunPlan& plan, std::string& trajectory, std::uint64_t stop = 0) const {
    RunObserver observer;
    observer.save = [&](const RunFrame& frame) { scenes::append_frame(trajectory, frame); };
    observer.progress = [&](std::uint64_t done, std::uint64_t) {
      if (done == stop) std::raise(SIGINT);
    };
    tools::Checkpoint checkpoint(file);
    observer.goes_on = [&](const World& world) { return checkpoint.see(world); };
    observer.ended = [&](const World& world) { checkpoint.write(world); };
    return scenes::run_scene(scene, plan, {}, observer);
  }

  const std::string file = file_of_test();
  const Scene scene = scenes::make_chain(8, 0.1, 10);
};

TEST_F(ResumedRuns, GoOnAsIfNothingHadStoppedThem) {
  std::string whole, parts;
  RunPlan plan{.duration = 0.5};
  plan.rates = {{.rod = 3, .rate = -0.05}};
  const RunResult straight = run(plan, whole);
  EXPECT_TRUE(straight.is_whole);

  const RunResult stopped = run(plan, parts, 11);
  EXPECT_FALSE(stopped.is_whole);
  EXPECT_EQ(stopped.frames, 11u);
  EXPECT_NEAR(stopped.end, 11 * plan.dt, 1e-15);

  plan.resume = file;
  const RunResult rest = run(plan, parts);
  EXPECT_TRUE(rest.is_whole);
  EXPECT_EQ(rest.start, stopped.end);
  EXPECT_EQ(rest.frames, 19u);
  EXPECT_EQ(rest.state_hash, straight.state_hash);
  EXPECT_EQ(parts, whole);
  EXPECT_EQ(rest.energy.initial, stopped.energy.final) << "lengths must be those of then";
}

TEST_F(ResumedRuns, LeaveOutWhatHadBroken) {
  Scene weak = scene;
  weak.rods[4].law.strength = 1;
  RunPlan plan{.duration = 0.1};
  plan.settings.method = Method::direct;
  RunObserver observer;
  tools::Checkpoint checkpoint(file);
  observer.ended = [&](const World& world) { checkpoint.write(world); };
  const RunResult broken = scenes::run_scene(weak, plan, {}, observer);
  ASSERT_EQ(broken.total.broken_rods, 1u);
  plan.duration = 0.5;
  plan.resume = file;
  const RunResult rest = scenes::run_scene(weak, plan);
  EXPECT_EQ(rest.energy.initial, broken.energy.final);
  EXPECT_LT(rest.stretch.max, 1e-9) << "a broken rod has no strain";
}

TEST_F(ResumedRuns, RefuseWhatCannotGoOn) {
  std::string frames;
  RunPlan plan{.duration = 0.5};
  run(plan, frames);
  plan.resume = file;
  const auto refused = [&](const RunPlan& of) {
    return test::refusal([&] { scenes::run_scene(scene, of); });
  };
  EXPECT_EQ(refused(plan),
            file + ": the snapshot is of 0.5 s, and the run ends at 0.5 s: ask for a longer --duration");
  plan.duration = 1.5;
  plan.dt = 0.3;
  EXPECT_EQ(refused(plan), file + ": the snapshot is of 0.5 s, where no frame of 0.3 s ends");
  plan.settings.substeps = 3;
  EXPECT_TRUE(refused(plan).starts_with(file + ": snapshot: is of a world with other settings"));
  scenes::write_file(file, "t,particle,x,y,z,vx,vy,vz\n0,0,0,0,0,0,0,0\n0,1,0.1,0,0,0,0,0\n");
  EXPECT_EQ(refused(plan), file + ": snapshot: does not begin as one");
}

/// Runs with a file as the command writes it.
class SavedRuns : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file); }

  /// Runs a plan. Says how often the file was written, if it is asked to be every so many seconds.
  RunResult run(const RunPlan& plan, std::optional<double> every = {}, int* writes = nullptr) const {
    tools::Checkpoint checkpoint(file, scenes::run_text("chain:links=8", plan), every);
    RunObserver observer;
    std::string before;
    observer.goes_on = [&](const World& world) {
      const bool goes_on = checkpoint.see(world);
      if (writes && std::exchange(before, scenes::read_file(file)) != before) ++*writes;
      return goes_on;
    };
    observer.ended = [&](const World& world) { checkpoint.write(world); };
    return scenes::run_scene(scene, plan, {}, observer);
  }
  std::string refused(const RunPlan& plan) const {
    return test::refusal([&] { scenes::run_scene(scene, plan); });
  }

  const std::string file = file_of_test();
  const Scene scene = scenes::make_chain(8, 0.1, 10);
};

TEST_F(SavedRuns, GoOnToTheSameBits) {
  RunPlan plan{.duration = 0.5};
  const RunResult straight = run(plan);
  plan.duration = 0.2;
  run(plan);
  plan.duration = 0.5;
  plan.resume = file;
  plan.settings.isa = Isa::scalar;  // bits are the same
  EXPECT_EQ(scenes::run_scene(scene, plan).state_hash, straight.state_hash);
  // Programs read the file as it is.
  const std::string bytes = scenes::read_file(file);
  World world(scene, {});
  world.restore(std::as_bytes(std::span(bytes)));
  EXPECT_NEAR(world.time(), 0.2, 1e-12);
  EXPECT_NE(bytes.find("\n  \"scene\": \"chain:links=8\",\n"), std::string::npos);
}

TEST_F(SavedRuns, AreWrittenAsOftenAsAsked) {
  int writes = 0;
  run({.duration = 1, .dt = 0.02}, 0.1, &writes);
  EXPECT_EQ(writes, 11) << "at the start, and after every tenth of a second";
}

TEST_F(SavedRuns, AreRefusedByTheSettingThatDiffers) {
  RunPlan plan{.duration = 0.2};
  run(plan);
  plan.duration = 0.5;
  plan.resume = file;
  const std::string scene_of = "; it was saved of the scene \"chain:links=8\"";
  RunPlan other = plan;
  other.dt = 1.0 / 50;
  EXPECT_TRUE(refused(other).starts_with(file + ": is of a run with another --dt: 0.01666"))
      << refused(other);
  other = plan;
  other.settings.substeps = 3;
  EXPECT_EQ(refused(other), file + ": is of a run with another --substeps: 1, and not 3" + scene_of);
  other = plan;
  other.rates = {{.rod = 3, .rate = -0.05}};
  EXPECT_EQ(refused(other),
            file + ": is of a run with another --winch: \"\", and not \"3:-0.05\"" + scene_of);
  // The gradient follows from the method, which is named.
  other = plan;
  other.settings.method = Method::relax;
  EXPECT_EQ(refused(other),
            file + ": is of a run with another --method: \"auto\", and not \"relax\"" + scene_of);
  other = plan;
  other.settings.most_work = 100;
  EXPECT_EQ(refused(other), file + ": is of a run with another --most-work: 20000, and not 100" + scene_of);
  EXPECT_EQ(test::refusal([&] { scenes::run_scene(scenes::make_chain(9, 0.1, 10), plan); }),
            file + ": snapshot: is of another scene" + scene_of);
}

TEST_F(SavedRuns, AreRefusedIfDamaged) {
  RunPlan plan{.duration = 0.2};
  run(plan);
  plan.duration = 0.5;
  plan.resume = file;
  const std::string bytes = scenes::read_file(file);
  std::size_t snapshot = bytes.rfind("{\n  \"plumb_run\"");
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{47}, snapshot / 2, snapshot - 1,
                                 snapshot + 1, snapshot + 40, bytes.size() - 2}) {
    scenes::write_file(file, std::string_view(bytes).substr(0, size));
    EXPECT_TRUE(refused(plan).starts_with(file + ": ")) << size;
  }
  for (std::size_t at = 3; at < snapshot; at += 97) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    scenes::write_file(file, changed);
    EXPECT_TRUE(refused(plan).starts_with(file + ": ")) << at;
  }
  scenes::write_file(file, bytes);
  EXPECT_EQ(refused(plan), "");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
