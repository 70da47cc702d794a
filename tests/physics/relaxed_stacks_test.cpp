// Boxes on each other come to rest where they are relaxed, too, in the ten sweeps of a substep by default.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/basics/seeded.hpp"
#include "support/boxes.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

/// A stack of crates of 40 cm and of random heights and weights, dropped by 2 mm each.
Scene stack_of(int count, std::uint64_t seed) {
  Scene scene;
  scene.planes.push_back({});
  scenes::Random random(seed);
  double top = 0;
  for (int i = 0; i < count; ++i) {
    const double half = random.between(0.1, 0.25), x = random.between(-0.03, 0.03),
                 z = random.between(-0.03, 0.03);
    test::add_box(scene, {x, top + half + 2e-3, z}, {0.2, half, 0.2}, random.between(2, 8), {});
    top += 2 * half + 2e-3;
  }
  return scene;
}

/// How far a body has gone aside, in m.
double aside(const Scene& scene, const World& world, std::uint32_t body) {
  const Vec3 went = test::middle_of(scene, world, body) - scene.bodies[body].center;
  return std::hypot(went.x, went.z);
}

// Where pushes moved the particles of bodies as points, 34 of 60 such stacks rocked on for 5 s, with corners
// that changed places in what carries. They land within 0.1 s and sleep half a second after that. Five
// seconds leave room for those of one substep, where gravity alone makes 0.16 m/s between corrections. Crates
// go aside by less than the slop of 0.5 mm while they land, and twice that where substeps are longest.
TEST(RelaxedStacks, OfTwoAndThreeCratesSleep) {
  for (const std::uint32_t substeps : {1u, 4u, 8u})
    for (const int count : {2, 3})
      for (std::uint64_t seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(testing::Message() << substeps << " substeps, " << count << ", " << seed);
        const Scene scene = stack_of(count, seed);
        World world(scene, {.method = Method::relax, .substeps = substeps, .threads = 1});
        std::uint64_t awake = 1;
        while (awake > 0 && world.time() < 5) awake = world.step(frame).awake_islands;
        EXPECT_EQ(awake, 0u);
        for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
          EXPECT_LT(aside(scene, world, i), substeps > 1 ? 5e-4 : 1e-3) << i;
      }
}

// In 8 substeps of 20 sweeps such a tower went aside by 5 cm in 20 s, and did not sleep. It is now asleep
// after 0.7 s, 0.3 mm aside: less than the slop, by which boxes may sink unevenly, and two seconds leave
// room.
TEST(RelaxedStacks, OfTenBoxesStandAndSleep) {
  for (const auto& [name, ground] : test::level_grounds({.friction = 0.6}))
    for (const double lean : {0.0, 0.01}) {
      SCOPED_TRACE(testing::Message() << name << ", " << lean);
      Scene scene = ground;
      for (int i = 0; i < 10; ++i)
        test::add_box(scene, {lean * ((7 * i) % 5 - 2), 0.1 + 0.2 * i, 0}, {0.2, 0.1, 0.2}, 2,
                      {.friction = 0.6});
      World world(scene, {.method = Method::relax, .substeps = 8, .stop = {.sweeps = 20}, .threads = 1});
      std::uint64_t awake = 1;
      while (awake > 0 && world.time() < 2) awake = world.step(frame).awake_islands;
      EXPECT_EQ(awake, 0u);
      for (std::uint32_t i = 0; i < 10; ++i) EXPECT_LT(aside(scene, world, i), 5e-4) << i;
    }
}

// Bodies that joints hold are pushed as rigid ones, too, and rigid pushes do not damp what their particles do
// otherwise. Two planks on a hinge so moved on for ever, at 0.4 m/s. They start 1 mm above the floor.
TEST(RelaxedStacks, OfPlanksOnAHingeSleep) {
  for (const std::uint32_t substeps : {1u, 4u, 16u})
    for (const bool has_crate : {false, true}) {
      SCOPED_TRACE(testing::Message() << substeps << " substeps, " << has_crate);
      Scene scene;
      scene.planes.push_back({});
      const std::uint32_t one = test::add_box(scene, {-0.62, 0.051, 0}, {0.6, 0.05, 0.3}, 3, {}),
                          two = test::add_box(scene, {0.62, 0.051, 0}, {0.6, 0.05, 0.3}, 3, {});
      add_revolute(scene, one, two, {0, 0.051, 0}, {0, 0, 1});
      if (has_crate) test::add_box(scene, {0.3, 0.22, 0.05}, {0.1, 0.1, 0.1}, 3, {});
      World world(scene, {.method = Method::relax, .substeps = substeps, .threads = 1});
      StepReport total, last;
      while (world.time() < 3) total += last = world.step(frame);
      EXPECT_EQ(last.awake_islands, 0u);
      EXPECT_LE(total.guarded_energy, 5u) << "blows that would bring energy, while they land";
    }
}

/// Expects that something sleeps at no time in some seconds.
World expect_awake(const Scene& scene, const Settings& settings, double seconds) {
  World world(scene, settings);
  while (world.time() < seconds) {
    if (world.step(frame).awake_islands > 0) continue;
    ADD_FAILURE() << "asleep after " << world.time() << " s";
    break;
  }
  return world;
}

const Settings ways[] = {{.method = Method::direct, .substeps = 4, .threads = 1},
                         {.method = Method::relax, .substeps = 4, .stop = {.sweeps = 40}, .threads = 1}};

// Below the slope of sliding by 2 %, friction leaves 2 % of what pulls: 0.09 m/s² at 0.5. That is faster than
// what sleeps, 0.02 m/s, after a quarter of a second. The block slides by half of that acceleration's square
// of time, 0.18 m in 2 s, and relaxation may add what it creeps.
TEST(SlowMotions, OfABlockThatSlidesStayAwake) {
  for (const Settings& settings : ways) {
    SCOPED_TRACE(static_cast<int>(settings.method));
    const double slope = 0.5 * 1.02, angle = std::atan(slope), pull = 0.01 * test::earth * std::cos(angle);
    Scene scene;
    scene.gravity = test::earth * Vec3{std::sin(angle), -std::cos(angle), 0};
    scene.planes.push_back({.surface = {.friction = 0.5}});
    test::add_box(scene, {0, 0.1, 0}, {0.2, 0.1, 0.2}, 2, {.friction = 0.5});
    const World world = expect_awake(scene, settings, 2);
    EXPECT_GT(test::middle_of(scene, world, 0).x, 0.9 * 0.5 * pull * 4);
  }
}

// Gravity leans over a box, beyond its edge by a hundredth. So it falls over, however slowly it begins.
TEST(SlowMotions, OfADominoThatLeansStayAwake) {
  for (const Settings& settings : ways) {
    SCOPED_TRACE(static_cast<int>(settings.method));
    const double lean = std::atan2(0.05, 0.4) + 0.01;
    Scene scene;
    scene.gravity = test::earth * Vec3{std::sin(lean), -std::cos(lean), 0};
    scene.planes.push_back({.surface = {.friction = 0.8}});
    test::add_box(scene, {0, 0.4, 0}, {0.05, 0.4, 0.1}, 2, {.friction = 0.8});
    World world(scene, settings);
    double lowest = 1;
    for (int i = 0; i < 240 && lowest > 0.1; ++i) {
      ASSERT_GT(world.step(frame).awake_islands, 0u) << i;
      lowest = std::min(lowest, test::middle_of(scene, world, 0).y);
    }
    EXPECT_LT(lowest, 0.1) << "it has not fallen";
  }
}

// A ball that rolls at 0.05 m/s goes on. Where contact is relaxed, it is braked as gradient new does, and is
// faster than 0.02 m/s for a second at least. A pendulum stands still at its turning points for an instant:
// at an amplitude of 0.05 it is slower than that for 0.08 s of a time to and fro of 2 s.
TEST(SlowMotions, OfBallsThatRollAndSwingStayAwake) {
  for (const Settings& settings : ways) {
    SCOPED_TRACE(static_cast<int>(settings.method));
    Scene rolls;
    rolls.planes.push_back({});
    MassProperties sphere = solid_sphere(1, 0.1);
    sphere.center = {0, 0.1, 0};
    const Point middle = point_on_body(rolls, add_body(rolls, sphere), sphere.center);
    rolls.capsules.push_back({.a = middle, .b = middle, .radius = 0.1});
    for (Particle& each : rolls.particles)
      each.velocity = Vec3{0.05, 0, 0} + cross(Vec3{0, 0, -0.5}, each.position - Vec3{0, 0.1, 0});
    expect_awake(rolls, settings, 1);
    Scene swings;
    swings.planes.push_back({});
    swings.particles = {{.position = {0, 1.2, 0}, .fixed = true},
                        {.position = {std::sin(0.05), 1.2 - std::cos(0.05), 0}, .mass = 1}};
    swings.rods = {{0, 1}};
    swings.capsules = {{.a = point_at(1), .b = point_at(1), .radius = 0.1}};
    expect_awake(swings, settings, 4);
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
