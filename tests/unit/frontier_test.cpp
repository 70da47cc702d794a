#include <gtest/gtest.h>

#include <filesystem>

#include "frontier/contest.hpp"
#include "frontier/peers.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"

namespace plumb::frontier::PLUMB_TEST_FILE {
namespace {

using Points = std::vector<std::pair<double, double>>;

TEST(Front, IsWhatNothingElseDominates) {
  EXPECT_EQ(find_front({}, 0), std::vector<bool>{});
  EXPECT_EQ(find_front({{1, 1e-2}, {2, 1e-3}, {3, 1e-2}, {4, 1e-4}, {5, 2e-4}}, 0),
            (std::vector<bool>{true, true, false, true, false}));
  // Of two that are equal, the first.
  EXPECT_EQ(find_front({{1, 1e-2}, {1, 1e-2}}, 0), (std::vector<bool>{true, false}));
}

TEST(Front, TakesErrorsBelowTheTruthsForEqual) {
  EXPECT_EQ(find_front({{1, 3e-9}, {2, 1e-12}}, 1e-8), (std::vector<bool>{true, false}));
  EXPECT_EQ(find_front({{1, 3e-9}, {2, 1e-12}}, 1e-9), (std::vector<bool>{true, true}));
}

TEST(Front, NeverHoldsADominatedPointOfRandomOnes) {
  Points points;
  std::uint64_t state = 1;
  const auto next = [&state] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 40) + 1;
  };
  for (int i = 0; i < 200; ++i) points.emplace_back(next(), next());
  const std::vector<bool> front = find_front(points, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool dominated = false;
    for (const auto& [time, error] : points)
      dominated = dominated || (time < points[i].first && error <= points[i].second) ||
                  (time <= points[i].first && error < points[i].second);
    EXPECT_EQ(front[i], !dominated) << i;
  }
}

TEST(FrontierProblems, HaveTruths) {
  for (const char* name : {"N5_r10", "elastic", "winch", "wire", "rods5", "tree", "humanoid", "ring"}) {
    for (Problem problem : all_problems()) {
      if (problem.name != name) continue;
      prepare(problem, 1);
      EXPECT_LE(problem.truth_error, 1e-9) << name;
      ASSERT_EQ(problem.truth.size(), 1u);
      EXPECT_EQ(problem.truth[0].positions.size(), problem.scene.particles.size());
    }
  }
}

// Second order relaxation, extrapolated: what it says it is known to must hold against Taylor series.
TEST(FrontierProblems, ExtrapolatedTruthsAreAsGoodAsTheySay) {
  Problem by_series{.name = "net", .spec = "net:width=4,height=6,level=1", .duration = 0.5};
  Problem extrapolated{.name = "net", .spec = "net:width=42,height=6,level=1", .duration = 0.5};
  prepare(by_series, 1);
  prepare(extrapolated, 2);
  EXPECT_EQ(by_series.truth_source, "Taylor series");
  EXPECT_EQ(extrapolated.truth_source, "extrapolated from relaxation");
  EXPECT_LE(extrapolated.truth_error, 1e-5);
  // Columns of a level net swing alike, however many there are.
  const double apart =
      norm(by_series.truth[0].positions.back() - extrapolated.truth[0].positions.back() + Vec3{3.8, 0, 0});
  EXPECT_LE(apart, 10 * extrapolated.truth_error * bounding_diagonal(extrapolated.scene));
}

// A figure is struck after a fifth of a second and compared after two. Contact is of first order here, so
// that the last two runs are nearer to each other than a tenth of a step's error, which is 1e-2.
TEST(FrontierProblems, ConvergedRunsAreAsGoodAsTheySay) {
  for (Problem problem : all_problems()) {
    if (problem.name != "struck") continue;
    ASSERT_TRUE(problem.touches);
    prepare(problem, 1e-3);
    EXPECT_EQ(problem.truth_source, "direct with 32 substeps against half as many");
    const double rough = problem.truth_error;
    const std::vector<Vec3> coarse = problem.truth[0].positions;
    EXPECT_LE(rough, 1e-3);
    EXPECT_GT(rough, 0);
    prepare(problem, 1);
    EXPECT_LT(problem.truth_error, rough);
    // Halved errors add up to twice the first.
    EXPECT_LE(rms_distance(coarse, problem.truth[0].positions), 2 * rough * bounding_diagonal(problem.scene));
  }
}

TEST(FrontierProblems, FewMethodsMoveWhatTouches) {
  std::uint32_t touching = 0;
  for (const Problem& problem : all_problems()) {
    if (!problem.touches) continue;
    ++touching;
    for (const std::string& family : all_families())
      EXPECT_EQ(paths_of(family, problem).empty(),
                family != "auto" && family != "direct" && family != "relax")
          << family;
  }
  EXPECT_EQ(touching, 3u);
}

TEST(Contest, KnowsItsFamilies) {
  Problem problem{.name = "N5_r10", .spec = "chain:links=5,end_mass=10"};
  prepare(problem, 1);
  for (const std::string& family : all_families())
    for (const Path& path : paths_of(family, problem)) EXPECT_EQ(path.family, family);
  EXPECT_THROW(paths_of("implicit springs", problem), std::logic_error);
}

TEST(Contest, MeasuresEveryFamily) {
  Problem problem{.name = "N5_r10", .spec = "chain:links=5,end_mass=10", .duration = 0.5};
  prepare(problem, 1);
  const std::vector<Point> points = compete(problem, all_families(), {.path_s = 0.01, .contest_s = 0.05});
  for (const std::string& family : all_families()) {
    const auto best = std::min_element(points.begin(), points.end(), [&](const Point& a, const Point& b) {
      return std::pair(a.family != family, a.position_error) <
             std::pair(b.family != family, b.position_error);
    });
    ASSERT_NE(best, points.end());
    EXPECT_EQ(best->family, family);
    EXPECT_LT(best->position_error, 0.1) << family;
    EXPECT_GT(best->ms, 0) << family;
  }
  EXPECT_TRUE(std::any_of(points.begin(), points.end(), [](const Point& p) { return p.on_front; }));
}

TEST(Peers, AreReadAsTheyAreWritten) {
  const Point point{.family = "Bullet",
                    .setting = "multibody 60 x 4",
                    .ms = 1.25,
                    .median_ms = 1.5,
                    .repetitions = 3,
                    .position_error = 1e-3,
                    .stretch = 2e-2,
                    .energy_drift = 0.125};
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "plumb_peers_test.csv";
  scenes::write_file(file, std::string(csv_header) + csv_row("rods5", point));
  const std::vector<PeerPoint> read = read_points(file);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].scene, "rods5");
  EXPECT_EQ(csv_row("rods5", read[0].point), csv_row("rods5", point));

  std::vector<Point> points{{.family = "direct", .ms = 2, .position_error = 1e-3}};
  add_peers(read, {.name = "rods5"}, points);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_FALSE(points[0].on_front);
  EXPECT_TRUE(points[1].on_front);
  add_peers(read, {.name = "tree"}, points);
  EXPECT_EQ(points.size(), 2u);

  scenes::write_file(file, std::string(csv_header) + "rods5,Bullet,x,1,1,1,nan,0,0,0\n");
  try {
    read_points(file);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), file.string() + ", line 2: 'nan' is not a number of 0 or more");
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace plumb::frontier::PLUMB_TEST_FILE
