// Bodies that are flat or thin: where their four particles are, and when their mass matrix is singular.

#include "scene/flat/flat_bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plumb/joints.hpp"
#include "plumb/measures.hpp"
#include "scene/barycentric.hpp"
#include "support/bodies.hpp"
#include "support/random_trees.hpp"
#include "support/refusals.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// A body of 2 kg whose mass reaches so far along three axes at right angles (m, standard deviations).
MassProperties reaching(double x, double y, double z) {
  return {.mass = 2,
          .center = {1, -2, 3},
          .inertia = {.xx = 2 * (y * y + z * z), .yy = 2 * (x * x + z * z), .zz = 2 * (x * x + y * y)}};
}

const std::array<MassProperties, 7> bodies{
    reaching(0, 1, 1),    reaching(1, 0, 0.4),     reaching(1e-6, 1, 0.5), reaching(1, 1, 5e-3),
    reaching(3e-6, 1, 0), reaching(1e-4, 1e-5, 1), reaching(0.5, 1, 2)};

// The masses follow from the places: M is diagonal, with what each place weighs. Tolerance: rounding of a
// tensor of inertia, 1e-15, from which thin bodies take their second moments.
TEST(BodyPoints, WeighWhatTheBodyDoes) {
  for (const MassProperties& body : bodies) {
    SCOPED_TRACE(testing::Message() << body.inertia.xx << ' ' << body.inertia.yy << ' ' << body.inertia.zz);
    Scene scene;
    add_body(scene, body);
    validate(scene);
    const auto mass = body_mass(scene, 0);
    std::array<PointMass, 4> points;
    for (std::size_t j = 0; j < 4; ++j) {
      points[j] = {scene.particles[j].position, std::max(mass[j][j], 0.0)};
      EXPECT_GE(mass[j][j], -1e-15);
      for (std::size_t k = 0; k < j; ++k) EXPECT_NEAR(mass[j][k], 0, 1e-14);
    }
    const MassProperties back = mass_properties(points);
    EXPECT_NEAR(back.mass, body.mass, 1e-14);
    EXPECT_LE(norm(back.center - body.center), 1e-14);
    EXPECT_NEAR(back.inertia.xx, body.inertia.xx, 1e-13);
    EXPECT_NEAR(back.inertia.yy, body.inertia.yy, 1e-13);
    EXPECT_NEAR(back.inertia.zz, body.inertia.zz, 1e-13);
    EXPECT_NEAR(back.inertia.xy, 0, 1e-13);
    EXPECT_NEAR(back.inertia.xz, 0, 1e-13);
    EXPECT_NEAR(back.inertia.yz, 0, 1e-13);
  }
}

// A regular tetrahedron has 0.71, that of the thickest of these bodies 0.08.
TEST(BodyPoints, AreATetrahedronHoweverThinTheBodyIs) {
  for (const MassProperties& body : bodies) EXPECT_GE(relative_volume(body_points(body)), 0.05);
}

// Those of solids are where they always were.
TEST(BodyPoints, OfASolidAreFourPoints) {
  const MassProperties box = solid_box(2, {0.1, 0.2, 0.3});
  const std::array<PointMass, 4> points = four_points(box);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(body_points(box)[k], points[k].position);
}

TEST(SingularMass, IsThatOfFlatAndThinBodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Scene scene;
    add_body(scene, bodies[i]);
    EXPECT_EQ(has_singular_mass(scene, 0), i < 3 || (i >= 3 && i < 6)) << i;
  }
}

// A disc that an anchor holds off its plane has inertia in all ways in which three particles move. In its
// plane, it has none in those that leave it.
TEST(SingularMass, DependsOnWhatIsHeld) {
  for (const bool is_off : {true, false}) {
    Scene scene;
    const double height = is_off ? 1 : 0;
    scene.particles = {test::fixed({0, height, 0}), test::movable({1, 0, 0}, 0), test::movable({0, 0, 1}, 0),
                       test::movable({-1, 1 - height, -1}, 0)};
    add_body(scene, {0, 1, 2, 3}, {.mass = 1, .inertia = {.xx = 0.5, .yy = 1, .zz = 0.5}});
    EXPECT_EQ(has_singular_mass(scene, 0), !is_off);
    validate(scene);
  }
}

// Rods of a solid may give, those of a disc may not.
TEST(FlatBodies, NeedRigidRods) {
  for (const bool is_flat : {true, false}) {
    Scene scene;
    add_body(scene, is_flat ? reaching(1, 0, 1) : reaching(1, 1, 1));
    scene.rods[3].law.stiffness = 1e6;
    EXPECT_EQ(test::refusal([&] { validate(scene); }),
              is_flat
                  ? "body 0: the rod between its particles 0 and 3 must be rigid, because the body is flat "
                    "or thin"
                  : "");
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
