// A rope over a round bar holds a load that is exp(mu theta) times as heavy as its other end (Euler,
// Eytelwein), however light it is itself, and takes no more work for it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/bodies.hpp"

namespace plumb {
namespace {

using test::frame;

constexpr int links = 40, around = 28, hanging = (links - around) / 2;
constexpr double friction = 0.4, radius = 0.2, thick = 0.002, turn = std::numbers::pi / around;
const double far = (radius + thick) / std::cos(turn / 2), link = 2 * far * std::sin(turn / 2);

/// A rope of 40 rods over half of a bar along z. Its particles weigh `mass` (kg), the first 1 kg and the last
/// `load` (kg).
Scene rope_over_bar(double mass, double load) {
  Scene scene;
  const Surface surface{.friction = friction};
  scene.ground_capsules.push_back({{0, 0, -0.5}, {0, 0, 0.5}, radius, surface});
  for (int i = -hanging; i <= around + hanging; ++i) {
    const double angle = turn * std::clamp(i, 0, around), down = link * std::max({0, -i, i - around});
    const double weighs = i == -hanging ? 1 : i == around + hanging ? load : mass;
    scene.particles.push_back(
        test::movable({-far * std::cos(angle), far * std::sin(angle) - down, 0}, weighs));
    const auto here = static_cast<std::uint32_t>(scene.particles.size() - 1);
    if (here == 0) continue;
    scene.rods.push_back({.a = here - 1, .b = here});
    scene.capsules.push_back(
        {.a = point_at(here - 1), .b = point_at(here), .radius = thick, .surface = surface});
  }
  return scene;
}

/// Between the angles 0 and pi of the bar, a rope of weight w per length slides where T' = mu T + w R (mu sin
/// + cos). Its solutions are C exp(mu angle) + A sin + B cos with this B.
double own_weight(double mass) {
  const double w = mass / link * test::earth;
  return -2 * friction / (1 + friction * friction) * w * (radius + thick);
}
/// Friction acts on the axis of rods that stand in the island's own matrix, so that thickness does not
/// matter. A corner turns by pi/28, whose tangent is its angle to 1e-3.
const double capstan = std::exp(friction * std::numbers::pi);

/// The load (kg) that just slides: what hangs on either side weighs as much as 5.5 particles.
double critical_load(double mass) {
  const double hangs = 5.5 * mass, own = own_weight(mass) / test::earth;
  return capstan * (1 + hangs - own) - own - hangs;
}

struct Pulled {
  double way = 0;    ///< m, of the load
  double ratio = 0;  ///< of the tensions at both ends of the bar, of what grows by the capstan's ratio
  double work = 0;   ///< Newton steps and halvings
};
Pulled pull_with(double mass, double load, int frames) {
  const Scene scene = rope_over_bar(mass, load);
  Settings settings = test::body_settings(1);
  settings.tensions = true;
  World world(scene, settings);
  const std::uint32_t last = world.particle_count() - 1;
  const Vec3 start = world.position(last);
  Pulled out;
  double loose = 0, tight = 0;
  for (int i = 0; i < frames; ++i) {
    const StepReport report = world.step(frame);
    EXPECT_EQ(report.unsolved, 0u);
    out.work += static_cast<double>(report.newton + report.halvings);
    if (2 * i < frames) continue;
    const double hangs = 5.5 * mass * test::earth;
    loose += world.tension(0) + hangs - own_weight(mass);
    tight += world.tension(world.rod_count() - 1) + hangs + own_weight(mass);
  }
  out.way = start.y - world.position(last).y;
  out.ratio = tight / loose;
  return out;
}

// 2 % is the bar. What holds does not go on by more than the sag that lets contacts push, 10 um.
TEST(Capstan, HoldsUpToItsRatioAndSlidesBeyond) {
  for (const double mass : {1e-4, 1e-3, 1e-2}) {
    SCOPED_TRACE(mass);
    const double load = critical_load(mass);
    EXPECT_LT(std::abs(pull_with(mass, 0.98 * load, 60).way), 1e-5);
    const Pulled slides = pull_with(mass, 1.1 * load, 30);
    EXPECT_GT(slides.way, 0.01);
    EXPECT_NEAR(slides.ratio, capstan, 0.02 * capstan);
  }
}

// Waves along a rope of 0.1 g a link are ten times as fast as along one of 10 g. A substep of a frame
// resolves neither.
TEST(Capstan, TakesAsMuchWorkForLightRopesAsForHeavyOnes) {
  for (const double share : {0.98, 1.1}) {
    double least = INFINITY, most = 0;
    for (const double mass : {1e-4, 1e-3, 1e-2}) {
      const double work = pull_with(mass, share * critical_load(mass), 30).work;
      least = std::min(least, work);
      most = std::max(most, work);
    }
    EXPECT_LE(most, 5 * least) << share;
    EXPECT_LE(most, 30 * 20) << "Newton steps of 30 frames";
  }
}

}  // namespace
}  // namespace plumb
