#include "plumb/inertia.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

void expect_near(const MassProperties& a, const MassProperties& b, double tolerance) {
  EXPECT_NEAR(a.mass, b.mass, tolerance);
  EXPECT_LE(norm(a.center - b.center), tolerance);
  EXPECT_NEAR(a.inertia.xx, b.inertia.xx, tolerance);
  EXPECT_NEAR(a.inertia.yy, b.inertia.yy, tolerance);
  EXPECT_NEAR(a.inertia.zz, b.inertia.zz, tolerance);
  EXPECT_NEAR(a.inertia.xy, b.inertia.xy, tolerance);
  EXPECT_NEAR(a.inertia.xz, b.inertia.xz, tolerance);
  EXPECT_NEAR(a.inertia.yz, b.inertia.yz, tolerance);
}

/// The solid as a fine lattice of equal points, which converges with the square of its spacing where the
/// surface is flat and a little slower where it is round.
MassProperties lattice(double mass, Vec3 half, const std::function<bool(Vec3)>& inside) {
  constexpr int n = 120;
  std::vector<PointMass> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const auto at = [](double h, int m) { return h * ((2.0 * m + 1) / n - 1); };
        const Vec3 p{at(half.x, i), at(half.y, j), at(half.z, k)};
        if (inside(p)) points.push_back({p, 1});
      }
  for (PointMass& point : points) point.mass = mass / static_cast<double>(points.size());
  return mass_properties(points);
}

TEST(Inertia, OfTwoPoints) {
  const PointMass points[] = {{{1, 2, 3}, 2}, {{3, 2, 3}, 6}};
  const MassProperties got = mass_properties(points);
  EXPECT_EQ(got.mass, 8);
  EXPECT_EQ(got.center, (Vec3{2.5, 2, 3}));
  EXPECT_DOUBLE_EQ(got.inertia.xx, 0);
  EXPECT_DOUBLE_EQ(got.inertia.yy, 2 * 1.5 * 1.5 + 6 * 0.5 * 0.5);
  EXPECT_DOUBLE_EQ(got.inertia.zz, got.inertia.yy);
  EXPECT_EQ(mass_properties({}).mass, 0);
}

// Products of inertia have the signs of eq. 2.13, and the parallel axes bring the tensor back to the origin.
TEST(Inertia, OfPointsOffTheAxes) {
  const PointMass points[] = {{{1, 0, 0}, 1}, {{0, 2, 1}, 3}, {{-1, 1, 2}, 2}};
  const MassProperties body = mass_properties(points);
  const Inertia origin = inertia_about(body, body.center);
  EXPECT_NEAR(origin.xx, 3 * 5 + 2 * 5, 1e-14);
  EXPECT_NEAR(origin.yy, 1 + 3 * 1 + 2 * 5, 1e-14);
  EXPECT_NEAR(origin.zz, 1 + 3 * 4 + 2 * 2, 1e-14);
  EXPECT_NEAR(origin.xy, 2, 1e-14);
  EXPECT_NEAR(origin.xz, 4, 1e-14);
  EXPECT_NEAR(origin.yz, -(3 * 2 + 2 * 2), 1e-14);
}

// Against the integrals as sums; the tolerance is what a lattice of 120 points a side leaves on round
// surfaces.
TEST(Inertia, OfSolidsIsThatOfTheirPoints) {
  const auto radius2 = [](Vec3 p) { return p.y * p.y + p.z * p.z; };
  expect_near(solid_box(3, {0.4, 0.6, 1}), lattice(3, {0.2, 0.3, 0.5}, [](Vec3) { return true; }), 1e-4);
  expect_near(solid_sphere(2, 0.5), lattice(2, {0.5, 0.5, 0.5}, [](Vec3 p) { return dot(p, p) <= 0.25; }),
              1e-3);
  expect_near(solid_cylinder(2, 0.3, 1.2),
              lattice(2, {0.6, 0.3, 0.3}, [&](Vec3 p) { return radius2(p) <= 0.09; }), 1e-3);
  expect_near(solid_capsule(2, 0.3, 0.8),
              lattice(2, {0.7, 0.3, 0.3},
                      [&](Vec3 p) {
                        const double out = std::max(std::abs(p.x) - 0.4, 0.0);
                        return radius2(p) + out * out <= 0.09;
                      }),
              1e-3);
}

// A solid along y has the moments of y and x swapped, and one along (1, 2, 2)/3 is turned there: its moments
// along and across that axis stay.
TEST(Inertia, OfSolidsBetweenPlacesIsTurned) {
  const MassProperties along_x = solid_capsule(2, 0.3, 0.9);
  const MassProperties upright = solid_capsule(2, 0.3, {1, 1, 1}, {1, 1.9, 1});
  EXPECT_LE(norm(upright.center - Vec3{1, 1.45, 1}), 1e-15);
  EXPECT_NEAR(upright.inertia.yy, along_x.inertia.xx, 1e-15);
  EXPECT_NEAR(upright.inertia.xx, along_x.inertia.yy, 1e-15);
  EXPECT_NEAR(upright.inertia.zz, along_x.inertia.yy, 1e-15);
  EXPECT_EQ(upright.inertia.xy, 0);
  const Inertia slanted = solid_capsule(2, 0.3, {0, 0, 0}, {0.3, 0.6, 0.6}).inertia;
  const auto about = [&](Vec3 u) {
    return slanted.xx * u.x * u.x + slanted.yy * u.y * u.y + slanted.zz * u.z * u.z +
           2 * (slanted.xy * u.x * u.y + slanted.xz * u.x * u.z + slanted.yz * u.y * u.z);
  };
  EXPECT_NEAR(about({1.0 / 3, 2.0 / 3, 2.0 / 3}), along_x.inertia.xx, 1e-15);
  EXPECT_NEAR(about({2.0 / 3, 1.0 / 3, -2.0 / 3}), along_x.inertia.yy, 1e-15);
  EXPECT_NEAR(about({-2.0 / 3, 2.0 / 3, -1.0 / 3}), along_x.inertia.yy, 1e-15);
  EXPECT_NEAR(solid_cylinder(2, 0.3, {0, 0, 5}, {0, 0, 4}).inertia.zz, 0.09, 1e-15);
  EXPECT_THROW(solid_cylinder(1, 1, {1, 2, 3}, {1, 2, 3}), InputError);
  EXPECT_THROW(solid_capsule(1, 1, {std::nan(""), 2, 3}, {1, 2, 3}), InputError);
}

// A long thin cylinder and a long thin capsule are a slender rod, m L^2 / 12.
TEST(Inertia, OfThinSolidsIsThatOfARod) {
  EXPECT_NEAR(solid_cylinder(3, 1e-6, 2).inertia.yy, 1, 1e-10);
  EXPECT_NEAR(solid_capsule(3, 1e-6, 2).inertia.yy, 1, 1e-5);
}

/// A cloud of random points with random masses, flattened along z.
std::vector<PointMass> cloud(test::Random& random, double thickness) {
  std::vector<PointMass> points;
  const Vec3 middle = test::random_vector(random);
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = test::random_vector(random);
    points.push_back({middle + Vec3{p.x, 2 * p.y, thickness * p.z}, 1.5 + test::signed_unit(random)});
  }
  return points;
}

// Tolerance: a few roundings of numbers up to 100.
TEST(FourPoints, WeighWhatTheBodyDoes) {
  test::Random random(5);
  for (int round = 0; round < 50; ++round) {
    const MassProperties body = mass_properties(cloud(random, round % 5 == 0 ? 0 : 0.1 * round));
    const auto points = four_points(body);
    for (const PointMass& point : points) EXPECT_DOUBLE_EQ(point.mass, body.mass / 4);
    expect_near(mass_properties(points), body, 1e-12);
  }
}

TEST(FourPoints, OfARodAreOnItsLine) {
  const MassProperties rod{.mass = 3, .center = {1, 2, 3}, .inertia = {.xx = 0, .yy = 1, .zz = 1}};
  const auto points = four_points(rod);
  expect_near(mass_properties(points), rod, 1e-14);
  for (const PointMass& point : points) EXPECT_NEAR(point.position.y, 2, 1e-14);
}

TEST(FourPoints, RefuseWhatNoBodyWeighs) {
  const auto refusal = [](const MassProperties& body) -> std::string {
    try {
      four_points(body);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal({.mass = 0}), "mass must be positive and finite, got 0 kg");
  EXPECT_EQ(refusal({.mass = 1, .center = {nan, 0, 0}}), "center of mass is not finite");
  EXPECT_EQ(refusal({.mass = 1, .inertia = {.xz = nan}}), "inertia is not finite");
  EXPECT_EQ(refusal({.mass = 1, .inertia = {.xx = 1, .yy = 1, .zz = 3}}),
            "inertia is that of no body: a second moment of its mass is negative (-0.5 kg m^2)");
}

TEST(Inertia, RefusesNonsense) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solid_sphere(1, 0), InputError);
  EXPECT_THROW(solid_sphere(-1, 1), InputError);
  EXPECT_THROW(solid_box(1, {1, nan, 1}), InputError);
  EXPECT_THROW(solid_cylinder(nan, 1, 1), InputError);
  EXPECT_THROW(solid_capsule(1, 1, -1), InputError);
  const PointMass bad[] = {{{0, 0, 0}, 1}, {{nan, 0, 0}, 1}};
  try {
    mass_properties(bad);
    FAIL() << "accepted a position that is not finite";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "point 1: position is not finite");
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
