// Steps of changing length keep velocity and acceleration.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/falling.hpp"
#include "scenes/generators/generators.hpp"
#include "support/planar_chain.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

// A free particle stays on its parabola to rounding, whatever the steps: 100 changes, each worth a few
// roundings of a velocity of 20 m/s.
TEST(ChangingStep, FreeFlightStaysExact) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}, 1, {3, 10, 0})};
  for (const Gradient gradient : all_gradients) {
    World world(scene, {.method = Method::relax, .gradient = gradient, .substeps = 2, .threads = 1});
    for (int i = 0; i < 100; ++i) {
      world.step(1.0 / (30 + 7 * (i % 13)));
      const double t = world.time();
      ASSERT_LE(norm(world.position(0) - Vec3{3 * t, 10 * t - 9.81 / 2 * t * t, 0}), 1e-12)
          << to_string(gradient);
      ASSERT_LE(norm(world.velocity(0) - Vec3{3, 10 - 9.81 * t, 0}), 1e-12) << to_string(gradient);
    }
  }
}

// A change of step is one error of third order, so a run with one change in it is as accurate as its steps.
TEST(ChangingStep, OnceKeepsAPendulumSecondOrder) {
  test::PlanarChain<1> truth({1}, 0.1L, 9.81L);
  truth.advance(1, 20000);
  const Scene scene = scenes::make_chain(1);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double errors[2];
    for (const int k : {0, 1}) {
      World world(scene, {.method = Method::relax,
                          .gradient = gradient,
                          .substeps = 16u << k,
                          .stop = {.sweeps = 100, .tolerance = 1e-13},
                          .threads = 1});
      test::run(world, 1.0 / 60, 30);
      test::run(world, 1.0 / 120, 60);
      errors[k] = rms_distance(test::positions_of(world), truth.frame().positions) / 0.1;
    }
    EXPECT_LE(errors[1], 1e-4) << to_string(gradient);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15) << to_string(gradient);
  }
}

// An engine's frames vary all the time, by a tenth here.
TEST(ChangingStep, EveryFrameKeepsAPendulumSecondOrder) {
  test::PlanarChain<1> truth({1}, 0.1L, 9.81L);
  truth.advance(1, 20000);
  const Scene scene = scenes::make_chain(1);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    double errors[2];
    for (const int k : {0, 1}) {
      World world(scene, {.method = Method::relax,
                          .gradient = gradient,
                          .substeps = 16u << k,
                          .stop = {.sweeps = 100, .tolerance = 1e-13},
                          .threads = 1});
      for (int i = 0; i < 60; ++i) world.step((i % 2 == 0 ? 0.9 : 1.1) / 60);
      errors[k] = rms_distance(test::positions_of(world), truth.frame().positions) / 0.1;
    }
    EXPECT_LE(errors[1], 1e-4) << to_string(gradient);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15) << to_string(gradient);
  }
}

// An engine may hand over a frame that is far too short, after a stall or while a window is dragged. Rods
// that sweeps left 1e-4 too long are corrected in it, which at 1/10,000 s looks like a metre a second;
// nothing may be made of that in the next frame of ordinary length. In ordinary frames these chains keep
// their energy to 0.03 of the range.
TEST(ChangingStep, OneShortFrameDoesNoHarm) {
  const Scene scene = scenes::make_chain(10, 0.1, 10);
  for (const Precision precision : {Precision::single, Precision::double_})
    for (const Gradient gradient : all_gradients) {
      World world(scene, {.method = Method::relax,
                          .precision = precision,
                          .gradient = gradient,
                          .substeps = 8,
                          .stop = {.sweeps = 50},
                          .threads = 1});
      test::run(world, 1.0 / 60, 30);
      world.step(1e-4);
      for (int i = 0; i < 10; ++i) {
        world.step(1.0 / 60);
        ASSERT_LE(std::abs(test::relative_energy(scene, world)), 0.1)
            << to_string(precision) << ", gradient " << to_string(gradient) << ", " << i << " frames later";
      }
    }
}

/// Twenty links hang 0.3 rad aside with ten times their weight at the end, so that ten sweeps leave strains
/// of a tenth.
Scene loaded_line(double mass, RodLaw law, RodLaw every_fourth) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0})};
  for (std::uint32_t i = 1; i <= 20; ++i) {
    scene.particles.push_back(
        test::movable({0.1 * i * std::sin(0.3), -0.1 * i * std::cos(0.3), 0}, i == 20 ? mass : 1));
    scene.rods.push_back({.a = i - 1, .b = i, .law = i % 4 == 0 ? every_fourth : law});
  }
  return scene;
}

/// Lengths of steps (s) that change: from one to the next, all the time, and every second.
double turn(int i) {
  return i % 2 == 0 ? 1.0 / 60 : 1e-3;
}
double spread(int i) {
  return std::pow(10, -4 + 2.2 * ((i * 37) % 101) / 100.0);
}
double blocks(int i) {
  return i % 120 < 60 ? 1.0 / 60 : 1e-3;
}

double equal(int) {
  return 1.0 / 60;
}

/// Returns the largest energy above that of the start in five seconds, over the scene's range.
double gain_of(const Scene& scene, Gradient gradient, double (*length)(int)) {
  World world(scene, {.method = Method::relax, .gradient = gradient, .threads = 1});
  const double start = test::relative_energy(scene, world);
  double most = 0;
  for (int i = 0; world.time() < 5; ++i) {
    world.step(length(i));
    most = std::max(most, test::relative_energy(scene, world) - start);
  }
  return most;
}

// What sweeps leave of a pull in a long step is not thrown by a short one. Before, these lines flew apart.
// Random steps may gain a little: up to 2 % of the range.
TEST(ChangingStep, ShortOnesThrowNothingThatLongOnesLeft) {
  const RodLaw rigid, cable{.one_sided = true}, spring{.stiffness = 1e4, .damping = 1};
  const Scene scenes[] = {loaded_line(10, rigid, rigid), loaded_line(10, cable, cable),
                          loaded_line(10, rigid, spring), scenes::make_net(12, 12),
                          scenes::make_graph({.particles = 300})};
  for (const Scene& scene : scenes)
    for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
      const double usual = gain_of(scene, gradient, equal);
      for (const auto& length : {turn, spread, blocks})
        EXPECT_LE(gain_of(scene, gradient, length), usual + 0.02)
            << &scene - scenes << ", gradient " << to_string(gradient);
    }
}

// Without the weight gradient old is stable, too. In steps of one length these fall by up to 2.3 m/s.
TEST(ChangingStep, ShortOnesThrowNoLineWithAnyGradient) {
  const Scene scene = loaded_line(1, {}, {});
  for (const Gradient gradient : all_gradients)
    for (const std::uint32_t substeps : {1u, 4u}) {
      World world(scene, {.method = Method::relax, .gradient = gradient, .substeps = substeps, .threads = 1});
      for (int i = 0; world.time() < 5; ++i) {
        world.step(turn(i));
        for (const Vec3& v : test::velocities_of(world))
          ASSERT_LE(norm(v), 2.5) << to_string(gradient) << ", step " << i;
      }
    }
}

// A tolerance holds for what is kept as well. Its sweeps are as many as these lines need.
TEST(ChangingStep, KeepsATolerance) {
  const Scene scene = loaded_line(10, {}, {});
  for (const Precision precision : {Precision::single, Precision::double_})
    for (const auto& length : {turn, spread, blocks}) {
      World world(scene, {.method = Method::relax,
                          .precision = precision,
                          .stop = {.sweeps = 3000, .tolerance = 1e-3},
                          .threads = 1});
      for (int i = 0; world.time() < 2; ++i) {
        const StepReport report = world.step(length(i));
        if (report.stopped_by != StoppedBy::tolerance) continue;
        ASSERT_LE(test::stretch_of(scene, world).max, 1.0001e-3) << i;
      }
    }
}

// An edit keeps what is to be taken back. A cut that did not threw the line at 17 m/s in the next
// millisecond.
TEST(ChangingStep, ShortOnesThrowNothingAfterACut) {
  World world(loaded_line(10, {}, {}), {.method = Method::relax, .threads = 1});
  test::run(world, 1.0 / 60, 120);
  world.cut(18);
  world.step(1e-3);
  for (const Vec3& v : test::velocities_of(world)) EXPECT_LE(norm(v), 2);
}

// An island that broke keeps nothing, and stays where it froze.
TEST(ChangingStep, ShortOnesLeaveWhatBrokeWhereItIs) {
  World world(loaded_line(10, {}, {}), {.method = Method::relax, .threads = 1});
  test::run(world, 1.0 / 60, 10);
  world.set_force(10, {1e300, 1e300, 0});
  std::uint32_t frozen = 0;
  for (int i = 0; i < 6; ++i) frozen += world.step(i < 3 ? 1e-3 : 1.0 / 60).frozen_islands;
  EXPECT_EQ(frozen, 1u);
  world.set_force(10, {});
  const auto stands = test::positions_of(world);
  for (int i = 0; i < 20; ++i) world.step(turn(i));
  EXPECT_EQ(test::positions_of(world), stands);
}

// What is to be taken back later is saved with the rest.
TEST(ChangingStep, GoesOnFromASnapshot) {
  const Scene scene = loaded_line(10, {}, {});
  World world(scene, {.method = Method::relax, .threads = 1}),
      other(scene, {.method = Method::relax, .threads = 1});
  for (int i = 0; i < 31; ++i) world.step(turn(i));
  std::vector<std::byte> bytes(world.snapshot_size());
  world.save(bytes);
  other.restore(bytes);
  for (int i = 31; i < 60; ++i) {
    world.step(turn(i));
    other.step(turn(i));
    ASSERT_EQ(world.state_hash(), other.state_hash()) << i;
  }
}

// --- Things that touch

/// Twenty links lie on the ground, the last one with a mass (kg) of its own. An anchor holds the first.
Scene lying_line(double mass) {
  constexpr double radius = 0.02;
  Scene scene;
  scene.particles = {test::fixed({0, radius, 0})};
  for (std::uint32_t i = 1; i <= 20; ++i) {
    scene.particles.push_back(test::movable({0.1 * i, radius, 0}, i == 20 ? mass : 1));
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = radius});
  }
  scene.planes = {{.normal = {0, 1, 0}}};
  return scene;
}

/// Steps a world and lifts its anchor, and lets it down again.
void step_lifted(World& world, double dt) {
  world.move_anchor(0, {0, 0.02 + 0.6 * (1 - std::cos(2 * (world.time() + dt))), 0});
  world.step(dt);
}

double top_speed(const World& world) {
  double most = 0;
  for (const Vec3& v : test::velocities_of(world)) most = std::max(most, norm(v));
  return most;
}

/// Says how fast something is, m/s, and how far a rod is strained, at most.
struct Most {
  double speed = 0, strain = 0;
};
Most most_of_lifted(double mass, Gradient gradient, double (*length)(int)) {
  const Scene scene = lying_line(mass);
  World world(scene, {.method = Method::relax, .gradient = gradient, .threads = 1});
  Most most;
  for (int i = 0; world.time() < 3; ++i) {
    step_lifted(world, length(i));
    most.speed = std::max(most.speed, top_speed(world));
    most.strain = std::max(most.strain, test::stretch_of(scene, world).max);
  }
  return most;
}

// In steps of one length these reach 2 to 2.8 m/s. Before, they reached 8 to 16 m/s in others.
TEST(ChangingStep, ShortOnesThrowNoLineThatTouches) {
  for (const double mass : {1.0, 10.0})
    for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
      const Most usual = most_of_lifted(mass, gradient, equal);
      for (const auto& length : {turn, spread}) {
        const Most most = most_of_lifted(mass, gradient, length);
        EXPECT_LE(most.speed, 1.3 * usual.speed) << mass << ", gradient " << to_string(gradient);
        EXPECT_LE(most.strain, 1.2 * usual.strain) << mass << ", gradient " << to_string(gradient);
      }
    }
}

// What lands in a short step is pushed much in it, and no more in the long one behind it. Before, these were
// still as fast as 1.4 to 6.3 m/s.
TEST(ChangingStep, LongOnesThrowNothingThatLandedInAShortOne) {
  const Scene scenes[] = {scenes::make_rope({.links = 30}), scenes::make_rope({.links = 60, .coil = 0.3}),
                          scenes::make_heap({.ropes = 4, .links = 12}), scenes::make_drape({.size = 12})};
  for (const Scene& scene : scenes) {
    World world(scene, {.method = Method::relax, .threads = 1});
    for (int i = 0; world.time() < 3; ++i) {
      world.step(turn(i));
      if (world.time() < 1) continue;
      ASSERT_LE(top_speed(world), 0.4) << &scene - scenes << ", step " << i;
    }
  }
}

// One short step after long ones takes nothing back that it would throw, whether a rod is cut before it or
// not. Before, it made these as fast as 2.5 to 4.5 m/s.
TEST(ChangingStep, AShortOneThrowsNothingThatTouches) {
  for (const bool cuts : {false, true})
    for (const double mass : {1.0, 10.0}) {
      World world(lying_line(mass), {.method = Method::relax, .threads = 1});
      for (int i = 0; i < 40; ++i) step_lifted(world, 1.0 / 60);
      const double before = top_speed(world);
      if (cuts) world.cut(18);
      for (int i = 0; i < 5; ++i) {
        step_lifted(world, 1e-3);
        EXPECT_LE(top_speed(world), 1.1 * before) << mass << ", step " << i;
      }
    }
}

TEST(ChangingStep, KeepsAToleranceOfWhatTouches) {
  const Scene scene = lying_line(10);
  for (const Precision precision : {Precision::single, Precision::double_}) {
    World world(scene, {.method = Method::relax,
                        .precision = precision,
                        .stop = {.sweeps = 3000, .tolerance = 1e-3},
                        .threads = 1});
    for (int i = 0; world.time() < 1; ++i) {
      world.move_anchor(0, {0, 0.02 + 0.5 * (world.time() + turn(i)), 0});
      const StepReport report = world.step(turn(i));
      if (report.stopped_by != StoppedBy::tolerance) continue;
      ASSERT_LE(test::stretch_of(scene, world).max, 1.01e-3) << i;
    }
  }
}

TEST(ChangingStep, GoesOnFromASnapshotOfWhatTouches) {
  const Scene scene = lying_line(10);
  for (const Precision precision : {Precision::single, Precision::double_}) {
    const Settings settings{.method = Method::relax, .precision = precision, .threads = 1};
    World world(scene, settings), other(scene, settings);
    for (int i = 0; i < 61; ++i) step_lifted(world, spread(i));
    std::vector<std::byte> bytes(world.snapshot_size());
    world.save(bytes);
    other.restore(bytes);
    for (int i = 61; i < 120; ++i) {
      step_lifted(world, spread(i));
      step_lifted(other, spread(i));
      ASSERT_EQ(world.state_hash(), other.state_hash()) << i;
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
