// Ropes and nets that land on ground and on each other: work, strain, depth, energy and momentum.

#include <gtest/gtest.h>

#include <algorithm>

#include "plumb/measures.hpp"
#include "scenes/generators/falling.hpp"
#include "support/bodies.hpp"
#include "support/reactions.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

struct Fall {
  std::uint64_t newton = 0;      ///< in the frame that took most
  double strain = 0, depth = 0;  ///< the largest
  StepReport total{};
};

Fall run_through(const Scene& scene, World& world, int frames) {
  Fall fall;
  for (int i = 0; i < frames; ++i) {
    const StepReport report = world.step(frame);
    fall.newton = std::max(fall.newton, report.newton);
    fall.total += report;
    fall.strain = std::max(fall.strain, test::stretch_of(scene, world).max);
    fall.depth = std::max(fall.depth, test::deepest(scene, world));
  }
  return fall;
}

// A straight rope of rigid rods with a ripple lands everywhere at once, and friction presses it together.
// Many arrangements of what sticks and slides fit nearly; a rope of 1000 rods once took 20,000 Newton steps.
TEST(FallingRope, LandsInAsManyNewtonStepsWhateverItsLength) {
  for (const std::uint32_t links : {100u, 400u, 1600u}) {
    const Scene scene = scenes::make_rope({.links = links});
    World world(scene, {.threads = 1});
    const Fall fall = run_through(scene, world, 60);
    EXPECT_LE(fall.newton, 100u) << links;
    EXPECT_EQ(fall.total.unsolved, 0u);
    EXPECT_LT(fall.strain, 1e-6);
    EXPECT_LT(fall.depth, 1e-3);
    EXPECT_GE(fall.total.contact_points, links);
  }
}

TEST(FallingRope, CoilsWithoutStretching) {
  for (const std::uint32_t links : {60u, 240u}) {
    const Scene scene = scenes::make_rope({.links = links, .coil = 0.3});
    World world(scene, {.threads = 1});
    const Fall fall = run_through(scene, world, 90);
    EXPECT_EQ(fall.total.unsolved, 0u);
    EXPECT_LE(fall.newton, 1000u) << links;
    EXPECT_LT(fall.strain, 1e-6);
    // Overlaps of 0.5 mm are left (ContactSettings::slop), and a blow may go as deep again. Of 240 rods, 13
    // turns come down on the lowest one, and press it in by as much once more.
    EXPECT_LT(fall.depth, links == 60 ? 1e-3 : 1.5e-3);
  }
}

// Turns of a coil lie on each other, so that pushes of thousands of places follow from each other. What is
// not solved would be relaxed, which counts as a fallback. Without sweeps of free particles a coil of 100
// rods had 128 of them. Those that are let be are of the blow, where ground has more places than its matrix
// and the rope touches itself in few.
TEST(FallingRope, CoilsByMethodDirectWithoutStretching) {
  for (const std::uint32_t links : {60u, 240u}) {
    const Scene scene = scenes::make_rope({.links = links, .coil = 0.3});
    World world(scene, {.method = Method::direct, .threads = 1});
    double before = test::energy_of(scene, world).total();
    const double highest = before;
    StepReport total{};
    double strain = 0, depth = 0;
    for (int i = 0; i < 90; ++i) {
      total += world.step(frame);
      strain = std::max(strain, test::stretch_of(scene, world).max);
      depth = std::max(depth, test::deepest(scene, world));
      const double now = test::energy_of(scene, world).total();
      EXPECT_LT(now, before + 1e-6 * highest) << links << ", " << i;
      before = now;
    }
    EXPECT_EQ(total.unsolved, 0u);
    EXPECT_EQ(total.missed_contacts, 0u);
    EXPECT_LE(total.fallbacks, 10u) << links;
    EXPECT_LT(strain, 1e-6);
    EXPECT_LT(depth, 1e-3);
  }
}

// What touches in many places is relaxed, and its rods are brought to their lengths after every step. That
// moves them into what they touch by a part of what relaxation left.
TEST(Heap, IsRelaxedAndKeepsItsLengths) {
  const scenes::HeapShape shape{.ropes = 8, .links = 12};
  const Scene scene = scenes::make_heap(shape);
  World world(scene, {.threads = 1});
  double before = test::energy_of(scene, world).total();
  const double highest = before;
  for (int i = 0; i < 150; ++i) {
    const StepReport report = world.step(frame);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_LE(report.newton, 3000u);
    EXPECT_LT(test::stretch_of(scene, world).max, 1e-6) << i;
    EXPECT_LT(test::deepest(scene, world), shape.radius / 5) << i;
    const double now = test::energy_of(scene, world).total();
    // What a projection lifts by a share of a radius.
    EXPECT_LT(now, before + 1e-3 * highest) << i;
    before = now;
  }
}

TEST(Heap, IsSolvedByMethodDirectUnlessItCannotBe) {
  const Scene scene = scenes::make_heap({.ropes = 4, .links = 10});
  World world(scene, {.method = Method::direct, .threads = 1});
  const Fall fall = run_through(scene, world, 60);
  EXPECT_EQ(fall.total.unsolved, 0u);
  EXPECT_LT(fall.strain, 1e-6);
  EXPECT_LE(fall.newton, 5000u);
}

TEST(Net, DrapesABoxWithoutStretching) {
  const scenes::DrapeShape shape{.size = 12};
  const Scene scene = scenes::make_drape(shape);
  World world(scene, {.threads = 1});
  const Fall fall = run_through(scene, world, 90);
  EXPECT_EQ(fall.total.unsolved, 0u);
  EXPECT_LT(fall.strain, 1e-6);
  EXPECT_LT(fall.depth, shape.radius / 2);
  EXPECT_GT(world.position(6 * shape.size + 6).y, 2 * scene.boxes[0].half_size.y) << "it lies on the box";
  EXPECT_LT(world.position(0).y, scene.boxes[0].half_size.y) << "its corners hang";
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
