// Joints of one rigid whole on itself: what holds anyway does nothing, and what cannot hold is refused.

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;
using test::for_jointed_settings;
using test::frame;

const Vec3 center{0, 2, 0}, x{0.05, 0, 0}, y{0, 0.05, 0};

Point on_crate(const Scene& scene, Vec3 from_center) {
  return point_on_body(scene, 0, center + from_center);
}

/// The same place, whose weights are added up in another order.
Point reordered(Point of) {
  std::swap(of.particles[0], of.particles[1]);
  std::swap(of.weights[0], of.weights[1]);
  return of;
}

Direction way(const Scene& scene, Vec3 from, Vec3 to) {
  return {on_crate(scene, from), on_crate(scene, to)};
}

/// A crate that falls and turns (rad/s), if anything.
Scene falling(Vec3 turn = {}) {
  Scene scene = test::crate(center);
  for (Particle& each : scene.particles) each.velocity = cross(turn, each.position - center);
  return scene;
}

/// Returns how far (m) particles of one scene are from those of another after half a second.
double difference(const Settings& settings, const Scene& with, const Scene& without) {
  World one(with, settings), other(without, settings);
  for (int i = 0; i < 30; ++i) {
    one.step(frame);
    other.step(frame);
    EXPECT_TRUE(one.problems().empty());
  }
  for (std::uint32_t i = 0; i < with.pins.size(); ++i) {
    EXPECT_EQ(norm(one.pin_force(i)), 0);
  }
  return test::apart(one, other);
}

/// Appends a drive, a spring and a torsion of a crate on itself, which pull so many times as much.
void add_pulls(Scene& scene, double strength) {
  const Direction u = way(scene, {}, x), v = way(scene, {}, y), axis = way(scene, {}, cross(x, y));
  scene.angles = {{.u = u, .v = v, .target = 1, .stiffness = strength, .damping = 1e-3}};
  scene.springs = {{.a = u.to, .b = v.to, .length = 0.2, .stiffness = 10 * strength, .damping = 0.1}};
  scene.torsions = {{.axis = axis, .u = u, .v = v, .stiffness = strength, .damping = 1e-3}};
}

// Rows that are empty count as redundant ones, whose matrix has a share of 1e-8 on its diagonal.
TEST(RigidJoints, OfOnePlaceDoNothing) {
  Scene scene = falling({1, 2, 3});
  const Point place = on_crate(scene, x), corner = point_on_body(scene, 0, scene.particles[0].position);
  scene.pins = {{place, reordered(place)}, {corner, point_at(0)}, {place, on_crate(scene, x + 1e-9 * y)}};
  for_jointed_settings([&](const Settings& settings) {
    EXPECT_LE(difference(settings, scene, falling({1, 2, 3})), 1e-9);
  });
}

// Such rows would make the matrix of multipliers singular, and such a joint a loop of one body.
TEST(RigidJoints, OfOnePlaceDoNothingInTheOtherMethods) {
  Scene with;
  add_body(with, {.mass = 1, .center = center, .inertia = {.xx = 0.007, .yy = 0.007, .zz = 0.007}});
  const Scene without = with;
  const Point place = on_crate(with, x);
  with.pins = {{place, reordered(place)}};
  for (const Method method : {Method::multipliers, Method::featherstone}) {
    World one(with, {.method = method}), other(without, {.method = method});
    for (int i = 0; i < 30; ++i) {
      one.step(frame);
      other.step(frame);
    }
    EXPECT_EQ(test::apart(one, other), 0);
    EXPECT_LT(one.position(0).y, 1);
  }
}

// A place of a rod is one place, too, and its rope falls. A spring that never pulls makes both ropes
// linkages.
TEST(RigidJoints, OfOnePlaceOfARodDoNothing) {
  Scene without = test::crate({9, 2, 0});
  const std::uint32_t first = test::add_rope(without, {0, 2, 0}, {1, 0, 0}, false, 0);
  const Point middle = point_on_rod(without, static_cast<std::uint32_t>(without.rods.size() - 1), 0.5);
  without.springs = {{.a = point_at(first), .b = middle}};
  Scene with = without;
  with.pins = {{middle, reordered(middle)}};
  for_jointed_settings(
      [&](const Settings& settings) { EXPECT_LE(difference(settings, with, without), 1e-12); });
}

// What never changes is kept anyway. Gradients may be others where something is kept, which turning feels.
TEST(RigidJoints, OfWhatNeverChangesDoNothing) {
  Scene scene = falling();
  const Direction u = way(scene, {}, x), v = way(scene, {}, y);
  scene.alignments = {{u, v}};
  scene.angles = {{.u = u, .v = v, .lower = 1, .upper = 2, .friction = 1}};
  for_jointed_settings(
      [&](const Settings& settings) { EXPECT_LE(difference(settings, scene, falling()), 1e-9); });
}

// Rods bear all that pulls. Sweeps leave a share of that: 1e-4 of a size of 0.2 m.
TEST(RigidJoints, ThatPullMoveNothing) {
  Scene with = falling(), without = falling();
  add_pulls(with, 1);
  add_pulls(without, 0);
  for_jointed_settings(
      [&](const Settings& settings) { EXPECT_LE(difference(settings, with, without), 2e-5); });
}

TEST(RigidJoints, ThatCannotHoldAreRefused) {
  Scene scene = test::crate(center);
  scene.pins = {{on_crate(scene, {}), on_crate(scene, x)}};
  expect_refusal("pin 0: its places are 0.05", [&] { World(scene, {}); });
  expect_refusal("m apart, and rigid rods keep them so", [&] { World(scene, {}); });
  scene.rods[0].law = {.stiffness = 1e4};
  World giving(scene, {.threads = 1});  // which a pin pulls together
  scene = test::crate(center);
  scene.angles = {{.u = way(scene, {}, x), .v = way(scene, {}, y), .lower = 1.8}};
  expect_refusal("rad, beyond its limits, and rigid rods keep it so", [&] { World(scene, {}); });
  scene.angles[0].lower = 1.57;
  World within(scene, {.threads = 1});
  scene.angles.clear();
  scene.alignments = {{way(scene, {}, x), way(scene, {}, y), 1e-4}};
  expect_refusal("alignment 0: its value is 0.0001 m^2", [&] { World(scene, {}); });
  scene.alignments[0].value = 0;
  World aligned(scene, {.threads = 1});
  Scene rope;
  test::add_rope(rope, {}, {1, 0, 0}, false, 0);
  rope.pins = {{point_at(1), point_on_rod(rope, 1, 0.5)}};
  expect_refusal("pin 0: its places are 0.05", [&] { World(rope, {}); });
  rope.pins = {{point_at(0), point_at(2)}};
  World folded(rope, {.threads = 1});  // which no rod forbids
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
