#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scale/fit.hpp"
#include "scale/output.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

TEST(ScaleFit, FindsThePowerOfLinks) {
  std::vector<Timing> timings;
  for (const double links : {1.0, 10.0, 20.0, 500.0})
    timings.emplace_back(links, 3e-7 * std::pow(links, 1.5));
  EXPECT_NEAR(*fit_slope(timings), 1.5, 1e-12);
  EXPECT_FALSE(fit_slope({}));
  EXPECT_FALSE(fit_slope({{5, 1e-6}}));
  EXPECT_FALSE(fit_slope({{5, 1e-6}, {5, 2e-6}}));
}

// What a frame costs by itself hides the power at first; the longer half of the lengths has less of it.
TEST(ScaleFit, LongerHalfLeavesOutWhatAFrameCostsByItself) {
  const std::vector<Timing> timings = {{1, 1e-6}, {2, 1e-6}, {4, 1e-6}, {1000, 1e-5}, {10000, 1e-4}};
  EXPECT_NEAR(*fit_longer_half({timings.begin() + 1, timings.end()}), 1, 1e-12);
  EXPECT_LT(*fit_slope(timings), 0.6);
  EXPECT_NEAR(*fit_longer_half(timings), *fit_slope({timings.begin() + 2, timings.end()}), 1e-12);
}

TEST(ScaleFit, LevelEndsWhereFramesGetSlower) {
  EXPECT_EQ(level_until({{1, 1.0}, {5, 1.1}, {20, 1.2}, {50, 1.3}, {100, 1.2}}, 1.25), 20);
  EXPECT_EQ(level_until({{1, 1.0}, {5, 2.0}}, 1.25), 1);
  EXPECT_EQ(level_until({}, 1.25), 0);
}

TEST(CellCap, EndsASeriesThatWouldTakeTooLong) {
  CellCap cap(1);
  EXPECT_TRUE(cap.allows(1e9));  // nothing is known yet
  cap.spent(100, 0.1);
  EXPECT_TRUE(cap.allows(1000));
  EXPECT_FALSE(cap.allows(1001));
  cap.spent(1000, 1.5);
  EXPECT_FALSE(cap.allows(1));
  CellCap stopped(1);
  stopped.stop();
  EXPECT_FALSE(stopped.allows(1));
}

// Relaxation has a series for each order, precision and number of threads.
TEST(ScaleSeries, AreRelaxationEightTimesAndOthersOnce) {
  ScaleOptions options;
  EXPECT_EQ(all_series(options).size(), 2 * 2 * 2 + all_methods().size() - 1);
  options.methods = {Method::springs, Method::relax};
  options.precisions = {Precision::single};
  const std::vector<ScaleSeries> series = all_series(options);
  ASSERT_EQ(series.size(), 5u);
  EXPECT_EQ(name_of(series[0]), "springs");
  EXPECT_EQ(name_of(series[2]), "relax, float, threads");
  EXPECT_EQ(name_of(series[4]), "relax, jacobi, float, threads");
  EXPECT_EQ(settings_of(series[4], options).order, SweepOrder::jacobi);
  options.orders = {SweepOrder::gauss_seidel};
  EXPECT_EQ(all_series(options).size(), 3u);
}

TEST(ScaleSeries, AreNamedWithTheirOrderInTheCsv) {
  ScaleResults results;
  const ScaleSeries series{.method = Method::relax, .order = SweepOrder::jacobi};
  results.cells.push_back(
      {.series = series, .links = 5, .sweeps = 5, .outcome = CellOutcome::measured, .least_s = 1e-6});
  EXPECT_NE(scale_csv(results).find("\n5,relax,5,jacobi,1,double,"), std::string::npos);
}

/// Relaxation of 5 and 20 links, the second too slow.
ScaleResults two_cells(const ScaleSeries& series) {
  ScaleResults results;
  results.cells.push_back({.series = series,
                           .links = 5,
                           .outcome = CellOutcome::measured,
                           .frames = 60,
                           .least_s = 1e-6,
                           .median_s = 1e-6});
  results.cells.push_back({.series = series, .links = 20, .outcome = CellOutcome::too_slow});
  return results;
}

TEST(ScaleTables, HaveADashWhereNothingWasMeasured) {
  ScaleOptions options;
  options.links = {5, 20};
  const ScaleSeries series{.method = Method::featherstone};
  const std::string frames = frames_table(options, two_cells(series)).to_text();
  EXPECT_EQ(frames,
            "links  featherstone\n"
            "5           1000000\n"
            "20                —\n");
  EXPECT_NE(slope_table(options, two_cells(series)).to_text().find("20 too slow"), std::string::npos);
  EXPECT_EQ(scale_csv(two_cells(series)).find("\n20,"), std::string::npos);
  const auto json = nlohmann::json::parse(scale_json(options, two_cells(series)).dump());
  EXPECT_EQ(json["slopes"][0]["slope"], nullptr);
}

TEST(ScaleTables, HaveADashWhereNothingMeetsTheTarget) {
  ScaleOptions options;
  options.error_links = {5, 20, 1000};
  options.most_fine = 300;
  ScaleResults results;
  const ChainFamily family = ChainFamily::equal_length;
  results.errors.push_back({.family = family, .links = 5, .cheapest = Cheapest{.setting = "x", .ms = 0.05}});
  results.errors.push_back({.family = family, .links = 20});
  EXPECT_EQ(error_table(options, results, family).to_text(),
            "µs a rod and simulated second  5 links  20 links  300 links  slope\n"
            "relax                             10.0         —          —      —\n");
  EXPECT_EQ(error_links_of(family, options), (std::vector<std::uint32_t>{5, 20, options.most_fine}));
  EXPECT_EQ(error_links_of(ChainFamily::equal_links, options), options.error_links);
}

bool says(const Comparison& comparison, const std::string& words) {
  return conclusion_of(comparison).find(words) != std::string::npos;
}

TEST(ScaleCells, AreCheckedForThreads) {
  ScaleCell alone{.series = {.precision = Precision::single}, .links = 1000};
  alone.outcome = CellOutcome::measured;
  alone.frames = 60;
  alone.state_hash = 1;
  ScaleCell together = alone;
  together.series.all_threads = true;
  EXPECT_FALSE(find_differing({alone, together}));
  together.state_hash = 2;
  EXPECT_EQ(find_differing({alone, together}), 1000u);
  together.frames = 30;  // the cap cut it short: nothing to compare
  EXPECT_FALSE(find_differing({alone, together}));
}

TEST(ScaleConclusion, FollowsTheNumbers) {
  Comparison c{.springs_slope = 1.02,
               .relax_slope = 0.98,
               .springs_level = 1,
               .relax_level = 20,
               .links = 1000,
               .springs_ns = 120,
               .relax_ns = 15};
  EXPECT_TRUE(says(c, "both scale alike"));
  EXPECT_TRUE(says(c, "relaxation is 8.0 times as fast"));
  EXPECT_TRUE(says(c, "does not hold"));
  c.relax_slope = 1.5;
  c.relax_ns = 360;
  EXPECT_TRUE(says(c, "springs scale better"));
  EXPECT_TRUE(says(c, "springs are 3.0 times as fast"));
  EXPECT_TRUE(says(c, "conclusion holds"));
  c.springs_slope.reset();
  EXPECT_TRUE(says(c, "too few lengths"));
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
