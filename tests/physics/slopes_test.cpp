// Blocks hold on a slope, and slide from it, to a thousandth of the angle of friction.

#include <gtest/gtest.h>

#include <cmath>

#include "support/boxes.hpp"
#include "support/ground.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// How far a block goes down in four seconds on a slope of `share` of its critical tangent, m, and how far in
/// the last two of them.
struct Way {
  double all = 0, last = 0;
};
Way way_down(double share, double friction, bool is_hull, std::uint32_t substeps) {
  const Surface surface{.friction = friction};
  Scene scene = test::sloping_ground(share * friction, surface);
  const std::uint32_t body = is_hull ? test::add_box(scene, {0, 0.1, 0}, {0.2, 0.1, 0.15}, 2, surface)
                                     : test::add_block(scene, {}, surface);
  World world(scene, test::body_settings(substeps));
  EXPECT_EQ(test::run(world, frame, 120).unsolved, 0u);
  const double middle = test::center_of(world, scene.bodies[body]).x;
  EXPECT_EQ(test::run(world, frame, 120).unsolved, 0u);
  const double end = test::center_of(world, scene.bodies[body]).x;
  return {end - scene.bodies[body].center.x, end - middle};
}

// Sweeps over what rests may leave 4e-4 of g h²/2 in a substep, and so a speed of 4e-4 g h/2. Friction has a
// thousandth of mu g left to stop it: after (4e-4 h)² g/(8e-3 mu), 0.3 um for the smallest mu and one
// substep. Places settle by 10 um. After that nothing creeps: in two seconds not as far as one substep's
// sweeps may leave, 4e-5 g h²/2.
TEST(Slope, HoldsABlockAThousandthBelowItsAngleOfFriction) {
  for (const double friction : {0.2, 0.5, 0.8})
    for (const bool is_hull : {false, true})
      for (const std::uint32_t substeps : {1u, 4u}) {
        SCOPED_TRACE(testing::Message() << friction << (is_hull ? ", hull, " : ", corners, ") << substeps);
        const Way way = way_down(0.999, friction, is_hull, substeps);
        EXPECT_LT(std::abs(way.all), 2e-5);
        EXPECT_LT(std::abs(way.last), 5e-8);
      }
}

// A thousandth above it slides by what is left: g cos (tan - mu) t²/2, some centimetres. The speed of the
// first substep adds up to 4e-4 g h/2 t, 0.13 mm.
TEST(Slope, LetsABlockSlideAThousandthAboveItsAngleOfFriction) {
  for (const double friction : {0.2, 0.5, 0.8})
    for (const bool is_hull : {false, true})
      for (const std::uint32_t substeps : {1u, 4u}) {
        SCOPED_TRACE(testing::Message() << friction << (is_hull ? ", hull, " : ", corners, ") << substeps);
        const double slope = 1.001 * friction;
        const double wanted = 0.5 * test::earth * std::cos(std::atan(slope)) * (slope - friction) * 16;
        EXPECT_NEAR(way_down(1.001, friction, is_hull, substeps).all, wanted, 0.02 * wanted + 2e-4);
      }
}

// What nobody has set suffices for a scene with a plane.
TEST(Plane, IsStoodOnWithDefaultSettings) {
  Scene scene;
  scene.planes.push_back({});
  test::add_ball(scene, {0, 0.1, 0}, 0.1, 1);
  World world(scene, Settings{});
  test::run(world, frame, 60);
  EXPECT_NEAR(world.position(0).y, 0.1, 1e-3);
}

// Friction is against the motion, whatever the shape of what slides: the block stays on its course and goes
// v²/(2 μ g). Pushes at its corners move a long block more easily along it than across. Friction that is
// balanced by each of these alone turned it aside by 11 degrees. Gradient new of relaxed contact stops it
// earlier, by half a substep of its speed.
TEST(Slides, GoStraightWhateverTheShape) {
  for (const Method method : {Method::direct, Method::relax})
    for (const Vec3 half : {Vec3{0.2, 0.1, 0.2}, Vec3{0.3, 0.1, 0.2}, Vec3{0.1, 0.2, 0.3}}) {
      SCOPED_TRACE(testing::Message() << to_string(method) << ' ' << half.x);
      Scene scene;
      scene.planes.push_back({.surface = {.friction = 0.4}});
      const Vec3 v{3.5, 0, 2}, start{0, half.y, 0};
      const std::uint32_t body = test::add_box(scene, start, half, 10, {.friction = 0.4});
      for (Particle& particle : scene.particles) particle.velocity = v;
      World world(scene, {.method = method, .substeps = 4, .threads = 1});
      test::run(world, test::frame, 90);
      const Vec3 went = test::middle_of(scene, world, body) - start;
      EXPECT_NEAR(norm(cross(went, v)) / norm(v), 0, 1e-4);
      const double expected = dot(v, v) / (2 * 0.4 * test::earth),
                   lost = method == Method::relax ? norm(v) / 480 : 0;
      EXPECT_NEAR(dot(went, v) / norm(v), expected - lost, 1e-3 * expected);
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
