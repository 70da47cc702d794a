#include "plumb/measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

// Expected values below are worked out by hand from small whole numbers; EXPECT_DOUBLE_EQ (4 ulp) is what
// rounding of a few operations leaves.

Particle movable_at(Vec3 position, double mass) {
  return {.position = position, .velocity = {}, .mass = mass, .fixed = false};
}
Particle fixed_at(Vec3 position) {
  return {.position = position, .velocity = {}, .mass = 0, .fixed = true};
}

/// Fixed at the origin, 2 kg at (1, 0, 0), 3 kg at (1, -1, 0); two massless rods of 1 m; gravity 10 m/s²
/// down.
Scene elbow() {
  Scene scene;
  scene.particles = {fixed_at({0, 0, 0}), movable_at({1, 0, 0}, 2), movable_at({1, -1, 0}, 3)};
  scene.rods = {{.a = 0, .b = 1}, {.a = 2, .b = 1, .length = 1}};
  scene.gravity = {0, -10, 0};
  return scene;
}

// Elastic rods have energy, slack cables and broken rods have none, nor strain.
TEST(Stretch, IsOfWhatPulls) {
  Scene scene = elbow();
  const std::vector<Vec3> x{{0, 0, 0}, {3, 0, 0}, {3, -0.5, 0}}, v(3);
  scene.rods[0].law = {.stiffness = 6};
  scene.rods[1].law = {.stiffness = 8, .one_sided = true};
  EXPECT_DOUBLE_EQ(measure_energy(scene, x, v).elastic, 12) << "6 N/m over 2 m; the other is slack";
  EXPECT_DOUBLE_EQ(measure_stretch(scene, x).rms, std::sqrt(2.0));
  scene.rods[0].law = {.stiffness = 0};
  EXPECT_EQ(measure_energy(scene, x, v).elastic, 0);
  EXPECT_EQ(measure_stretch(scene, x).max, 0);
}

TEST(Stretch, IsZeroAtRest) {
  const Scene scene = elbow();
  const Stretch stretch = measure_stretch(scene, std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  EXPECT_EQ(stretch.rms, 0);
  EXPECT_EQ(stretch.max, 0);
  EXPECT_EQ(measure_stretch(Scene{}, {}).rms, 0);
}

TEST(Stretch, IsRelativeAndNamesTheRod) {
  // Rod 0 is 1.5 m instead of 1 m, rod 1 is 1 m instead of 4 m.
  Scene scene = elbow();
  scene.rods[1].length = 4;
  const Stretch stretch = measure_stretch(scene, std::vector<Vec3>{{0, 0, 0}, {0, 1.5, 0}, {0, 2.5, 0}});
  EXPECT_DOUBLE_EQ(stretch.max, 0.75);
  EXPECT_EQ(stretch.max_rod, 1u);
  EXPECT_DOUBLE_EQ(stretch.rms, std::sqrt((0.5 * 0.5 + 0.75 * 0.75) / 2));
}

TEST(Stretch, DoesNotHideARodGoneBad) {
  Scene scene = elbow();
  scene.particles.push_back(movable_at({2, 0, 0}, 1));
  scene.rods.push_back({.a = 1, .b = 3});
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Stretch stretch =
      measure_stretch(scene, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, nan, 0}, {9, 0, 0}});
  EXPECT_TRUE(std::isnan(stretch.max));
  EXPECT_TRUE(std::isnan(stretch.rms));
  EXPECT_EQ(stretch.max_rod, 1u);
}

TEST(EnergyOfAScene, CountsMovableMass) {
  const Scene scene = elbow();
  const std::vector<Vec3> positions{{0, 100, 0}, {1, 2, 0}, {1, -1, 5}};
  const std::vector<Vec3> velocities{{7, 7, 7}, {1, 2, 2}, {0, 0, -4}};
  const Energy energy = measure_energy(scene, positions, velocities);
  EXPECT_DOUBLE_EQ(energy.kinetic, 0.5 * 2 * 9 + 0.5 * 3 * 16);
  EXPECT_DOUBLE_EQ(energy.potential, 10 * (2 * 2 + 3 * -1));
  EXPECT_DOUBLE_EQ(energy.total(), 33 + 10);
}

TEST(EnergyOfAScene, CountsHalfOfEachRodAtAMovableEnd) {
  Scene scene = elbow();
  scene.rods[0].mass = 4;  // half of it at the fixed end
  const Energy energy =
      measure_energy(scene, std::vector<Vec3>{{}, {0, 1, 0}, {}}, std::vector<Vec3>{{}, {3, 0, 0}, {}});
  EXPECT_DOUBLE_EQ(energy.kinetic, 0.5 * (2 + 2) * 9);
  EXPECT_DOUBLE_EQ(energy.potential, 10 * (2 + 2) * 1);
}

TEST(EnergyRange, IsWeightTimesDiagonal) {
  Scene scene = elbow();
  scene.particles[0].mass = 1000;  // of a fixed particle: ignored
  EXPECT_DOUBLE_EQ(energy_range(scene), 5 * 10 * std::sqrt(2));
  scene.rods[0].mass = 1;
  EXPECT_DOUBLE_EQ(energy_range(scene), 6 * 10 * std::sqrt(2));
}

TEST(MomentumOfAScene, IsThatOfTheMovableParticles) {
  const Scene scene = elbow();
  const std::vector<Vec3> positions{{9, 9, 9}, {1, 0, 0}, {0, 2, 0}};
  const std::vector<Vec3> velocities{{9, 9, 9}, {0, 1, 0}, {0, 0, 2}};
  const Momentum momentum = measure_momentum(scene, positions, velocities);
  EXPECT_EQ(momentum.linear, (Vec3{0, 2, 6}));
  EXPECT_EQ(momentum.angular, (Vec3{12, 0, 2}));  // (0,2,0) × (0,0,6) + (1,0,0) × (0,2,0)
  EXPECT_DOUBLE_EQ(momentum.center_of_mass.x, 2.0 / 5);
  EXPECT_DOUBLE_EQ(momentum.center_of_mass.y, 6.0 / 5);
}

TEST(MomentumOfAScene, IsZeroWithoutMovableParticles) {
  Scene scene;
  scene.particles = {fixed_at({1, 1, 1})};
  const Momentum momentum =
      measure_momentum(scene, std::vector<Vec3>{{1, 1, 1}}, std::vector<Vec3>{{1, 0, 0}});
  EXPECT_EQ(momentum.linear, Vec3{});
  EXPECT_EQ(momentum.center_of_mass, Vec3{});
}

/// A body of random weight, on particles of its own or (`given`) on others, and how it moves.
struct Spinning {
  Scene scene;
  MassProperties weight;
  Vec3 velocity, spin;
  std::vector<Vec3> positions, velocities;
};
Spinning random_spinning(test::Random& random, bool given) {
  Spinning s;
  std::vector<PointMass> points;
  for (int i = 0; i < 6; ++i)
    points.push_back({test::random_vector(random), 0.6 + 0.5 * test::signed_unit(random)});
  s.weight = mass_properties(points);
  if (given) {
    for (const Vec3 corner : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, 1.5}})
      s.scene.particles.push_back({.position = corner + 0.2 * test::random_vector(random)});
    add_body(s.scene, {0, 1, 2, 3}, s.weight);
  } else {
    add_body(s.scene, s.weight);
  }
  s.velocity = test::random_vector(random);
  s.spin = test::random_vector(random);
  for (const Particle& particle : s.scene.particles) {
    s.positions.push_back(particle.position);
    s.velocities.push_back(s.velocity + cross(s.spin, particle.position - s.weight.center));
  }
  return s;
}

Vec3 times(const Inertia& i, Vec3 v) {
  return {i.xx * v.x + i.xy * v.y + i.xz * v.z, i.xy * v.x + i.yy * v.y + i.yz * v.z,
          i.xz * v.x + i.yz * v.y + i.zz * v.z};
}

// Half m v^2 + half w.I.w, m v, c x m v + I w and m g·c, in both mass models: the matrix of a body is exact.
// Tolerance: a hundred roundings of numbers of order ten.
TEST(Measures, OfASpinningBodyAreThoseOfTheSolid) {
  test::Random random(31);
  for (int round = 0; round < 100; ++round) {
    const auto [scene, weight, velocity, spin, positions, velocities] =
        random_spinning(random, round % 2 == 0);
    const Vec3 linear = weight.mass * velocity;
    const Vec3 turning = times(weight.inertia, spin);
    for (const MassModel model : {MassModel::lumped, MassModel::consistent}) {
      const Energy energy = measure_energy(scene, positions, velocities, model);
      EXPECT_NEAR(energy.kinetic, 0.5 * dot(linear, velocity) + 0.5 * dot(spin, turning), 1e-12);
      EXPECT_NEAR(energy.potential, -weight.mass * dot(scene.gravity, weight.center), 1e-12);
      const Momentum momentum = measure_momentum(scene, positions, velocities, model);
      EXPECT_LE(norm(momentum.linear - linear), 1e-12);
      EXPECT_LE(norm(momentum.angular - cross(weight.center, linear) - turning), 1e-12);
      EXPECT_LE(norm(momentum.center_of_mass - weight.center), 1e-12);
    }
  }
}

// A body that turns about a fixed corner, whose velocity is zero: still all of its kinetic energy.
TEST(Measures, OfABodyOnAFixedParticleHaveItsEnergy) {
  test::Random random(32);
  Spinning s = random_spinning(random, true);
  const Vec3 pivot = s.positions[0];
  s.scene.particles[0].fixed = true;
  for (std::size_t i = 0; i < 4; ++i) s.velocities[i] = cross(s.spin, s.positions[i] - pivot);
  const Inertia about_pivot = inertia_about(s.weight, s.weight.center - pivot);
  EXPECT_NEAR(measure_energy(s.scene, s.positions, s.velocities).kinetic,
              0.5 * dot(s.spin, times(about_pivot, s.spin)), 1e-12);
}

TEST(EnergyRange, CountsBodies) {
  test::Random random(33);
  const Spinning s = random_spinning(random, false);
  EXPECT_DOUBLE_EQ(energy_range(s.scene), s.weight.mass * 9.81 * bounding_diagonal(s.scene));
}

TEST(RmsDistance, IsInMetres) {
  const std::vector<Vec3> truth{{0, 0, 0}, {1, 1, 1}};
  EXPECT_DOUBLE_EQ(rms_distance(std::vector<Vec3>{{3, 0, 4}, {1, 1, 1}}, truth), std::sqrt(25.0 / 2));
  EXPECT_EQ(rms_distance(truth, truth), 0);
  EXPECT_EQ(rms_distance({}, {}), 0);
}

TEST(Measures, RefuseStateOfAnotherSize) {
  const Scene scene = elbow();
  const std::vector<Vec3> three(3);
  const std::vector<Vec3> two(2);
  EXPECT_THROW(measure_stretch(scene, two), InputError);
  EXPECT_THROW(measure_energy(scene, two, three), InputError);
  EXPECT_THROW(measure_energy(scene, three, two), InputError);
  EXPECT_THROW(measure_momentum(scene, three, two), InputError);
  EXPECT_THROW(rms_distance(two, three), InputError);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
