// Bodies without thickness: tops, free discs and coins move as mechanics says, by all methods that move
// bodies.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "support/exact_methods.hpp"
#include "support/ground.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

constexpr double mass = 1, radius = 0.1;
/// kg m², across the disc's axis; about it there is twice that.
constexpr double across = mass * radius * radius / 4;

/// A disc whose axis is x.
constexpr MassProperties disc{.mass = mass, .inertia = {.xx = 2 * across, .yy = across, .zz = across}};

/// A disc on an axle along x, `arm` (m) from its tip at the origin. It spins about the axle and turns about
/// the tip.
constexpr double arm = 0.15;
constexpr Vec3 spin{60, 3, 2};
Scene heavy_top(double thickness = 0) {
  Scene scene;
  MassProperties wheel = thickness > 0 ? solid_cylinder(mass, radius, thickness) : disc;
  wheel.center = {arm, 0, 0};
  const std::uint32_t body = add_body(scene, wheel);
  scene.particles.push_back(test::fixed({}));
  add_spherical(scene, point_at(4), point_on_body(scene, body, {}));
  test::set_motion(scene, body, cross(spin, wheel.center), spin);
  return scene;
}

/// Integrates Euler's and Poisson's equations of a heavy top with the axle along x, in axes that turn with
/// it, by Kutta's method. Returns where a mark of the top is, m, to 1e-10 m over a second.
Vec3 top_at(double t, Vec3 mark, double about_tip) {
  struct State {
    Vec3 w;     // 1/s, in the top's axes
    Vec3 e[3];  // the axes of space as the top sees them
  };
  const auto rate = [&](const State& s) {
    const Vec3 torque = cross({arm, 0, 0}, -mass * earth * s.e[1]);
    const Vec3 l{2 * across * s.w.x, about_tip * s.w.y, about_tip * s.w.z};
    const Vec3 turn = torque - cross(s.w, l);
    State out{{turn.x / (2 * across), turn.y / about_tip, turn.z / about_tip}, {}};
    for (int k = 0; k < 3; ++k) out.e[k] = cross(s.e[k], s.w);
    return out;
  };
  const auto ahead = [](const State& s, double h, const State& by) {
    State out{s.w + h * by.w, {}};
    for (int k = 0; k < 3; ++k) out.e[k] = s.e[k] + h * by.e[k];
    return out;
  };
  const int steps = static_cast<int>(std::ceil(t / 5e-5));
  const double h = t / steps;
  State s{spin, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int i = 0; i < steps; ++i) {
    const State a = rate(s), b = rate(ahead(s, h / 2, a)), c = rate(ahead(s, h / 2, b)),
                d = rate(ahead(s, h, c));
    for (const auto& [weight, slope] : {std::pair{1, a}, {2, b}, {2, c}, {1, d}})
      s = ahead(s, weight * h / 6, slope);
  }
  return {dot(s.e[0], mark), dot(s.e[1], mark), dot(s.e[2], mark)};
}

/// How far the particles of a top of that thickness (m) are from where they should be, m, after a second of
/// precession and nutation.
double error_of_top(const Settings& settings, double dt, double thickness = 0) {
  const Scene scene = heavy_top(thickness);
  World world(scene, settings);
  const int steps = static_cast<int>(std::lround(1 / dt));
  EXPECT_EQ(test::run(world, dt, steps).unsolved, 0u);
  const double about_tip = mass * (radius * radius / 4 + thickness * thickness / 12 + arm * arm);
  double worst = 0;
  for (std::uint32_t i = 0; i < 4; ++i)
    worst = std::max(worst, norm(world.position(i) - top_at(1, scene.particles[i].position, about_tip)));
  return worst;
}

Settings direct_of(Gradient gradient, std::uint32_t substeps = 1) {
  Settings settings = test::body_settings(substeps);
  settings.gradient = gradient;
  return settings;
}

// The top precesses by some 80 degrees and nods four times meanwhile.
TEST(FlatTop, ConvergesToSecondOrder) {
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const double coarse = error_of_top(direct_of(gradient), 1e-3),
                 fine = error_of_top(direct_of(gradient), 5e-4);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << to_string(gradient);
    EXPECT_LE(fine, 3e-3) << to_string(gradient);
  }
}

// That is the truth itself, and methods that share no equation with direct agree with it.
TEST(FlatTop, IsExactWithHighOrders) {
  Settings settings = direct_of(Gradient::old, 4);
  settings.time_order = 6;
  EXPECT_LE(error_of_top(settings, 4e-3), 1e-8);
  for (const Method method : {Method::multipliers, Method::featherstone})
    EXPECT_LE(error_of_top(test::exact(method, Integrator::rk4, 8), 2e-3), 1e-7) << to_string(method);
}

// A top of 1 mm is next to a flat one and converges like it.
TEST(ThinTop, ConvergesToSecondOrder) {
  for (const double thickness : {1e-3, 1e-4, 1e-6}) {
    const auto error = [&](double dt) { return error_of_top(direct_of(Gradient::mid), dt, thickness); };
    EXPECT_NEAR(std::log2(error(1e-3) / error(5e-4)), 2, 0.1) << thickness;
  }
}

// Relaxation gives what stands off a flat body a thousandth of its mass, so that it errs by some 0.3 % of
// what it turns about a diameter.
TEST(FlatTop, IsNearlyRightWhereItIsRelaxed) {
  Settings settings = direct_of(Gradient::mid, 8);
  settings.method = Method::relax;
  settings.stop.sweeps = 40;
  EXPECT_LE(error_of_top(settings, 2e-3), 0.03);
}

/// A disc that turns freely, about no principal axis.
constexpr Vec3 free_spin{8, 12, 0}, free_velocity{1, 2, -1};
Scene free_disc() {
  Scene scene;
  scene.gravity = {};
  test::set_motion(scene, add_body(scene, disc), free_velocity, free_spin);
  return scene;
}

/// Turns a vector about an axis by an angle (rad).
Vec3 turned(Vec3 v, Vec3 about, double angle) {
  const Vec3 n = (1 / norm(about)) * about;
  return std::cos(angle) * v + std::sin(angle) * cross(n, v) + ((1 - std::cos(angle)) * dot(n, v)) * n;
}

/// Where a mark of the free disc is, m. The body turns about its axis at a constant rate, and the axis about
/// the angular momentum L at L over the moment across (Poinsot).
Vec3 disc_at(double t, Vec3 mark) {
  const Vec3 momentum{2 * across * free_spin.x, across * free_spin.y, across * free_spin.z};
  const double own = free_spin.x - momentum.x / across;
  return t * free_velocity + turned(turned(mark, {1, 0, 0}, own * t), momentum, norm(momentum) / across * t);
}

double error_of_disc(const Settings& settings, double dt, int steps) {
  const Scene scene = free_disc();
  World world(scene, settings);
  EXPECT_EQ(test::run(world, dt, steps).unsolved, 0u);
  double worst = 0;
  for (std::uint32_t i = 0; i < 4; ++i)
    worst = std::max(worst, norm(world.position(i) - disc_at(dt * steps, scene.particles[i].position)));
  return worst;
}

TEST(FreeDisc, MovesAsPoinsotSays) {
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const double coarse = error_of_disc(direct_of(gradient), 5e-3, 200);
    const double fine = error_of_disc(direct_of(gradient), 2.5e-3, 400);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05) << to_string(gradient);
    EXPECT_LE(fine, 2e-3) << to_string(gradient);
  }
  Settings settings = direct_of(Gradient::old, 4);
  settings.time_order = 6;
  EXPECT_LE(error_of_disc(settings, 0.01, 100), 1e-9);
  for (const Method method : {Method::multipliers, Method::featherstone})
    EXPECT_LE(error_of_disc(test::exact(method, Integrator::rk4, 32), 0.01, 100), 1e-9) << to_string(method);
}

// As for other bodies: to rounding.
TEST(FreeDisc, KeepsEnergyAndMomenta) {
  const Scene scene = free_disc();
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    World world(scene, direct_of(gradient));
    const Momentum before = test::momentum_of(scene, world);
    const double energy = test::energy_of(scene, world).total();
    for (int i = 0; i < 600; ++i) {
      world.step(frame);
      const Momentum now = test::momentum_of(scene, world);
      ASSERT_LE(norm(now.linear - before.linear), 1e-11 * norm(before.linear)) << to_string(gradient);
      ASSERT_LE(norm(now.angular - before.angular), 1e-9 * norm(before.angular)) << to_string(gradient);
      ASSERT_NEAR(test::energy_of(scene, world).total(), energy, 1e-7 * energy) << to_string(gradient);
    }
  }
}

// What stands off a disc weighs nothing, so that nothing pulls it in flight. This tells multipliers from
// those that the matrix alone would have.
TEST(FreeDisc, PullsNothingOffItsPlane) {
  const Scene scene = free_disc();
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid}) {
    Settings settings = direct_of(gradient);
    settings.tensions = true;
    World world(scene, settings);
    world.step(frame);
    double most = 0, off_plane = 0;
    for (std::uint32_t i = 0; i < 6; ++i) {
      double& largest = scene.rods[i].a == 0 ? off_plane : most;
      largest = std::max(largest, std::abs(world.tension(i)));
    }
    EXPECT_GE(most, 1) << to_string(gradient);
    EXPECT_LE(off_plane, 1e-8 * most) << to_string(gradient);
  }
}

// The tip's reaction and gravity make the change of momentum, to 1e-8 of the largest in a step.
TEST(FlatTop, IsHeldByWhatChangesItsMomentum) {
  const Scene scene = heavy_top();
  for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
    Settings settings = direct_of(gradient, 2);
    settings.tensions = true;
    World world(scene, settings);
    for (int i = 0; i < 60; ++i) {
      const Vec3 before = test::momentum_of(scene, world).linear;
      world.step(2e-3);
      const Vec3 change = (1 / 2e-3) * (test::momentum_of(scene, world).linear - before);
      const Vec3 held = world.reaction(4) + mass * scene.gravity;
      ASSERT_LE(norm(change - held), 1e-8 * norm(held)) << to_string(gradient) << ' ' << i;
    }
  }
}

// A plate on a hinge in its own plane is a pendulum, whose period says its moment: the particles of the hinge
// are anchors, so that what moves has no inertia but in one way. A second swing of 0.1 rad ends where it
// began.
TEST(FlatPlate, SwingsOnAHingeInItsPlane) {
  constexpr double height = 0.6;
  const double length = 2.0 / 3 * height;  // of the pendulum with the same period
  Scene scene;
  scene.particles = {test::fixed({-0.2, 0, 0}), test::fixed({0.2, 0, 0}), test::movable({0, -height, 0}, 0),
                     test::movable({0, 0, 0.3}, 0)};
  const MassProperties plate{
      .mass = 3,
      .center = {0, -height / 2, 0},
      .inertia = {
          .xx = 3 * height * height / 12, .yy = 3 * 0.16 / 12, .zz = 3 * (height * height + 0.16) / 12}};
  add_body(scene, {0, 1, 2, 3}, plate);
  constexpr double swing = 0.1;
  const Vec3 low = turned({0, -height, 0}, {1, 0, 0}, swing), side = turned({0, 0, 0.3}, {1, 0, 0}, swing);
  scene.particles[2].position = low;
  scene.particles[3].position = side;
  scene.bodies[0].center = 0.5 * low;
  const double c = std::cos(swing), s = std::sin(swing), z = plate.inertia.zz, y = plate.inertia.yy;
  scene.bodies[0].inertia.yy = c * c * y + s * s * z;
  scene.bodies[0].inertia.zz = s * s * y + c * c * z;
  scene.bodies[0].inertia.yz = c * s * (y - z);
  // Of the period's series in the swing, the next term is 1e-8.
  const double period = 2 * std::numbers::pi * std::sqrt(length / earth) *
                        (1 + swing * swing / 16 + 11 * swing * swing * swing * swing / 3072);
  World world(scene, test::body_settings());
  test::run(world, period / 1000, 1000);
  EXPECT_LE(norm(world.position(2) - low), 1e-5 * height);
}

/// A coin of a hull: a prism of 32 sides around y, 4 mm thick, whose mass lies in a disc.
std::uint32_t add_coin(Scene& scene, double height, Surface surface) {
  MassProperties flat = disc;
  std::swap(flat.inertia.xx, flat.inertia.yy);
  flat.center = {0, height, 0};
  const std::uint32_t body = add_body(scene, flat);
  Hull& hull = scene.hulls.emplace_back(Hull{.body = body, .surface = surface});
  for (int i = 0; i < 32; ++i)
    for (const double y : {-2e-3, 2e-3}) {
      const double angle = 2 * std::numbers::pi * i / 32;
      hull.points.push_back({radius * std::cos(angle), height + y, radius * std::sin(angle)});
    }
  return body;
}

// It falls flat, lies at half its thickness, to a millimetre that contact lets be, and sleeps.
TEST(Coin, FallsAndLies) {
  for (const Method method : {Method::direct, Method::relax}) {
    SCOPED_TRACE(to_string(method));
    Scene scene = test::sloping_ground(0, {.friction = 0.5});
    const std::uint32_t body = add_coin(scene, 0.05, {.friction = 0.5});
    test::set_motion(scene, body, {0.2, 0, 0}, {1, 2, 0});
    Settings settings = test::body_settings(4, true);
    settings.method = method;
    World world(scene, settings);
    const StepReport report = test::run(world, frame, 240);
    const Point center = point_on_body(scene, body, {0, 0.05, 0});
    EXPECT_NEAR(test::place_of(world, center).y, 2e-3, 1e-3);
    EXPECT_LE(norm(test::spin_of(world, scene.bodies[body])), 0.02);
    EXPECT_EQ(report.fell_asleep, 1u);
  }
}

// A wheel whose mass lies in a disc rolls down a slope at 2/3 of what it would slide at, to 1e-3.
TEST(Coin, RollsAtItsShareOfGravity) {
  constexpr double slope = 0.2;
  Scene scene = test::sloping_ground(slope, {.friction = 0.6});
  MassProperties flat = disc;
  std::swap(flat.inertia.xx, flat.inertia.zz);
  flat.center = {0, radius, 0};
  const std::uint32_t body = add_body(scene, flat);
  const Vec3 half{0, 0, 0.01};
  scene.capsules.push_back({.a = point_on_body(scene, body, flat.center - half),
                            .b = point_on_body(scene, body, flat.center + half),
                            .radius = radius,
                            .surface = {.friction = 0.6}});
  World world(scene, test::body_settings(4));
  test::run(world, frame, 60);
  const double wanted = 2.0 / 3 * earth * std::sin(std::atan(slope));
  EXPECT_NEAR(test::spin_of(world, scene.bodies[body]).z * -radius, wanted, 1e-3 * wanted);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
