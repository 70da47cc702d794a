#include "plumb/joints.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "support/dense_solves.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

MassProperties random_weight(test::Random& random) {
  std::vector<PointMass> points;
  const Vec3 middle = test::random_vector(random);
  for (int i = 0; i < 6; ++i)
    points.push_back({middle + test::random_vector(random), 0.6 + 0.5 * test::signed_unit(random)});
  return mass_properties(points);
}

Scene two_bodies(test::Random& random) {
  Scene scene;
  add_body(scene, random_weight(random));
  add_body(scene, random_weight(random));
  return scene;
}

std::string refusal(const std::function<void(Scene&)>& change) {
  test::Random random(40);
  Scene scene = two_bodies(random);
  try {
    change(scene);
  } catch (const InputError& error) {
    EXPECT_EQ(scene.particles.size(), 8u) << "changed";
    EXPECT_EQ(scene.rods.size(), 12u) << "changed";
    EXPECT_EQ(scene.bodies.size(), 2u) << "changed";
    EXPECT_TRUE(scene.pins.empty() && scene.alignments.empty()) << "changed";
    return error.what();
  }
  return {};
}

Vec3 vector_of(const Scene& scene, const Direction& d) {
  return position_of(scene, d.to) - position_of(scene, d.from);
}

/// What the joints of two bodies keep: 0 as the scene was when they were made.
Eigen::VectorXd violation(const Scene& scene) {
  std::vector<double> rows;
  for (const Rod& rod : scene.rods)
    rows.push_back(norm(scene.particles[rod.b].position - scene.particles[rod.a].position) - rod.length);
  for (const Pin& pin : scene.pins) {
    const Vec3 apart = position_of(scene, pin.b) - position_of(scene, pin.a);
    rows.insert(rows.end(), {apart.x, apart.y, apart.z});
  }
  for (const auto& [u, v, value] : scene.alignments)
    rows.push_back(dot(vector_of(scene, u), vector_of(scene, v)));
  return Eigen::Map<Eigen::VectorXd>(rows.data(), static_cast<Eigen::Index>(rows.size()));
}

double& coordinate(Scene& scene, std::size_t i) {
  Vec3& p = scene.particles[i / 3].position;
  return i % 3 == 0 ? p.x : i % 3 == 1 ? p.y : p.z;
}

/// The freedoms left by rods and joints: coordinates less the rank of the Jacobian, by central differences
/// (error 1e-9, far below the pivots that count). All rows must count, too.
Eigen::Index freedoms(Scene scene) {
  const Eigen::Index columns = static_cast<Eigen::Index>(3 * scene.particles.size());
  Eigen::MatrixXd jacobian(violation(scene).size(), columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    double& x = coordinate(scene, static_cast<std::size_t>(i));
    const double was = x, h = 1e-5;
    x = was + h;
    const Eigen::VectorXd more = violation(scene);
    x = was - h;
    jacobian.col(i) = (more - violation(scene)) / (2 * h);
    x = was;
  }
  const Eigen::Index rank = test::rank_of(jacobian.cast<test::Real>(), 1e-6L);
  EXPECT_EQ(rank, jacobian.rows()) << "a joint forbids something twice";
  return columns - rank;
}

Vec3 turned(Vec3 v, Vec3 unit, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(unit, v) + (1 - std::cos(angle)) * dot(unit, v) * unit;
}

/// Moves body b, particles 4 to 7.
void move_b(Scene& scene, const std::function<Vec3(Vec3)>& motion) {
  for (std::size_t i = 4; i < 8; ++i) scene.particles[i].position = motion(scene.particles[i].position);
}

double worst(const Scene& scene) {
  return violation(scene).cwiseAbs().maxCoeff();
}

/// A position, and axes of length one at right angles.
struct Place {
  Vec3 position, x, y, z;
};
Place random_place(test::Random& random) {
  const Vec3 p = test::random_vector(random);
  const Vec3 u = test::random_vector(random) + Vec3{0.01, 0, 0};
  const Vec3 x = (1 / norm(u)) * u;
  const Vec3 across = cross(x, test::random_vector(random));
  const Vec3 y = (1 / norm(across)) * across;
  return {p, x, y, cross(x, y)};
}

TEST(Points, AreWhereTheyWereSaidToBe) {
  test::Random random(41);
  for (int round = 0; round < 50; ++round) {
    Scene scene = two_bodies(random);
    EXPECT_EQ(position_of(scene, point_at(3)), scene.particles[3].position);
    const Rod& rod = scene.rods[2];
    const Vec3 a = scene.particles[rod.a].position, b = scene.particles[rod.b].position;
    for (const double fraction : {0.0, 0.3, 1.0, 2.5})
      EXPECT_LE(norm(position_of(scene, point_on_rod(scene, 2, fraction)) - (a + fraction * (b - a))), 1e-14);
    // A place on a body goes with it: turned about the origin, it is where the same turn brings the place.
    const Vec3 place = 2 * test::random_vector(random);
    const Point point = point_on_body(scene, 1, place);
    EXPECT_LE(norm(position_of(scene, point) - place), 1e-13);
    const Vec3 x = random_place(random).x;
    move_b(scene, [&](Vec3 p) { return turned(p, x, 1) + Vec3{1, 2, 3}; });
    EXPECT_LE(norm(position_of(scene, point) - turned(place, x, 1) - Vec3{1, 2, 3}), 1e-12);
  }
}

TEST(Points, OfWhatIsNotThereAreRefused) {
  EXPECT_EQ(refusal([](Scene& s) { point_on_rod(s, 12, 0.5); }),
            "rod 12 does not exist (the scene has 12 rods)");
  EXPECT_EQ(refusal([](Scene& s) { point_on_rod(s, 1, nan); }), "rod 1: fraction is not finite: nan");
  EXPECT_EQ(refusal([](Scene& s) { point_on_body(s, 2, {}); }),
            "body 2 does not exist (the scene has 2 bodies)");
  EXPECT_EQ(refusal([](Scene& s) { point_on_body(s, 1, {0, nan, 0}); }), "body 1: position is not finite");
  EXPECT_EQ(refusal([](Scene& s) {
              for (std::size_t i = 0; i < 4; ++i) s.particles[i].position.y = 0;
              point_on_body(s, 0, {});
            }),
            "body 0: its particles lie in one plane");
}

// On particles of its own a body's mass matrix is a quarter of its mass on each; tolerance: rounding.
TEST(Bodies, HaveTheirMassOnFourParticles) {
  test::Random random(42);
  for (int round = 0; round < 50; ++round) {
    Scene scene;
    const MassProperties weight = random_weight(random);
    EXPECT_EQ(add_body(scene, weight), 0u);
    validate(scene);
    ASSERT_EQ(scene.particles.size(), 4u);
    ASSERT_EQ(scene.rods.size(), 6u);
    for (const Particle& particle : scene.particles) EXPECT_EQ(particle.mass, 0);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(scene.rods[i].mass, 0);
      EXPECT_GT(scene.rods[i].length, 0);
    }
    EXPECT_LE(worst(scene), 0);
    EXPECT_EQ(scene.bodies[0].inertia, weight.inertia);
    const auto mass = body_mass(scene, 0);
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(mass[j][k], j == k ? weight.mass / 4 : 0, 1e-12);
  }
}

TEST(Bodies, OnParticlesThatAreThereGetTheRodsThatAreMissing) {
  test::Random random(43);
  Scene scene;
  for (const Vec3 p : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    scene.particles.push_back({.position = p});
  scene.rods = {{.a = 2, .b = 0}, {.a = 1, .b = 3, .mass = 1}};
  Scene hinged = scene;
  EXPECT_EQ(add_body(scene, {3, 1, 0, 2}, random_weight(random)), 0u);
  EXPECT_EQ(scene.rods.size(), 6u);
  EXPECT_EQ(scene.rods[1].mass, 1);
  validate(scene);
  hinged.particles[0].fixed = hinged.particles[1].fixed = true;
  add_body(hinged, {3, 1, 0, 2}, random_weight(random));
  EXPECT_EQ(hinged.rods.size(), 5u) << "none between the two that are fixed";
  validate(hinged);
}

TEST(Bodies, ThatAreNotSolidAreRefused) {
  EXPECT_EQ(refusal([](Scene& s) { add_body(s, {.mass = 1, .inertia = {.xx = 1, .yy = 1, .zz = 2.5}}); }),
            "body 2: inertia is not that of a solid: a second moment of its mass is negative (-0.25 kg m^2)");
  EXPECT_EQ(
      refusal([](Scene& s) { add_body(s, {.mass = 1, .inertia = {.xx = 1, .yy = 1, .zz = 0}}); }),
      "body 2: inertia is that of a line, which nothing keeps from spinning about itself: a body needs a "
      "thickness of more than 1e-6 of its length, and a rod with mass needs none");
  EXPECT_EQ(refusal([](Scene& s) { add_body(s, {.mass = -1}); }),
            "body 2: mass must be positive and finite, got -1 kg");
  const MassProperties ball = solid_sphere(1, 1);
  EXPECT_EQ(refusal([&](Scene& s) {
              add_body(s, {0, 1, 2, 8}, ball);
            }),
            "body 2: particle 8 does not exist (the scene has 8 particles)");
  EXPECT_EQ(refusal([&](Scene& s) { add_body(s, {0, 1, 2, 1}, ball); }), "body 2: particle 1 is there twice");
  EXPECT_EQ(refusal([&](Scene& s) {
              s.particles[1].position = s.particles[0].position;
              add_body(s, {0, 1, 2, 3}, ball);
            }),
            "body 2: its particles lie in one plane");
  EXPECT_EQ(refusal([&](Scene& s) {
              add_body(s, {0, 1, 4, 5}, {.mass = 0});
            }),
            "body 2: mass must be positive and finite, got 0 kg");
}

// Two free bodies have 12 freedoms, 6 of which are those of the whole.
TEST(Joints, LeaveTheFreedomsTheyAreNamedFor) {
  test::Random random(44);
  for (int round = 0; round < 20; ++round) {
    const Scene free = two_bodies(random);
    const auto [position, x, y, z] = random_place(random);
    EXPECT_EQ(freedoms(free), 12);
    Scene scene = free;
    add_spherical(scene, point_on_body(scene, 0, position), point_on_body(scene, 1, position));
    EXPECT_EQ(freedoms(scene), 6 + 3);
    validate(scene);
    scene = free;
    add_revolute(scene, 0, 1, position, 3 * x);
    EXPECT_EQ(freedoms(scene), 6 + 1);
    validate(scene);
    scene = free;
    add_universal(scene, 0, 1, position, 0.1 * x, 7 * y);
    EXPECT_EQ(freedoms(scene), 6 + 2);
    validate(scene);
    scene = free;
    add_prismatic(scene, 0, 1, position, 3 * x);
    EXPECT_EQ(freedoms(scene), 6 + 1);
    validate(scene);
  }
}

// What a joint allows, by any amount, violates nothing; what it forbids does. Tolerance: roundings of weights
// of order ten.
TEST(Joints, AllowWhatTheyAreNamedFor) {
  test::Random random(45);
  for (int round = 0; round < 20; ++round) {
    const Scene free = two_bodies(random);
    const auto [at, x, y, z] = random_place(random);
    const Vec3 position = at;  // clang 14 cannot capture a structured binding
    const auto after = [&](Scene scene, Vec3 axis, double angle, Vec3 shift) {
      move_b(scene, [&](Vec3 p) { return position + turned(p - position, axis, angle) + shift; });
      return worst(scene);
    };
    Scene revolute = free;
    add_revolute(revolute, 0, 1, position, 3 * x);
    Scene universal = free;
    add_universal(universal, 0, 1, position, x, y);
    Scene prismatic = free;
    add_prismatic(prismatic, 0, 1, position, 3 * x);
    for (const double amount : {-2.0, 0.3, 1.0, 3.0}) {
      EXPECT_LE(after(revolute, x, amount, {}), 1e-11);
      EXPECT_LE(after(universal, x, amount, {}), 1e-11);
      EXPECT_LE(after(universal, y, amount, {}), 1e-11);
      EXPECT_LE(after(prismatic, x, 0, amount * x), 1e-11);
    }
    EXPECT_GT(after(revolute, y, 0.3, {}), 1e-3);
    EXPECT_GT(after(revolute, x, 0, 0.3 * x), 1e-3);
    EXPECT_GT(after(universal, z, 0.3, {}), 1e-3);
    EXPECT_GT(after(prismatic, x, 0.3, {}), 1e-3);
    EXPECT_GT(after(prismatic, y, 0.3, {}), 1e-3);
    EXPECT_GT(after(prismatic, x, 0, 0.3 * z), 1e-3);
  }
}

TEST(Joints, RefuseNonsense) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0};
  EXPECT_EQ(refusal([&](Scene& s) { add_revolute(s, 0, 2, {}, x); }),
            "body 2 does not exist (the scene has 2 bodies)");
  EXPECT_EQ(refusal([&](Scene& s) { add_prismatic(s, 1, 1, {}, x); }), "body 1: a joint needs two bodies");
  EXPECT_EQ(refusal([&](Scene& s) {
              add_prismatic(s, 0, 1, {nan, 0, 0}, x);
            }),
            "joint of bodies 0 and 1: position is not finite");
  EXPECT_EQ(refusal([](Scene& s) { add_revolute(s, 0, 1, {}, {}); }),
            "axis must be finite and of a length above zero");
  EXPECT_EQ(refusal([&](Scene& s) {
              add_universal(s, 0, 1, {}, x, {nan, 0, 0});
            }),
            "axis_b must be finite and of a length above zero");
  EXPECT_EQ(refusal([&](Scene& s) {
              add_universal(s, 0, 1, {}, x, Vec3{0.75, 0, 0} + y);
            }),
            "joint of bodies 0 and 1: axes must be at right angles, their cosine is 0.6000000000000001");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
