// Methods multipliers and featherstone with bodies, joints, springs and torsions: the same motion as method
// direct's, which shares none of their equations, each to its order.

#include <gtest/gtest.h>

#include <cmath>

#include "plumb/joints.hpp"
#include "support/exact_methods.hpp"
#include "support/mechanisms.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::Andrews;

Settings by(Method method, std::uint32_t substeps = 1) {
  return test::exact(method, Integrator::rk4, substeps);
}

std::vector<Vec3> end_of(const Scene& scene, const Settings& settings, double dt, int steps) {
  World world(scene, settings);
  EXPECT_EQ(test::run(world, dt, steps).unsolved, 0u);
  return test::positions_of(world);
}

/// Where direct's steps of order 6 end, which is the truth to some 1e-10 m.
std::vector<Vec3> best_end_of(const Scene& scene, double dt, int steps) {
  Settings settings = test::body_settings(8);
  settings.time_order = 6;
  settings.gradient = Gradient::old;
  return end_of(scene, settings, dt, steps);
}

// The mechanism has a torque, a spring and rods with inertia. RK4 of 15 us a step is within 1e-8 m of the
// published end, and of order 4 or better before.
TEST(JointedMultipliers, EndAndrewsMechanismAtItsPublishedAngles) {
  const Andrews::Places at = Andrews::places(Andrews::end);
  const auto error = [&](int steps) {
    const std::vector<Vec3> x =
        end_of(Andrews::of_rods(), by(Method::multipliers), Andrews::duration / steps, steps);
    return std::max({norm(x[Andrews::crank] - at.crank), norm(x[Andrews::middle] - at.middle),
                     norm(x[Andrews::lower] - at.lower), norm(x[Andrews::upper] - at.upper),
                     norm(x[Andrews::spring] - at.spring)});
  };
  const double coarse = error(500), fine = error(1000), best = error(2000);
  EXPECT_GE(std::log2(coarse / fine), 3.5);
  EXPECT_LE(best, 1e-8);
}

// Of bodies and hinges nine constraints are redundant. They decide nothing.
TEST(JointedMultipliers, MoveAndrewsMechanismWithRedundantHinges) {
  const Scene scene = Andrews::of_bodies();
  World world(scene, by(Method::multipliers));
  constexpr int steps = 2000;
  EXPECT_EQ(test::run(world, Andrews::duration / steps, steps).unsolved, 0u);
  const std::uint32_t crank = 5;  // the crank's first particle, after the ground's four and the spring's
  const Vec3 start = scene.particles[crank].position, now = world.position(crank);
  const double turned = Andrews::end[0] - Andrews::start[0];
  const Vec3 expected{std::cos(turned) * start.x - std::sin(turned) * start.y,
                      std::sin(turned) * start.x + std::cos(turned) * start.y, start.z};
  EXPECT_LE(norm(now - expected) / norm(Vec3{start.x, start.y, 0}), 1e-6);
}

/// A body of three different moments that tumbles as it falls.
Scene tumbler() {
  Scene scene;
  const std::uint32_t body = add_body(scene, solid_box(2, {0.1, 0.3, 0.5}));
  test::set_motion(scene, body, {1, 2, 0.5}, {3, 0.5, -2});
  return scene;
}

/// A heavy top that spins on a tip, where a pin holds it.
Scene top() {
  Scene scene;
  MassProperties wheel = solid_cylinder(1, 0.1, 0.03);
  wheel.center = {0.1, 0.05, 0.02};
  const std::uint32_t body = add_body(scene, wheel);
  scene.particles.push_back(test::fixed({}));
  add_spherical(scene, point_at(static_cast<std::uint32_t>(scene.particles.size() - 1)),
                point_on_body(scene, body, {}));
  const Vec3 spin{20, 10, 4};
  test::set_motion(scene, body, cross(spin, wheel.center), spin);
  return scene;
}

/// Four bodies: two hang from a ball joint and a hinge, two float tied to them by springs alone. A spring, a
/// torsion, a drive of an angle and drag act on them.
Scene branched() {
  Scene scene;
  scene.drag = 0.1;
  std::uint32_t bodies[4];
  for (int i = 0; i < 4; ++i) {
    MassProperties box = solid_box(1 + i, {0.1, 0.2 + 0.1 * i, 0.15});
    box.center = {0.5 * i, -0.2 * i, 0.1 * i};
    bodies[i] = add_body(scene, box);
  }
  const std::uint32_t ground = test::add_fixed_body(scene);
  const auto joined = [&](std::uint32_t body, Vec3 at) { return point_on_body(scene, body, at); };
  add_spherical(scene, joined(ground, {-0.1, 0.2, 0}), joined(bodies[0], {-0.1, 0.2, 0}));
  add_revolute(scene, bodies[1], bodies[0], {0.2, -0.1, 0}, {0.3, 0.2, 1});
  add_spherical(scene, joined(bodies[3], {1.2, -0.5, 0.2}), joined(bodies[2], {1.2, -0.5, 0.2}));
  scene.springs.push_back({.a = joined(bodies[1], {0.6, 0, 0}),
                           .b = joined(bodies[2], {0.9, -0.4, 0.2}),
                           .length = 0.4,
                           .stiffness = 200,
                           .damping = 3,
                           .force = 5});
  const Point hinge = joined(bodies[0], {0.2, -0.1, 0});
  scene.torsions.push_back({.axis = {hinge, joined(bodies[0], {0.5, 0.1, 1})},
                            .u = {hinge, joined(bodies[0], {1.2, -0.1, 0})},
                            .v = {hinge, joined(bodies[1], {0.2, 0.9, 0})},
                            .angle = 7,
                            .stiffness = 2,
                            .damping = 0.1,
                            .torque = 0.3});
  scene.angles.push_back({.u = {hinge, joined(bodies[0], {0.2, 0.9, 0})},
                          .v = {hinge, joined(bodies[1], {0.2, -0.1, 1})},
                          .target = 1,
                          .stiffness = 3,
                          .damping = 0.2});
  test::set_motion(scene, bodies[3], {0, 1, 0}, {0, 2, 0});
  return scene;
}

struct Case {
  const char* name;
  Scene scene;
};
std::vector<Case> cases() {
  return {{"tumbler", tumbler()}, {"top", top()}, {"branched", branched()}};
}

// Errors against direct's best fall with the fourth power of the step, and the finest is below 1e-8 m.
TEST(JointedMethods, MoveBodiesAsDirectDoes) {
  for (const Case& each : cases()) {
    const std::vector<Vec3> best = best_end_of(each.scene, 0.01, 50);
    for (const Method method : {Method::multipliers, Method::featherstone}) {
      double errors[3];
      for (const int k : {0, 1, 2})
        errors[k] = rms_distance(end_of(each.scene, by(method, 1u << k), 0.01, 50), best);
      EXPECT_NEAR(std::log2(errors[0] / errors[1]), 4, 0.5) << each.name << ", " << to_string(method);
      EXPECT_NEAR(std::log2(errors[1] / errors[2]), 4, 0.5) << each.name << ", " << to_string(method);
      EXPECT_LE(rms_distance(end_of(each.scene, by(method, 32), 0.01, 50), best), 1e-8)
          << each.name << ", " << to_string(method);
    }
  }
}

// The two solve the same equations in other coordinates. Forces on particles and anchors that move act on
// both.
TEST(JointedMethods, AgreeUnderForcesAndMovedAnchors) {
  const Scene scene = branched();
  std::vector<Vec3> ends[2];
  for (const Method method : {Method::multipliers, Method::featherstone}) {
    World world(scene, by(method, 32));
    world.set_force(2, {3, 1, -2});
    for (int i = 1; i <= 20; ++i) {
      for (std::uint32_t anchor = 16; anchor < 20; ++anchor)
        world.move_anchor(anchor, scene.particles[anchor].position + Vec3{0.005 * i, 0, 0.002 * i});
      world.step(0.01);
    }
    ends[method == Method::featherstone] = test::positions_of(world);
  }
  EXPECT_LE(rms_distance(ends[0], ends[1]), 1e-9);
}

std::string refusal(const Scene& scene, Method method) {
  return test::refusal([&] { World world(scene, by(method)); });
}
void expect_says(const std::string& message, const char* part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

// What they do not know they name, with a particle of the island.
TEST(JointedMethods, RefuseWhatTheyDoNotKnow) {
  for (const Method method : {Method::multipliers, Method::featherstone}) {
    Scene limited = branched();
    limited.angles[0].lower = 0.5;
    expect_says(refusal(limited, method), "limits of angles");
    limited.angles[0].lower = 0;
    limited.angles[0].friction = 1;
    expect_says(refusal(limited, method), "dry friction");
    Scene braked = tumbler();
    braked.joint_drag = 1;
    expect_says(refusal(braked, method), "drag of joints");
    Scene shaped = tumbler();
    shaped.capsules.push_back({.a = point_at(0), .b = point_at(1), .radius = 0.01});
    expect_says(refusal(shaped, method), "shapes");
    Scene asleep = tumbler();
    for (Particle& particle : asleep.particles) particle.asleep = true;
    expect_says(refusal(asleep, method), "sleepers");
  }
  World world(branched(), by(Method::multipliers));
  expect_says(test::refusal([&] { world.set_spring(0, {.length = 1}); }), "keeps them as they are");
  expect_says(refusal(Andrews::of_bodies(), Method::featherstone), "more than one place");
  expect_says(refusal(Andrews::of_rods(), Method::featherstone), "particles or rods besides");
  Scene looped = branched();
  add_spherical(looped, point_on_body(looped, 3, {1, -0.3, 0.2}), point_on_body(looped, 2, {1, -0.3, 0.2}));
  expect_says(refusal(looped, Method::featherstone), "close loops");
  Scene universal = branched();
  universal.alignments.pop_back();
  expect_says(refusal(universal, Method::featherstone), "neither ball joints nor hinges");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
