// Vectors of three numbers, and which plumb this is.

#include "plumb/vec3.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "plumb/error.hpp"
#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/version.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

// To the rounding of some ten operations on numbers of about 1.
TEST(Vec3, ProductsObeyLagrangesIdentity) {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = test::random_vector(random), b = test::random_vector(random), c = cross(a, b);
    EXPECT_NEAR(dot(c, c) + dot(a, b) * dot(a, b), dot(a, a) * dot(b, b), 1e-15);
    EXPECT_NEAR(dot(c, a), 0, 1e-15);
    EXPECT_EQ(cross(b, a), -1 * c);
    EXPECT_NEAR(norm(a) * norm(a), dot(a, a), 1e-15);
  }
}

TEST(Vec3, AxesAreRightHanded) {
  EXPECT_EQ(cross({1, 0, 0}, {0, 1, 0}), (Vec3{0, 0, 1}));
}

TEST(Vec3, IsFiniteInAllComponentsOrNot) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(is_finite(Vec3{1, -2, 1e308}));
  EXPECT_FALSE(is_finite(Vec3{infinity, 0, 0}));
  EXPECT_FALSE(is_finite(Vec3{0, infinity - infinity, 0}));
  EXPECT_FALSE(is_finite(Vec3{0, 0, -infinity}));
}

TEST(Version, IsThatOfTheHeaders) {
  const std::string wanted = std::to_string(PLUMB_VERSION_MAJOR) + "." + std::to_string(PLUMB_VERSION_MINOR) +
                             "." + std::to_string(PLUMB_VERSION_PATCH);
  EXPECT_EQ(version(), wanted);
}

// An exception that is shown is recognised by its type in whatever object it was thrown: the library's by
// itself and by its base, and one that a program derives from it.
struct PLUMB_VISIBLE Shown : InputError {
  using InputError::InputError;
};
TEST(Export, ExceptionsAreRecognised) {
  EXPECT_THROW(throw Shown("a"), InputError);
  Scene scene;
  scene.drag = -1;
  EXPECT_THROW(validate(scene), InputError);
  EXPECT_THROW(validate(scene), std::exception);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
