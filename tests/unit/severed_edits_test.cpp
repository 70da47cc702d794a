// Joints and springs that are cut out of worlds that run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/severed.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::add_crate;
using test::add_figure;
using test::cut;
using test::expect_refusal;
using test::for_jointed_settings;
using test::frame;
using test::sever;
using test::step;
using test::thrown;

Momentum momentum(const World& world, const Settings& settings) {
  return measure_momentum(world.scene(), test::positions_of(world), test::velocities_of(world),
                          settings.method == Method::relax ? MassModel::lumped : MassModel::consistent);
}

/// Returns where a place of a scene is now.
Vec3 place_of(Scene scene, const World& world, const Point& point) {
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) scene.particles[i].position = world.position(i);
  return position_of(scene, point);
}
double dot_of(const Scene& scene, const World& world, const Alignment& of) {
  const auto way = [&](const Direction& each) {
    return place_of(scene, world, each.to) - place_of(scene, world, each.from);
  };
  return dot(way(of.u), way(of.v));
}

// The same figure uncut keeps its momenta as well as its method does. The cut takes none of that away.
TEST(Severing, KeepsMomentumAndLetsPartsFly) {
  for_jointed_settings([](const Settings& settings) {
    World world(thrown(), settings), whole(thrown(), settings);
    for (World* const each : {&world, &whole}) step(*each, 5);
    const Momentum before = momentum(world, settings);
    const double energy = test::energy_of(world.scene(), world).total();
    const std::vector<Vec3> x = test::positions_of(world), v = test::velocities_of(world);
    const Vec3 crate = world.position(8);
    sever(world);
    EXPECT_EQ(test::positions_of(world), x);
    EXPECT_EQ(test::velocities_of(world), v);
    for (World* const each : {&world, &whole}) step(*each, 1);
    EXPECT_EQ(world.info().islands, 3u);
    const Momentum after = momentum(world, settings), uncut = momentum(whole, settings);
    const double drift = norm(uncut.angular - before.angular);
    // Gradient old begins with as much in every world that begins with such a body.
    const double begun = settings.gradient == Gradient::old ? 1e-9 : 1e-12;
    EXPECT_LE(norm(after.linear - before.linear), 1e-12 * norm(before.linear));
    EXPECT_LE(norm(after.angular - before.angular), begun * norm(before.angular) + 1.1 * drift);
    Vec3 from[2], velocity[2];
    for (const std::uint32_t body : {0u, 1u}) {
      from[body] = world.pose(body).position;
      velocity[body] = world.motion(body).velocity;
    }
    step(world, 20);
    step(whole, 20);
    for (const std::uint32_t body : {0u, 1u})
      EXPECT_LE(norm(world.pose(body).position - from[body] - 20 * frame * velocity[body]), 1e-12);
    EXPECT_GT(norm(world.pose(0).position - world.pose(1).position), 0.45);
    EXPECT_LE(norm(momentum(world, settings).linear - before.linear), 1e-12 * norm(before.linear));
    EXPECT_LE(test::energy_of(world.scene(), world).total(), (1 + 1e-12) * energy);
    EXPECT_NE(world.position(8), crate);
    for (std::uint32_t i = 8; i < 12; ++i)
      EXPECT_EQ(world.position(i), whole.position(i)) << "keeps its bits";
    EXPECT_TRUE(world.problems().empty());
  });
}

// What is left of a hinge without one of its alignments is a universal joint.
TEST(Severing, LeavesTheOtherJointsOfAHinge) {
  Scene scene;
  add_figure(scene, {0, 2, 0});
  scene.angles.clear();
  scene.springs.clear();
  scene.torsions.clear();
  scene.pins.clear();
  scene.alignments.clear();
  add_revolute(scene, 0, 1, {0, 1.8, 0}, {1, 0, 0});
  scene.gravity = {};
  for (std::uint32_t i = 4; i < 8; ++i)
    scene.particles[i].velocity = cross(Vec3{1, 0, 0}, scene.particles[i].position - Vec3{0, 1.8, 0});
  for_jointed_settings([&](const Settings& settings) {
    World world(scene, settings);
    step(world, 5);
    cut<Alignment>(world, 0);
    for (std::uint32_t i = 4; i < 8; ++i) world.set_force(i, {i % 2 == 0 ? 4.0 : -2.0, 0, 0.7});
    step(world, 20);
    EXPECT_EQ(world.info().islands, 1u);
    const bool is_relaxed = settings.method == Method::relax;
    const double left = is_relaxed ? 1e-2 : 1e-9;
    const Pin& pin = scene.pins[0];
    EXPECT_LE(norm(place_of(scene, world, pin.a) - place_of(scene, world, pin.b)), left);
    const auto change = [&](std::size_t i) {
      return std::abs(dot_of(scene, world, scene.alignments[i]) -
                      dot_of(scene, World(scene, settings), scene.alignments[i]));
    };
    EXPECT_LE(change(1), is_relaxed ? 1e-4 : 1e-9);
    EXPECT_GT(change(0), 2e-3) << "of directions of 0.1 m";
    expect_refusal("alignment 0: was removed", [&] { (void)world.number(Handle<Alignment>{0, 1}); });
    EXPECT_EQ(world.scene().alignments.size(), 1u);
  });
}

// Springs and torsions end one by one, and what is said to them afterwards is refused. Others keep what
// programs changed of them.
TEST(Severing, EndsSpringsAndTorsions) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene = thrown();
    World world(scene, settings);
    Torsion stiff = scene.torsions[0];
    stiff.stiffness = 3;
    world.set_torsion(0, stiff);
    step(world, 3);
    EXPECT_GT(norm(world.spring_force(0)), 0.01);
    cut<Spring>(world);
    EXPECT_TRUE(world.has(world.handle<Spring>(0))) << "it waits";
    world.set_spring(0, scene.springs[0]);
    step(world, 1);
    expect_refusal("spring 0: was removed", [&] { (void)world.spring_force(0); });
    expect_refusal("spring 0: was removed", [&] { world.set_spring(0, scene.springs[0]); });
    EXPECT_EQ(world.scene().springs.size(), 0u);
    EXPECT_EQ(world.scene().torsions[0].stiffness, 3);
    EXPECT_GT(std::abs(world.torsion_torque(0)), 0.01);
    cut<Torsion>(world);
    step(world, 1);
    expect_refusal("torsion 0: was removed", [&] { (void)world.torsion_torque(0); });
    expect_refusal("torsion 0: was removed", [&] { (void)world.torsion_angle(0); });
    expect_refusal("torsion 0: was removed", [&] { world.set_torsion(0, stiff); });
    EXPECT_TRUE(is_finite(world.pin_force(0)));
    cut<AngleControl>(world);
    cut<Pin>(world);
    step(world, 1);
    expect_refusal("angle 0: was removed", [&] { world.set_angle(0, scene.angles[0]); });
    expect_refusal("angle 0: was removed", [&] { (void)world.angle_torque(0); });
    expect_refusal("pin 0: was removed", [&] { (void)world.pin_force(0); });
    EXPECT_EQ(world.info().islands, 2u) << "an alignment is left";
  });
}

// A crate hangs by a corner from a body that stands, and another from a fixed particle.
TEST(Severing, LetsFallWhatHangs) {
  Scene scene;
  add_crate(scene, {0, 3, 0});
  for (Particle& each : scene.particles) each.fixed = true;
  scene.rods.clear();
  scene.hulls.clear();
  add_crate(scene, {0, 2, 0});
  add_spherical(scene, point_on_body(scene, 0, {0, 2.1, 0}), point_on_body(scene, 1, {0, 2.1, 0}));
  scene.particles.push_back({.position = {5, 2.1, 0}, .fixed = true});
  const auto anchor = static_cast<std::uint32_t>(scene.particles.size() - 1);
  add_crate(scene, {5, 2, 0});
  add_spherical(scene, point_at(anchor), point_on_body(scene, 2, {5, 2.1, 0}));
  for_jointed_settings([&](const Settings& settings) {
    World world(scene, settings);
    step(world, 10);
    EXPECT_NEAR(world.reaction(anchor).y, 9.81, 0.1);
    EXPECT_NEAR(world.pose(1).position.y, 2, 1e-3);
    cut<Pin>(world, 0);
    cut<Pin>(world, 1);
    step(world, 30);
    for (const std::uint32_t body : {1u, 2u})
      EXPECT_NEAR(world.pose(body).position.y, 2 - 0.5 * 9.81 * 0.25, 0.03) << body;
    EXPECT_EQ(world.position(anchor), (Vec3{5, 2.1, 0}));
    EXPECT_EQ(world.reaction(anchor), Vec3{});
    EXPECT_EQ(world.position(0), scene.particles[0].position);
    world.remove(anchor);
    world.step(frame);
  });
}

// Particles are freed, fixed, joined and made heavier in the steps that sever what has them.
TEST(Severing, GoesWithOtherEdits) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene = thrown();
    scene.particles.push_back({.position = {0, 2.5, 0}, .mass = 0.1, .fixed = true});
    add_spherical(scene, point_at(12), point_on_body(scene, 0, {0, 2.5, 0}));
    World world(scene, settings);
    step(world, 3);
    world.free(12);
    cut<Pin>(world, 1);
    cut<Spring>(world, 0);
    world.set_mass(0, 0.2);
    world.join({.a = 12, .b = 8});
    step(world, 3);
    EXPECT_EQ(world.info().islands, 2u);
    EXPECT_GT(norm(world.position(12) - Vec3{0, 2.5, 0}), 1e-6);
    const Vec3 held = world.position(1);
    world.fix(1);
    cut<Pin>(world, 0);
    cut<Torsion>(world, 0);
    step(world, 1);
    EXPECT_EQ(world.position(1), held);
    EXPECT_TRUE(test::all_finite(world));
    EXPECT_TRUE(world.problems().empty());
  });
}

// Shapes between two bodies have nothing to go on between, and those of one go on.
TEST(Severing, EndsShapesBetweenWhatComesApart) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene = thrown();
    scene.capsules.push_back({.a = point_on_body(scene, 0, {0, 1.9, 0}),
                              .b = point_on_body(scene, 1, {0, 1.7, 0}),
                              .radius = 0.01});
    World world(scene, settings);
    step(world, 2);
    cut<Spring>(world);
    step(world, 1);
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, 2}));
    for (const bool all : {false, true}) {
      if (all) cut<Pin>(world);
      if (!all) {
        cut<Alignment>(world);
        cut<AngleControl>(world);
        cut<Torsion>(world);
      }
      step(world, 1);
      EXPECT_EQ(world.has_shape({ShapeKind::capsule, 2}), !all);
      EXPECT_EQ(world.info().islands, all ? 3u : 2u);
    }
    EXPECT_TRUE(world.has_shape({ShapeKind::capsule, 0}));
    EXPECT_EQ(world.scene().capsules.size(), 2u);
  });
}

TEST(Severing, IsTheSameOnTwoThreads) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax}) {
    std::vector<std::uint64_t> hashes;
    for (const unsigned threads : {1u, 2u}) {
      Scene scene = test::floor_alone();
      for (int i = 0; i < 4; ++i) add_figure(scene, {0.3 * i, 0.7 + 0.1 * i, 0});
      World world(scene, {.method = method, .substeps = 4, .threads = threads});
      step(world, 20);
      for (const std::uint32_t i : {1u, 2u})
        sever(world, {.pin = i, .alignment = i, .angle = i, .spring = i, .torsion = i});
      step(world, 60);
      EXPECT_EQ(world.info().islands, 6u);
      EXPECT_TRUE(test::all_finite(world));
      hashes.push_back(world.state_hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]) << to_string(method);
  }
}

// A figure that sleeps wakes, and another sleeps on.
TEST(Severing, WakesWhatSleeps) {
  Scene scene = test::floor_alone();
  for (const double x : {0.0, 9.0}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    add_figure(scene, {x, 0.6, 0});
    for (std::uint32_t i = first; i < first + 8; ++i) scene.particles[i].asleep = true;
  }
  World world(scene, {.substeps = 4, .sleep = true, .events = true});
  step(world, 2);
  const Vec3 place = world.position(0), other = world.position(8);
  EXPECT_EQ(place, scene.particles[0].position) << "it sleeps";
  sever(world);
  world.step(frame);
  EXPECT_TRUE(std::any_of(world.events().begin(), world.events().end(),
                          [](const Event& each) { return each.kind == Event::Kind::woke; }));
  step(world, 10);
  EXPECT_NE(world.position(0), place);
  EXPECT_EQ(world.position(8), other);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
