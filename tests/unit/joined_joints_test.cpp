// Joints and springs that are joined to worlds that run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/severed.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;
using test::for_jointed_settings;
using test::frame;
using test::step;

/// Two ropes that fly and touch with particles 4 and 5, the second without shapes, and a crate far away.
Scene two_ropes() {
  Scene scene;
  scene.gravity = {};
  test::add_rope(scene, {0, 2, 0}, {1, 0, 0}, false, 0.02);
  test::add_rope(scene, {0.4, 2, 0}, {0, 0, 1}, false, 0);
  for (std::uint32_t i = 0; i < 5; ++i) {
    scene.particles[i].velocity = {0.3, 0.1 * i, 0.2};
    scene.particles[5 + i].velocity = {-0.5, 0.2 - 0.1 * i, 0};
  }
  test::add_crate(scene, {9, 2, 0});
  return scene;
}
const Pin pin{.a = point_at(4), .b = point_at(5)};
const Spring spring{.a = point_at(2), .b = point_at(7), .length = 0.2, .stiffness = 20, .damping = 0.1};

/// The two bodies of a figure, which fly and turn, without what holds them together.
Scene two_bodies() {
  Scene scene = test::figure({0, 2, 0});
  test::set_flying(scene, {0, 1.8, 0});
  scene.pins.clear();
  scene.alignments.clear();
  scene.angles.clear();
  scene.springs.clear();
  scene.torsions.clear();
  return scene;
}

Momentum momentum(const World& world) {
  return test::momentum_of(world.scene(), world);
}

/// The bodies from above, which turn against each other.
Scene bodies_that_turn() {
  Scene scene = two_bodies();
  for (std::uint32_t i = 4; i < 8; ++i)
    scene.particles[i].velocity += cross(Vec3{2, 0, 3}, scene.particles[i].position - Vec3{0, 1.6, 0});
  return scene;
}

double product(const World& world, const Alignment& of) {
  const auto place = [&](const Point& point) {
    Vec3 sum;
    for (std::size_t k = 0; k < 4; ++k) sum += point.weights[k] * world.position(point.particles[k]);
    return sum;
  };
  return dot(place(of.u.to) - place(of.u.from), place(of.v.to) - place(of.v.from));
}

/// Both solve the same equations from the same numbers, to rounding. A relaxed world begins with the blow of
/// 1 m/s still before it, which is taken out where one is joined: 1e-3 m are a hundredth of what it moves.
double tolerance(const Settings& settings) {
  return settings.method == Method::relax ? 1e-3 : 1e-12;
}

// Two balls stick together. What both had as momentum, both have then, but for the share of 1e-11 that the
// matrix has on its diagonal beside a blow's own.
TEST(JoinedJoints, EndTheBlowOfTwoBallsAtTheirMean) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene = test::crate({9, 2, 0});
    scene.gravity = {};
    scene.particles.push_back({.velocity = {1, 0, 0}, .mass = 0.1});
    scene.particles.push_back({.velocity = {0, 2, 0}, .mass = 0.3});
    World world(scene, settings);
    world.join(Pin{.a = point_at(4), .b = point_at(5)});
    world.step(frame);
    const Vec3 mean{0.25, 1.5, 0};
    EXPECT_LE(norm(world.velocity(4) - mean), 1e-11);
    EXPECT_LE(norm(world.velocity(5) - mean), 1e-11);
    EXPECT_LE(norm(world.position(4) - frame * mean), 1e-12);
  });
}

// The blow of a pin is its own force. Gradient new and sweeps turn what they project a little.
TEST(JoinedJoints, KeepMomentumAndAngularMomentum) {
  for_jointed_settings([](const Settings& settings) {
    World world(two_ropes(), settings);
    const Momentum before = momentum(world);
    world.join(pin);
    world.join(spring);
    world.step(frame);
    const Momentum after = momentum(world);
    EXPECT_LE(norm(after.linear - before.linear), 1e-12);
    if (settings.method != Method::relax && settings.gradient != Gradient::new_) {
      EXPECT_LE(norm(after.angular - before.angular), 1e-12);
    }
    EXPECT_LE(norm(world.position(4) - world.position(5)), 1e-9);
    EXPECT_EQ(world.info().islands, 2u);
  });
}

TEST(JoinedJoints, MoveRopesAsInAFreshWorld) {
  for_jointed_settings([](const Settings& settings) {
    World world(two_ropes(), settings);
    Scene scene = world.scene();  // whose velocities fit its rods
    EXPECT_EQ(world.number(world.join(pin)), 0u);
    EXPECT_EQ(world.number(world.join(spring)), 0u);
    EXPECT_TRUE(std::isnan(world.pin_force(0).x));
    EXPECT_TRUE(std::isnan(world.spring_force(0).x));
    EXPECT_TRUE(world.scene().pins.empty() && world.scene().springs.empty());
    scene.pins.push_back(pin);
    scene.springs.push_back(spring);
    World fresh(scene, settings);
    step(world, 1);
    step(fresh, 1);
    EXPECT_LE(test::apart(world, fresh), tolerance(settings));
    EXPECT_EQ(world.info().islands, fresh.info().islands);
    const double force = norm(fresh.spring_force(0));
    EXPECT_LE(norm(world.spring_force(0) - fresh.spring_force(0)),
              settings.method == Method::relax ? 0.1 * force : 1e-9 * force);
    EXPECT_EQ(world.scene().pins.size(), 1u);
  });
}

TEST(JoinedJoints, MoveBodiesAsInAFreshWorld) {
  const Scene figure = test::figure({0, 2, 0});
  for_jointed_settings([&](const Settings& settings) {
    Scene scene = two_bodies();
    World world(scene, settings);
    world.join(figure.pins[0]);
    world.join(figure.angles[0]);
    world.join(figure.springs[0]);
    world.join(figure.torsions[0]);
    scene.pins = figure.pins;
    scene.angles = figure.angles;
    scene.springs = figure.springs;
    scene.torsions = figure.torsions;
    World fresh(scene, settings);
    step(world, 1);
    step(fresh, 1);
    EXPECT_LE(test::apart(world, fresh), tolerance(settings));
    EXPECT_NEAR(world.torsion_angle(0), fresh.torsion_angle(0), 10 * tolerance(settings));
    world.set_spring(0, {.a = spring.a, .b = spring.b, .length = 0.3, .stiffness = 1});
    step(world, 10);
    EXPECT_TRUE(world.problems().empty());
  });
}

// The product is that of now. It stays so when the island is made anew from what the scene says.
TEST(JoinedJoints, KeepTheProductOfNow) {
  const Alignment alignment = test::figure({0, 2, 0}).alignments[0];
  for_jointed_settings([&](const Settings& settings) {
    World world(bodies_that_turn(), settings);
    step(world, 10);
    Scene scene = world.scene();
    const double now = product(world, alignment);
    EXPECT_GT(std::abs(now - product(World(bodies_that_turn(), settings), alignment)), 0.1)
        << "it has changed";
    EXPECT_EQ(world.number(world.join(alignment)), 0u);
    EXPECT_TRUE(world.scene().alignments.empty());
    scene.alignments.push_back(alignment);
    World fresh(scene, settings);
    step(world, 1);
    step(fresh, 1);
    EXPECT_LE(test::apart(world, fresh), std::max(tolerance(settings), 1e-11))
        << "which fits velocities anew";
    EXPECT_EQ(world.scene().alignments[0].value, now);
    step(world, 5);
    world.set_mass(0, 0.1);
    step(world, 5);
    EXPECT_NEAR(product(world, alignment), now, settings.method == Method::relax ? 1e-3 : 1e-9);
    EXPECT_TRUE(world.problems().empty());
    world.cut(world.handle<Alignment>(0));
    step(world, 5);
    EXPECT_TRUE(world.scene().alignments.empty());
  });
}

// The ways between ends of two ropes change their lengths, which the angle between them does not feel.
TEST(JoinedJoints, DriveAnglesBetweenParticles) {
  const AngleControl angle{.u = {point_at(0), point_at(7)},
                           .v = {point_at(4), point_at(9)},
                           .target = 1,
                           .stiffness = 0.5,
                           .damping = 0.01};
  for_jointed_settings([&](const Settings& settings) {
    World world(two_ropes(), settings);
    step(world, 10);
    Scene scene = world.scene();
    world.join(angle);
    scene.angles.push_back(angle);
    World fresh(scene, settings);
    step(world, 1);
    step(fresh, 1);
    EXPECT_LE(test::apart(world, fresh), tolerance(settings));
    const Momentum before = momentum(world);
    step(world, 20);
    EXPECT_LE(norm(momentum(world).linear - before.linear), 1e-12);
    if (settings.method != Method::relax && settings.gradient != Gradient::new_) {
      EXPECT_LE(norm(momentum(world).angular - before.angular), 1e-10);
    }
    EXPECT_TRUE(world.problems().empty());
  });
}

// At the start v is 3 rad ahead of u, and turns on by 1.5 rad. A torsion counts from where they are now, as
// in a world that begins so, and not from 3 rad on.
TEST(JoinedJoints, CountTurnsFromNow) {
  const Scene figure = test::figure({0, 2, 0});
  const Vec3 middle{0, 1.8, 0};
  Scene scene = two_bodies();
  for (std::uint32_t i = 0; i < 8; ++i)
    scene.particles[i].velocity =
        i < 4 ? Vec3{} : cross(Vec3{6, 0, 0}, scene.particles[i].position - Vec3{0, 1.6, 0});
  World world(scene, {.method = Method::direct, .gradient = Gradient::mid, .substeps = 8, .threads = 1});
  step(world, 15);
  Torsion torsion = figure.torsions[0];
  torsion.v = {point_on_body(figure, 1, middle),
               point_on_body(figure, 1, middle + Vec3{0, std::cos(3.0), std::sin(3.0)})};
  torsion.stiffness = 0.01;
  world.join(torsion);
  EXPECT_EQ(world.scene().torsions.size(), 0u);
  world.step(frame);
  EXPECT_NEAR(world.torsion_angle(0), 4.6 - 2 * std::numbers::pi, 0.01) << "to what it turns in a frame";
  World fresh(world.scene(), world.settings());
  EXPECT_NEAR(fresh.torsion_angle(0), world.torsion_angle(0), 1e-9);
}

// What is joined from a hand to an anchor hangs from that, wherever it has been moved.
TEST(JoinedJoints, HangFromAnchorsWhereTheyAre) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene = two_ropes();
    scene.particles.push_back({.position = {5, 5, 5}, .fixed = true});
    World world(scene, settings);
    step(world, 2);
    world.move_anchor(14, world.position(9));
    step(world, 1);
    world.move_anchor(14, world.position(9));
    world.fix(9);
    step(world, 1);
    world.teleport(std::vector<std::uint32_t>{14}, std::vector{world.position(9)}, std::vector{Vec3{}});
    world.free(9);
    world.join(Pin{.a = point_at(9), .b = point_at(14)});
    const Vec3 at = world.position(14);
    step(world, 10);
    EXPECT_LE(norm(world.position(9) - at), 1e-9);
    EXPECT_GT(norm(world.velocity(5)), 0.01);
    EXPECT_TRUE(world.problems().empty());
  });
}

TEST(JoinedJoints, AreTakenBackByCuts) {
  for_jointed_settings([](const Settings& settings) {
    World world(two_ropes(), settings), other(two_ropes(), settings);
    const Handle<Pin> first = world.join(pin);
    world.cut(first);
    EXPECT_FALSE(world.has(first));
    expect_refusal("pin 0: was removed", [&] { world.cut(first); });
    step(world, 3);
    step(other, 3);
    EXPECT_EQ(world.state_hash(), other.state_hash());
  });
}

// Freed parts fly on as they were: on straight lines as a whole, away from each other.
TEST(JoinedJoints, FreeWhatIsCutAgain) {
  for_jointed_settings([](const Settings& settings) {
    World world(two_ropes(), settings);
    const Handle<Pin> held = world.join(pin);
    step(world, 3);
    const Momentum before = momentum(world);
    world.cut(held);
    const Handle<Spring> next = world.join(spring);
    step(world, 1);
    EXPECT_FALSE(world.has(held));
    world.cut(next);
    step(world, 60);
    EXPECT_EQ(world.info().islands, 3u);
    EXPECT_GT(norm(world.position(4) - world.position(5)), 0.01);
    EXPECT_LE(norm(momentum(world).linear - before.linear), 1e-11);
    EXPECT_EQ(world.number(world.join(spring)), 0u);
    EXPECT_TRUE(world.problems().empty());
  });
}

// While a joint waits, and after it was joined. Threads do not matter.
TEST(JoinedJoints, AreKnownToSnapshots) {
  for_jointed_settings([](const Settings& settings) {
    World world(two_ropes(), settings), late(two_ropes(), settings);
    world.join(pin);
    late.restore(test::snapshot_of(world));
    EXPECT_EQ(test::snapshot_of(late), test::snapshot_of(world));
    step(world, 3);
    step(late, 3);
    EXPECT_EQ(test::snapshot_of(late), test::snapshot_of(world));
    World last(two_ropes(), settings);
    last.restore(test::snapshot_of(world));
    Settings other = settings;
    other.threads = 3 - settings.threads;
    World both(two_ropes(), other);
    both.join(pin);
    step(both, 3);
    for (World* const each : {&world, &last, &both}) {
      each->join(spring);
      step(*each, 3);
      each->cut(each->handle<Pin>(0));
      step(*each, 3);
    }
    EXPECT_EQ(last.state_hash(), world.state_hash());
    EXPECT_EQ(both.state_hash(), world.state_hash());
  });
}

// Another method goes on from what was joined under the one before.
TEST(JoinedJoints, StayUnderOtherSettings) {
  World world(two_ropes(), {.method = Method::relax, .threads = 1});
  world.join(pin);
  world.join(spring);
  step(world, 3);
  const std::vector<Vec3> before = test::positions_of(world);
  world.set_settings({.method = Method::direct, .threads = 1});
  EXPECT_EQ(test::positions_of(world), before);
  step(world, 10);
  EXPECT_LE(norm(world.position(4) - world.position(5)), 1e-9);
  EXPECT_EQ(world.info().islands, 2u);
  EXPECT_TRUE(world.problems().empty());
}

TEST(JoinedJoints, EndWithWhatIsRemoved) {
  for_jointed_settings([](const Settings& settings) {
    World world(two_ropes(), settings);
    const Handle<Pin> waits = world.join(pin);
    world.remove(7);
    EXPECT_FALSE(world.has(waits));
    step(world, 1);
    const Handle<Spring> held = world.join(Spring{.a = point_at(2), .b = point_at(10), .stiffness = 1});
    step(world, 1);
    EXPECT_EQ(world.info().islands, 1u);
    world.remove(2);
    EXPECT_FALSE(world.has(held));
    EXPECT_EQ(world.info().islands, 0u);
    step(world, 1);
  });
}

TEST(JoinedJoints, RefuseWhatCannotHold) {
  World world(two_ropes(), {.threads = 1});
  expect_refusal("pin 0: its places are 0.4", [&] { world.join(Pin{point_at(0), point_at(5)}); });
  expect_refusal("particle 99: unknown", [&] { world.join(Pin{point_at(0), point_at(99)}); });
  expect_refusal("pin 0: both points are the same", [&] { world.join(Pin{point_at(3), point_at(3)}); });
  Spring push = spring;
  push.stiffness = -1;
  expect_refusal("spring 0: stiffness", [&] { world.join(push); });
  expect_refusal("alignment 0: its product is 0 m^2, and is to be 0.01 m^2", [&] {
    world.join(Alignment{{point_at(0), point_at(1)}, {point_at(5), point_at(6)}, 0.01});
  });
  world.join(spring);
  expect_refusal("spring 0: is joined in the next step", [&] { world.set_spring(0, spring); });
  world.fix(2);
  expect_refusal("particle 7: cannot be fixed, since nothing of spring 0 could move then",
                 [&] { world.fix(7); });
  world.fix(0);
  expect_refusal("spring 0: all its particles are fixed",
                 [&] { world.join(Spring{.a = point_at(0), .b = point_at(2), .stiffness = 1}); });
  world.step(frame);
  EXPECT_TRUE(world.problems().empty());
}

TEST(JoinedJoints, RefuseWhatWorldsCannotMove) {
  Scene ropes;
  test::add_rope(ropes, {0, 2, 0}, {1, 0, 0}, false, 0);
  test::add_rope(ropes, {0.4, 2, 0}, {0, 0, 1}, false, 0);
  World bare(ropes, {.threads = 1});
  expect_refusal("began without them and without ground", [&] { bare.join(pin); });
  World hung(two_ropes(), {.threads = 1});
  Scene tackle;
  test::add_rope(tackle, {0, 5, 0}, {1, 0, 0}, false, 0);
  tackle.tackles.push_back({.particles = {0, 2, 4}, .length = 1, .law = {.one_sided = true}});
  const std::uint32_t first = hung.add(tackle).particle;
  expect_refusal("islands with shapes or joints would come together with tackle 0",
                 [&] { hung.join(Spring{.a = point_at(first), .b = point_at(7), .stiffness = 1}); });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
