// The articulated-body algorithm against textbook solutions, and against d'Alembert's principle on random
// bodies of every kind of joint.
#include "reference/featherstone/articulated_body.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "support/articulated_body.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::advance;
using test::start_of;
using test::State;

constexpr Vec3 gravity{0, -9.81, 0};

/// Links as they move, their centres of mass, and what follows.
struct Motion {
  Array<LinkMotion> links;
  std::vector<Vec3> centers, velocities;  ///< of mass
  std::vector<Vec3> spins;                ///< angular momenta about the centres
};
Motion motion_of(const ArticulatedBody& body, const Array<Link>& links, const State& s) {
  Motion motion;
  motion.links.resize(links.size());
  body.motions(s.q, s.v, {}, {}, motion.links);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const LinkMotion& m = motion.links[i];
    const Vec3 arm = m.rotation * links[i].center;
    motion.centers.push_back(m.position + arm);
    motion.velocities.push_back(m.velocity + cross(m.angular_velocity, arm));
    const Inertia& own = links[i].inertia;
    const Sym3 tensor{own.xx, own.xy, own.xz, own.yy, own.yz, own.zz};
    motion.spins.push_back(m.rotation * (tensor * transposed_times(m.rotation, m.angular_velocity)));
  }
  return motion;
}

double energy_of(const Array<Link>& links, const Motion& motion, Vec3 g) {
  double energy = 0;
  for (std::size_t i = 0; i < links.size(); ++i)
    energy += 0.5 * links[i].mass * dot(motion.velocities[i], motion.velocities[i]) +
              0.5 * dot(motion.spins[i], motion.links[i].angular_velocity) -
              links[i].mass * dot(g, motion.centers[i]);
  return energy;
}
Vec3 linear_momentum(const Array<Link>& links, const Motion& motion) {
  Vec3 sum{};
  for (std::size_t i = 0; i < links.size(); ++i) sum += links[i].mass * motion.velocities[i];
  return sum;
}
Vec3 angular_momentum(const Array<Link>& links, const Motion& motion) {
  Vec3 sum{};
  for (std::size_t i = 0; i < links.size(); ++i)
    sum += motion.spins[i] + links[i].mass * cross(motion.centers[i], motion.velocities[i]);
  return sum;
}

// Two bars on revolute joints. Lagrange, in angles t of each from the horizontal:
//   (I1 + m1 c1² + m2 L²) t1'' + m2 L c2 [cos(t1 - t2) t2'' + sin(t1 - t2) t2'²] = -(m1 c1 + m2 L) g cos t1
//   (I2 + m2 c2²) t2'' + m2 L c2 [cos(t1 - t2) t1'' - sin(t1 - t2) t1'²] = -m2 c2 g cos t2
TEST(ArticulatedBody, RevoluteJointsMakeADoublePendulum) {
  const double m1 = 2, m2 = 3, c1 = 0.3, c2 = 0.2, length = 0.7, i1 = 0.11, i2 = 0.07, g = 9.81;
  ArticulatedBody body({{.joint = Joint::revolute,
                         .axis = {0, 0, 1},
                         .mass = m1,
                         .center = {c1, 0, 0},
                         .inertia = {.xx = 0.5, .yy = 0.6, .zz = i1}},
                        {.parent = 0,
                         .joint = Joint::revolute,
                         .place = {length, 0, 0},
                         .axis = {0, 0, 1},
                         .mass = m2,
                         .center = {c2, 0, 0},
                         .inertia = {.xx = 0.3, .yy = 0.2, .zz = i2}}});
  for (const double a : {-1.1, 0.4, 2.0}) {
    State s = start_of(body);
    s.q << a, 0.9;
    s.v << 1.7, -3.1;
    VectorXd rates;
    body.accelerations(s.q, s.v, {.gravity = gravity}, rates);
    const double t1 = s.q[0], t2 = s.q[0] + s.q[1], w1 = s.v[0], w2 = s.v[0] + s.v[1];
    const double coupling = m2 * length * c2;
    Eigen::Matrix2d mass;
    mass << i1 + m1 * c1 * c1 + m2 * length * length, coupling * std::cos(t1 - t2),
        coupling * std::cos(t1 - t2), i2 + m2 * c2 * c2;
    const Eigen::Vector2d right{
        -coupling * std::sin(t1 - t2) * w2 * w2 - g * (m1 * c1 + m2 * length) * std::cos(t1),
        coupling * std::sin(t1 - t2) * w1 * w1 - g * m2 * c2 * std::cos(t2)};
    const Eigen::Vector2d wanted = mass.inverse() * right;
    EXPECT_NEAR(rates[0], wanted[0], 1e-12);
    EXPECT_NEAR(rates[0] + rates[1], wanted[1], 1e-12);
  }
}

// A block slides down a wedge that slides on the floor, without friction: the block by
// (M + m) g sin a / (M + m sin² a) relative to the wedge, the wedge by -m g sin a cos a / (M + m sin² a).
TEST(ArticulatedBody, PrismaticJointsMakeAWedge) {
  const double wedge = 5, block = 2, a = 0.5, g = 9.81;
  ArticulatedBody body({{.joint = Joint::prismatic, .axis = {1, 0, 0}, .mass = wedge},
                        {.parent = 0,
                         .joint = Joint::prismatic,
                         .place = {0.3, 1, 0},
                         .axis = {std::cos(a), -std::sin(a), 0},
                         .mass = block,
                         .inertia = {.xx = 1, .yy = 1, .zz = 1}}});
  State s = start_of(body);
  s.v << 0.3, 2;
  const double below = wedge + block * std::sin(a) * std::sin(a);
  VectorXd rates;
  body.accelerations(s.q, s.v, {.gravity = gravity}, rates);
  EXPECT_NEAR(rates[0], -block * g * std::sin(a) * std::cos(a) / below, 1e-13);
  EXPECT_NEAR(rates[1], (wedge + block) * g * std::sin(a) / below, 1e-13);
  advance(body, s, {.gravity = gravity}, 0.5, 10);  // accelerations are constant: exact
  EXPECT_NEAR(s.q[1], 2 * 0.5 + 0.5 * 0.25 * (wedge + block) * g * std::sin(a) / below, 1e-13);
}

// A bead on a rod that turns evenly about an upright axis leaves as exp(w t): r'' = w² r, with a heavy
// turntable that its Coriolis force hardly slows.
TEST(ArticulatedBody, SlidesOnATurningRod) {
  const double w = 3;
  ArticulatedBody body(
      {{.joint = Joint::revolute, .axis = {0, 1, 0}, .inertia = {.xx = 1, .yy = 1e9, .zz = 1}},
       {.parent = 0, .joint = Joint::prismatic, .axis = {1, 0, 0}, .mass = 1}});
  State s = start_of(body);
  s.q << 0, 0.2;
  s.v << w, 0;
  advance(body, s, {}, 0.5, 500);
  EXPECT_NEAR(s.q[1], 0.2 * std::cosh(w * 0.5), 1e-8);  // 1e-9 is the mass over the turntable's inertia
}

Array<Link> brick(Vec3 center) {
  return {
      {.mass = 2, .center = center, .inertia = {.xx = 0.1, .yy = 0.25, .zz = 0.3, .xy = 0.02, .yz = -0.03}}};
}

// Euler's equations in space: L = I w stays, so w' = I^-1 (I w x w); and the energy stays.
TEST(ArticulatedBody, TorqueFreeBodyKeepsMomentumAndEnergy) {
  const Array<Link> links = brick({});
  ArticulatedBody body(links);
  State s = start_of(body);
  s.q << 0.5, 0.5, -0.1, std::sqrt(0.49);
  s.v << 1, 5, -2;
  const Motion first = motion_of(body, links, s);
  VectorXd rates;
  body.accelerations(s.q, s.v, {}, rates);
  const Mat3 r = first.links[0].rotation;
  const Sym3 tensor{0.1, 0.02, 0, 0.25, -0.03, 0.3};
  const Vec3 omega = load3(s.v.data());
  const Vec3 wanted = r * (inverse(tensor) * transposed_times(r, cross(first.spins[0], omega)));
  EXPECT_LE(norm(load3(rates.data()) - wanted), 1e-13);
  advance(body, s, {}, 2, 4000);
  const Motion last = motion_of(body, links, s);
  EXPECT_GT(norm(last.links[0].angular_velocity - omega), 0.5) << "it tumbles";
  EXPECT_LE(norm(last.spins[0] - first.spins[0]), 1e-10);
  EXPECT_NEAR(energy_of(links, last, {}), energy_of(links, first, {}), 1e-10);
}

// On a floating base, off its centre, under gravity: the centre falls as a stone does, the spin stays.
TEST(ArticulatedBody, FloatingBodyFallsAsAStone) {
  Array<Link> links = brick({0.3, -0.2, 0.1});
  links.insert(links.begin(), {.joint = Joint::translation});
  links[1].parent = 0;
  ArticulatedBody body(links);
  State s = start_of(body);
  s.q[3] = 1;
  s.v << 1, 2, 3, 4, -3, 2;
  const Motion first = motion_of(body, links, s);
  advance(body, s, {.gravity = gravity}, 1, 4000);
  const Motion last = motion_of(body, links, s);
  EXPECT_LE(norm(last.centers[1] - first.centers[1] - first.velocities[1] - 0.5 * gravity), 1e-10);
  EXPECT_LE(norm(last.spins[1] - first.spins[1]), 1e-10);
}

// A symmetric top whose axis keeps its tilt a and goes round at W needs the spin about its axis that solves
// I1 W² cos a - I3 w3 W + m g l = 0, I1 about the tip. A fast one does so slowly.
TEST(ArticulatedBody, TopPrecessesSteadily) {
  const double mass = 1.5, far = 0.2, i3 = 0.01, across = 0.02, tilt = 0.6, turn = 2.0;
  const double i1 = across + mass * far * far;
  const double spin = (i1 * turn * turn * std::cos(tilt) + mass * 9.81 * far) / (i3 * turn);
  const Array<Link> links{
      {.mass = mass, .center = {0, far, 0}, .inertia = {.xx = across, .yy = i3, .zz = across}}};
  ArticulatedBody body(links);
  State s = start_of(body);
  s.q << std::cos(tilt / 2), 0, 0, -std::sin(tilt / 2);  // about -z: the axis leans to +x
  const Vec3 axis{std::sin(tilt), std::cos(tilt), 0}, up{0, 1, 0};
  // Of the turning about the upright, the axis has cos(tilt) already.
  store3(s.v.data(), turn * up + (spin - turn * std::cos(tilt)) * axis);
  for (int quarter = 1; quarter <= 4; ++quarter) {
    advance(body, s, {.gravity = gravity}, std::numbers::pi / 2 / turn, 16000);
    const Vec3 now = motion_of(body, links, s).links[0].rotation.y;
    const double angle = quarter * std::numbers::pi / 2;
    EXPECT_LE(
        norm(now - Vec3{std::sin(tilt) * std::cos(angle), std::cos(tilt), -std::sin(tilt) * std::sin(angle)}),
        1e-8)
        << quarter;
  }
}

/// Uniform, without inertia about its axis.
Link bar(Vec3 axis, double length, double mass) {
  const double i = mass * length * length / 12;
  return {.mass = mass,
          .center = (0.5 * length) * axis,
          .inertia = {.xx = i * (1 - axis.x * axis.x),
                      .yy = i * (1 - axis.y * axis.y),
                      .zz = i * (1 - axis.z * axis.z),
                      .xy = -i * axis.x * axis.y,
                      .xz = -i * axis.x * axis.z,
                      .yz = -i * axis.y * axis.z},
          .grip = length * axis};
}

// A uniform bar swings as a point at two thirds of its length, whichever axis of its frame it lies along; let
// go level, it passes the bottom with w² = 3 g / L.
TEST(ArticulatedBody, SlenderLinksSwing) {
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{0.36, 0.48, 0.8}}) {
    const double length = 0.6;
    const Array<Link> links{bar(axis, length, 3)};
    ArticulatedBody body(links);
    State s = start_of(body);
    // Level: from the axis to x.
    const Vec3 x{1, 0, 0}, about = cross(axis, x);
    s.q << 1 + dot(axis, x), about.x, about.y, about.z;
    s.q.normalize();
    VectorXd rates;
    body.accelerations(s.q, s.v, {.gravity = gravity}, rates);
    EXPECT_LE(norm(load3(rates.data()) - Vec3{0, 0, -1.5 * 9.81 / length}), 1e-12);
    // The quarter period of a pendulum let go at 90 degrees: K(1/sqrt 2) sqrt(l / g), l two thirds.
    const double quarter = 1.8540746773013719 * std::sqrt(2 * length / 3 / 9.81);
    advance(body, s, {.gravity = gravity}, quarter, 2000);
    EXPECT_NEAR(s.v[2], -std::sqrt(3 * 9.81 / length), 1e-9);
    EXPECT_LE(norm(motion_of(body, links, s).links[0].rotation * axis - Vec3{0, -1, 0}), 1e-9);
  }
}

/// A body of random links and joints; `slender`: some of them bars on spherical joints.
Array<Link> random_links(test::Random& random, bool floats, bool slender) {
  Array<Link> links;
  for (std::uint32_t i = 0; i < 9; ++i) {
    const Joint joints[] = {Joint::spherical, Joint::revolute, Joint::prismatic};
    // The translation of a floating base does not turn: nothing but a spherical joint in its centre of mass.
    const std::uint32_t first = floats && i > 1 ? 1 : 0;
    Link link{.parent = i == 0 ? Link::base : first + test::below(random, i - first),
              .joint = floats && i == 1 ? Joint::spherical : joints[test::below(random, 3)]};
    if (!floats || i != 1) link.place = test::random_vector(random);
    const Vec3 way = test::random_vector(random);
    link.axis = (1 / norm(way)) * way;
    std::vector<PointMass> points;
    for (int k = 0; k < 5; ++k) points.push_back({test::random_vector(random), 0.5});
    const MassProperties solid = mass_properties(points);
    link.mass = solid.mass;
    link.center = solid.center;
    link.inertia = solid.inertia;
    link.grip = test::random_vector(random);
    if (slender && i > 0 && test::below(random, 2) == 0) {
      const Link thin = bar(test::below(random, 2) == 0 ? Vec3{1, 0, 0} : link.axis, 0.8, 2);
      link.joint = Joint::spherical;
      link.mass = thin.mass;
      link.center = thin.center;
      link.inertia = thin.inertia;
      link.grip = thin.grip;
    }
    // On a bar, at its end and free to turn, so that the bar has no inertia about its axis from it.
    const bool on_bar = i > 0 && slender && links[link.parent].grip == 2 * links[link.parent].center;
    if (on_bar) {
      link.joint = Joint::spherical;
      link.place = links[link.parent].grip;
    }
    if (i == 0 && floats) link = {.joint = Joint::translation, .place = link.place, .mass = 1};
    links.push_back(link);
  }
  return links;
}
bool is_bar(const Link& link) {
  return link.joint == Joint::spherical && link.grip == 2 * link.center;
}

State random_state(const ArticulatedBody& body, const Array<Link>& links, test::Random& random) {
  State s = start_of(body);
  for (double& x : s.q) x = test::signed_unit(random);
  for (double& x : s.v) x = 2 * test::signed_unit(random);
  for (std::uint32_t i = 0; i < links.size(); ++i)
    if (links[i].joint == Joint::spherical) s.q.segment<4>(body.coordinate(i)).normalize();
  body.settle(s.q, s.v);
  return s;
}

/// Velocities of centres and angular velocities per speed: 6 rows a link. Motions are linear in speeds, so
/// finite differences of any size are exact.
MatrixXd jacobian(const ArticulatedBody& body, const Array<Link>& links, const State& s) {
  MatrixXd j(6 * static_cast<Eigen::Index>(links.size()), body.speeds());
  for (Eigen::Index k = 0; k < body.speeds(); ++k) {
    const Motion motion = motion_of(body, links, {s.q, VectorXd::Unit(body.speeds(), k)});
    for (std::size_t i = 0; i < links.size(); ++i) {
      store3(&j(6 * static_cast<Eigen::Index>(i), k), motion.velocities[i]);
      store3(&j(6 * static_cast<Eigen::Index>(i) + 3, k), motion.links[i].angular_velocity);
    }
  }
  return j;
}

// Accelerations by unit forces on the joints, from rest, are the columns of the inverse of Jᵀ M J; of a bar
// without spin.
TEST(ArticulatedBody, InvertsTheMassMatrix) {
  test::Random random(17);
  for (int round = 0; round < 40; ++round) {
    const bool slender = round % 2 == 0;
    const Array<Link> links = random_links(random, round % 4 < 2, slender);
    ArticulatedBody body(links);
    State s = random_state(body, links, random);
    const MatrixXd j = jacobian(body, links, s);
    MatrixXd masses = MatrixXd::Zero(j.rows(), j.rows());
    Array<LinkMotion> motion(links.size());
    s.v.setZero();
    body.motions(s.q, s.v, {}, {}, motion);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto at = 6 * static_cast<Eigen::Index>(i);
      const Inertia& own = links[i].inertia;
      const Mat3 tensor = full({own.xx, own.xy, own.xz, own.yy, own.yz, own.zz});
      const Mat3 turned = motion[i].rotation * tensor * transposed(motion[i].rotation);
      masses.block<3, 3>(at, at).diagonal().setConstant(links[i].mass);
      store3(&masses(at + 3, at + 3), turned.x);
      store3(&masses(at + 3, at + 4), turned.y);
      store3(&masses(at + 3, at + 5), turned.z);
    }
    const MatrixXd matrix = j.transpose() * masses * j;
    for (Eigen::Index k = 0; k < body.speeds(); ++k) {
      VectorXd speeds = VectorXd::Unit(body.speeds(), k), back;
      body.settle(s.q, speeds);
      const VectorXd force = matrix * speeds;
      body.accelerations(s.q, s.v, {.torques = {force.data(), static_cast<std::size_t>(force.size())}}, back);
      // Rounding, times the condition of the matrix: below 1e5 in all of these.
      EXPECT_LE((back - speeds).norm(), 1e-10) << round << ", speed " << k;
    }
  }
}

// d'Alembert: in every speed, the forces of inertia of all links, found from their motions a moment before
// and after, balance gravity, the forces at their grips and those on joints. Central differences err by 1e-9
// here.
TEST(ArticulatedBody, BalancesForcesOfInertia) {
  test::Random random(23);
  for (int round = 0; round < 40; ++round) {
    const Array<Link> links = random_links(random, round % 4 < 2, round % 2 == 0);
    ArticulatedBody body(links);
    const State s = random_state(body, links, random);
    std::vector<Vec3> forces;
    for (std::size_t i = 0; i < links.size(); ++i) forces.push_back(5 * test::random_vector(random));
    VectorXd torques(body.speeds());
    for (double& t : torques) t = 3 * test::signed_unit(random);
    for (std::uint32_t i = 0; i < links.size(); ++i)
      if (is_bar(links[i])) torques.segment<3>(body.speed(i)).setZero();  // nothing to turn about its axis
    State slope;
    body.rates(s.q, s.v, slope.q);
    const Vec3 pull{0.3, -9.81, 1};
    body.accelerations(s.q, s.v,
                       {.gravity = pull,
                        .forces = forces,
                        .torques = {torques.data(), static_cast<std::size_t>(torques.size())}},
                       slope.v);
    const double e = 1e-5;
    const Motion before = motion_of(body, links, {s.q - e * slope.q, s.v - e * slope.v}),
                 after = motion_of(body, links, {s.q + e * slope.q, s.v + e * slope.v}),
                 now = motion_of(body, links, s);
    VectorXd left(6 * static_cast<Eigen::Index>(links.size()));
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Vec3 a = (0.5 / e) * (after.velocities[i] - before.velocities[i]);
      const Vec3 spin = (0.5 / e) * (after.spins[i] - before.spins[i]);
      const Vec3 arm = now.links[i].rotation * (links[i].grip - links[i].center);
      store3(&left[6 * static_cast<Eigen::Index>(i)], links[i].mass * (a - pull) - forces[i]);
      store3(&left[6 * static_cast<Eigen::Index>(i) + 3], spin - cross(arm, forces[i]));
    }
    const VectorXd off = jacobian(body, links, s).transpose() * left - torques;
    EXPECT_LE(off.norm(), 1e-6 * (1 + left.norm())) << round;
  }
}

// All that is inside a floating body leaves its momenta alone.
TEST(ArticulatedBody, FloatingBodiesKeepTheirMomenta) {
  test::Random random(29);
  for (int round = 0; round < 4; ++round) {
    const Array<Link> links = random_links(random, true, round % 2 == 0);
    ArticulatedBody body(links);
    State s = random_state(body, links, random);
    const Motion first = motion_of(body, links, s);
    advance(body, s, {}, 0.2, 2000);
    const Motion last = motion_of(body, links, s);
    EXPECT_LE(norm(linear_momentum(links, last) - linear_momentum(links, first)), 1e-9);
    EXPECT_LE(norm(angular_momentum(links, last) - angular_momentum(links, first)), 1e-9);
    EXPECT_NEAR(energy_of(links, last, {}), energy_of(links, first, {}), 1e-9);
  }
}

TEST(ArticulatedBody, RefusesLinksInTheWrongOrder) {
  EXPECT_THROW(ArticulatedBody({{.parent = 0, .mass = 1}}), std::invalid_argument);
  EXPECT_THROW(ArticulatedBody({{.mass = 1}, {.parent = 0, .joint = Joint::translation, .mass = 1}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
