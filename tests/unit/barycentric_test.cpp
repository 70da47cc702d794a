// Places by their weights on four points.

#include "scene/barycentric.hpp"

#include <gtest/gtest.h>

#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

// To rounding over the volume, which is kept above a hundredth of its largest value.
TEST(Barycentric, WeightsGiveThePlaceBack) {
  test::Random random(2);
  int tried = 0;
  while (tried < 100) {
    const std::array<Vec3, 4> p{test::random_vector(random), test::random_vector(random),
                                test::random_vector(random), test::random_vector(random)};
    if (relative_volume(p) < 0.01) continue;
    ++tried;
    const Barycentric barycentric(p);
    const Vec3 place = 2.0 * test::random_vector(random);
    const std::array<double, 4> w = barycentric.weights(place);
    Vec3 back{}, slope{};
    for (std::size_t i = 0; i < 4; ++i) {
      back += w[i] * p[i];
      slope += barycentric.gradients()[i];
    }
    EXPECT_LE(norm(back - place), 1e-12);
    EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-12);
    EXPECT_LE(norm(slope), 1e-12) << "weights add up to 1 everywhere";
  }
}

TEST(Barycentric, WeightsOfACornerAreItsOwn) {
  const std::array<Vec3, 4> p{Vec3{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 8}};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(Barycentric(p).weights(p[i])[k], i == k ? 1 : 0);
}

TEST(RelativeVolume, IsOfSizeAndPlaceIndependent) {
  const std::array<Vec3, 4> unit{Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::array<Vec3, 4> moved = unit;
  for (Vec3& p : moved) p = Vec3{4, -8, 2} + 16.0 * p;
  // The longest edge is √2, the determinant of the edges 1.
  EXPECT_NEAR(relative_volume(unit), 1 / (2 * std::sqrt(2.0)), 1e-15);
  EXPECT_NEAR(relative_volume(moved), relative_volume(unit), 1e-15);
  EXPECT_EQ(relative_volume({Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), 0);
  EXPECT_EQ(relative_volume({}), 0);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
