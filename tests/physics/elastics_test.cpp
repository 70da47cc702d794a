// Springs, torsions and drives: what they do is that of the linear oscillator, of the pendulum or of the rod
// they stand for, to second order in the substep, and any stiffness is stable.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "support/bodies.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr double pi = std::numbers::pi;

/// A rod of 2 kg and 1 m that turns about a fixed particle at the origin. Particle 3 is where it ends, those
/// before it tell directions.
constexpr double inertia = 2.0 / 3;
Scene bare_rod() {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::fixed({0, 0, 0}), test::fixed({0, 1, 0}), test::fixed({0, 0, 1}),
                     test::movable({1, 0, 0}, 0)};
  scene.rods = {{.a = 0, .b = 3, .mass = 2}};
  return scene;
}
/// The same with a torsion, whose angle is -pi/2 where the rod lies along x.
Scene twisted_rod(Torsion torsion) {
  Scene scene = bare_rod();
  torsion.axis = {point_at(0), point_at(2)};
  torsion.u = {point_at(0), point_at(1)};
  torsion.v = {point_at(0), point_at(3)};
  scene.torsions.push_back(torsion);
  return scene;
}
Scene driven_rod(AngleControl angle) {
  Scene scene = bare_rod();
  angle.u = {point_at(0), point_at(1)};
  angle.v = {point_at(0), point_at(3)};
  scene.angles.push_back(angle);
  return scene;
}
/// The angle from y towards x, in rad.
double angle_of(const World& world) {
  const Vec3 x = world.position(3);
  return std::atan2(x.x, x.y);
}

constexpr double swing = 0.3;  ///< rad
/// A spring of this stiffness (N m/rad) as a drive and as a torsion, wound up by the swing.
std::vector<Scene> wound_rods(double stiffness) {
  return {driven_rod({.target = pi / 2 + swing, .stiffness = stiffness}),
          twisted_rod({.angle = -pi / 2 - swing, .stiffness = stiffness})};
}

// Without damping nothing is lost: after ten seconds, 11 swings, energy is that of the start to second order.
TEST(Elastics, SwingAsTheLinearOscillatorDoes) {
  const double stiffness = 30, omega = std::sqrt(stiffness / inertia);
  for (const Scene& scene : wound_rods(stiffness)) {
    double errors[2], drifts[2];
    for (const int k : {0, 1}) {
      World world(scene, test::body_settings(4u << k));
      const double before = test::energy_of(scene, world, MassModel::consistent);
      errors[k] = drifts[k] = 0;
      for (int i = 0; i < 600; ++i) {
        world.step(frame);
        const double exact = pi / 2 + swing * (1 - std::cos(omega * world.time()));
        errors[k] = std::max(errors[k], std::abs(angle_of(world) - exact));
        drifts[k] = std::max(
            drifts[k], std::abs(test::energy_of(scene, world, MassModel::consistent) - before) / before);
      }
    }
    // tan(theta/2) = omega h/2, so that a substep of h runs slow by (omega h)²/12 of its angle. Of the
    // swing's size that is, after ten seconds at 8 substeps:
    const double h = frame / 8, late = omega * 10 * omega * h * omega * h / 12;
    EXPECT_LE(errors[1], 1.05 * swing * late);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.05);
    EXPECT_LE(drifts[1], 1e-5);
    EXPECT_NEAR(std::log2(drifts[0] / drifts[1]), 2, 0.1);
  }
}

// From slack to rigid at 1/60 s. What a substep resolves keeps its swing; what it does not comes to rest.
TEST(Elastics, AreStableAtAnyStiffness) {
  for (const double stiffness : {1.0, 30.0, 1e3, 1e4, 1e6, 1e9, 1e12})
    for (const Scene& scene : wound_rods(stiffness)) {
      World world(scene, test::body_settings());
      const bool is_resolved = std::sqrt(stiffness / inertia) * frame < 1;
      double most = 0;
      StepReport report;
      for (int i = 0; i < 600; ++i) {
        report += world.step(frame);
        if (i >= 300) most = std::max(most, std::abs(angle_of(world) - pi / 2 - swing));
      }
      EXPECT_EQ(report.unsolved, 0u) << stiffness;
      if (is_resolved) {
        EXPECT_NEAR(most, swing, 1e-3 * swing) << stiffness;
      }
      if (stiffness >= 1e4) {
        EXPECT_LE(most, 1e-6) << stiffness;
      }
    }
}

/// A particle that turns about a fixed one above it, with a spring to a fixed one straight below. There the
/// spring moves nothing; it pushes from then on.
Scene over_its_centre(double stiffness) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::fixed({0, 0, 0}), test::movable({0, -1, 0}, 1, {1, 0, 0}),
                     test::fixed({0, -2, 0})};
  scene.rods = {{.a = 0, .b = 1, .length = 1}};
  scene.springs = {{.a = point_at(1), .b = point_at(2), .length = 1, .stiffness = stiffness}};
  return scene;
}
/// Two particles at one place, which part.
Scene parting(double stiffness) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::movable({}, 1, {-0.5, 0, 0}), test::movable({}, 1, {0.5, 0, 0})};
  scene.springs = {{.a = point_at(0), .b = point_at(1), .length = 0.1, .stiffness = stiffness}};
  return scene;
}

// What a spring moves changes as it turns. One that starts where it moves nothing must not be taken for one
// that is resolved ever after. It pushes nothing in its first substep, where its energy jumps by k/2 (x²/2)²
// of a way x: 4 J of 0.5 J at 1e8 N/m and 1/60 s. That must come to rest, and eight substeps leave nothing of
// it.
TEST(Elastics, AreStableFromWhereTheyMoveNothing) {
  for (const double stiffness : {1e4, 1e6, 1e8})
    for (const std::uint32_t substeps : {1u, 8u})
      for (const Scene& scene : {over_its_centre(stiffness), parting(stiffness)}) {
        World world(scene, test::body_settings(substeps));
        const auto energy = [&] { return test::energy_of(scene, world, MassModel::consistent); };
        const double start = energy();
        double most = 0;
        StepReport report;
        for (int i = 0; i < 240; ++i) {
          report += world.step(frame);
          most = std::max(most, energy());
        }
        // What parts along a line passes through zero length, where a resolved spring has no direction.
        if (substeps == 1 || !scene.rods.empty()) {
          EXPECT_LE(energy(), 1.001 * start) << stiffness << ' ' << substeps;
        }
        if (substeps == 8 && !scene.rods.empty()) {
          EXPECT_LE(most, 1.02 * start) << stiffness;
        }
        EXPECT_EQ(report.unsolved + report.frozen_islands, 0u) << stiffness;
      }
}

// A dashpot alone: the rate decays as exp(-damping t/I).
TEST(Elastics, DampersDecayToSecondOrder) {
  for (const bool is_torsion : {false, true}) {
    Scene scene = is_torsion ? twisted_rod({.damping = 1}) : driven_rod({.damping = 1});
    scene.particles[3].velocity = {0, 1, 0};
    const double exact = pi / 2 - inertia * (1 - std::exp(-0.5 / inertia));
    double errors[2];
    for (const int k : {0, 1}) {
      World world(scene, test::body_settings(1u << k));
      test::run(world, frame, 30);
      errors[k] = std::abs(angle_of(world) - exact);
    }
    EXPECT_LE(errors[1], 1e-5);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.1);
  }
}

// A damper of any strength stops what it damps and does not ring. What is stopped within the first substep
// goes on by inertia v/damping, or twice that far: a substep does not resolve it.
TEST(Elastics, StrongDampersStop) {
  for (const double damping : {1e2, 1e4, 1e8}) {
    Scene scene = twisted_rod({.damping = damping});
    scene.particles[3].velocity = {0, 3, 0};
    World world(scene, test::body_settings());
    test::run(world, frame, 60);
    EXPECT_NEAR(pi / 2 - angle_of(world), 4.5 * inertia / damping, 1.5 * inertia / damping) << damping;
    EXPECT_LE(norm(world.velocity(3)), 1e-9);
  }
}

// A motor turns a rod many times: phi = torque t²/(2 I), and substeps add no error but that of turning.
TEST(Torsions, CountTurnsOfAMotor) {
  const Scene scene = twisted_rod({.torque = 2});
  World world(scene, test::body_settings(4));
  EXPECT_NEAR(world.torsion_angle(0), -pi / 2, 1e-15);
  test::run(world, frame, 240);
  const double turned = 0.5 * 2 / inertia * 16;
  EXPECT_NEAR(world.torsion_angle(0), -pi / 2 + turned, 1e-3 * turned);
  EXPECT_GT(world.torsion_angle(0), 2 * pi);
}

// A spring wound by five turns and damped unwinds to its angle, not to one a turn off.
TEST(Torsions, SeekAnglesManyTurnsAway) {
  const Scene scene = twisted_rod({.angle = 10 * pi, .stiffness = 5, .damping = 3});
  World world(scene, test::body_settings(8));
  test::run(world, frame, 600);
  EXPECT_NEAR(world.torsion_angle(0), 10 * pi, 1e-6);
}

/// A particle of 2 kg on a spring of 50 N/m from the origin, and below it.
Scene spring_pendulum(double length) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({0, -1, 0}, 2, {0.5, 0, 0.2})};
  scene.springs.push_back({.a = point_at(0), .b = point_at(1), .length = length, .stiffness = 50});
  return scene;
}

// Energy stays within a bound that falls as the square of the substep.
TEST(Springs, KeepEnergyToSecondOrder) {
  const Scene scene = spring_pendulum(1);
  double drifts[2];
  for (const int k : {0, 1}) {
    World world(scene, test::body_settings(4u << k));
    const double before = test::energy_of(scene, world, MassModel::consistent);
    drifts[k] = 0;
    for (int i = 0; i < 3600; ++i) {
      world.step(frame);
      drifts[k] =
          std::max(drifts[k], std::abs(test::energy_of(scene, world, MassModel::consistent) - before));
    }
  }
  EXPECT_LE(drifts[1], 1e-4 * energy_range(scene)) << "a minute";
  EXPECT_NEAR(std::log2(drifts[0] / drifts[1]), 2, 0.1);
}

// A spring of length 0 is an oscillator in all three axes, and its ends pass through each other.
TEST(Springs, OfLengthZeroPassThroughTheirEnds) {
  Scene scene = spring_pendulum(0);
  scene.gravity = {};
  scene.particles[1] = test::movable({0.3, 0, 0}, 2);
  const double omega = 5;
  for (const double across : {0.0, 1e-6, 0.4}) {
    scene.particles[1].velocity = {0, across, 0};
    World world(scene, test::body_settings(16));
    test::run(world, frame, 120);
    const double t = world.time();
    EXPECT_NEAR(world.position(1).x, 0.3 * std::cos(omega * t), 1e-5);
    EXPECT_NEAR(world.position(1).y, across / omega * std::sin(omega * t), 1e-5);
  }
}

// Stiffer and stiffer, a spring becomes the rigid rod: with k the line is longer by its pull over k.
TEST(Springs, BecomeRigidRods) {
  Scene rigid;
  rigid.particles = {test::fixed({0, 0, 0}), test::movable({1, 0, 0}, 2)};
  rigid.rods = {{.a = 0, .b = 1}};
  Scene stiff = rigid;
  // A spring that pulls next to nothing makes it a linkage, too, whose energy nothing corrects either.
  rigid.springs = {{.a = point_at(0), .b = point_at(1), .stiffness = 1e-12}};
  stiff.rods.clear();
  World exact(rigid, test::body_settings(4));
  test::run(exact, frame, 120);
  for (const double stiffness : {1e7, 1e9, 1e12}) {
    stiff.springs = {{.a = point_at(0), .b = point_at(1), .length = 1, .stiffness = stiffness}};
    World world(stiff, test::body_settings(4));
    const StepReport report = test::run(world, frame, 120);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_LE(norm(world.position(1) - exact.position(1)), 1e3 / stiffness + 1e-8) << stiffness;
  }
}

// Between two hinged bodies that fly, pulls are equal and opposite: both momenta stay, to 1e-10.
TEST(Springs, KeepMomenta) {
  Scene scene;
  scene.gravity = {};
  MassProperties a = solid_box(3, {0.4, 0.3, 0.5}), b = solid_box(2, {0.3, 0.5, 0.8});
  b.center = {1, 0.2, 0.1};
  const std::uint32_t one = add_body(scene, a), two = add_body(scene, b);
  test::set_motion(scene, one, {0.3, -0.2, 0.1}, {0.5, 1, -0.7});
  test::set_motion(scene, two, {-0.1, 0.4, 0}, {1, -1, 0.5});
  add_revolute(scene, one, two, {0.5, 0.1, 0.05}, {1, 0, 0});
  const auto on = [&](std::uint32_t body, Vec3 at) { return point_on_body(scene, body, at); };
  for (const double stiffness : {20.0, 1e4})
    scene.springs.push_back({.a = on(one, {0.1, 0.3, 0.1}),
                             .b = on(two, {0.9, 0.1, 0}),
                             .length = norm(Vec3{0.8, -0.2, -0.1}) + 1 / (100 + stiffness),
                             .stiffness = stiffness,
                             .damping = 0.01 * stiffness,
                             .force = 1});
  scene.torsions.push_back({.axis = {on(one, {0, 0, 0}), on(one, {1, 0, 0})},
                            .u = {on(one, {0, 0, 0}), on(one, {0.3, 1, 0})},
                            .v = {on(two, {1, 0, 0}), on(two, {1.1, 1, 1})},
                            .angle = 1,
                            .stiffness = 3,
                            .damping = 0.1,
                            .torque = 0.5});
  for (const std::uint32_t substeps : {1u, 8u}) {
    World world(scene, test::body_settings(substeps));
    const Momentum before = test::momentum_of(scene, world);
    const StepReport report = test::run(world, frame, 120);
    const Momentum after = test::momentum_of(scene, world);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_LE(norm(after.linear - before.linear), 1e-10 * norm(before.linear)) << substeps;
    EXPECT_LE(norm(after.angular - before.angular), 1e-10 * norm(before.angular)) << substeps;
  }
}

/// A load of 1 kg falls 0.5 m before a cable of 1 m is taut.
Scene falling_load(double stiffness) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({0, -0.5, 0})};
  scene.springs.push_back(
      {.a = point_at(0), .b = point_at(1), .length = 1, .stiffness = stiffness, .one_sided = true});
  return scene;
}

// It falls freely, is caught, swings about its weight, m g/k below, and flies as far up again.
TEST(Springs, OneSidedCatchAndLetGo) {
  const double stiffness = 2000, omega = std::sqrt(stiffness), give = test::earth / stiffness;
  const double falls = std::sqrt(2 * 0.5 / test::earth), speed = test::earth * falls;
  const double held = 2 * (pi - std::atan2(speed / omega, give)) / omega;
  const auto exact = [&](double t) {
    if (t > falls + held) {
      const double rises = t - falls - held;
      return -1 + speed * rises - 0.5 * test::earth * rises * rises;
    }
    const double s = omega * (t - falls);
    return -1 - give * (1 - std::cos(s)) - speed / omega * std::sin(s);
  };
  // Three instants: while it is caught, on the way up, and about at the top.
  double errors[2]{};
  for (const int k : {0, 1}) {
    World world(falling_load(stiffness), test::body_settings(16u << (2 * k)));
    for (int i = 1; i <= 42; ++i) {
      world.step(frame);
      if (i == 21 || i == 30 || i == 42)
        errors[k] = std::max(errors[k], std::abs(world.position(1).y - exact(world.time())));
    }
  }
  // Where within a substep it is caught shows as its square, by chance more or less.
  EXPECT_LE(errors[0], 1e-3);
  EXPECT_LE(errors[1], 1e-4);
  World free(falling_load(stiffness), test::body_settings());
  test::run(free, frame, 15);
  EXPECT_NEAR(free.position(1).y, -0.5 - 0.5 * test::earth / 16, 1e-12) << "slack, it falls freely";
}

// Elastic rods in an island with a joint are the same springs.
TEST(Springs, AreWhatElasticRodsAre) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({1, 0, 0}, 2), test::movable({2, 0, 0}, 1),
                     test::movable({2, 0, 0}, 1)};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  scene.pins = {{point_at(2), point_at(3)}};
  Scene other = scene;
  scene.rods[1].law = {.stiffness = 300, .damping = 2};
  other.rods.pop_back();
  other.springs = {{.a = point_at(1), .b = point_at(2), .length = 1, .stiffness = 300, .damping = 2}};
  World one(scene, test::body_settings(4)), two(other, test::body_settings(4));
  test::run(one, frame, 120);
  test::run(two, frame, 120);
  for (const std::uint32_t i : {1u, 2u, 3u}) EXPECT_LE(norm(one.position(i) - two.position(i)), 1e-9);
  EXPECT_GT(std::abs(test::stretch_of(scene, one).max), 1e-3);
}

// A ball hangs on elastic rods whose particles are so light that substeps do not resolve how those swing. The
// ball's own swing, of 20 frames, goes on. It was damped with the rods', and hung still after a second.
TEST(Springs, LetHeavyThingsSwingOnLightOnes) {
  constexpr double mass = 5, light = 0.2, stiffness = 6000, g = 9.81;
  constexpr int rods = 3;
  Scene scene;
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const Vec3 at{0, -double(i) / rods, 0};
    scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, light));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .law = {.stiffness = stiffness}});
  }
  MassProperties sphere = solid_sphere(mass, 0.1);
  sphere.center = {0, -1.1, 0};
  const std::uint32_t ball = add_body(scene, sphere);
  scene.pins.push_back({point_on_body(scene, ball, {0, -1, 0}), point_at(rods)});
  // Let go unstretched, it falls by twice what it hangs lower in the end, but for swings of light particles.
  const double lower = g * (rods * mass + light * (1 + 2 + 3)) / stiffness;
  const auto amplitude = [&](World& world) {
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 60; ++k) {
      world.step(frame);
      low = std::min(low, world.pose(ball).position.y);
      high = std::max(high, world.pose(ball).position.y);
    }
    return (high - low) / 2;
  };
  double lost = 1;
  for (const std::uint32_t substeps : {1u, 2u, 4u}) {
    World world(scene, {.substeps = substeps, .threads = 1});
    EXPECT_NEAR(amplitude(world), lower, 0.02 * lower) << substeps;
    test::run(world, frame, 180);
    const double loses = 1 - amplitude(world) / lower;  // a third of that if substeps are half as long
    EXPECT_LT(loses, lost / 3) << substeps;
    EXPECT_LT(loses, substeps == 1 ? 0.05 : 0.02) << substeps;
    lost = std::max(loses, 0.01);  // what is seen at frames
  }
}

// An elastic rope with shapes falls on the ground, and lies there. A rigid cable holds a ball above it.
TEST(Springs, TouchTheGround) {
  Scene scene;
  scene.planes.push_back({});
  for (std::uint32_t i = 0; i < 10; ++i) {
    scene.particles.push_back(test::movable({0.2 * i, 0.3 + 0.02 * i, 0}, 0.1));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .length = 0.2, .law = {.stiffness = 500, .damping = 1}});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.05});
  }
  const auto anchor = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(test::fixed({0, 3, 0}));
  const std::uint32_t ball = test::add_ball(scene, {0, 2.5, 0}, 0.1, 1);
  RodLaw cable;
  cable.one_sided = true;
  scene.rods.push_back({.a = anchor, .b = ball, .length = 1, .law = cable});
  World world(scene, test::body_settings(4));
  const StepReport report = test::run(world, frame, 300);
  EXPECT_EQ(report.unsolved, 0u);
  for (std::uint32_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(world.position(i).y, 0.05, 2e-3);
    EXPECT_LE(norm(world.velocity(i)), 1e-2);
  }
  EXPECT_NEAR(world.position(ball).y, 2, 1e-6);
  EXPECT_LE(test::stretch_of(scene, world).max, 1e-2);
}

// What is set holds from the next step on, and wakes what slept.
TEST(Springs, ChangeWhileTheyRun) {
  Scene scene = spring_pendulum(1);
  scene.particles[1] = test::movable({0, -1 - 2 * test::earth / 50, 0}, 2);
  World world(scene, test::body_settings(1, true));
  test::run(world, frame, 120);
  EXPECT_EQ(world.step(frame).awake_islands, 0u);
  Spring spring = scene.springs[0];
  spring.length = 0.5;
  spring.damping = 20;
  world.set_spring(0, spring);
  EXPECT_EQ(world.step(frame).awake_islands, 1u);
  // What creeps by less than 2 cm/s sleeps after half a second.
  test::run(world, frame, 300);
  EXPECT_NEAR(world.position(1).y, -0.5 - 2 * test::earth / 50, 2e-3);
  spring.force = 5;
  world.set_spring(0, spring);
  test::run(world, frame, 300);
  EXPECT_NEAR(world.position(1).y, -0.5 - (2 * test::earth - 5) / 50, 2e-3);

  World rod(twisted_rod({.stiffness = 10, .damping = 5}), test::body_settings());
  rod.set_torsion(0, {.angle = 1, .stiffness = 10, .damping = 5});
  test::run(rod, frame, 300);
  EXPECT_NEAR(rod.torsion_angle(0), 1, 1e-6);

  World driven(driven_rod({.target = 1, .stiffness = 10, .damping = 5}), test::body_settings());
  driven.set_angle(0, {.upper = 1.2, .target = 2, .stiffness = 10, .damping = 5});
  test::run(driven, frame, 300);
  EXPECT_NEAR(angle_of(driven), 1.2, 1e-3) << "the limit that was set";
}

TEST(Springs, RefuseChangesThatMakeNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  World world(spring_pendulum(1), test::body_settings());
  const auto refusal = [&](Spring spring, std::uint32_t number = 0) {
    return test::refusal([&] { world.set_spring(number, spring); });
  };
  EXPECT_NE(refusal({.length = 1}, 1).find("spring 1: unknown"), std::string::npos);
  EXPECT_NE(refusal({.length = 1, .stiffness = nan}).find("spring 0: stiffness"), std::string::npos);
  EXPECT_NE(refusal({.length = 1, .damping = -1}).find("spring 0: damping"), std::string::npos);
  EXPECT_NE(refusal({.length = 0}).find("spring 0: its length cannot become 0"), std::string::npos);
  EXPECT_NE(test::refusal([&] { world.set_torsion(0, {}); }).find("torsion 0: unknown"), std::string::npos);
  EXPECT_NE(test::refusal([&] { (void)world.torsion_angle(0); }).find("torsion 0"), std::string::npos);
  World limited(driven_rod({.upper = 2}), test::body_settings());
  EXPECT_NE(test::refusal([&] { limited.set_angle(0, {.stiffness = 1}); }).find("angle 0"),
            std::string::npos);
  EXPECT_NE(test::refusal([&] { limited.set_angle(0, {.lower = 2, .upper = 1}); }).find("limits"),
            std::string::npos);
}

TEST(Springs, AreRefusedByNameWhereNothingMovesThem) {
  const auto refused = [](const Scene& scene, Method method) {
    return test::refusal([&] { const World world(scene, {.method = method}); });
  };
  const Scene spring = spring_pendulum(1), torsion = twisted_rod({.stiffness = 1});
  EXPECT_NE(refused(spring, Method::springs).find("spring 0: method"), std::string::npos);
  EXPECT_NE(refused(torsion, Method::springs).find("torsion 0: method"), std::string::npos);
  for (const Scene& scene : {spring, torsion}) {
    EXPECT_EQ(refused(scene, Method::multipliers), "");
    EXPECT_NE(refused(scene, Method::featherstone).find("particles or rods besides"), std::string::npos);
  }
}

TEST(Springs, AreValidated) {
  const auto refusal = [](const Scene& scene) { return test::refusal([&] { validate(scene); }); };
  Scene scene = spring_pendulum(1);
  scene.springs[0].b = point_at(0);
  EXPECT_NE(refusal(scene).find("spring 0: both points are the same"), std::string::npos);
  scene.springs[0].b = point_at(7);
  EXPECT_NE(refusal(scene).find("spring 0, point b"), std::string::npos);
  scene = twisted_rod({.stiffness = -1});
  EXPECT_NE(refusal(scene).find("torsion 0: stiffness"), std::string::npos);
  scene = twisted_rod({.stiffness = 1});
  scene.torsions[0].u = scene.torsions[0].axis;
  EXPECT_NE(refusal(scene).find("torsion 0, u: lies along the axis"), std::string::npos);
  scene = twisted_rod({.stiffness = 1});
  scene.torsions[0].v = {point_at(2), point_at(1)};
  EXPECT_NE(refusal(scene).find("torsion 0: all its particles are fixed"), std::string::npos);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
