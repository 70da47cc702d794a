// What a user hangs up must hang: slack lines fall, tight ones hold, and what cannot be shares what it lacks.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// The largest departure from the catenary of equal weights: slopes of neighbouring rods differ by as much
/// everywhere, the weight over the horizontal pull. It is relative to that.
double off_catenary(const Scene& scene, const World& world) {
  std::vector<double> bend;
  double last = 0;
  for (std::size_t k = 0; k < scene.rods.size(); ++k) {
    const Vec3 d = world.position(scene.rods[k].b) - world.position(scene.rods[k].a);
    const double slope = d.y / d.x;
    if (k > 0) bend.push_back(slope - last);
    last = slope;
  }
  const auto [least, most] = std::minmax_element(bend.begin(), bend.end());
  return (*most - *least) / *most;
}

struct Slack {
  std::uint32_t rods;
  double slack;  ///< Share of the span that the line is longer.
};

class SlackLine : public testing::TestWithParam<Slack> {};

// Drawn straight, they have no direction to give way, and must find one. After 25 s at a drag of 4/s what is
// left of the fall is below rounding, and so is Newton's converged change.
TEST_P(SlackLine, FallsToItsCatenary) {
  const auto [rods, slack] = GetParam();
  const double span = 2;
  Scene scene = scenes::make_line({.links = rods, .span = span, .slack = slack});
  scene.drag = 4;
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World world(scene, {.method = Method::direct, .gradient = gradient, .threads = 1});
    EXPECT_EQ(world.info().unprojected_islands, 0u);
    const StepReport report = test::run(world, frame, 1500);
    EXPECT_EQ(report.unsolved + report.elastic_substeps, 0u) << to_string(gradient);
    EXPECT_LE(off_catenary(scene, world), 1e-9) << to_string(gradient);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-11);
  }
}

INSTANTIATE_TEST_SUITE_P(Rods, SlackLine,
                         testing::Values(Slack{5, 0.2}, Slack{20, 0.05}, Slack{21, 0.5}, Slack{200, 0.1}));

// Without drag it swings for ever and keeps its energy, with method automatic and no settings but one thread.
TEST(Hangings, ASlackLineSwings) {
  for (const std::uint32_t rods : {5u, 20u, 200u, 1000u}) {
    const Scene scene = scenes::make_line({.links = rods, .span = 20, .slack = 0.05});
    World world(scene, {.threads = 1});
    const double before = test::energy_of(scene, world).total();
    const StepReport report = test::run(world, frame, 120);
    EXPECT_EQ(report.unsolved + report.elastic_substeps + report.fallbacks, 0u) << rods;
    EXPECT_NEAR(test::energy_of(scene, world).total(), before, 1e-9 * std::abs(before)) << rods;
    EXPECT_LT(world.position(rods / 2).y, -0.5) << rods;
  }
}

// A line that is too short for its anchors is straight, and every rod has the same strain. It sags by what
// its compliance allows, and the tolerance is ten times that.
TEST(Hangings, ALineThatIsTooShortSharesItsMisfit) {
  for (const std::uint32_t rods : {5u, 20u, 200u}) {
    const Scene scene = scenes::make_line({.links = rods, .span = 20, .slack = -0.05});
    World world(scene, {.threads = 1});
    EXPECT_EQ(world.info().unprojected_islands, 1u);
    const StepReport report = test::run(world, frame, 60);
    EXPECT_EQ(report.unsolved, 0u) << rods;
    for (const Rod& rod : scene.rods) {
      const double length = norm(world.position(rod.b) - world.position(rod.a));
      EXPECT_NEAR(length, 20.0 / rods, 1e-5 * 20 / rods) << rods;
    }
  }
}

// A line drawn straight between anchors can go nowhere. No pull holds it, and Newton's method goes round in
// circles where it looks for one. It sags as soon as an anchor comes nearer.
TEST(Hangings, ALineDrawnStraightIsLocked) {
  const std::uint32_t rods = 12;
  const Scene scene = scenes::make_line({.links = rods, .span = 6, .slack = 0});
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World world(scene, {.method = Method::direct, .gradient = gradient, .threads = 1});
    StepReport report = test::run(world, frame, 60);
    EXPECT_LE(report.newton, 2 * 60u) << to_string(gradient);
    EXPECT_EQ(report.unsolved + report.elastic_substeps + report.fallbacks, 0u) << to_string(gradient);
    for (std::uint32_t i = 1; i < rods; ++i)
      EXPECT_LE(norm(world.position(i) - scene.particles[i].position), 1e-12) << to_string(gradient);
    for (int i = 1; i <= 60; ++i) {
      world.move_anchor(rods, world.position(rods) - Vec3{0.01, 0, 0});
      report += world.step(frame);
    }
    EXPECT_EQ(report.unsolved, 0u) << to_string(gradient);
    EXPECT_LT(world.position(rods / 2).y, -0.5) << to_string(gradient);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-6) << to_string(gradient);
  }
}

// Its anchor is pulled beyond its length and comes back.
TEST(Hangings, ALineRecoversFromAnAnchorPulledTooFar) {
  const std::uint32_t rods = 20;
  Scene scene = scenes::make_line({.links = rods, .span = 19, .slack = 1.0 / 19});
  scene.drag = 1;
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World world(scene, {.method = Method::direct, .gradient = gradient, .threads = 1});
    StepReport total;
    const auto pull = [&](double from, double to, int frames) {
      total = {};
      for (int i = 1; i <= frames; ++i) {
        world.move_anchor(rods, {from + (to - from) * i / frames, 0, 0});
        total += world.step(frame);
      }
      EXPECT_EQ(total.unsolved, 0u) << to_string(gradient) << ", to " << to;
    };
    pull(19, 22, 120);
    EXPECT_GT(total.elastic_substeps, 0u);
    pull(22, 22, 120);
    for (std::uint32_t i = 1; i < rods; ++i) {
      EXPECT_LT(norm(world.position(i) - Vec3{1.1 * i, 0, 0}), 1e-5) << to_string(gradient) << " " << i;
      EXPECT_LT(norm(world.velocity(i)), 1e-6) << to_string(gradient) << " " << i;
    }
    pull(22, 19, 120);
    pull(19, 19, 1500);
    EXPECT_EQ(total.elastic_substeps, 0u) << "rods fit again";
    EXPECT_LE(off_catenary(scene, world), 1e-3) << to_string(gradient);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-11) << to_string(gradient);
  }
}

// A line that is nearly straight has no sound projection of velocities, which would divide by rounding. What
// is read must stay near what particles do; without a guard it was ten thousand times that.
TEST(Hangings, VelocitiesOfALineThatComesTautAreSound) {
  const std::uint32_t rods = 40;
  const Scene scene = scenes::make_line({.links = rods, .span = 2, .slack = 0.05});
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World world(scene, {.method = Method::direct, .gradient = gradient, .threads = 1});
    double fastest = 0, fastest_read = 0;
    for (int i = 1; i <= 60; ++i) {
      const std::vector<Vec3> before = test::positions_of(world);
      world.move_anchor(rods, {2 + 0.2 * std::min(i, 60 - i) / 30, 0, 0});
      world.step(frame);
      for (std::uint32_t p = 1; p < rods; ++p) {
        fastest = std::max(fastest, norm(world.position(p) - before[p]) / frame);
        fastest_read = std::max(fastest_read, norm(world.velocity(p)));
      }
    }
    EXPECT_LT(fastest_read, 100 * fastest) << to_string(gradient);
  }
}

// Particles that all start in one place are laid out along gravity.
TEST(Hangings, ParticlesInOnePlaceAreLaidOut) {
  Scene scene;
  scene.particles.push_back(test::fixed({1, 2, 3}));
  for (std::uint32_t i = 1; i <= 10; ++i) {
    scene.particles.push_back(test::movable({1, 2, 3}));
    scene.rods.push_back({.a = i - 1, .b = i, .length = 0.1});
  }
  World world(scene, {.threads = 1});
  EXPECT_EQ(world.info().unprojected_islands, 0u);
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-11);
  EXPECT_EQ(test::run(world, frame, 60).unsolved, 0u);
}

/// A net that hangs from corners nearer than its rows are long, by `slack` of their distance. Columns start
/// in zigzag.
Scene slack_net(std::uint32_t n, double slack) {
  Scene scene = scenes::make_net(n, n);
  const double length = norm(scene.particles[1].position), share = 1 / (1 + slack);
  for (Rod& rod : scene.rods) rod.length = length;
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    Vec3& position = scene.particles[i].position;
    position.x *= share;
    if (i % n % 2 == 1) position.z = length * std::sqrt(1 - share * share);
  }
  return scene;
}

/// What two seconds did, and the largest strain at the end of a frame.
struct Hung {
  StepReport total{};
  double largest = 0;
};
Hung hang(const Scene& scene, World& world) {
  Hung out;
  for (int i = 0; i < 120; ++i) {
    out.total += world.step(frame);
    out.largest = std::max(out.largest, test::stretch_of(scene, world).max);
  }
  return out;
}

// By default a net drawn straight below its corners hangs there: nothing stretches, and nothing moves but by
// what is left of lengths.
TEST(Hangings, ANetHangsFromItsCorners) {
  for (const std::uint32_t n : {8u, 16u, 32u}) {
    const Scene scene = scenes::make_net(n, n);
    World world(scene, {.threads = 1});
    const auto [total, largest] = hang(scene, world);
    EXPECT_EQ(total.unsolved + total.elastic_substeps + total.fallbacks, 0u) << n;
    EXPECT_LE(largest, 1e-6) << n;
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      EXPECT_LE(norm(world.position(i) - scene.particles[i].position), 1e-8) << n << ", particle " << i;
  }
}

// By default a slack one falls, folds and comes taut, rigid all the time.
TEST(Hangings, ASlackNetFallsRigidly) {
  for (const std::uint32_t n : {8u, 16u, 32u}) {
    Scene scene = slack_net(n, 0.1);
    World world(scene, {.threads = 1});
    const auto [total, largest] = hang(scene, world);
    EXPECT_EQ(total.unsolved + total.elastic_substeps, 0u) << n;
    EXPECT_LE(largest, 1e-6) << n;
  }
}

// Where a solved net comes to rest, relaxation leaves it: the shape is the same. Sweeps turn rods by what
// particles fall in a substep, which moves the shape by 5e-4 of a metre at 1/60 s, and by h² of that. With
// gradient old nothing turns, and whole steps leave ten times the tolerance.
TEST(Hangings, ANetRestsWhereRelaxationDoes) {
  Scene scene = slack_net(8, 0.1);
  scene.drag = 4;
  World solved(scene, {.sleep = false, .threads = 1});
  EXPECT_EQ(test::run(solved, frame, 1800).unsolved, 0u);
  const std::vector<Vec3> rest = test::positions_of(solved);
  for (std::uint32_t i = 0; i < rest.size(); ++i) scene.particles[i].position = rest[i];
  World relaxed(scene, {.method = Method::relax,
                        .substeps = 64,
                        .stop = {.sweeps = 100'000, .tolerance = 1e-9},
                        .sleep = false,
                        .threads = 1});
  World coarse(scene, {.method = Method::relax,
                       .gradient = Gradient::old,
                       .stop = {.sweeps = 100'000, .tolerance = 1e-9},
                       .sleep = false,
                       .threads = 1});
  test::run(relaxed, frame, 15);
  test::run(coarse, frame, 240);
  for (std::uint32_t i = 0; i < rest.size(); ++i) {
    EXPECT_LE(norm(solved.velocity(i)), 1e-6) << "particle " << i;
    EXPECT_LE(norm(relaxed.position(i) - rest[i]), 1e-6) << "particle " << i;
    EXPECT_LE(norm(coarse.position(i) - rest[i]), 1e-8) << "particle " << i;
  }
}

// A row that is locked goes where both corners go, and is free again when one corner comes nearer.
TEST(Hangings, ALockedRowFollowsItsCorners) {
  const std::uint32_t n = 8;
  const Scene scene = scenes::make_net(n, n);
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    World world(scene, {.method = Method::direct, .gradient = gradient, .threads = 1});
    StepReport total;
    const auto move = [&](Vec3 left, Vec3 right) {
      world.move_anchor(0, world.position(0) + left);
      world.move_anchor(n - 1, world.position(n - 1) + right);
      total += world.step(frame);
    };
    const Vec3 by{0.002, 0, 0.004};
    for (int i = 0; i < 30; ++i) move(by, by);
    EXPECT_EQ(total.unsolved + total.elastic_substeps, 0u) << to_string(gradient);
    for (std::uint32_t i = 1; i + 1 < n; ++i)
      EXPECT_LE(norm(world.position(i) - scene.particles[i].position - 30.0 * by), 1e-12) << i;
    for (int i = 0; i < 30; ++i) move({}, {-0.004, 0, 0});
    EXPECT_EQ(total.unsolved, 0u) << to_string(gradient);
    EXPECT_LT(world.position(n / 2).y, -0.05) << to_string(gradient);
    EXPECT_LE(test::stretch_of(scene, world).max, 1e-3) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
