// What moves slowly on free bodies that rest moves as on the ground, in however short substeps.

#include <gtest/gtest.h>

#include <cmath>

#include "support/boxes.hpp"
#include "support/ground.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

constexpr double half = 0.05, friction = 0.5;  // m

/// Plates of a mass (kg) that lie on each other on a slope.
Scene plates_on(double slope, int plates, double mass) {
  Scene scene = test::sloping_ground(slope, {.friction = friction});
  for (int i = 0; i < plates; ++i)
    test::add_box(scene, {0, (2 * i + 1) * half, 0}, {0.4, half, 0.1}, mass, {.friction = friction});
  return scene;
}

/// Returns how fast the last body goes along x a second after all were at rest, m/s.
double speed_after_a_second(const Scene& scene, std::uint32_t substeps) {
  World world(scene, test::body_settings(substeps));
  const StepReport report = test::run(world, frame, 60);
  EXPECT_EQ(report.unsolved, 0u);
  return test::velocity_of(world, scene.bodies.back()).x;
}

// A ball of 1 kg rolls at 5/7 of g sin. In a substep of h, sweeps leave what rests a speed of g h times half
// a hundredth of sweep_tolerance. That is 2e-2 of what the least slope adds.
TEST(SlowMotion, RollsOnPlatesThatLieOnASlope) {
  for (const double slope : {1e-3, 5e-3, 0.1})
    for (const std::uint32_t substeps : {1u, 4u, 16u})
      for (const auto& [plates, mass] : {std::pair{1, 0.1}, {1, 1.0}, {1, 10.0}, {2, 1.0}}) {
        SCOPED_TRACE(testing::Message() << "slope " << slope << ", substeps " << substeps << ", " << plates
                                        << " plates of " << mass << " kg");
        Scene scene = plates_on(slope, plates, mass);
        MassProperties solid = solid_sphere(1, half);
        solid.center = {0, (2 * plates + 1) * half, 0};
        const std::uint32_t body = add_body(scene, solid);
        Capsule ball = sphere_at(point_on_body(scene, body, solid.center), half);
        ball.surface = {.friction = friction};
        scene.capsules.push_back(ball);
        const double wanted = 5.0 / 7 * earth * std::sin(std::atan(slope));
        EXPECT_NEAR(speed_after_a_second(scene, substeps), wanted, 2e-2 * wanted);
      }
}

// Without friction a box slides at g sin. The bar is that of the ball.
TEST(SlowMotion, StartsOnPlatesThatLieOnASlope) {
  for (const std::uint32_t substeps : {1u, 4u, 16u}) {
    constexpr double slope = 1e-3;
    Scene scene = plates_on(slope, 2, 1);
    test::add_box(scene, {0, 5 * half, 0}, {half, half, half}, 1, {});
    scene.hulls.back().surface.friction = 0;
    const double wanted = earth * std::sin(std::atan(slope));
    EXPECT_NEAR(speed_after_a_second(scene, substeps), wanted, 2e-2 * wanted) << substeps;
  }
}

/// Returns when (s) a box that is turned about its edge by an angle beyond its balance has fallen by half its
/// height.
double time_to_fall(double wide, double high, double angle) {
  const double arm = std::hypot(wide, high), inertia = 4.0 / 3 * arm * arm;
  constexpr double h = 1e-5;
  double rate = 0, time = 0;
  for (; arm * std::cos(angle) > 0.5 * high; time += h) {
    rate += h * earth * arm * std::sin(angle) / inertia;
    angle += h * rate;
  }
  return time;
}

// A box that stands on its edge, just past its balance, falls as mechanics says. Two frames are the bar of
// two seconds: it falls from the end of the first, and lies at the end of the last.
TEST(SlowMotion, FallsFromPastItsBalance) {
  constexpr double wide = 0.02, high = 0.5;  // m, halves
  for (const double beyond : {1e-3, 2e-3}) {
    const double turn = std::atan2(wide, high) + beyond;
    const Vec3 up{-std::sin(turn), std::cos(turn), 0};  // in the box's axes
    const double below = dot(up, Vec3{wide, -high, 0});
    Scene scene;
    scene.gravity = -earth * up;
    scene.planes.push_back({.normal = up, .offset = below, .surface = {.friction = friction}});
    const std::uint32_t body = test::add_box(scene, {}, {wide, high, wide}, 1, {.friction = friction});
    World world(scene, test::body_settings());
    while (world.time() < 4 && dot(up, world.pose(body).position) - below > 0.5 * high) world.step(frame);
    EXPECT_NEAR(world.time(), time_to_fall(wide, high, beyond), 2 * frame) << beyond;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
