#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>

#include "plumb/error.hpp"
#include "stability/grid.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

const StabilityMethod& method(const std::string& name) {
  const auto& all = all_stability_methods();
  return *std::find_if(all.begin(), all.end(), [&](const StabilityMethod& m) { return m.name == name; });
}

/// A cell that was run to its end and in which nothing went wrong.
StabilityResult sound() {
  StabilityResult result;
  result.cell.frames = result.frames = 10;
  result.stretch_max = 0.1;
  result.energy_gain = 0.1;
  return result;
}

TEST(Stability, DefaultGridIsTheTwoPlanesEachCellOnce) {
  const StabilityGrid grid;
  const auto cells = list_cells(grid);
  // 7 ratios, 5 links and 6 steps, the line that the planes share counted once.
  EXPECT_EQ(cells.size(), grid.methods.size() * 7 * (5 + 6 - 1));
  std::set<std::tuple<std::string, double, std::uint32_t, double>> seen;
  for (const StabilityCase& c : cells) {
    EXPECT_TRUE(c.size == grid.at_size || c.dt == grid.at_dt);
    EXPECT_TRUE(seen.emplace(c.method.name, c.severity, c.size, c.dt).second);
  }
}

TEST(Stability, FullGridIsTheWholeBox) {
  StabilityGrid grid;
  grid.full = true;
  EXPECT_EQ(list_cells(grid).size(), grid.methods.size() * 7 * 5 * 6);
}

TEST(Stability, FramesCoverTheDurationToHalfAStep) {
  StabilityGrid grid;
  grid.full = true;
  for (const StabilityCase& c : list_cells(grid)) EXPECT_NEAR(c.simulated_s(), grid.duration, c.dt / 2);
  grid.duration = 0.01;
  for (const StabilityCase& c : list_cells(grid)) EXPECT_GE(c.frames, 1u);
}

TEST(Stability, DefaultMethodsAreAllThatDiffer) {
  for (const StabilityMethod& m : default_stability_methods()) EXPECT_NE(m.method, Method::automatic);
  EXPECT_EQ(default_stability_methods().size() + 1, all_stability_methods().size());
}

TEST(Stability, RefusesGridsThatMakeNoSense) {
  for (const auto& spoil : std::initializer_list<void (*)(StabilityGrid&)>{
           [](StabilityGrid& g) { g.methods.clear(); }, [](StabilityGrid& g) { g.severities.clear(); },
           [](StabilityGrid& g) { g.severities = {-1}; }, [](StabilityGrid& g) { g.sizes = {0}; },
           [](StabilityGrid& g) { g.dts.push_back(std::numeric_limits<double>::quiet_NaN()); },
           [](StabilityGrid& g) { g.duration = 0; }, [](StabilityGrid& g) { g.at_size = 7; },
           [](StabilityGrid& g) { g.at_dt = 0.5; }}) {
    StabilityGrid grid;
    spoil(grid);
    EXPECT_THROW(list_cells(grid), InputError);
  }
}

TEST(Stability, CriterionNamesTheFirstThingThatWentWrong) {
  StabilityResult r = sound();
  EXPECT_EQ(judge(r), Outcome::survived);
  r.frames = 9;
  EXPECT_EQ(judge(r), Outcome::too_slow);
  r.energy_gain = 1.01 * most_gain_of(StabilityScene::chains);
  EXPECT_EQ(judge(r), Outcome::gained_energy);
  r.depth_max = 1.01 * most_depth;
  EXPECT_EQ(judge(r), Outcome::sank);
  r.stretch_max = 1.01 * most_stretch;
  EXPECT_EQ(judge(r), Outcome::stretched);
  r.total.unsolved = 1;
  EXPECT_EQ(judge(r), Outcome::unsolved);
  r.total.frozen_islands = 1;
  EXPECT_EQ(judge(r), Outcome::frozen);
  r.finite = false;
  EXPECT_EQ(judge(r), Outcome::not_finite);
}

TEST(Stability, WhatIsNotANumberDoesNotSurvive) {
  StabilityResult r = sound();
  r.stretch_max = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judge(r), Outcome::stretched);
  r = sound();
  r.energy_gain = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judge(r), Outcome::gained_energy);
}

TEST(Stability, LosingEnergyIsNotBreaking) {
  StabilityResult r = sound();
  r.energy_gain = 0;
  r.energy_drift = 0.9;
  EXPECT_EQ(judge(r), Outcome::survived);
}

// One second of five links with a heavy end: the direct method at the middle keeps rods and energy to
// rounding (1e-9 leaves three digits for what Newton leaves), relaxation at the old position is far beyond
// 2/omega_max.
TEST(Stability, MeasuresWhatHoldsAndWhatBreaks) {
  const StabilityResult holds = measure_stability({method("direct-mid"), 1000, 5, 1.0 / 60, 60}, 20, 60);
  EXPECT_EQ(holds.outcome, Outcome::survived);
  EXPECT_EQ(holds.frames, 60u);
  EXPECT_LT(holds.stretch_max, 1e-9);
  EXPECT_LT(holds.energy_drift, 1e-9);
  const StabilityResult breaks = measure_stability({method("relax-old"), 1000, 5, 1.0 / 60, 60}, 20, 60);
  EXPECT_NE(breaks.outcome, Outcome::survived);
  EXPECT_NE(breaks.outcome, Outcome::too_slow);
}

TEST(Stability, AutoIsMeasuredToo) {
  EXPECT_EQ(measure_stability({method("auto"), 1, 5, 0.01, 10}, 20, 60).frames, 10u);
}

TEST(Stability, StopsWhenItsTimeIsOver) {
  const StabilityResult r = measure_stability({method("relax-new"), 1, 5, 0.01, 1'000'000'000}, 20, 1e-9);
  EXPECT_EQ(r.frames, 1u);
  EXPECT_EQ(r.outcome, Outcome::too_slow);
  EXPECT_TRUE(std::isfinite(r.ms_per_s()));
}

TEST(Stability, CsvHasAsManyFieldsAsItsHeader) {
  StabilityResult r = sound();
  r.cell.method = method("direct-old");
  r.energy_drift = std::numeric_limits<double>::infinity();
  const std::string csv = stability_csv({r});
  const auto end = csv.begin() + static_cast<std::ptrdiff_t>(csv.find('\n'));
  EXPECT_EQ(std::count(csv.begin(), end, ','), std::count(end, csv.end(), ','));
  EXPECT_NE(csv.find("chains,direct-old,1,,1,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",survived,0.1,0,inf,"), std::string::npos) << csv;
  r.cell.scene = StabilityScene::boxes;
  r.cell.severity = 30;
  const std::string landed = stability_csv({r});
  EXPECT_EQ(std::count(landed.begin(), landed.end(), ','), std::count(csv.begin(), csv.end(), ','));
  EXPECT_NE(landed.find("boxes,direct-old,,30,1,"), std::string::npos) << landed;
}

TEST(Stability, WhatLandsMayGainLess) {
  StabilityResult r = sound();
  EXPECT_EQ(judge(r), Outcome::survived);
  r.cell.scene = StabilityScene::ropes;
  EXPECT_EQ(judge(r), Outcome::gained_energy);
}

TEST(Stability, EveryScenesGridIsMeasuredByWhatMovesIt) {
  for (const StabilityScene scene : {StabilityScene::chains, StabilityScene::nets, StabilityScene::ropes,
                                     StabilityScene::drapes, StabilityScene::boxes}) {
    const StabilityGrid grid = default_grid(scene);
    const auto cells = list_cells(grid);
    ASSERT_FALSE(cells.empty()) << to_string(scene);
    const std::size_t planes = grid.sizes.size() + grid.dts.size() - 1;
    EXPECT_EQ(cells.size(), grid.methods.size() * grid.severities.size() * planes) << to_string(scene);
    for (const StabilityMethod& m : grid.methods) {
      StabilityCase cell{m, 1, grid.at_size, 0.01, 1, scene};
      EXPECT_EQ(measure_stability(cell, 20, 60).frames, 1u) << to_string(scene) << ", " << m.name;
    }
  }
}

// A net of 4 x 4 particles hangs from two corners, and its rows are slack by a tenth. Method direct at the
// middle keeps it as it keeps a chain, to rounding; Newton leaves 1e-10.
TEST(Stability, NetsHangFromTwoCorners) {
  const StabilityCase cell{method("direct-mid"), 100, 4, 1.0 / 60, 60, StabilityScene::nets};
  const Scene scene = make_stability_scene(cell);
  EXPECT_EQ(std::count_if(scene.particles.begin(), scene.particles.end(),
                          [](const Particle& p) { return p.fixed; }),
            2);
  EXPECT_EQ(scene.particles.back().mass, 100);
  const StabilityResult result = measure_stability(cell, 20, 60);
  EXPECT_EQ(result.outcome, Outcome::survived);
  EXPECT_LT(result.stretch_max, 1e-9);
  EXPECT_LT(result.energy_drift, 1e-9);
}

// Springs give by 1 % under the weight of all. Implicit steps of 10 ms follow them; explicit ones would have
// to be below 2/omega, with omega = 2 sqrt(k/m) some 490/s, and do not stay finite.
TEST(Stability, SpringsHoldInImplicitStepsAlone) {
  const StabilityResult holds = measure_stability({method("springs-implicit"), 1, 5, 0.01, 100}, 20, 60);
  EXPECT_EQ(holds.outcome, Outcome::survived);
  EXPECT_GT(holds.stretch_max, 1e-4);
  const StabilityResult breaks = measure_stability({method("springs"), 1, 5, 0.01, 100}, 20, 60);
  EXPECT_NE(breaks.outcome, Outcome::survived);
  EXPECT_NE(breaks.outcome, Outcome::too_slow);
}

// What is thrown down at 10 m/s loses that, and lies: nothing is deeper than a tenth of its thickness, which
// leaves room for the slop of 0.5 mm at a radius of 1 cm and more.
TEST(Stability, WhatLandsComesToRest) {
  for (const StabilityScene scene : {StabilityScene::ropes, StabilityScene::drapes, StabilityScene::boxes}) {
    const StabilityCase cell{method("auto"), 10, 5, 1.0 / 60, 30, scene};
    const StabilityResult result = measure_stability(cell, 20, 600);
    EXPECT_EQ(result.outcome, Outcome::survived) << to_string(scene);
    EXPECT_LT(result.depth_max, 0.1) << to_string(scene);
    EXPECT_GT(result.energy_drift, 0.5) << to_string(scene);
    EXPECT_LT(result.energy_gain, 1e-6) << to_string(scene);
    EXPECT_GT(result.total.contact_points, 0u) << to_string(scene);
  }
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
