// Matrices of 3 x 3, turns, and second moments: against Eigen and against each other.

#include "reference/multipliers/small_matrices.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "reference/featherstone/turning.hpp"
#include "scene/second_moments.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

Eigen::Matrix3d to_eigen(const Mat3& m) {
  Eigen::Matrix3d out;
  out << m.x.x, m.y.x, m.z.x, m.x.y, m.y.y, m.z.y, m.x.z, m.y.z, m.z.z;
  return out;
}

Sym3 random_positive(test::Random& random) {
  Sym3 m = Sym3::diagonal(0.1);
  for (int i = 0; i < 3; ++i) m += outer(1, test::random_vector(random));
  return m;
}

// Tolerances are rounding times the condition of 0.1 against about 3.
TEST(SmallMatrices, InverseTimesMatrixIsOne) {
  test::Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Sym3 m = random_positive(random);
    const Eigen::Matrix3d product = to_eigen(full(m)) * to_eigen(full(inverse(m)));
    EXPECT_LE((product - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
}

// To the rounding of some ten products of numbers below 1.
TEST(SmallMatrices, ProductsAreEigens) {
  test::Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Mat3 a{test::random_vector(random), test::random_vector(random), test::random_vector(random)};
    const Mat3 b{test::random_vector(random), test::random_vector(random), test::random_vector(random)};
    const Vec3 v = test::random_vector(random), w = test::random_vector(random);
    EXPECT_LE((to_eigen(a * b) - to_eigen(a) * to_eigen(b)).norm(), 4e-15);
    EXPECT_LE(norm(transposed_times(a, v) - transposed(a) * v), 4e-15);
    EXPECT_LE(norm(cross_matrix(v) * w - cross(v, w)), 4e-15);
    EXPECT_LE(norm(outer(v, w) * v - dot(w, v) * v), 4e-15);
    EXPECT_LE(norm(outer_both(v, w) * v - (dot(w, v) * v + dot(v, v) * w)), 4e-15);
    EXPECT_EQ(trace(outer(2, v)), trace(symmetric(full(outer(2, v)))));
  }
}

TEST(SmallMatrices, LoadAndStoreAreInverse) {
  double three[4] = {1, 2, 3, 4};
  store3(three, load3(three + 1));
  EXPECT_EQ(load3(three), (Vec3{2, 3, 4}));
}

// A quaternion of any length is the turn that Rodrigues' formula makes of its axis and angle.
TEST(Turning, QuaternionsAreRodriguesTurns) {
  test::Random random(5);
  for (int i = 0; i < 50; ++i) {
    Vec3 axis = test::random_vector(random);
    axis = (1 / norm(axis)) * axis;
    const double angle = 3 * test::signed_unit(random), length = 0.5 + std::abs(test::signed_unit(random));
    const Quaternion q{length * std::cos(angle / 2), length * std::sin(angle / 2) * axis};
    const Eigen::Matrix3d turn = to_eigen(rotation(q));
    EXPECT_LE((turn - to_eigen(rotation(axis, angle))).norm(), 1e-14);
    EXPECT_LE((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LE(norm(first_axis(q, 2 / norm2(q)) - rotation(q).x), 1e-15);
    EXPECT_LE(norm(rotation(q) * axis - axis), 1e-14);
  }
}

TEST(Turning, InertiaOfAPointIsThatOfItsMassAcross) {
  test::Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Vec3 c = test::random_vector(random), w = test::random_vector(random);
    // Energy of a turn by w: m |w x c|²/2.
    EXPECT_NEAR(dot(w, point_inertia(3, c) * w), 3 * dot(cross(w, c), cross(w, c)), 1e-14);
  }
}

// A tensor of inertia is made of second moments, tr(S) 1 - S, and second_moments() takes it apart again.
TEST(SecondMoments, AreWhatInertiaIsMadeOf) {
  test::Random random(7);
  for (int i = 0; i < 50; ++i) {
    const Sym3 s = random_positive(random), j = Sym3::diagonal(trace(s)) - s;
    const Sym3 back =
        second_moments({.xx = j.xx, .yy = j.yy, .zz = j.zz, .xy = j.xy, .xz = j.xz, .yz = j.yz});
    EXPECT_LE(norm(back * Vec3{1, 2, 3} - s * Vec3{1, 2, 3}), 1e-13);
  }
}

TEST(SecondMoments, PrincipalAxesDiagonalise) {
  test::Random random(8);
  for (int i = 0; i < 50; ++i) {
    const Sym3 s = random_positive(random);
    const Principal principal = principal_axes(s);
    EXPECT_LE(principal.moment[0], principal.moment[1]);
    EXPECT_LE(principal.moment[1], principal.moment[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(norm(s * principal.axis[k] - principal.moment[k] * principal.axis[k]), 1e-13);
      EXPECT_NEAR(dot(principal.axis[k], principal.axis[(k + 1) % 3]), 0, 1e-13);
      EXPECT_NEAR(norm(principal.axis[k]), 1, 1e-13);
    }
  }
  EXPECT_FALSE(is_finite(Inertia{.xx = 1, .yy = 1, .zz = 1, .xz = INFINITY}));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
