// Mechanisms of the literature, by their published solutions.

#include "support/mechanisms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenes/basics/clock.hpp"
#include "support/exact_methods.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::Andrews;
using test::FourBars;
using test::Governor;

/// How far angles of a mechanism are from the published ones after 0.03 s, in rad: that of the crank, which
/// has turned two and a half times, and the largest of others.
struct Miss {
  double crank = 0, others = 0;
};
Miss miss_of(const Scene& scene, bool has_rods, std::uint32_t time_order, int steps) {
  Settings settings = test::body_settings();
  settings.time_order = time_order;
  settings.gradient = Gradient::old;
  World world(scene, settings);
  EXPECT_EQ(test::run(world, Andrews::duration / steps, steps).unsolved, 0u);
  Miss out{.crank = std::abs(world.torsion_angle(0) - Andrews::end[0])};
  if (!has_rods) return out;
  const Vec3 gamma = world.position(Andrews::middle) - Andrews::b;
  const Vec3 delta = world.position(Andrews::lower) - Andrews::a;
  const Vec3 epsilon = world.position(Andrews::upper) - Andrews::a;
  const Vec3 both = world.position(Andrews::crank) - world.position(Andrews::middle);
  out.others = std::max({std::abs(std::atan2(gamma.x, -gamma.y) - Andrews::end[2]),
                         std::abs(std::atan2(delta.y, delta.x) - Andrews::end[4]),
                         std::abs(std::atan2(epsilon.x, -epsilon.y) - Andrews::end[6]),
                         std::abs(std::atan2(both.y, both.x) - Andrews::end[0] - Andrews::end[1])});
  return out;
}

// The numbers are those of the mechanism: at the angles given its loops close, to their 16 digits, and so do
// they at the published end.
TEST(AndrewsMechanism, ClosesItsLoops) {
  for (const bool is_end : {false, true}) {
    const auto& angles = is_end ? Andrews::end : Andrews::start;
    const Andrews::Places at = Andrews::places(angles);
    const double phi = angles[3], gamma = angles[2], delta = angles[4], omega = angles[5],
                 epsilon = angles[6];
    const Vec3 by_gamma = Andrews::b + Andrews::ss * Vec3{std::sin(gamma), -std::cos(gamma), 0};
    const Vec3 by_phi = at.lower + Andrews::e * Vec3{std::sin(phi + delta), -std::cos(phi + delta), 0};
    const Vec3 by_omega =
        at.upper + Andrews::zf * Vec3{std::cos(omega + epsilon), std::sin(omega + epsilon), 0};
    for (const Vec3 each : {by_gamma, by_phi, by_omega}) EXPECT_LE(norm(each - at.middle), 1e-15);
  }
}

// Second order at turns of some 0.02 rad a step, and order 4 to 1e-6 rad, which is the bar, and to 1e-8.
TEST(AndrewsMechanism, EndsAtItsPublishedAngles) {
  const Scene scene = Andrews::of_rods();
  const Miss coarse = miss_of(scene, true, 2, 2000), fine = miss_of(scene, true, 2, 4000);
  EXPECT_NEAR(std::log2(coarse.crank / fine.crank), 2, 0.05);
  EXPECT_LE(fine.crank, 1e-4);
  EXPECT_LE(fine.others, 1e-4);
  const Miss best = miss_of(scene, true, 4, 2000);
  EXPECT_LE(best.crank, 1e-8);
  EXPECT_LE(best.others, 1e-8);
}

// Of bodies and hinges, nine constraints are redundant. No number decides between them: 1e-6 rad.
TEST(AndrewsMechanism, EndsThereWithRedundantHinges) {
  const Scene scene = Andrews::of_bodies();
  for (const int steps : {1000, 4000}) EXPECT_LE(miss_of(scene, false, 4, steps).crank, 1e-6) << steps;
  EXPECT_LE(miss_of(scene, false, 2, 4000).crank, 1e-4);
}

/// Where the collar and the balls are after a second.
std::vector<Vec3> governor_after(bool rigid, std::uint32_t substeps) {
  World world(Governor::scene(rigid), test::body_settings(substeps));
  EXPECT_EQ(test::run(world, test::frame, 60).unsolved, 0u);
  return {world.position(Governor::collar), world.position(Governor::ball_a),
          world.position(Governor::ball_b)};
}

// Its dampers act within 0.1 ms, far below a substep; the order is that of the rigid one all the same.
TEST(FlyballGovernor, ConvergesToSecondOrder) {
  for (const bool rigid : {false, true}) {
    const std::vector<Vec3> best = governor_after(rigid, 256);
    double errors[4];
    for (const int k : {0, 1, 2, 3}) errors[k] = rms_distance(governor_after(rigid, 2u << k), best);
    for (const int k : {0, 1, 2}) EXPECT_NEAR(std::log2(errors[k] / errors[k + 1]), 2, 0.1) << rigid << k;
    EXPECT_LE(errors[3], 2e-5) << rigid;
  }
}

// With springs so stiff the collar is within their give, load / stiffness of 1e-4 m, of the rigid one's.
TEST(FlyballGovernor, IsNearTheRigidOne) {
  const std::vector<Vec3> soft = governor_after(false, 16), rigid = governor_after(true, 16);
  EXPECT_LE(rms_distance(soft, rigid), 1e-4);
  EXPECT_GT(rms_distance(soft, rigid), 1e-7);
}

// The bar is ten times; bench_mechanisms finds 1.3 to 3. Runs are in turns, and the fastest of each counts.
TEST(FlyballGovernor, TakesLessThanTenTimesTheRigidOnesTime) {
  double ms[2] = {1e30, 1e30};
  for (int round = 0; round < 5; ++round)
    for (const bool rigid : {false, true}) {
      World world(Governor::scene(rigid), test::body_settings(4));
      const auto start = scenes::Clock::now();
      test::run(world, test::frame, 60);
      ms[rigid] = std::min(ms[rigid], 1e3 * scenes::seconds_since(start));
    }
  EXPECT_LE(ms[0], 10 * ms[1]);
}

/// How far the ends of all posts are from where they should be, at worst after every second, in m.
double worst_of_posts(World& world, std::uint32_t n, double dt, int seconds) {
  double worst = 0;
  for (int s = 1; s <= seconds; ++s) {
    test::run(world, dt, static_cast<int>(std::lround(1 / dt)));
    const Vec3 first = FourBars::first_end(n, s);
    for (std::uint32_t i = 0; i <= n; ++i)
      worst = std::max(worst, norm(world.position(n + 1 + i) - first - Vec3{i * FourBars::length, 0, 0}));
  }
  return worst;
}

// Errors grow by no more than the accuracy in each second, through some 40 passages where constraints are
// redundant. Steps that change let gradient old's energy drift: it ends at 2 times that.
TEST(FourBars, KeepTheirAccuracyForTwentySeconds) {
  constexpr std::uint32_t n = 40;
  const Scene scene = FourBars::scene(n);
  for (const double dt : {test::frame, 0.05})
    for (const double accuracy : {1e-4, 1e-5}) {
      World world(scene, {.accuracy = accuracy, .threads = 1});
      EXPECT_LE(worst_of_posts(world, n, dt, 20), 20 * accuracy * bounding_diagonal(scene))
          << dt << ", " << accuracy;
    }
}

// Runge-Kutta steps would stall at 1e-5 m, because one stage in some hundred lies within 1e-4 rad of a place
// where constraints are redundant. They go past: the rest is of order 4, below 1e-7 m, or rounding.
TEST(FourBars, MultipliersGoPastWhereRodsAreRedundant) {
  constexpr std::uint32_t n = 5;
  const Scene scene = FourBars::scene(n);
  for (const std::uint32_t substeps : {16u, 32u}) {
    World world(scene, test::exact(Method::multipliers, Integrator::rk4, substeps));
    EXPECT_LE(worst_of_posts(world, n, test::frame, 20), 1e-6) << substeps;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
