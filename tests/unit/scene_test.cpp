#include "plumb/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "plumb/error.hpp"

namespace plumb {
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
  try {
    validate(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
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

TEST(BoundingDiagonal, SpansAllParticles) {
  EXPECT_EQ(bounding_diagonal(Scene{}), 0);
  Scene scene;
  scene.particles = {movable_at({-1, 5, 2}, 1), movable_at({1, 2, 2}, 1), fixed_at({0, 4, 8})};
  EXPECT_DOUBLE_EQ(bounding_diagonal(scene), 7);  // 2, 3, 6
}

}  // namespace
}  // namespace plumb
