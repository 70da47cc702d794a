// Forces of joints, springs, drives and contacts, and tensions beside them: at rest, in circles, and as the
// change of momentum.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "contact/pulls/linkage_pulls.hpp"
#include "support/bodies.hpp"
#include "support/reactions.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;
using test::sum_of_reactions;

constexpr double pi = std::numbers::pi;

Settings counting(std::uint32_t substeps = 1) {
  Settings settings = test::body_settings(substeps);
  settings.tensions = true;
  return settings;
}

Vec3 sum_of_contacts(const Scene& scene, const World& world) {
  std::vector<Vec3> all(scene.capsules.size());
  world.copy_contact_forces(all);
  Vec3 sum;
  for (const Vec3 each : all) sum += each;
  return sum;
}
double mass_of(const Scene& scene) {
  double mass = 0;
  for (const Particle& particle : scene.particles) mass += particle.mass;
  for (const Rod& rod : scene.rods) mass += rod.mass;
  for (const Body& body : scene.bodies) mass += body.mass;
  return mass;
}

/// A box of 2 kg that hangs from a fixed particle at the origin by a ball joint, `center` (m) away from it.
Scene hung_box(Vec3 center) {
  Scene scene;
  scene.particles.push_back(test::fixed({}));
  MassProperties box = solid_box(2, {0.3, 0.4, 0.5});
  box.center = center;
  const std::uint32_t body = add_body(scene, box);
  add_spherical(scene, point_at(0), point_on_body(scene, body, {}));
  return scene;
}

TEST(JointForces, APinCarriesWhatHangsFromIt) {
  Scene scene = hung_box({0.1, -0.4, 0.05});
  scene.drag = 8;
  const double weight = 2 * earth;
  for (const std::uint32_t substeps : {1u, 4u}) {
    World world(scene, counting(substeps));
    test::run(world, frame, 3000);
    EXPECT_LT(norm(world.pin_force(0) - Vec3{0, -weight, 0}), 1e-9 * weight);
    EXPECT_LT(norm(world.reaction(0) - Vec3{0, weight, 0}), 1e-9 * weight);
  }
}

TEST(JointForces, APinHoldsAgainstTheCentrifugalForce) {
  constexpr double w = 3, r = 0.5, mass = 2;
  Scene scene = hung_box({r, 0, 0});
  scene.bodies[0].inertia = solid_sphere(mass, 0.2).inertia;
  scene.gravity = {};
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.velocity = cross(Vec3{0, 0, w}, particle.position);
  const auto error = [&](int steps) {
    World world(scene, counting());
    double worst = 0, angle = 0;
    const double dt = 1.0 / steps;
    for (int i = 0; i < steps; ++i) {
      world.step(dt);
      const double next = w * world.time();
      const Vec3 mean{std::sin(next) - std::sin(angle), std::cos(angle) - std::cos(next), 0};
      worst = std::max(worst, norm(world.pin_force(0) - (mass * w * r / dt) * mean));
      angle = next;
    }
    return worst;
  };
  const double coarse = error(60), fine = error(120);
  EXPECT_LT(fine, 1e-3 * mass * w * w * r);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}

/// A figure of two boxes with everything that pulls: a ball joint, an angle with limits, friction and drive,
/// a spring, a torsion and a rope of rods that give, one of them a cable. It falls at a slant.
Scene figure(bool hangs) {
  Scene scene;
  MassProperties box = solid_box(2, {0.3, 0.4, 0.5});
  box.center = {0, 1, 0};
  const std::uint32_t a = add_body(scene, box);
  box.center = {0.8, 1.1, 0.1};
  const std::uint32_t b = add_body(scene, box);
  const auto on = [&](std::uint32_t body, Vec3 at) { return point_on_body(scene, body, at); };
  add_spherical(scene, on(a, {0.4, 1, 0}), on(b, {0.4, 1, 0}));
  scene.angles.push_back({.u = {on(a, {0, 1, 0}), on(a, {0, 1, 0.5})},
                          .v = {on(b, {0.8, 1, 0}), on(b, {0.8, 1.5, 0})},
                          .lower = pi / 2 - 0.1,
                          .upper = pi / 2 + 0.1,
                          .friction = 0.3,
                          .target = pi / 2 + 0.3,
                          .stiffness = 5,
                          .damping = 0.1});
  scene.springs.push_back(
      {.a = on(a, {0, 1.2, 0}), .b = on(b, {0.8, 1.2, 0}), .length = 0.6, .stiffness = 80});
  scene.springs.push_back(
      {.a = on(a, {0, 0.8, 0}), .b = on(b, {0.8, 0.8, 0}), .stiffness = 3, .damping = 0.5, .force = 0.7});
  scene.torsions.push_back({.axis = {on(a, {0, 1, 0}), on(a, {1, 1, 0})},
                            .u = {on(a, {0, 1, 0}), on(a, {0, 1.5, 0})},
                            .v = {on(b, {0.8, 1, 0}), on(b, {0.8, 1.5, 0})},
                            .stiffness = 4,
                            .damping = 0.1,
                            .torque = 0.2});
  const std::uint32_t end = scene.bodies[b].particles[0];
  const auto next = static_cast<std::uint32_t>(scene.particles.size());
  const Vec3 from = scene.particles[end].position;
  scene.particles.push_back(test::movable(from + Vec3{0.2, 0, 0}, 0.3));
  scene.particles.push_back(test::movable(from + Vec3{0.4, 0, 0.1}, 0.2));
  scene.rods.push_back({.a = end, .b = next, .law = {.stiffness = 300, .damping = 1}});
  scene.rods.push_back({.a = next, .b = next + 1, .law = {.one_sided = true}});
  for (Particle& particle : scene.particles) particle.velocity = {0.5, 0, -0.3};
  if (!hangs) return scene;
  scene.particles.push_back(test::fixed({-0.3, 1.6, 0}));
  add_spherical(scene, on(a, {-0.3, 1.6, 0}), point_at(next + 2));
  scene.particles.push_back(test::fixed({1.5, 2, 0}));
  scene.rods.push_back({.a = next + 1, .b = next + 3, .law = {.stiffness = 50}});
  return scene;
}

/// How far what forces do is from the change of momentum, over a second, in N.
struct Balance {
  double worst = 0;          ///< the largest difference in a step
  double worst_guarded = 0;  ///< that in steps whose energy was guarded
  double contact = 0;        ///< the largest force of contact
};
Balance balance(const Scene& scene, const Settings& settings, int steps) {
  World world(scene, settings);
  const double dt = 1.0 / steps;
  const Vec3 weight = mass_of(scene) * scene.gravity;
  Balance out;
  Vec3 last = test::momentum_of(scene, world).linear;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = world.step(dt);
    EXPECT_EQ(report.unsolved, 0u);
    const Vec3 now = test::momentum_of(scene, world).linear, contacts = sum_of_contacts(scene, world);
    const double off = norm(1 / dt * (now - last) - (sum_of_reactions(world) + contacts + weight));
    double& worst = report.guarded_energy + report.trimmed_energy > 0 ? out.worst_guarded : out.worst;
    worst = std::max(worst, off);
    out.contact = std::max(out.contact, norm(contacts));
    last = now;
  }
  return out;
}

/// Forces here are of some 100 N, and of 1,000 N in blows.
constexpr double rounding = 1e-10;

TEST(JointForces, MakeTheChangeOfMomentumWithAnchors) {
  for (const std::uint32_t substeps : {1u, 3u})
    EXPECT_LT(balance(figure(true), counting(substeps), 100).worst, rounding);
}

// Anchors that hold corners of a body get their share of its mass.
TEST(JointForces, HoldABodyByItsCorner) {
  for (const bool both : {false, true}) {
    Scene scene;
    scene.drag = 8;
    scene.particles = {test::fixed({}), test::movable({1, 0, 0}, 0), test::movable({0, 1, 0}, 0),
                       test::movable({0, 0, 1}, 0)};
    scene.particles[2].fixed = both;
    add_body(scene, {0, 1, 2, 3}, solid_box(2, {0.3, 0.4, 0.5}));
    World world(scene, counting());
    test::run(world, frame, 3000);
    EXPECT_LT(norm(sum_of_reactions(world) + mass_of(scene) * scene.gravity), 1e-9 * 2 * earth);
  }
}

TEST(JointForces, FlightsOfOrderFourCountThem) {
  Scene scene = hung_box({0.1, -0.4, 0.05});
  Settings settings = counting(4);
  settings.time_order = 4;
  settings.gradient = Gradient::old;
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.velocity = cross(Vec3{1, 0.5, 2}, particle.position);
  // Nothing but its energy's guard stands between a flight and the balance of its stages.
  EXPECT_LT(balance(scene, settings, 60).worst, 1e-6);
  World flying(scene, settings), fine(scene, counting(400));
  double worst = 0;
  for (int i = 0; i < 30; ++i) {
    flying.step(frame);
    fine.step(frame);
    worst = std::max(worst, norm(flying.pin_force(0) - fine.pin_force(0)));
  }
  EXPECT_LT(worst, 1e-4);
}

TEST(JointForces, SpringsPullByTheirLaw) {
  Scene scene;
  scene.drag = 8;
  scene.particles = {test::fixed({}), test::movable({0, -1, 0}, 2), test::fixed({3, 0, 0}),
                     test::movable({3, -1, 0}, 2)};
  scene.springs = {{.a = point_at(0), .b = point_at(1), .length = 0.7, .stiffness = 100, .force = 3},
                   {.a = point_at(3), .b = point_at(2), .stiffness = 50, .force = 2}};
  World world(scene, counting());
  test::run(world, frame, 3000);
  const double weight = 2 * earth;
  EXPECT_NEAR(100 * (-world.position(1).y - 0.7) + 3, weight, 1e-9 * weight);
  EXPECT_LT(norm(world.spring_force(0) - Vec3{0, -weight, 0}), 1e-9 * weight) << "on the anchor";
  EXPECT_LT(norm(world.spring_force(1) - Vec3{0, weight, 0}), 1e-9 * weight) << "on the load";
  EXPECT_NEAR(world.reaction(0).y, weight, 1e-9 * weight);
}

/// A rod of 2 kg and 1 m about the origin, from the x axis.
Scene lever() {
  Scene scene;
  scene.drag = 8;
  scene.particles = {test::fixed({}), test::fixed({0, 1, 0}), test::fixed({0, 0, 1}),
                     test::movable({1, 0, 0}, 0)};
  scene.rods = {{.a = 0, .b = 3, .mass = 2}};
  return scene;
}

TEST(JointForces, TorsionsDrivesAndLimitsHoldALever) {
  const auto moment = [](const World& world) { return 2 * earth * world.position(3).x / 2; };
  Scene twisted = lever(), driven = lever(), limited = lever();
  const Direction up{point_at(0), point_at(1)}, arm{point_at(0), point_at(3)};
  twisted.torsions = {{.axis = {point_at(0), point_at(2)}, .u = up, .v = arm, .angle = -1, .stiffness = 60}};
  driven.angles = {{.u = up, .v = arm, .target = 1, .stiffness = 60}};
  limited.angles = {{.u = up, .v = arm, .upper = 2}};
  World by_torsion(twisted, counting()), by_drive(driven, counting()), by_limit(limited, counting());
  for (World* const world : {&by_torsion, &by_drive, &by_limit}) test::run(*world, frame, 3000);
  EXPECT_NEAR(by_torsion.torsion_torque(0), moment(by_torsion), 1e-9 * earth);
  EXPECT_NEAR(by_torsion.torsion_torque(0), 60 * (-1 - by_torsion.torsion_angle(0)), 1e-9 * earth);
  EXPECT_NEAR(by_drive.angle_torque(0), -moment(by_drive), 1e-9 * earth) << "it holds the angle together";
  // Limits are sought to Settings::contact.sweep_tolerance.
  EXPECT_NEAR(by_limit.angle_torque(0), -moment(by_limit), 1e-5 * earth);
}

TEST(ContactForces, MakeTheChangeOfMomentum) {
  Scene scene = figure(false);
  for (const Body& body : scene.bodies)
    for (const std::uint32_t i : {0, 1})
      scene.capsules.push_back({.a = point_at(body.particles[i]),
                                .b = point_at(body.particles[i + 2]),
                                .radius = 0.1,
                                .surface = {.friction = 0.4, .restitution = 0.3}});
  scene.planes.push_back({.normal = {0.6, 0.8, 0}, .offset = 0.2});
  scene.boxes.push_back({.center = {0, -1, 0}, .half_size = {2, 1, 2}});
  test::add_ball(scene, {0.3, 0.3, 0}, 0.2, 0.5, {}, {.friction = 0.3, .restitution = 0});
  const Balance off = balance(scene, counting(4), 100);
  EXPECT_GT(off.contact, 100);
  EXPECT_LT(off.worst, rounding);
}

// Contacts in the island's own matrix. Where energy is guarded, motion is taken without a force.
TEST(ContactForces, CarryALyingRope) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 40; ++i) {
    scene.particles.push_back(test::movable({0.05 * i, 0.01 + 0.001 * std::sin(0.7 * i), 0}, 0.05));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.01});
  }
  scene.planes.push_back({});
  EXPECT_LT(balance(scene, counting(4), 60).worst, rounding);
  World world(scene, counting(4));
  test::run(world, frame, 600);
  const Vec3 weight = mass_of(scene) * scene.gravity;
  EXPECT_LT(norm(sum_of_contacts(scene, world) + weight), 1e-9 * norm(weight));
  EXPECT_FALSE(std::isnan(world.tension(7)));
}

/// Contacts are sought to what a sweep may leave: rest is as exact as that.
Settings exact_contacts(std::uint32_t substeps) {
  Settings settings = counting(substeps);
  settings.contact.sweep_tolerance = 1e-11;
  settings.contact.length_scale = 1e-3;
  return settings;
}

TEST(ContactForces, CarryWhatRests) {
  for (const double slope : {0.0, 0.3}) {
    Scene scene;
    scene.gravity = earth * Vec3{std::sin(slope), -std::cos(slope), 0};
    scene.planes.push_back({.surface = {.friction = 0.8, .restitution = 0}});
    test::add_capsule_rod(scene, {0, 0.1, 0}, {0.5, 0.1, 0.2}, 3, 0.1, {.friction = 0.8, .restitution = 0});
    for (const bool is_exact : {false, true}) {
      World world(scene, is_exact ? exact_contacts(1) : counting());
      test::run(world, frame, 900);
      const double weight = 3 * earth;
      EXPECT_LT(norm(world.contact_force(0) + 3.0 * scene.gravity), (is_exact ? 1e-9 : 1e-5) * weight)
          << slope;
    }
  }
}

TEST(ContactForces, APileCarriesItself) {
  Scene scene;
  scene.planes.push_back({.surface = test::smooth});
  const Surface rough{.friction = 0.5, .restitution = 0};
  for (int i = 0; i < 3; ++i) test::add_ball(scene, {0, 0.2 + 0.4 * i, 0}, 0.2, 1 + i, {}, rough);
  World world(scene, exact_contacts(1));
  test::run(world, frame, 900);
  EXPECT_LT(norm(sum_of_contacts(scene, world) + mass_of(scene) * scene.gravity), 1e-9 * 6 * earth);
  for (const std::uint32_t i : {0u, 1u, 2u})
    EXPECT_NEAR(world.contact_force(i).y, (1 + i) * earth, 1e-8 * earth);
}

// A rope that touches nothing is at home; where it lies, the contact solver moves it. Asleep it keeps its
// forces.
TEST(ContactForces, StayThroughSleepAndEndInTheAir) {
  Scene scene;
  scene.planes.push_back({.surface = test::smooth});
  test::add_ball(scene, {0, 0.2, 0}, 0.2, 2);
  Settings settings = counting(4);
  settings.sleep = true;
  World world(scene, settings);
  EXPECT_EQ(world.contact_force(0), Vec3{}) << "before the first step";
  StepReport report;
  for (int i = 0; i < 120; ++i) report = world.step(frame);
  ASSERT_EQ(report.awake_islands, 0u);
  EXPECT_NEAR(world.contact_force(0).y, 2 * earth, 1e-4 * earth);
  world.set_force(0, {0, 200, 0});
  test::run(world, frame, 30);
  EXPECT_EQ(world.contact_force(0), Vec3{});
}

TEST(JointForces, HaveTheSameBitsOnTwoThreads) {
  Scene scene;
  for (int k = 0; k < 20; ++k) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back(test::fixed({3.0 * k, 0, 0}));
    scene.particles.push_back(test::movable({3.0 * k + 1, 0.1 * k, 0}, 1));
    scene.springs.push_back(
        {.a = point_at(first), .b = point_at(first + 1), .length = 0.5, .stiffness = 100});
    scene.capsules.push_back({.a = point_at(first + 1), .b = point_at(first + 1), .radius = 0.1});
  }
  scene.planes.push_back({.offset = -0.5});
  std::vector<Vec3> forces[2];
  for (const unsigned threads : {1u, 2u}) {
    Settings settings = counting(2);
    settings.threads = threads;
    World world(scene, settings);
    for (int step = 0; step < 60; ++step) {
      world.step(frame);
      for (std::uint32_t i = 0; i < scene.capsules.size(); ++i) {
        forces[threads - 1].push_back(world.contact_force(i));
        forces[threads - 1].push_back(world.spring_force(i));
      }
    }
  }
  EXPECT_TRUE(forces[0] == forces[1]);
}

TEST(JointForces, ThatAreNotThereAreRefused) {
  using test::refusal;
  Scene scene = figure(false);
  World silent(scene, test::body_settings());
  EXPECT_EQ(refusal([&] { (void)silent.pin_force(0); }),
            "tensions are not known: Settings::tensions asks for them");
  World world(scene, counting());
  EXPECT_EQ(refusal([&] { (void)world.pin_force(1); }), "pin 1: unknown, the world has 1 pin");
  EXPECT_EQ(refusal([&] { (void)world.angle_torque(1); }), "angle 1: unknown, the world has 1 angle");
  EXPECT_EQ(refusal([&] { (void)world.spring_force(2); }), "spring 2: unknown, the world has 2 springs");
  EXPECT_EQ(refusal([&] { (void)world.torsion_torque(1); }), "torsion 1: unknown, the world has 1 torsion");
  EXPECT_EQ(refusal([&] { (void)world.contact_force(0); }), "shape 0: unknown, the world has 0 shapes");
  std::vector<Vec3> some(1);
  EXPECT_EQ(refusal([&] { world.copy_contact_forces(some); }),
            "contact forces of 0 shapes cannot be copied into 1 elements");
  EXPECT_TRUE(std::isnan(world.pin_force(0).x) && std::isnan(world.torsion_torque(0)))
      << "before the first step";
  Scene ball;
  ball.particles = {test::movable({}, 1)};
  World bare(ball, {.tensions = true});
  EXPECT_EQ(refusal([&] { (void)bare.pin_force(0); }), "pin 0: unknown, the world has 0 pins");
  bare.copy_contact_forces({});
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
