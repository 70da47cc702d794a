// Joints between bodies: what they let go keeps to the equations of motion, in reduced coordinates by another
// algorithm; what they forbid does not happen. Limits, friction and drives of angles, drag in joints and air.

#include "plumb/joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/articulated_body.hpp"
#include "support/bodies.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

enum class Type : std::uint8_t { shared, pin, revolute, universal, prismatic };

const char* name_of(Type type) {
  const char* const names[] = {"SharedParticle", "Pin", "Revolute", "Universal", "Prismatic"};
  return names[static_cast<std::size_t>(type)];
}

/// At right angles and of length one; joints are about the first, universal ones also about the second.
const Vec3 axes[3] = {(1 / 3.0) * Vec3{2, 1, 2}, (1 / 3.0) * Vec3{1, 2, -2}, (1 / 3.0) * Vec3{-2, 2, 1}};

/// Body b jointed to a body a that is fixed or free, and moving as the joint lets it.
struct Pair {
  Scene scene;
  std::uint32_t a = 0, b = 0;
  Vec3 place{};        ///< of the joint, at first
  Point at[2]{};       ///< the same, of either body
  Point tips[2][3]{};  ///< 1 m from it along the axes, of either body
  Array<detail::Link> links{};
  test::State state{};  ///< of these links
};

const MassProperties box_a = solid_box(3, {0.4, 0.3, 0.5}), box_b = solid_box(2, {0.3, 0.5, 0.8});
const Vec3 arm{0.35, -0.2, 0.15};  ///< m, from the joint to b's centre

/// The motion of a and of b in space, and of the joint.
struct PairMotion {
  Vec3 velocity_a{}, spin_a{}, spin_b{};
  double along = 0, about = 0, about_second = 0;
};
PairMotion motion_of(Type type, bool free) {
  PairMotion m;
  if (free) m.velocity_a = {0.3, -0.2, 0.1}, m.spin_a = {0.5, 1, -0.7};
  m.spin_b = m.spin_a;
  if (type == Type::shared || type == Type::pin) m.spin_b = {1, -2, 1.5};
  if (type == Type::revolute || type == Type::universal) m.about = 2;
  if (type == Type::universal) m.about_second = -1.5;
  if (type == Type::prismatic) m.along = 1.2;
  m.spin_b += m.about * axes[0] + m.about_second * axes[1];
  return m;
}

Pair make_pair(Type type, bool free) {
  Pair pair;
  Scene& scene = pair.scene;
  MassProperties a = box_a, b = box_b;
  a.center = {-0.4, 0.1, 0.05};
  pair.a = free ? add_body(scene, a) : test::add_fixed_body(scene);
  const std::uint32_t shared = scene.bodies[pair.a].particles[0];
  if (type == Type::shared) pair.place = scene.particles[shared].position;
  b.center = pair.place + arm;
  if (type == Type::shared) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (const Vec3 way : axes) scene.particles.push_back(test::movable(pair.place + 0.5 * way, 0));
    pair.b = add_body(scene, {shared, first, first + 1, first + 2}, b);
  } else {
    pair.b = add_body(scene, b);
  }
  const auto on = [&](std::uint32_t body, Vec3 by) { return point_on_body(scene, body, pair.place + by); };
  for (const int side : {0, 1}) {
    const std::uint32_t body = side == 0 ? pair.a : pair.b;
    pair.at[side] = on(body, {});
    for (int k = 0; k < 3; ++k) pair.tips[side][k] = on(body, axes[k]);
  }
  if (type == Type::pin) add_spherical(scene, pair.at[0], pair.at[1]);
  if (type == Type::revolute) add_revolute(scene, pair.a, pair.b, pair.place, axes[0]);
  if (type == Type::universal) add_universal(scene, pair.a, pair.b, pair.place, axes[0], axes[1]);
  if (type == Type::prismatic) add_prismatic(scene, pair.a, pair.b, pair.place, axes[0]);

  const PairMotion m = motion_of(type, free);
  const Vec3 at_joint = free ? m.velocity_a + cross(m.spin_a, pair.place - a.center) : Vec3{};
  test::set_motion(scene, pair.b, at_joint + m.along * axes[0] + cross(m.spin_b, arm), m.spin_b);
  if (free) test::set_motion(scene, pair.a, m.velocity_a, m.spin_a);

  using detail::Joint;
  std::uint32_t parent = detail::Link::base;
  Vec3 place = pair.place;
  if (free) {
    pair.links.push_back({.joint = Joint::translation, .place = a.center});
    pair.links.push_back({.parent = 0, .joint = Joint::spherical, .mass = a.mass, .inertia = a.inertia});
    parent = 1;
    place = pair.place - a.center;
  }
  if (type == Type::universal) {  // a cross without mass between two revolute joints
    const auto cross_link = static_cast<std::uint32_t>(pair.links.size());
    pair.links.push_back({.parent = parent, .joint = Joint::revolute, .place = place, .axis = axes[0]});
    parent = cross_link;
    place = {};
  }
  const Joint joint = type == Type::revolute || type == Type::universal ? Joint::revolute
                      : type == Type::prismatic                         ? Joint::prismatic
                                                                        : Joint::spherical;
  pair.links.push_back({.parent = parent,
                        .joint = joint,
                        .place = place,
                        .axis = axes[type == Type::universal ? 1 : 0],
                        .mass = b.mass,
                        .center = arm,
                        .inertia = b.inertia});
  const detail::ArticulatedBody body(pair.links);
  pair.state = test::start_of(body);
  const auto last = static_cast<std::uint32_t>(pair.links.size() - 1);
  const auto set_speed = [&](std::uint32_t link, Vec3 v) {
    pair.state.v.segment<3>(body.speed(link)) << v.x, v.y, v.z;
  };
  for (std::uint32_t i = 0; i <= last; ++i)
    if (pair.links[i].joint == Joint::spherical) pair.state.q[body.coordinate(i)] = 1;
  if (free) {
    set_speed(0, m.velocity_a);
    set_speed(1, m.spin_a);
  }
  if (joint == Joint::spherical) set_speed(last, m.spin_b);
  if (type == Type::revolute) pair.state.v[body.speed(last)] = m.about;
  if (type == Type::prismatic) pair.state.v[body.speed(last)] = m.along;
  if (type == Type::universal) {
    pair.state.v[body.speed(last - 1)] = m.about;
    pair.state.v[body.speed(last)] = m.about_second;
  }
  return pair;
}

/// Where the particles of the bodies are by the reduced coordinates.
std::vector<Vec3> exact_positions(const Pair& pair, double duration) {
  detail::ArticulatedBody body(pair.links);
  test::State state = pair.state;
  test::advance(body, state, {.gravity = pair.scene.gravity}, duration, 2000);
  Array<detail::LinkMotion> motions(pair.links.size());
  body.motions(state.q, state.v, {}, {}, motions);
  std::vector<Vec3> out;
  for (const Particle& particle : pair.scene.particles) out.push_back(particle.position);
  const auto place = [&](std::uint32_t number, const detail::LinkMotion& link, Vec3 origin) {
    for (const std::uint32_t i : pair.scene.bodies[number].particles)
      out[i] = link.position + link.rotation * (pair.scene.particles[i].position - origin);
  };
  place(pair.b, motions.back(), pair.place);
  if (pair.links.front().joint == detail::Joint::translation)
    place(pair.a, motions[1], pair.scene.bodies[pair.a].center);
  return out;
}

/// What the joint forbids, in m 1 m away from it or as a cosine.
double broken(const Pair& pair, Type type, const World& world) {
  const std::vector<Vec3> x = test::positions_of(world);
  const auto place = [&](const Point& point) { return scenes::place_of(point, x); };
  const Vec3 apart = place(pair.at[1]) - place(pair.at[0]);
  const auto tip = [&](int side, int k) { return place(pair.tips[side][k]) - place(pair.at[side]); };
  switch (type) {
    case Type::shared:
    case Type::pin:
      return norm(apart);
    case Type::revolute:
      return std::max(norm(apart), norm(tip(0, 0) - tip(1, 0)));
    case Type::universal:
      return std::max(norm(apart), std::abs(dot(tip(0, 0), tip(1, 1))));
    case Type::prismatic:
      break;
  }
  double worst = norm(cross(apart, tip(0, 0)));
  for (int k = 0; k < 3; ++k) worst = std::max(worst, norm(tip(0, k) - tip(1, k)));
  return worst;
}

class Joints : public testing::TestWithParam<std::tuple<Type, bool>> {
 protected:
  Type type = std::get<0>(GetParam());
  bool free = std::get<1>(GetParam());
  Pair pair = make_pair(type, free);
};

INSTANTIATE_TEST_SUITE_P(Every, Joints,
                         testing::Combine(testing::Values(Type::shared, Type::pin, Type::revolute,
                                                          Type::universal, Type::prismatic),
                                          testing::Bool()),
                         [](const auto& test) {
                           return std::string(name_of(std::get<0>(test.param))) +
                                  (std::get<1>(test.param) ? "OfTwoFreeBodies" : "OfAFixedBody");
                         });

TEST_P(Joints, StartAsTheyMove) {
  const World world(pair.scene, test::body_settings());
  EXPECT_LE(world.info().projected_velocity, 1e-12) << "the velocities given are those of the joint";
}

// Runge-Kutta at half a millisecond errs by less than 1e-9 here; a substep by its square, at 1/1920 s and
// turns of 3 rad/s by some 1e-6 m.
TEST_P(Joints, MoveAsReducedCoordinatesSay) {
  const std::vector<Vec3> exact = exact_positions(pair, 1);
  double errors[2];
  for (const int k : {0, 1}) {
    World world(pair.scene, test::body_settings(16u << k));
    test::run(world, frame, 60);
    errors[k] = rms_distance(test::positions_of(world), exact);
  }
  EXPECT_LE(errors[1], 1e-5);
  if (errors[1] > 1e-9) {  // sliding from a fixed body is even: exact
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.1);
  }
}

// 1e-6 of the range, or of the energy where nothing falls; freedoms that are forbidden, 1e-6 m at 1 m.
TEST_P(Joints, KeepEnergyAndForbidWhatTheyForbid) {
  if (free || type == Type::prismatic) pair.scene.gravity = {};  // it would be far away in 10 s
  for (const std::uint32_t substeps : {1u, 8u}) {
    World world(pair.scene, test::body_settings(substeps));
    const double before = test::energy_of(pair.scene, world, MassModel::consistent);
    const double range = std::max(energy_range(pair.scene), before);
    double drift = 0, off = 0;
    for (int i = 0; i < 600; ++i) {
      world.step(frame);
      drift = std::max(drift, std::abs(test::energy_of(pair.scene, world, MassModel::consistent) - before));
      off = std::max(off, broken(pair, type, world));
    }
    EXPECT_LE(drift, 1e-6 * range) << substeps;
    EXPECT_LE(off, 1e-6) << substeps;
    EXPECT_LE(test::stretch_of(pair.scene, world).max, 1e-6) << substeps;
  }
}

// Nothing acts on two free bodies from outside: both momenta stay, to 1e-10.
TEST_P(Joints, KeepMomenta) {
  if (!free) return;
  pair.scene.gravity = {};
  World world(pair.scene, test::body_settings(4));
  const Momentum before = test::momentum_of(pair.scene, world);
  test::run(world, frame, 120);
  const Momentum after = test::momentum_of(pair.scene, world);
  EXPECT_LE(norm(after.linear - before.linear), 1e-10 * norm(before.linear));
  EXPECT_LE(norm(after.angular - before.angular), 1e-10 * norm(before.angular));
}

// Four bodies in a ring of hinges, three constraints too many, light and heavy ones in turn: factors must not
// lose what small pivots are worth. Energy to the bar of joints, momentum to what redundant constraints
// leave.
TEST(FourBar, KeepsEnergyAndMomentumAtEveryMassRatio) {
  for (const double ratio : {1e-6, 1e-3, 1.0, 1e3, 1e6})
    for (const std::uint32_t substeps : {1u, 8u}) {
      SCOPED_TRACE(testing::Message() << ratio << ", substeps " << substeps);
      Scene scene;
      scene.gravity = {};
      const Vec3 corners[4] = {{0, 0, 0}, {1, 0, 0}, {1.2, 0.8, 0}, {0, 1, 0}};
      std::uint32_t bars[4];
      for (std::uint32_t i = 0; i < 4; ++i) {
        MassProperties bar = solid_box(i % 2 ? ratio : 1, {0.4, 0.2, 0.1});
        bar.center = 0.5 * (corners[i] + corners[(i + 1) % 4]);
        bars[i] = add_body(scene, bar);
        test::set_motion(scene, bars[i], {0.5, 0.2, 0}, {});
      }
      for (std::uint32_t i = 0; i < 4; ++i)
        add_revolute(scene, bars[i], bars[(i + 1) % 4], corners[(i + 1) % 4], {0, 0, 1});
      for (const std::uint32_t particle : scene.bodies[bars[0]].particles)
        scene.particles[particle].velocity +=
            cross(Vec3{0, 0, 2}, scene.particles[particle].position - corners[0]);
      World world(scene, test::body_settings(substeps));
      const auto momentum = [&] {
        return measure_momentum(scene, test::positions_of(world), test::velocities_of(world),
                                MassModel::consistent)
            .linear;
      };
      const double energy = test::energy_of(scene, world, MassModel::consistent);
      const Vec3 before = momentum();
      const StepReport report = test::run(world, frame, 600);
      EXPECT_EQ(report.unsolved, 0u);
      EXPECT_NEAR(test::energy_of(scene, world, MassModel::consistent), energy, 1e-6 * energy);
      EXPECT_LE(norm(momentum() - before), 1e-7 * norm(before));
    }
}

// The same of a rod alone, which is all rigid: what energy is held to must not cost it momentum.
TEST(FreeRod, KeepsMomenta) {
  Scene scene;
  scene.gravity = {};
  test::add_capsule_rod(scene, {0, 0, -0.5}, {0, 0, 0.5}, 2, 0.05);
  scene.particles[0].velocity = {1, 0.5, 0.3};
  scene.particles[1].velocity = {0, -0.5, 0.3};
  for (const std::uint32_t substeps : {1u, 16u, 64u}) {
    World world(scene, test::body_settings(substeps));
    const Momentum before = test::momentum_of(scene, world);
    test::run(world, frame, 120);
    const Momentum after = test::momentum_of(scene, world);
    EXPECT_LE(norm(after.linear - before.linear), 1e-10 * norm(before.linear)) << substeps;
    EXPECT_LE(norm(after.angular - before.angular), 1e-10 * norm(before.angular)) << substeps;
  }
}

/// A rod of 2 kg and 1 m, level, that turns about a fixed particle, and its angle with what points up there.
constexpr double rod_mass = 2, rod_length = 1, rod_inertia = rod_mass * rod_length * rod_length / 3;
Scene held_rod(AngleControl control, Vec3 gravity = {0, -test::earth, 0}) {
  Scene scene;
  scene.gravity = gravity;
  scene.particles = {test::fixed({0, 0, 0}), test::fixed({0, 1, 0}), test::movable({rod_length, 0, 0}, 0)};
  scene.rods = {{.a = 0, .b = 2, .mass = rod_mass}};
  control.u = {point_at(0), point_at(1)};
  control.v = {point_at(0), point_at(2)};
  scene.angles.push_back(control);
  return scene;
}
double angle_of(const World& world) {
  return std::acos(std::clamp(world.position(2).y / rod_length, -1.0, 1.0));
}

// A degree is the bar, at whatever speed the limit is met.
TEST(AngleLimits, ArePassedByNoMoreThanADegree) {
  for (const double speed : {0.0, -5.0, 30.0})
    for (const std::uint32_t substeps : {1u, 4u}) {
      Scene scene = held_rod({.lower = 60 * test::degree, .upper = 130 * test::degree});
      scene.particles[2].velocity = {0, speed, 0};
      World world(scene, test::body_settings(substeps));
      double least = 10, most = 0;
      for (int i = 0; i < 300; ++i) {
        world.step(frame);
        least = std::min(least, angle_of(world));
        most = std::max(most, angle_of(world));
      }
      EXPECT_GE(least, 59 * test::degree) << speed;
      EXPECT_LE(most, 131 * test::degree) << speed;
      EXPECT_NEAR(angle_of(world), 130 * test::degree, 0.1 * test::degree) << "at rest";
    }
}

// Two rods that fly and fold at their joint. The limit is within the whole: linear momentum stays to what
// energy is held to (lengths to 1e-9); the rods turn on while it pushes them along the directions of the
// substep's start, at 5 rad/s, and angular momentum is off by that turn at most.
TEST(AngleLimits, HoldBetweenRodsThatFly) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {test::movable({-1, 0, 0}, 0, {0, 4, 1}), test::movable({0, 0, 0}, 0, {0, -2, 0}),
                     test::movable({1, 0.2, 0}, 0, {0, 4, -1})};
  scene.rods = {{.a = 1, .b = 0, .mass = 2}, {.a = 1, .b = 2, .mass = 3}};
  scene.angles.push_back({.u = {point_at(1), point_at(0)},
                          .v = {point_at(1), point_at(2)},
                          .lower = 70 * test::degree,
                          .upper = 175 * test::degree});
  for (const std::uint32_t substeps : {1u, 16u}) {
    World world(scene, test::body_settings(substeps));
    const Momentum before = test::momentum_of(scene, world);
    double least = 10;
    for (int i = 0; i < 300; ++i) {
      world.step(frame);
      const Vec3 u = world.position(0) - world.position(1), v = world.position(2) - world.position(1);
      least = std::min(least, std::acos(dot(u, v) / (norm(u) * norm(v))));
    }
    EXPECT_GE(least, 69 * test::degree);
    EXPECT_LE(least, 72 * test::degree) << "never met";
    const Momentum after = test::momentum_of(scene, world);
    EXPECT_LE(norm(after.linear - before.linear), 1e-8 * norm(before.linear));
    EXPECT_LE(norm(after.angular - before.angular), 5 * frame / substeps * norm(before.angular));
  }
}

constexpr double load = rod_mass * test::earth * rod_length / 2;  ///< N m, of the rod's weight when level

// 1 % above the load friction holds it; 1 % below, what is left turns it, I a = 0.01 load, to the second
// order in the angle that it gets to (8 mrad).
TEST(AngleFriction, HoldsWhatItIsStrongerThan) {
  for (const std::uint32_t substeps : {1u, 4u}) {
    World holds(held_rod({.friction = 1.01 * load}), test::body_settings(substeps));
    test::run(holds, frame, 120);
    EXPECT_NEAR(angle_of(holds), 90 * test::degree, 1e-5);
    World slips(held_rod({.friction = 0.99 * load}), test::body_settings(substeps));
    test::run(slips, frame, 20);
    const double turned = 0.5 * 0.01 * load / rod_inertia / 9;
    EXPECT_NEAR(angle_of(slips), 90 * test::degree + turned, 0.05 * turned);
  }
}

// What friction holds is at rest, and says so.
TEST(AngleFriction, HoldsAtRest) {
  World world(held_rod({.friction = 2 * load}), test::body_settings());
  test::run(world, frame, 60);
  EXPECT_LE(norm(world.velocity(2)), 1e-3);
}

// The linear oscillator I a'' + c a' + k a = 0, from 0.05 rad, without damping, below and above the critical
// one. Two seconds are 13 rad of a swing that runs slow by (omega h)²/24, 5e-6 of it.
TEST(AngleDrive, ReachesItsTargetAsTheLinearOscillatorDoes) {
  const double stiffness = 30, omega = std::sqrt(stiffness / rod_inertia), start = 0.05;
  for (const double ratio : {0.0, 0.2, 0.7, 2.0}) {
    const double damping = 2 * ratio * omega * rod_inertia;
    World world(
        held_rod({.target = 90 * test::degree + start, .stiffness = stiffness, .damping = damping}, {}),
        test::body_settings(16));
    double worst = 0;
    for (int i = 0; i < 120; ++i) {
      world.step(frame);
      const double t = world.time(), decay = ratio * omega;
      double left = 0;
      if (ratio < 1) {
        const double rate = omega * std::sqrt(1 - ratio * ratio);
        left = std::exp(-decay * t) * (std::cos(rate * t) + decay / rate * std::sin(rate * t));
      } else {
        const double rate = omega * std::sqrt(ratio * ratio - 1);
        left = std::exp(-decay * t) * (std::cosh(rate * t) + decay / rate * std::sinh(rate * t));
      }
      worst = std::max(worst, std::abs(angle_of(world) - 90 * test::degree - start * (1 - left)));
    }
    EXPECT_LE(worst, 1e-4 * start) << "damping ratio " << ratio;
  }
}

// Without a drive the damping alone: the rate decays as exp(-c t / I).
TEST(AngleDamping, SlowsTheAngle) {
  Scene scene = held_rod({.damping = 1}, {});
  scene.particles[2].velocity = {0, 0.2, 0};
  World world(scene, test::body_settings(4));
  test::run(world, frame, 60);
  EXPECT_NEAR(norm(world.velocity(2)), 0.2 * std::exp(-1 / rod_inertia),
              0.01 * 0.2 * std::exp(-1 / rod_inertia));
}

/// Five rods in a row that fly, each particle with a velocity of its own.
Scene flying_row() {
  test::Random random(4);
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < 6; ++i)
    scene.particles.push_back(
        test::movable({0.4 * i, 0, 0.1 * (i % 2)}, 0, 2.0 * test::random_vector(random)));
  for (std::uint32_t i = 0; i < 5; ++i) scene.rods.push_back({.a = i, .b = i + 1, .mass = 1.0 + i});
  return scene;
}

// It takes the motion between rods alone: momenta stay to 1e-10, and in the end all turn as one.
TEST(JointDrag, KeepsMomentaAndStopsTheRest) {
  Scene scene = flying_row();
  scene.joint_drag = 5;
  for (const std::uint32_t substeps : {1u, 4u}) {
    World world(scene, test::body_settings(substeps));
    const Momentum before = test::momentum_of(scene, world);
    test::run(world, frame, 360);
    const Momentum after = test::momentum_of(scene, world);
    EXPECT_LE(norm(after.linear - before.linear), 1e-10 * norm(before.linear));
    EXPECT_LE(norm(after.angular - before.angular), 1e-10 * norm(before.angular));
    const auto distances = [&] {
      std::vector<double> out;
      for (std::uint32_t i = 0; i < 6; ++i)
        for (std::uint32_t j = 0; j < i; ++j) out.push_back(norm(world.position(i) - world.position(j)));
      return out;
    };
    const std::vector<double> was = distances();
    test::run(world, frame, 6);
    const std::vector<double> is = distances();
    // At first they change by some 2 m/s. What stays is slow: turning pulls the row straight against the
    // drag.
    for (std::size_t i = 0; i < is.size(); ++i) EXPECT_NEAR(is[i], was[i], 0.1 * 6 * frame) << i;
  }
}

// Thesis 2.1.5 and 2.1.6: along the axis, across it, and turning, each decays as exp(-ct). What a substep
// errs is (ch)²/12 of the exponent.
TEST(Air, SlowsALoneRodAlongAndAcrossItself) {
  const double linear = 0.7, orthogonal = 1.3;
  struct Case {
    const char* name;
    Vec3 a, b;
    double rate;
  };
  for (const Case& c :
       {Case{"along", {3, 0, 0}, {3, 0, 0}, linear}, Case{"across", {0, 2, 1}, {0, 2, 1}, orthogonal},
        Case{"turning", {0, 2, 1}, {0, -2, -1}, orthogonal}})
    for (const std::uint32_t substeps : {1u, 4u}) {
      Scene scene;
      scene.gravity = {};
      scene.particles = {test::movable({0, 0, 0}, 0, c.a), test::movable({1, 0, 0}, 0, c.b)};
      scene.rods = {{.a = 0, .b = 1, .mass = 2, .linear_drag = linear, .orthogonal_drag = orthogonal}};
      World world(scene, test::body_settings(substeps));
      test::run(world, frame, 60);
      const double left = norm(world.velocity(0)) / norm(c.a), h = frame / substeps;
      EXPECT_NEAR(left, std::exp(-c.rate), 0.3 * c.rate * c.rate * h * left) << c.name;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
