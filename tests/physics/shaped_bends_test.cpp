// Bends of islands with shapes: the same beams as without, what they press on, and wires that lie on ground.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/beams.hpp"
#include "support/bodies.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// Puts a ball on a scene's last particle, which makes its island a linkage.
Scene with_ball(Scene scene, double radius = 0.01) {
  const auto last = static_cast<std::uint32_t>(scene.particles.size() - 1);
  scene.capsules.push_back({point_at(last), point_at(last), radius});
  return scene;
}

std::vector<Vec3> after(const Scene& scene, const Settings& settings, int frames) {
  World world(scene, settings);
  for (int i = 0; i < frames; ++i) EXPECT_EQ(world.step(frame).unsolved, 0u);
  return test::positions_of(world);
}
double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, norm(a[i] - b[i]));
  return out;
}

/// A beam that is thrown and twirls, while it swings. A rest angle keeps it off the straight line.
Scene thrown(double angle, double damping) {
  Scene scene = test::free_beam(8, 8 * std::max(angle, 0.1));
  test::give_velocities(scene, 3);
  for (Bend& bend : scene.bends) {
    bend.angle = angle;
    bend.damping = damping;
  }
  return scene;
}

// Substeps of 1/3840 s resolve the fastest swing, of 250/s, so that the error falls with their square.
TEST(ShapedBends, MoveAsBendsAlone) {
  for (const double angle : {0.0, 0.5})
    for (const double damping : {0.0, 0.01}) {
      const Scene scene = thrown(angle, damping);
      const auto truth = after(scene, {.gradient = Gradient::mid, .substeps = 1024, .threads = 1}, 20);
      const auto error = [&](std::uint32_t substeps) {
        return farthest(after(with_ball(scene), {.substeps = substeps, .threads = 1}, 20), truth);
      };
      const double coarse = error(64), fine = error(128);
      EXPECT_LT(fine, 1e-3) << angle << ' ' << damping;
      EXPECT_NEAR(coarse / fine, 4, 1) << angle << ' ' << damping;
    }
}

TEST(ShapedBends, RelaxToTheSameMotion) {
  const Scene scene = thrown(0, 0.01);
  const auto truth = after(scene, {.gradient = Gradient::mid, .substeps = 1024, .threads = 1}, 20);
  const auto error = [&](std::uint32_t substeps) {
    Settings settings{.method = Method::relax, .substeps = substeps, .threads = 1};
    settings.stop.sweeps = 40;
    return farthest(after(with_ball(scene), settings, 20), truth);
  };
  const double coarse = error(128), fine = error(256);
  EXPECT_LT(fine, 0.02);
  EXPECT_GT(coarse / fine, 1.6) << "it is of first order";
}

TEST(ShapedBends, KeepMomenta) {
  for (const double angle : {0.0, 0.5}) {
    Scene scene = with_ball(thrown(angle, 0.01));
    scene.gravity = {};
    World world(scene, {.substeps = 16, .threads = 1});
    const Momentum before = test::momentum_of(scene, world);
    for (int i = 0; i < 120; ++i) world.step(frame);
    const Momentum now = test::momentum_of(scene, world);
    EXPECT_LT(norm(now.linear - before.linear), 1e-12);
    EXPECT_LT(norm(now.angular - before.angular), 1e-3 * norm(before.angular)) << angle;
  }
}

// The tip of a cantilever rests on ground while its clamp comes down: P = 3 EI δ/L³.
TEST(ShapedBends, PressOnGroundAsEulerAndBernoulliSay) {
  const double radius = 0.05, down = 0.01;
  Scene scene = with_ball(test::cantilever(40), radius);
  scene.drag = 5;
  scene.planes.push_back({.offset = -radius});
  World world(scene, {.sleep = false, .tensions = true, .threads = 1});
  for (int i = 1; i <= 600; ++i) {
    const double y = -down * std::min(1.0, i / 60.0);
    world.move_anchor(0, scene.particles[0].position + Vec3{0, y, 0});
    world.move_anchor(1, Vec3{0, y, 0});
    EXPECT_EQ(world.step(frame).unsolved, 0u);
  }
  EXPECT_NEAR(world.contact_force(0).y, 3 * down, 0.01 * 3 * down);
}

// Both halves of a wire that spins apart go straight on, which they would not if a bend still joined them.
TEST(ShapedBends, EndWhereARodBreaks) {
  Scene scene = with_ball(test::free_beam(8, 0.4));
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    scene.particles[i].velocity = cross({0, 0, 6}, scene.particles[i].position);
  scene.rods[3].law.strength = 1;
  World world(scene, {.substeps = 8, .threads = 1});
  std::uint64_t broken = 0;
  for (int i = 0; i < 3 && broken == 0; ++i) broken += world.step(frame).broken_rods;
  ASSERT_EQ(broken, 1u);
  const auto momentum = [&] {
    Vec3 sum{};
    for (std::uint32_t i = 0; i <= 3; ++i) sum += scene.particles[i].mass * world.velocity(i);
    return sum;
  };
  const Vec3 before = momentum();
  for (int i = 0; i < 10; ++i) world.step(frame);
  EXPECT_LT(norm(momentum() - before), 1e-12);
}

/// A wire of `rods` rods of 5 cm that stands nearly upright on the floor.
Scene falling_wire(std::uint32_t rods, double stiffness) {
  Scene scene;
  const double length = 0.05, radius = 0.01;
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back(
        test::movable({0.002 * std::sin(i), 0.05 + length * i, 0.002 * std::cos(2 * i)}, 0.01));
  for (std::uint32_t i = 0; i < rods; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.capsules.push_back({point_at(i), point_at(i + 1), radius, {.friction = 0.5}});
  }
  for (std::uint32_t i = 0; i + 2 <= rods; ++i)
    scene.bends.push_back(
        {.a = i, .b = i + 1, .c = i + 2, .stiffness = stiffness, .damping = 0.01 * stiffness});
  scene.planes.push_back({});
  return scene;
}

TEST(ShapedBends, WiresLieDown) {
  for (const double stiffness : {0.001, 0.04, 1.0})
    for (const Method method : {Method::automatic, Method::relax})
      for (const Precision precision : {Precision::double_, Precision::single}) {
        if (method == Method::automatic && precision == Precision::single)
          continue;  // islands with shapes are double
        const Scene scene = falling_wire(30, stiffness);
        Settings settings{.method = method,
                          .precision = precision,
                          .substeps = method == Method::relax ? 8u : 2u,
                          .threads = 1};
        if (method == Method::relax) settings.stop.sweeps = 20;
        World world(scene, settings);
        SCOPED_TRACE(std::to_string(stiffness) + ' ' + std::string(to_string(method)));
        std::uint32_t awake = 1;
        for (int i = 0; i < 900 && awake > 0; ++i) {
          const StepReport report = world.step(frame);
          ASSERT_EQ(report.unsolved, 0u) << i;
          ASSERT_LT(test::deepest(scene, world), 1e-3) << i;
          awake = report.awake_islands;
        }
        EXPECT_EQ(awake, 0u);
        for (std::uint32_t i = 0; i < scene.particles.size(); ++i) EXPECT_LT(world.position(i).y, 0.03) << i;
      }
}

/// Rods that start off their lengths are brought there, however much the bends resist.
TEST(ShapedBends, StartOffTheirLengths) {
  for (const double stiffness : {0.001, 0.1, 1.0})
    for (const double length : {0.048, 0.0495, 0.052}) {
      SCOPED_TRACE(std::to_string(stiffness) + ' ' + std::to_string(length));
      Scene scene = falling_wire(24, stiffness);
      for (Rod& rod : scene.rods) rod.length = length;
      const double top = scene.particles[24].position.y;
      World world(scene, {.threads = 1});
      for (int i = 0; i < 60; ++i) ASSERT_EQ(world.step(frame).unsolved, 0u) << i;
      EXPECT_LT(test::stretch_of(scene, world).max, 1e-6);
      EXPECT_LT(world.position(24).y, top - 0.03);
    }
}

TEST(ShapedBends, AreRefusedWithoutShapesAlone) {
  Scene scene = with_ball(test::cantilever(4));
  EXPECT_EQ(test::refusal([&] { const World world(scene, {.gradient = Gradient::old, .threads = 1}); }), "");
  scene.particles.push_back(test::fixed({5, 0, 0}));
  for (std::uint32_t i = 0; i < 2; ++i) {
    const auto last = static_cast<std::uint32_t>(scene.particles.size() - 1);
    scene.particles.push_back(test::movable({5.1 + 0.1 * i, 0, 0}, 1));
    scene.rods.push_back({.a = last, .b = last + 1});
  }
  scene.bends.push_back({.a = 6, .b = 7, .c = 8, .stiffness = 1});
  EXPECT_EQ(test::refusal([&] { const World world(scene, {.threads = 1}); }), "");
  EXPECT_EQ(test::refusal([&] { const World world(scene, {.method = Method::relax, .threads = 1}); }),
            "bend 4: method relax moves no bends; direct and auto do");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
