// plumb humanoid: what it reads off a motion, on motions made up here, and its pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <pugixml.hpp>
#include <set>

#include "humanoid/experiment.hpp"
#include "humanoid/pictures.hpp"
#include "plumb/error.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

constexpr double dt = 1.0 / 60;
const Vec3 gravity{0, -9.81, 0};

/// A body that stands until frame `hit`, then slides along (3, 0, 4)/5 from 1 m/s, slower and slower, and
/// stops after `sliding` seconds and sleeps half a second later; the ball flies freely, bounces back in two
/// frames and goes on.
std::vector<Instant> made_up(std::size_t hit, double sliding, double duration) {
  std::vector<Instant> track;
  Vec3 ball{-10, 2, 0};
  double way = 0;
  for (std::size_t i = 0; static_cast<double>(i) * dt <= duration + 1e-9; ++i) {
    const double t = static_cast<double>(i) * dt;
    if (i > 0) ball += dt * gravity;
    if (i == hit || i == hit + 1) ball += Vec3{6, 0, 0};
    const double since = t - static_cast<double>(hit) * dt;
    const double speed = i < hit ? 0 : std::max(0.0, 1 - since / sliding);
    way += speed * dt;
    track.push_back({.t = t,
                     .center = {0.6 * way, 1, 0.8 * way},
                     .body_energy = i < hit    ? 100.0
                                    : i == hit ? 130.0
                                               : 150.0 - since,
                     .body_fastest = speed,
                     .ball_velocity = ball,
                     .asleep = i < hit || since > sliding + 0.5});
  }
  return track;
}

TEST(HumanoidTrack, ImpactIsWhereTheBallLeavesItsFlight) {
  const std::vector<Instant> track = made_up(10, 1, 3);
  const auto impact = find_impact(track, gravity);
  ASSERT_TRUE(impact);
  EXPECT_EQ(impact->first, 10u);
  EXPECT_EQ(impact->last, 11u);
  // From before the first of its frames to the end of the last.
  EXPECT_NEAR(energy_received(track, *impact), 150 - dt - 100, 1e-12);
}

TEST(HumanoidTrack, ABallThatBouncesOffTheGroundHitsNobody) {
  std::vector<Instant> track = made_up(10, 1, 3);
  for (Instant& now : track) now.body_fastest = 0;
  EXPECT_FALSE(find_impact(track, gravity));
  EXPECT_FALSE(find_impact({}, gravity));
  EXPECT_FALSE(body_rests(track, {}));
}

TEST(HumanoidTrack, RestIsTheSlownessThatSleepEnds) {
  // 1 - s/2 < 0.02 from s = 1.96 s on; the impact began a frame before its first instant.
  const std::vector<Instant> track = made_up(12, 2, 4);
  const auto impact = find_impact(track, gravity);
  ASSERT_TRUE(impact);
  const auto rest = time_to_rest(track, *impact);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(*rest, 1.96 + dt, dt);
  // It stirs before it sleeps; without sleep, however slow, it does not rest.
  std::vector<Instant> stirred = track;
  stirred[static_cast<std::size_t>(std::lround((12 * dt + 2.3) / dt))].body_fastest = 0.1;
  EXPECT_GT(*time_to_rest(stirred, *impact), 2.3);
  for (Instant& now : stirred) now.asleep = false;
  EXPECT_FALSE(time_to_rest(stirred, *impact));
}

TEST(HumanoidTrack, TheBallMayMoveOnWhenTheBodyRests) {
  const std::vector<Instant> track = made_up(12, 2, 4);
  const auto impact = find_impact(track, gravity);
  EXPECT_TRUE(body_rests(track, impact));  // the ball flies on
  EXPECT_FALSE(body_rests(std::span(track).first(track.size() - 90), impact));
  EXPECT_FALSE(body_rests(track, {}));
}

TEST(HumanoidTrack, DistanceIsAlongTheGround) {
  std::vector<Instant> track = {{.t = 0, .center = {1, 2, 3}}, {.t = 1, .center = {4, 0, 7}}};
  EXPECT_DOUBLE_EQ(distance_over_ground(track), 5);
  EXPECT_EQ(distance_over_ground({}), 0);
}

TEST(HumanoidMedian, NeedsMostOfThemToRest) {
  std::vector<HumanoidResult> results(3);
  results[0] = {.distance = 3, .time_to_rest = 2.0, .energy_received = 5};
  results[1] = {.distance = 1, .time_to_rest = {}, .energy_received = 9};
  results[2] = {.distance = 2, .time_to_rest = 4.0, .energy_received = -1};
  const HumanoidMeasure m = median_of(results);
  EXPECT_EQ(m.distance, 2);
  EXPECT_EQ(m.energy_received, 5);
  EXPECT_EQ(m.time_to_rest, 4.0);
  results[0].time_to_rest.reset();
  EXPECT_FALSE(median_of(results).time_to_rest);
}

TEST(HumanoidScene, SeedsAimElsewhereButNear) {
  HumanoidRun run;
  const Scene straight = make_scene(run);
  ASSERT_EQ(straight.particles.size(), 11u);
  ASSERT_EQ(straight.capsules.size(), 10u);
  std::set<double> heights;
  for (run.seed = 1; run.seed <= 5; ++run.seed) {
    const Vec3 off = make_scene(run).particles[10].position - straight.particles[10].position;
    EXPECT_LE(std::abs(off.y), 0.01 + 1e-12);
    EXPECT_LE(std::abs(off.z), 0.01 + 1e-12);
    heights.insert(off.y);
  }
  EXPECT_EQ(heights.size(), 5u);
  run.seed = 3;
  EXPECT_EQ(make_scene(run).particles[10].position, make_scene(run).particles[10].position);
}

TEST(HumanoidScene, PenetrationIsThatOfTheDeepest) {
  const Scene scene = make_scene({});
  std::vector<Vec3> positions;
  for (const Particle& p : scene.particles) positions.push_back(p.position);
  EXPECT_NEAR(deepest_penetration(scene, positions), 0, 1e-15);
  positions[9].y -= 0.03;  // a foot into the ground
  EXPECT_NEAR(deepest_penetration(scene, positions), 0.03, 1e-14);
  // The ball, 5 inches, into the upper torso, 10 inches, at half its height.
  positions[10] = 0.5 * (positions[2] + positions[3]) + Vec3{14 * scenes::inch, 0, 0};
  EXPECT_NEAR(deepest_penetration(scene, positions), 0.03, 1e-14);
  positions[10].x -= 3 * scenes::inch;
  EXPECT_NEAR(deepest_penetration(scene, positions), 4 * scenes::inch, 1e-14);
}

TEST(HumanoidCases, AreTwoOfEachFigureAndDifferInOneThing) {
  HumanoidRun usual;
  usual.substeps = 7;
  const std::vector<HumanoidCase> cases = thesis_cases(usual);
  ASSERT_EQ(cases.size(), 8u);
  for (std::size_t i = 0; i < 8; i += 2) EXPECT_EQ(cases[i].figure, cases[i + 1].figure);
  for (const HumanoidCase& c : cases) EXPECT_EQ(c.run.substeps, 7u);
  EXPECT_LT(cases[0].run.ball.speed, cases[1].run.ball.speed);
  EXPECT_LT(cases[2].run.ball.elasticity, cases[3].run.ball.elasticity);
  // Of one density.
  const scenes::Ball &light = cases[4].run.ball, &heavy = cases[5].run.ball;
  EXPECT_NEAR(heavy.mass / light.mass, std::pow(heavy.radius / light.radius, 3), 1e-12);
  EXPECT_EQ(cases[7].run.figure.body, scenes::BodyType::wide);
}

TEST(HumanoidRuns, EndInTimeAndSayWhetherTheyHit) {
  HumanoidRun run;
  run.most = 0.25;
  run.ball.direction = {0, -1, 0};  // from above, on the head
  const HumanoidResult result = run_humanoid(run, true);
  EXPECT_TRUE(result.finite);
  EXPECT_EQ(result.track.size(), 16u);
  EXPECT_DOUBLE_EQ(result.simulated, 0.25);
  EXPECT_EQ(result.poses.size(), poses_shown);
  run.most = -1;
  EXPECT_THROW(run_humanoid(run), InputError);
}

TEST(HumanoidRuns, EndWhenTheBodySleeps) {
  HumanoidRun run;
  run.ball.speed = 20;
  const HumanoidResult result = run_humanoid(run);
  ASSERT_TRUE(result.hit);
  ASSERT_TRUE(result.time_to_rest);
  EXPECT_LT(result.simulated, run.most);
  EXPECT_TRUE(result.track.back().asleep);
  EXPECT_FALSE((result.track.end() - 2)->asleep);
  // World lets it sleep after rest_duration; asleep is a whole frame, and rounding may take another one.
  const double flown = result.track[find_impact(result.track, gravity)->first - 1].t;
  EXPECT_NEAR(result.simulated, flown + *result.time_to_rest + rest_duration, 2.5 * run.dt);
}

std::size_t count(const pugi::xml_node& root, const char* path) {
  return root.select_nodes(path).size();
}

TEST(HumanoidPictures, DrawEveryInstantOfEveryRun) {
  const Scene scene = make_scene({});
  Frame pose{.t = 0, .positions = {}, .velocities = {}};
  for (const Particle& p : scene.particles) pose.positions.push_back(p.position);
  const PoseRow row{.title = "a < b & \"c\"", .scene = scene, .poses = {pose, pose, pose}};
  const std::vector<PoseRow> rows = {row, row};
  pugi::xml_document document;
  const pugi::xml_parse_result read = document.load_string(draw_poses(rows).c_str());
  ASSERT_TRUE(read) << read.description();
  const pugi::xml_node svg = document.child("svg");
  EXPECT_EQ(count(svg, "g[@class='pose']"), 6u);
  EXPECT_EQ(count(svg, ".//line[@class='limb']"), 6 * 9u);
  EXPECT_EQ(count(svg, ".//circle[@class='ball']"), 6u);
  EXPECT_EQ(count(svg, "text"), 2u + 6u);
  EXPECT_STREQ(svg.child("text").text().get(), "a < b & \"c\"");
  // Clip paths are there, each once.
  std::set<std::string> ids;
  for (const auto& node : svg.select_nodes("clipPath")) ids.insert(node.node().attribute("id").value());
  EXPECT_EQ(ids.size(), 6u);
  for (const auto& node : svg.select_nodes("g[@class='pose']")) {
    const std::string url = node.node().attribute("clip-path").value();
    EXPECT_TRUE(ids.contains(url.substr(5, url.size() - 6))) << url;
  }
  // A round line is as thick as the limb: of the medium torso 20 inches, of the neck 4, at one scale, but for
  // a rim of 0.4 px.
  std::set<double> widths;
  for (const auto& node : svg.select_nodes(".//line[@class='limb']"))
    widths.insert(node.node().attribute("stroke-width").as_double());
  EXPECT_EQ(widths.size(), 4u);  // 4, 6, 10 and 20 inches
  EXPECT_NEAR((*widths.rbegin() + 0.8) / (*widths.begin() + 0.8), 5, 0.01);
}

TEST(HumanoidPictures, NothingToDrawIsAnEmptyPicture) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(draw_poses({}).c_str()));
}

// The page has the figure's colours and thickness, and of each frame what changed since the one before.
TEST(HumanoidReplays, HoldEveryFrameInMillimetres) {
  const Scene scene = make_scene({});
  Frame pose{.t = 0, .positions = {}, .velocities = {}};
  for (const Particle& p : scene.particles) pose.positions.push_back(p.position);
  Frame next = pose;
  for (Vec3& at : next.positions) at += Vec3{0.0124, 0, -3};
  const PoseRow row{.title = "</script>", .scene = scene, .poses = {pose}, .motion = {pose, next}};
  const Replay replay = replay_poses({&row, 1}, dt);
  EXPECT_EQ(replay.frame_length, dt);
  EXPECT_GT(replay.right - replay.left, 1);
  ASSERT_EQ(replay.runs.size(), 1u);
  const ReplayRun& run = replay.runs.front();
  ASSERT_EQ(run.lines.size(), scene.capsules.size());
  EXPECT_EQ(run.lines.back().look, "ball");
  EXPECT_EQ(run.lines.front().look, "near");
  ASSERT_EQ(run.frames.size(), 2u);
  EXPECT_EQ(run.frames[0].size(), 2 * run.lines.size());

  const std::string page = replay_data(replay);
  EXPECT_EQ(page.find("</script>"), page.size() - 10) << "a title ends no element";
  std::string change = "[12,0,-3000";
  for (std::size_t i = 1; i < run.frames[1].size(); ++i) change += ",12,0,-3000";
  EXPECT_NE(page.find("," + change + "]]"), std::string::npos) << page;
}

// A state that is no number is drawn, too: the page says that the run failed.
TEST(HumanoidReplays, TakeWhatIsNoNumber) {
  const Replay replay{
      .frame_length = dt,
      .left = -1,
      .right = 1,
      .top = 1,
      .runs = {{.title = "", .lines = {{}}, .frames = {{{NAN, INFINITY, 0}, {-1e300, 0, 0}}}}}};
  EXPECT_NE(replay_data(replay).find("[0,1000000000,0,-1000000000,0,0]"), std::string::npos);
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
