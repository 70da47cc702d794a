// Particles without rods, where the exact solution is known.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::movable;

constexpr double double_epsilon = std::numeric_limits<double>::epsilon();
constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

Scene lone_particle(Vec3 position, Vec3 velocity, Vec3 gravity, double drag = 0) {
  Scene scene;
  scene.gravity = gravity;
  scene.drag = drag;
  scene.particles = {movable(position, 3, velocity)};
  return scene;
}

class FreeFlight : public testing::TestWithParam<std::tuple<Gradient, Precision>> {
 protected:
  Gradient gradient() const { return std::get<0>(GetParam()); }
  Precision precision() const { return std::get<1>(GetParam()); }
  World world(const Scene& scene, std::uint32_t substeps = 1) const {
    return World(scene, {.method = Method::relax,
                         .precision = precision(),
                         .gradient = gradient(),
                         .substeps = substeps,
                         .threads = 1});
  }
};

// Verlet with its right first step lies on the parabola at every step, whatever its size. With 2^-6 s, 8
// m/s^2 and small binary fractions no operation rounds, in float neither, so the tolerance is zero.
TEST_P(FreeFlight, ParabolaIsExact) {
  World flying = world(lone_particle({0, 100, 0}, {1.5, 4, -0.25}, {0, -8, 0}));
  for (int i = 1; i <= 256; ++i) {
    flying.step(1.0 / 64);
    const double t = i / 64.0;
    ASSERT_EQ(flying.position(0), (Vec3{1.5 * t, 100 + 4 * t - 4 * t * t, -0.25 * t})) << "t = " << t;
    ASSERT_EQ(flying.velocity(0), (Vec3{1.5, 4 - 8 * t, -0.25})) << "t = " << t;
  }
}

// The same with numbers that round: each of n substeps adds one displacement, with an error of half a unit in
// the last place of the height fallen, and the displacement itself n of its own.
TEST_P(FreeFlight, FallIsExactToRounding) {
  const int steps = 60;
  const std::uint32_t substeps = 10;
  World falling = world(lone_particle({0, 0, 0}, {}, {0, -9.81, 0}), substeps);
  test::run(falling, 1.0 / 60, steps);
  const double epsilon = precision() == Precision::single ? 0x1p-23 : double_epsilon;
  const double n = steps * substeps;
  EXPECT_NEAR(falling.position(0).y, -9.81 / 2, n * epsilon * 9.81);
  EXPECT_NEAR(falling.velocity(0).y, -9.81, n * epsilon * 9.81);
  EXPECT_EQ(falling.position(0).x, 0);
}

std::string flight_name(const testing::TestParamInfo<std::tuple<Gradient, Precision>>& info) {
  std::string gradient(to_string(std::get<0>(info.param)));
  return gradient + (std::get<1>(info.param) == Precision::single ? "Float" : "Double");
}
INSTANTIATE_TEST_SUITE_P(Every, FreeFlight,
                         testing::Combine(testing::ValuesIn(all_gradients),
                                          testing::Values(Precision::single, Precision::double_)),
                         flight_name);

/// The solution of v' = g - c v from the origin: v0 t phi(ct) + g t^2 psi(ct), phi(z) = (1 - e^-z)/z and psi
/// = (1 - phi)/z, by their series where they would cancel.
Vec3 dragged_position(Vec3 v0, Vec3 g, double c, double t) {
  const long double z = static_cast<long double>(c) * t;
  const long double phi = z < 1e-3L ? 1 - z / 2 + z * z / 6 - z * z * z / 24 : -std::expm1(-z) / z;
  const long double psi = z < 1e-3L ? 0.5L - z / 6 + z * z / 24 - z * z * z / 120 : (1 - phi) / z;
  return static_cast<double>(t * phi) * v0 + static_cast<double>(t * t * psi) * g;
}
Vec3 dragged_velocity(Vec3 v0, Vec3 g, double c, double t) {
  return std::exp(-c * t) * (v0 - (1 / c) * g) + (1 / c) * g;
}

// Decay and kick are the exact ones of a constant force, so gradients new and old lie on the exact curve at
// every step size, from drag that one step hardly feels to drag that stops a particle within one. Rounding:
// as for the fall.
TEST(Drag, IsExactForGradientsNewAndOld) {
  const Vec3 v0{20, 5, -3}, gravity{0.5, -9.81, 0};
  for (const Gradient gradient : {Gradient::new_, Gradient::old})
    for (const double drag : {1e-9, 1e-3, 0.7, 30.0, 2000.0})
      for (const std::uint32_t substeps : {1u, 7u}) {
        World world(lone_particle({}, v0, gravity, drag),
                    {.method = Method::relax, .gradient = gradient, .substeps = substeps, .threads = 1});
        for (int i = 1; i <= 120; ++i) {
          world.step(1.0 / 60);
          const double t = i / 60.0;
          ASSERT_LE(norm(world.position(0) - dragged_position(v0, gravity, drag, t)),
                    40 * 840 * double_epsilon)
              << "drag " << drag << ", t = " << t;
        }
      }
}

// Velocities are read from the last two displacements: second order, and so exact once they stop changing.
TEST(Drag, VelocitiesAreSecondOrder) {
  const Vec3 v0{20, 5, -3}, gravity{0, -9.81, 0};
  const double drag = 2;
  for (const Gradient gradient : all_gradients) {
    double errors[2];
    for (const int k : {0, 1}) {
      World world(lone_particle({}, v0, gravity, drag),
                  {.method = Method::relax, .gradient = gradient, .substeps = 4u << k, .threads = 1});
      test::run(world, 1.0 / 60, 30);
      errors[k] = norm(world.velocity(0) - dragged_velocity(v0, gravity, drag, 0.5));
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.1) << to_string(gradient);
    EXPECT_LT(errors[1], 1e-3) << to_string(gradient);
  }
}

// Gradient mid splits drag around the step: half before, half after. Second order, not exact.
TEST(Drag, IsSecondOrderForGradientMid) {
  const Vec3 v0{20, 5, -3}, gravity{0, -9.81, 0};
  double errors[2];
  for (const int k : {0, 1}) {
    World world(lone_particle({}, v0, gravity, 2),
                {.method = Method::relax, .gradient = Gradient::mid, .substeps = 4u << k, .threads = 1});
    test::run(world, 1.0 / 60, 60);
    errors[k] = norm(world.position(0) - dragged_position(v0, gravity, 2, 1));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.05);
}

// Falling long enough, weight and drag balance at g/c. Gradient mid ends at (g/c) z/sinh(z), z = c h/2: that
// is what its split drag balances at, 1 - z^2/6 of the true speed.
TEST(Drag, TerminalVelocity) {
  const double drag = 2, dt = 1.0 / 60;
  for (const Gradient gradient : all_gradients) {
    World world(lone_particle({}, {3, 0, 0}, {0, -9.81, 0}, drag),
                {.method = Method::relax, .gradient = gradient, .threads = 1});
    test::run(world, dt, 60 * 20);  // exp(-40) of what it started with is left
    const double z = drag * dt / 2;
    const double wanted = -9.81 / drag * (gradient == Gradient::mid ? z / std::sinh(z) : 1);
    EXPECT_NEAR(world.velocity(0).y, wanted, 1e-12) << to_string(gradient);
    EXPECT_NEAR(world.velocity(0).x, 0, 1e-12) << to_string(gradient);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
