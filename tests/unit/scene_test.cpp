#include "plumb/scene.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"
#include "support/random_trees.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Particle movable_at(Vec3 position, double mass) {
  return {.position = position, .velocity = {}, .mass = mass, .fixed = false};
}
Particle fixed_at(Vec3 position) {
  return {.position = position, .velocity = {}, .mass = 0, .fixed = true};
}

/// Particle 0 fixed at the origin, 1 to 3 along +x at 1 m; rods 0 to 2 between them.
Scene chain() {
  Scene scene;
  scene.particles.push_back(fixed_at({0, 0, 0}));
  for (int i = 1; i <= 3; ++i) scene.particles.push_back(movable_at({1.0 * i, 0, 0}, 1));
  for (std::uint32_t i = 0; i < 3; ++i) scene.rods.push_back({.a = i, .b = i + 1});
  return scene;
}

/// The message of the InputError that validate() throws after `change`, or empty if it throws none.
std::string refusal(const std::function<void(Scene&)>& change) {
  Scene scene = chain();
  change(scene);
  return test::refusal([&] { validate(scene); });
}

TEST(Scene, GoodOnesAreAccepted) {
  EXPECT_NO_THROW(validate(Scene{}));
  EXPECT_NO_THROW(validate(chain()));
  // A mass of the rods' alone, and a fixed particle whose mass is ignored.
  EXPECT_EQ(refusal([](Scene& s) {
              s.particles[3].mass = 0;
              s.rods[2].mass = 0.5;
              s.particles[0].mass = infinity;
            }),
            "");
}

TEST(Scene, SurroundingsAreFinite) {
  EXPECT_EQ(refusal([](Scene& s) { s.gravity.y = nan; }), "gravity is not finite: (0, nan, 0)");
  EXPECT_EQ(refusal([](Scene& s) { s.drag = infinity; }), "drag is not finite: inf");
  EXPECT_EQ(refusal([](Scene& s) { s.drag = -0.5; }), "drag is negative (-0.5 per second)");
}

TEST(Scene, ParticlesAreFinite) {
  EXPECT_EQ(refusal([](Scene& s) { s.particles[2].position.x = nan; }),
            "particle 2: position is not finite: (nan, 0, 0)");
  EXPECT_EQ(refusal([](Scene& s) { s.particles[0].position.z = -infinity; }),
            "particle 0: position is not finite: (0, 0, -inf)");
  EXPECT_EQ(refusal([](Scene& s) { s.particles[1].velocity.y = infinity; }),
            "particle 1: velocity is not finite: (0, inf, 0)");
  EXPECT_EQ(refusal([](Scene& s) { s.particles[3].mass = nan; }), "particle 3: mass is not finite: nan");
  EXPECT_EQ(refusal([](Scene& s) { s.particles[3].mass = infinity; }), "particle 3: mass is not finite: inf");
}

TEST(Scene, MassesArePositive) {
  EXPECT_EQ(refusal([](Scene& s) { s.particles[3].mass = -2; }), "particle 3: mass is negative (-2 kg)");
  EXPECT_EQ(refusal([](Scene& s) { s.particles[3].mass = 0; }),
            "particle 3: has no mass, neither its own nor from a rod, and is not fixed");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].mass = -1; }), "rod 1: mass is negative (-1 kg)");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].mass = nan; }), "rod 1: mass is not finite: nan");
  EXPECT_EQ(refusal([](Scene& s) {
              s.particles[2].mass = std::numeric_limits<double>::max();
              s.rods[1].mass = s.rods[2].mass = std::numeric_limits<double>::max();
            }),
            "particle 2: mass with its share of its rods is not finite");
}

TEST(Scene, RodsJoinTwoParticlesThatExist) {
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].b = 4; }),
            "rod 1: particle 4 does not exist (the scene has 4 particles)");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[0].a = 4'000'000'000u; }),
            "rod 0: particle 4000000000 does not exist (the scene has 4 particles)");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].b = 1; }), "rod 1: both ends are particle 1");
}

TEST(Scene, RodsHaveALength) {
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].length = -1; }), "rod 2: length is negative (-1 m)");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].length = nan; }), "rod 2: length is not finite: nan");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].length = infinity; }), "rod 2: length is not finite: inf");
  EXPECT_EQ(
      refusal([](Scene& s) { s.particles[3].position = s.particles[2].position; }),
      "rod 2: length is zero, no length is given and its ends (particles 2 and 3) are at the same place");
  EXPECT_EQ(refusal([](Scene& s) {
              s.particles[3].position = s.particles[2].position;
              s.rods[2].length = 1;
            }),
            "");
  // A distance whose square overflows.
  EXPECT_EQ(refusal([](Scene& s) { s.particles[3].position.y = 1e200; }), "rod 2: length is not finite: inf");
}

TEST(Scene, ARodHasAMovableEnd) {
  EXPECT_EQ(refusal([](Scene& s) {
              s.particles[3].fixed = true;
              s.rods.push_back({.a = 0, .b = 3});
            }),
            "rod 3: both ends (particles 0 and 3) are fixed");
}

TEST(Scene, RodsAreNotDuplicated) {
  EXPECT_EQ(refusal([](Scene& s) { s.rods.push_back({.a = 1, .b = 2}); }),
            "rod 3: joins the same particles (1 and 2) as rod 1");
  EXPECT_EQ(refusal([](Scene& s) { s.rods.push_back({.a = 2, .b = 1, .length = 5}); }),
            "rod 3: joins the same particles (2 and 1) as rod 1");
}

TEST(Scene, RodsHaveDragOfTheAir) {
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].linear_drag = -1; }),
            "rod 1: drag must be finite and not negative, got -1 per second");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].orthogonal_drag = nan; }),
            "rod 2: drag must be finite and not negative, got nan per second");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[0].mass = 0, s.rods[0].linear_drag = 1; }),
            "rod 0: has drag of the air, but no mass of its own for it to act on");
}

TEST(Scene, BendsLieBetweenRods) {
  const auto with = [](Bend bend) {
    return refusal([=](Scene& s) { s.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = 1}, bend}; });
  };
  EXPECT_EQ(with({.a = 3, .b = 2, .c = 1, .stiffness = 1}), "");
  EXPECT_EQ(with({.a = 1, .b = 2, .c = 9, .stiffness = 1}),
            "bend 1: particle 9 does not exist (the scene has 4 particles)");
  EXPECT_EQ(with({.a = 1, .b = 2, .c = 1, .stiffness = 1}),
            "bend 1: needs three different particles, got 1, 2 and 1");
  EXPECT_EQ(with({.a = 1, .b = 3, .c = 2, .stiffness = 1}),
            "bend 1: no rod joins particles 1 and 3; only fixed particles need none");
  EXPECT_EQ(with({.a = 1, .b = 2, .c = 3, .stiffness = infinity}),
            "bend 1: stiffness must be finite and not negative, got inf N m");
  EXPECT_EQ(with({.a = 1, .b = 2, .c = 3, .stiffness = 1, .damping = -1}),
            "bend 1: damping must be finite and not negative, got -1 N m s");
  EXPECT_EQ(with({.a = 1, .b = 2, .c = 3}),
            "bend 1: has neither stiffness nor damping, so that it holds nothing");
  EXPECT_EQ(with({.a = 1, .b = 2, .c = 3, .stiffness = 1, .angle = 4}),
            "bend 1: angle must be from 0 to 2.89 rad, got 4 rad");
  EXPECT_EQ(with({.a = 2, .b = 1, .c = 0, .damping = 1}), "bend 1: bends the same particles as bend 0");
}

TEST(Scene, AnEndIsClampedByTwoFixedParticles) {
  const auto with = [](Vec3 position, std::uint32_t last) {
    return refusal([=](Scene& s) {
      s.particles.push_back(fixed_at(position));
      s.particles.push_back(fixed_at({0, 1, 0}));
      s.bends = {{.a = 4, .b = 0, .c = last, .stiffness = 1}};
    });
  };
  EXPECT_EQ(with({-1, 0, 0}, 1), "");
  EXPECT_EQ(with({0, 0, 0}, 1), "bend 0: fixed particles 4 and 0 are at the same place");
  EXPECT_EQ(with({-1, 0, 0}, 5), "bend 0: all of its particles (4, 0 and 5) are fixed");
}

TEST(Scene, TwistsLieAlongRods) {
  const auto with = [](Twist twist) { return refusal([=](Scene& s) { s.twists = {twist}; }); };
  EXPECT_EQ(with({.particles = {0, 1, 2}, .stiffness = 1, .angle = 100}), "");
  EXPECT_EQ(with({.particles = {0, 1}, .stiffness = 1}),
            "twist 0: needs a chain of three particles or more, got 2");
  EXPECT_EQ(with({.particles = {0, 1, 9}, .stiffness = 1}),
            "twist 0: particle 9 does not exist (the scene has 4 particles)");
  EXPECT_EQ(with({.particles = {0, 1, 0}, .stiffness = 1}),
            "twist 0: a ring needs three different particles");
  EXPECT_EQ(with({.particles = {0, 1, 2, 1}, .stiffness = 1}), "twist 0: goes through particle 1 twice");
  EXPECT_EQ(with({.particles = {0, 1, 3}, .stiffness = 1}),
            "twist 0: no rod joins particles 1 and 3; only fixed particles need none");
  EXPECT_EQ(with({.particles = {0, 1, 2}}), "twist 0: stiffness must be positive and finite, got 0 N m^2");
  EXPECT_EQ(with({.particles = {0, 1, 2}, .stiffness = 1, .angle = infinity}),
            "twist 0: angle is not finite: inf");
}

TEST(Scene, RodsMayGive) {
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].law.stiffness = -1; }),
            "rod 1: stiffness must be 0 or more, got -1 N/m");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[1].law.stiffness = nan; }),
            "rod 1: stiffness must be 0 or more, got nan N/m");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[0].law = {.stiffness = 1, .damping = -2}; }),
            "rod 0: damping must be finite and not negative, got -2 N s/m");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[0].law.damping = 2; }),
            "rod 0: is rigid, so that it has no damping; give it a stiffness");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[0].law.stiffness = 0; }),
            "rod 0: has neither stiffness nor damping, so that it holds nothing");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].law.strength = 0; }),
            "rod 2: strength must be positive, got 0 N");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].law = {.stiffness = 0, .damping = 3, .one_sided = true}; }), "");
  EXPECT_TRUE(RodLaw{}.is_rigid());
  EXPECT_FALSE((RodLaw{.one_sided = true}.is_rigid()));
}

/// The chain with particles 4 to 7 of a body (rods 3 to 8) and one of everything else.
Scene everything() {
  Scene scene = chain();
  add_body(scene, {.mass = 2, .center = {1, 1, 1}, .inertia = {.xx = 2, .yy = 3, .zz = 4}});
  scene.pins = {{point_at(3), point_at(4)}};
  const Direction u{point_at(0), point_at(1)}, v{point_at(4), point_at(5)};
  scene.alignments = {{u, v}};
  scene.angles = {{.u = u, .v = v}};
  scene.capsules = {{.a = point_at(1), .b = point_at(2), .radius = 0.1}};
  scene.planes = {{}};
  scene.boxes = {{.half_size = {1, 1, 1}}};
  return scene;
}

/// The same as refusal(), of a scene that has everything.
std::string refusal_after(const std::function<void(Scene&)>& change) {
  return refusal([&](Scene& s) {
    s = everything();
    change(s);
  });
}

TEST(SceneChecks, GoodOnesAreAccepted) {
  EXPECT_EQ(refusal_after([](Scene&) {}), "");
  // Asleep though fixed, and a limit at either end of what an angle can be.
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.particles[0].asleep = true;
              s.angles[0].upper = std::numbers::pi;
            }),
            "");
  // Weights that are off by rounding, and particles without weight that do not exist.
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.pins[0].a = {.particles = {1, 2, 99, 99}, .weights = {0.5, 0.5 + 1e-10, 0, 0}};
            }),
            "");
}

TEST(SceneChecks, BodiesHaveFourParticles) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].particles[1] = 8; }),
            "body 0: particle 8 does not exist (the scene has 8 particles)");
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].particles[2] = 4; }),
            "body 0: particle 4 is there twice");
  EXPECT_EQ(refusal_after([](Scene& s) {
              for (std::size_t i = 4; i < 8; ++i) s.particles[i].position.z = 0;
            }),
            "body 0: its particles lie in one plane");
  EXPECT_EQ(refusal_after([](Scene& s) { s.rods.erase(s.rods.begin() + 4); }),
            "body 0: no rod keeps its particles 4 and 6 apart");
}

// Between fixed particles there can be no rod, and none is needed.
TEST(SceneChecks, BodiesMayTurnAboutTwoFixedParticles) {
  const auto hinge = [](Scene& s) {
    s.particles[4].fixed = s.particles[6].fixed = true;
    s.rods.erase(s.rods.begin() + 4);
  };
  EXPECT_EQ(refusal_after(hinge), "");
}

TEST(SceneChecks, BodiesWeighWhatSolidsDo) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].mass = 0; }),
            "body 0: mass must be positive and finite, got 0 kg");
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].center.y = nan; }),
            "body 0: center of mass is not finite");
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].inertia.xz = infinity; }),
            "body 0: inertia is not finite");
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].inertia = {.xx = 1, .yy = 1, .zz = 3}; }),
            "body 0: inertia is not that of a solid: a second moment of its mass is negative (-0.5 kg m^2)");
  EXPECT_EQ(
      refusal_after([](Scene& s) { s.bodies[0].inertia = {.xx = 1, .yy = 1, .zz = 0}; }),
      "body 0: inertia is that of a line, which nothing keeps from spinning about itself: a body needs a "
      "thickness of more than 1e-6 of its length, and a rod with mass needs none");
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies[0].inertia = {.xx = 1, .yy = 1, .zz = 2}; }), "");
}

TEST(SceneChecks, ABodysParticlesHaveItsMass) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.bodies.clear(); }),
            "particle 4: has no mass, neither its own nor from a rod, and is not fixed");
}

TEST(SceneChecks, PinsJoinTwoPlaces) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.pins[0].b.particles[0] = 8; }),
            "pin 0, point b: particle 8 does not exist (the scene has 8 particles)");
  EXPECT_EQ(refusal_after([](Scene& s) { s.pins[0].a.weights[0] = nan; }),
            "pin 0, point a: weight is not finite: nan");
  EXPECT_EQ(refusal_after([](Scene& s) { s.pins[0].a.weights[1] = 0.5; }),
            "pin 0, point a: weights must add up to 1, not 1.5");
  EXPECT_EQ(refusal_after([](Scene& s) { s.pins[0].a.weights = {}; }),
            "pin 0, point a: weights must add up to 1, not 0");
  EXPECT_EQ(refusal_after([](Scene& s) { s.pins[0].b = s.pins[0].a; }), "pin 0: both points are the same");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.particles.push_back(fixed_at({5, 5, 5}));
              s.pins[0] = {point_at(0), point_at(8)};
            }),
            "pin 0: all its particles are fixed");
}

TEST(SceneChecks, AlignmentsAreOfSomethingThatMoves) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.alignments[0].v.to.particles[0] = 8; }),
            "alignment 0, v.to: particle 8 does not exist (the scene has 8 particles)");
  EXPECT_EQ(refusal_after([](Scene& s) { s.alignments[0].u.from.weights[0] = 2; }),
            "alignment 0, u.from: weights must add up to 1, not 2");
  EXPECT_EQ(refusal_after([](Scene& s) { s.alignments[0].u.to = s.alignments[0].u.from; }), "");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.alignments[0].u.to = s.alignments[0].u.from;
              s.alignments[0].v.to = s.alignments[0].v.from;
            }),
            "alignment 0: both directions are of length zero");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.particles.push_back(fixed_at({5, 5, 5}));
              s.alignments[0].u = s.alignments[0].v = {point_at(0), point_at(8)};
            }),
            "alignment 0: all its particles are fixed");
  EXPECT_EQ(refusal_after([](Scene& s) { s.alignments[0].value = infinity; }),
            "alignment 0: value is not finite: inf");
}

TEST(SceneChecks, AnglesHaveDirectionsAndLimits) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].u.to = s.angles[0].u.from; }),
            "angle 0, u: is of length zero");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].v.to = s.angles[0].v.from; }),
            "angle 0, v: is of length zero");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].v.to.weights[0] = 0.9; }),
            "angle 0, v.to: weights must add up to 1, not 0.9");
  const std::string limits = "angle 0: limits must be within 0 and pi, the lower below the upper, got ";
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].upper = 4; }), limits + "0 and 4 rad");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].lower = -1; }), limits + "-1 and 3.141592653589793 rad");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].lower = s.angles[0].upper = 1; }),
            limits + "1 and 1 rad");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].target = nan; }),
            "angle 0: target must be within 0 and pi, got nan rad");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].friction = -1; }),
            "angle 0: friction must be finite and not negative, got -1 N m");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].stiffness = infinity; }),
            "angle 0: stiffness must be finite and not negative, got inf N m/rad");
  EXPECT_EQ(refusal_after([](Scene& s) { s.angles[0].damping = nan; }),
            "angle 0: damping must be finite and not negative, got nan N m s/rad");
}

TEST(SceneChecks, ShapesAndGroundHaveSizesAndSurfaces) {
  EXPECT_EQ(refusal_after([](Scene& s) { s.capsules[0].radius = -1; }),
            "capsule 0: radius must be finite and not negative, got -1 m");
  EXPECT_EQ(refusal_after([](Scene& s) { s.capsules[0].b.particles[0] = 8; }),
            "capsule 0, point b: particle 8 does not exist (the scene has 8 particles)");
  EXPECT_EQ(refusal_after([](Scene& s) { s.capsules[0].b = {}; }),
            "capsule 0, point b: has no weights; those of a sphere are those of point a, as sphere_at() has "
            "them");
  EXPECT_EQ(refusal_after([](Scene& s) { s.capsules[0].b.weights = {0.5}; }),
            "capsule 0, point b: weights must add up to 1, not 0.5");
  EXPECT_EQ(refusal_after([](Scene& s) { s.capsules[0].surface.friction = -0.1; }),
            "capsule 0: friction must be finite and not negative, got -0.1");
  EXPECT_EQ(refusal_after([](Scene& s) { s.planes[0].surface.restitution = 1.1; }),
            "plane 0: restitution must be from 0 to 1, got 1.1");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.planes[0].normal = {1, 1, 0};
            }),
            "plane 0: normal must be of length 1, not 1.4142135623730951");
  EXPECT_EQ(refusal_after([](Scene& s) { s.planes[0].offset = infinity; }),
            "plane 0: offset is not finite: inf");
  EXPECT_EQ(refusal_after([](Scene& s) { s.boxes[0].center.x = nan; }), "box 0: center is not finite");
  EXPECT_EQ(refusal_after([](Scene& s) { s.boxes[0].half_size.y = 0; }),
            "box 0: half size must be positive and finite, got 0 m");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.boxes[0].orientation = {1, 0, 0, 1};
            }),
            "box 0: orientation must be a quaternion of length 1, not 1.4142135623730951");
  EXPECT_EQ(refusal_after([](Scene& s) { s.boxes[0].surface.friction = nan; }),
            "box 0: friction must be finite and not negative, got nan");
}

/// A cloud of point masses, and a body of the same weight on four other places.
struct Cloud {
  std::vector<PointMass> points;
  Scene scene;
};
Cloud random_cloud(test::Random& random) {
  Cloud cloud;
  const Vec3 middle = test::random_vector(random);
  for (int i = 0; i < 200; ++i)
    cloud.points.push_back({middle + test::random_vector(random), 0.01 * (1.5 + test::signed_unit(random))});
  const Vec3 origin = test::random_vector(random);
  for (const Vec3 edge : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, 1.5}})
    cloud.scene.particles.push_back({.position = origin + edge + 0.2 * test::random_vector(random)});
  add_body(cloud.scene, {0, 1, 2, 3}, mass_properties(cloud.points));
  return cloud;
}

// M_jk is the sum of m w_j w_k over the cloud, with w the barycentric weights of each point; tolerance: some
// hundred roundings of numbers of order ten.
TEST(BodyMass, IsThatOfItsPoints) {
  test::Random random(21);
  for (int round = 0; round < 20; ++round) {
    const Cloud cloud = random_cloud(random);
    std::array<std::array<double, 4>, 4> expected{};
    for (const PointMass& point : cloud.points) {
      const auto w = point_on_body(cloud.scene, 0, point.position).weights;
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t k = 0; k < 4; ++k) expected[j][k] += point.mass * w[j] * w[k];
    }
    const auto mass = body_mass(cloud.scene, 0);
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(mass[j][k], expected[j][k], 1e-11);
  }
}

TEST(RodLength, DefaultsToTheDistance) {
  Scene scene = chain();
  scene.particles[1].position = {3, 4, 0};
  EXPECT_DOUBLE_EQ(rod_length(scene, 0), 5);
  scene.rods[0].length = 0.25;
  EXPECT_DOUBLE_EQ(rod_length(scene, 0), 0.25);
}

TEST(LumpedMasses, ShareRodsBetweenTheirEnds) {
  Scene scene = chain();
  scene.rods[1].mass = 2;
  scene.rods[2].mass = 0.5;
  const std::vector<double> masses = lumped_masses(scene);
  ASSERT_EQ(masses.size(), 4u);
  EXPECT_EQ(masses[0], infinity);
  EXPECT_DOUBLE_EQ(masses[1], 1 + 1);
  EXPECT_DOUBLE_EQ(masses[2], 1 + 1 + 0.25);
  EXPECT_DOUBLE_EQ(masses[3], 1 + 0.25);
}

TEST(LumpedMasses, ShareBodiesBetweenTheirParticles) {
  Scene scene = everything();
  scene.particles[5].mass = 1;
  const std::vector<double> masses = lumped_masses(scene);
  EXPECT_DOUBLE_EQ(masses[4], 0.5);
  EXPECT_DOUBLE_EQ(masses[5], 1.5);
}

TEST(BoundingDiagonal, SpansAllParticles) {
  EXPECT_EQ(bounding_diagonal(Scene{}), 0);
  Scene scene;
  scene.particles = {movable_at({-1, 5, 2}, 1), movable_at({1, 2, 2}, 1), fixed_at({0, 4, 8})};
  EXPECT_DOUBLE_EQ(bounding_diagonal(scene), 7);  // 2, 3, 6
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
