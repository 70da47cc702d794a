// Tackles: Atwood's machine, blocks, what gradient mid keeps, and the order in time.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/swinging_machine.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using std::numbers::pi;
using test::atwood;
using test::direct_with_tensions;
using test::fixed;
using test::movable;

constexpr double g = 9.81;

TEST(Tackles, AtwoodsMachineFallsAtItsRate) {
  for (const Gradient gradient : {Gradient::mid, Gradient::new_})
    for (const bool with_rods : {false, true}) {
      Scene scene = atwood({with_rods ? 0.4 : 1, 3});
      if (with_rods) {
        scene.particles.push_back(movable({0, -3, 0}, 0.6));
        scene.rods = {{.a = 0, .b = 3}};
      }
      World world(scene, direct_with_tensions(gradient, 4));
      const StepReport report = test::run(world, 0.01, 30);
      const double rate = g * (3 - 1) / (3 + 1), t = 0.3;
      EXPECT_NEAR(world.position(0).y, -2 + rate / 2 * t * t, 1e-12);
      // The velocity of gradient new is that of the last substep, half of it earlier.
      EXPECT_NEAR(world.velocity(2).y, -rate * (gradient == Gradient::mid ? t : t - 0.01 / 8), 1e-11);
      EXPECT_NEAR(world.tackle_tension(0), 2 * g * 3 / 4, 1e-9);
      EXPECT_NEAR(world.reaction(1).y, 4 * g * 3 / 4, 1e-9) << "the cord pulls at the pulley twice";
      EXPECT_EQ(report.fallbacks + report.unsolved + report.halvings, 0u);
    }
}

TEST(Tackles, SwingingMachinesConvergeToTheTruthWithTheirOrder) {
  const Vec3 truth = test::swung(1.5, 1, 0, 1.2, 0.5);
  for (const auto& [gradient, order] : {std::pair{Gradient::mid, 2}, std::pair{Gradient::new_, 1}}) {
    const auto error = [&, gradient = gradient](int steps) {
      World world(atwood({1.5, 1}, 0, 1.2), direct_with_tensions(gradient));
      test::run(world, 0.5 / steps, steps);
      return norm(world.position(2) - truth);
    };
    const double coarse = error(100), fine = error(200);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.05);
    EXPECT_LT(fine, order == 2 ? 2e-5 : 1e-2);
  }
}

/// A cord through three free particles and back, which spins, and one of whose particles has a rod.
Scene spinning_ring() {
  Scene scene;
  scene.gravity = {};
  scene.particles = {movable({0, 0, 0}, 1, {0.3, 0, 0.2}), movable({1, 0, 0.1}, 2, {0, 1, 0}),
                     movable({0.3, 0.8, 0}, 0.5, {-1, 0.1, 0}), movable({0.5, 1.5, 0.2}, 1, {-1, 0.4, 0.7})};
  scene.rods = {{.a = 2, .b = 3}};
  scene.tackles = {{.particles = {0, 1, 2, 0}}};
  return scene;
}

TEST(Tackles, MidKeepsEnergyAndMomentum) {
  for (const double stiffness : {std::numeric_limits<double>::infinity(), 50.0, 1e6})
    for (const bool one_sided : {false, true}) {
      if (one_sided && !std::isfinite(stiffness)) continue;  // a rigid cable that catches loses energy
      Scene scene = spinning_ring();
      scene.tackles[0].law = {.stiffness = stiffness, .one_sided = one_sided};
      World world(scene, direct_with_tensions(Gradient::mid));
      const double energy = test::energy_of(scene, world).total();
      const auto momentum = [&] {
        return measure_momentum(scene, test::positions_of(world), test::velocities_of(world));
      };
      const Momentum start = momentum();
      const StepReport report = test::run(world, 1.0 / 240, 4000);
      EXPECT_EQ(report.fallbacks + report.unsolved, 0u) << stiffness << one_sided;
      // Newton's method leaves rounding, which stiffness multiplies.
      EXPECT_NEAR(test::energy_of(scene, world).total() / energy, 1, 1e-9) << stiffness << one_sided;
      EXPECT_LT(norm(momentum().linear - start.linear), 1e-10);
      EXPECT_LT(norm(momentum().angular - start.angular), 1e-10);
    }
}

/// A load of 100 kg in a block on `falls` falls of a cord, which a winch hauls in.
Scene block_and_tackle(std::uint32_t falls) {
  Scene scene;
  scene.particles = {fixed({-0.1, 0, 0}), fixed({0.1, 0, 0}), movable({0, -3, 0}, 100)};
  Tackle& tackle = scene.tackles.emplace_back();
  tackle.particles = {0};
  for (std::uint32_t fall = 0; fall < falls; fall += 2) {
    tackle.particles.push_back(2);
    tackle.particles.push_back(1);
  }
  return scene;
}

TEST(Tackles, AWinchDoesTheWorkThatALoadGains) {
  for (const std::uint32_t falls : {2u, 4u}) {
    const Scene scene = block_and_tackle(falls);
    World world(scene, direct_with_tensions(Gradient::mid));
    const double start = test::energy_of(scene, world).total();
    double length = tackle_length(scene, 0), work = 0;
    StepReport report;
    for (int i = 1; i <= 1000; ++i) {
      const double s = i / 1000.0, next = tackle_length(scene, 0) - falls * s * s * (3 - 2 * s);
      world.set_tackle_length(0, next);
      report += world.step(0.01);
      work += world.tackle_tension(0) * (length - next);
      length = next;
    }
    const double gained = test::energy_of(scene, world).total() - start;
    EXPECT_GT(gained, 900);
    EXPECT_NEAR(work / gained, 1, 1e-4);
    // The load hangs from its falls, which lean a little, and mid lets it ring by the start of the winch.
    const double lean = norm(world.position(2)) > 0 ? -world.position(2).y / norm(world.position(2)) : 1;
    EXPECT_NEAR(world.tackle_tension(0) * falls * lean / (100 * g), 1, 0.02);
    EXPECT_EQ(report.fallbacks + report.unsolved + report.elastic_substeps, 0u);
  }
}

TEST(Tackles, ABlockHangsWhereTheCordsAreEquallySteep) {
  Scene scene;
  scene.drag = 3;
  scene.particles = {fixed({0, 0, 0}), movable({1, -1, 0}, 2), fixed({3, 1, 0})};
  scene.tackles = {{.particles = {0, 1, 2}, .length = 5, .law = {.one_sided = true}}};
  World world(scene, {.tensions = true});
  const StepReport report = test::run(world, 1.0 / 60, 1800);
  EXPECT_EQ(report.unsolved, 0u);
  // Both falls lean by the same angle, the sine of which is the span over the length.
  const double sine = 3.0 / 5, cosine = std::sqrt(1 - sine * sine);
  const double first = (5 * cosine - 1) / (2 * cosine);  // the shorter fall, to the lower anchor
  EXPECT_LT(norm(world.position(1) - Vec3{first * sine, -first * cosine, 0}), 1e-9);
  EXPECT_NEAR(world.tackle_tension(0), 2 * g / (2 * cosine), 1e-6);
  const Vec3 left = world.reaction(0), right = world.reaction(2);
  EXPECT_LT(norm(left + right - Vec3{0, 2 * g, 0}), 1e-6);
  EXPECT_NEAR(right.x, 2 * g / (2 * cosine) * sine, 1e-6);
}

TEST(Tackles, ElasticCordsStretchByTheirPullAndStiffOnesAreRigid) {
  Scene scene = block_and_tackle(2);
  scene.drag = 5;
  scene.tackles[0].length = tackle_length(scene, 0);
  scene.tackles[0].law = {.stiffness = 1e4, .damping = 100};
  World soft(scene, {.tensions = true});
  test::run(soft, 1.0 / 60, 1200);
  double way = 0;
  for (const std::uint32_t anchor : {0u, 1u})
    way += norm(soft.position(2) - scene.particles[anchor].position);
  EXPECT_NEAR(soft.tackle_tension(0), 1e4 * (way - scene.tackles[0].length), 1e-6);

  const auto tip = [&](double stiffness) {
    Scene machine = atwood({1.5, 1}, 0, 1.2);
    machine.tackles[0].law.stiffness = stiffness;
    World world(machine, direct_with_tensions(Gradient::mid));
    test::run(world, 0.01, 50);
    return world.position(2);
  };
  EXPECT_LT(norm(tip(1e13) - tip(std::numeric_limits<double>::infinity())), 1e-9);
}

TEST(Tackles, ACordThatIsTooShortGivesWay) {
  Scene scene = block_and_tackle(2);
  scene.particles[0].position = {-2, 0, 0};
  scene.particles[1].position = {2, 0, 0};
  scene.tackles[0].length = 3;  // the anchors are 4 m apart
  World world(scene);
  EXPECT_EQ(world.info().unprojected_islands, 1u);
  const StepReport report = test::run(world, 1.0 / 60, 3);
  EXPECT_GT(report.elastic_substeps, 0u);
  EXPECT_TRUE(test::all_finite(world));
  EXPECT_LT(std::abs(world.position(2).y), 0.1) << "it is pulled straight";
}

TEST(Tackles, AnchorsThatAccelerateShowInThePull) {
  Scene scene = block_and_tackle(2);
  World world(scene, direct_with_tensions(Gradient::mid));
  const double dt = 0.01, rate = 2;
  for (int i = 1; i <= 40; ++i) {
    for (const std::uint32_t anchor : {0u, 1u})
      world.move_anchor(anchor, scene.particles[anchor].position + Vec3{0, rate / 2 * i * dt * i * dt, 0});
    world.step(dt);
  }
  EXPECT_NEAR((world.reaction(0) + world.reaction(1)).y, 100 * (g + rate), 1e-6);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
