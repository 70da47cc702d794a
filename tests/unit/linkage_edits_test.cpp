// Particles of islands with joints that are fixed and freed while a world runs, and rods that join them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "contact/edits/meeting.hpp"
#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::add_crate;
using test::add_figure;
using test::add_hose;
using test::add_rope;
using test::expect_refusal;
using test::for_jointed_settings;

constexpr double frame = 1.0 / 60;

/// A figure of two bodies that flies, a crate, a rope that hangs with shapes and one without, and a hose.
/// Their first particles:
constexpr std::uint32_t figure = 0, box = 8, shaped = 12, bare = 17, hose = 22;
Scene several() {
  Scene scene;
  add_figure(scene, {0, 2, 0});
  add_crate(scene, {2, 2, 0});
  add_rope(scene, {4, 2, 0}, {0, -1, 0}, true, 0.01);
  add_rope(scene, {6, 2, 0}, {0, -1, 0}, true, 0);
  add_hose(scene, {8, 2, 0}, true);
  return scene;
}

void step(World& world, int times) {
  for (int i = 0; i < times; ++i) world.step(frame);
}

/// Expects a world to go on as one that begins as it is, but for what gradients old and new and sweeps
/// remember of the last step. Where nothing was edited, they are as far off: 2e-7, 2e-5 and 4e-4 m.
void expect_as_fresh(World& world, const Settings& settings) {
  World fresh(world.scene(), settings);
  ASSERT_EQ(fresh.particle_count(), world.particle_count());
  for (int i = 0; i < 3; ++i) {
    world.step(frame);
    fresh.step(frame);
  }
  double most = 0;
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    most = std::max(most, norm(world.position(i) - fresh.position(i)));
  const bool is_relaxed = settings.method == Method::relax;
  const double left = *settings.gradient == Gradient::mid   ? 1e-9
                      : *settings.gradient == Gradient::old ? 1e-6
                                                            : 1e-4;
  EXPECT_LE(most, is_relaxed ? 1e-3 : left);
  EXPECT_EQ(world.info().islands, fresh.info().islands);
}

Momentum momentum(const World& world, const Settings& settings) {
  return measure_momentum(world.scene(), test::positions_of(world), test::velocities_of(world),
                          settings.method == Method::relax ? MassModel::lumped : MassModel::consistent);
}

/// Returns the largest strain of rods that do not give.
double strain(const World& world) {
  Scene scene = world.scene();
  std::erase_if(scene.rods, [](const Rod& rod) { return rod.law.is_elastic(); });
  return measure_stretch(scene, test::positions_of(world)).max;
}

// What two parts have is there once, as the first has it, and all names its particles by their new places.
TEST(NamedParts, JoinInTheOrderOfNumbers) {
  detail::NamedPart parts[2];
  add_crate(parts[0].scene, {});
  parts[0].names.particles = {9, 4, 7, 8};
  parts[0].names.rods = {11, 12, 13, 14, 15, 16};
  parts[0].names.bodies = {1};
  parts[0].names.hulls = {2};
  parts[0].scene.particles[1].mass = 3;
  add_crate(parts[1].scene, {});
  parts[1].names.particles = {1, 2, 3, 4};
  parts[1].names.rods = {5, 6, 7, 8, 9, 10};
  parts[1].names.bodies = {0};
  parts[1].names.hulls = {3};
  detail::Meeting meeting{{}, {}, {}, detail::joined(parts), {}, {}};
  const detail::NamedPart& all = meeting.others;
  EXPECT_EQ(all.names.particles, (Array<std::uint32_t>{1, 2, 3, 4, 7, 8, 9}));
  EXPECT_EQ(all.scene.particles[3].mass, 3);
  EXPECT_EQ(all.scene.bodies[1].particles, (std::array<std::uint32_t, 4>{6, 3, 4, 5}));
  EXPECT_EQ(all.scene.hulls[0].body, 1u);
  EXPECT_EQ(all.scene.hulls[1].body, 0u);
  EXPECT_EQ(all.scene.rods[6].a, 6u);
  EXPECT_EQ(detail::Met{}.were.size(), 0u);
}

TEST(LinkageEdits, FixAHandAndLetItGo) {
  for_jointed_settings([](const Settings& settings) {
    World world(several(), settings);
    step(world, 10);
    const Vec3 place = world.position(figure + 5);
    world.fix(figure + 5);
    step(world, 1);
    EXPECT_EQ(world.position(figure + 5), place);
    EXPECT_EQ(world.info().islands, 5u);
    step(world, 20);
    EXPECT_EQ(world.position(figure + 5), place);
    EXPECT_LT(norm(world.position(figure) - place), 1.0);
    expect_as_fresh(world, settings);
    world.free(figure + 5);
    step(world, 1);
    EXPECT_NE(world.position(figure + 5), place);
    expect_as_fresh(world, settings);
    const double y = world.pose(1).position.y;
    step(world, 30);
    EXPECT_LT(world.pose(1).position.y, y - 0.5);
    EXPECT_TRUE(world.problems().empty());
  });
}

// The rods between fixed particles pull nothing, and are there again when these are free.
TEST(LinkageEdits, HoldACrateByACornerAnEdgeAndAFace) {
  for_jointed_settings([](const Settings& settings) {
    World world(several(), settings);
    for (const std::uint32_t k : {0u, 1u, 2u}) {
      world.fix(box + k);
      step(world, 5);
      expect_as_fresh(world, settings);
    }
    const Pose held = world.pose(2);
    step(world, 5);
    EXPECT_LE(norm(world.pose(2).position - held.position), 1e-9);
    for (const std::uint32_t k : {0u, 1u, 2u}) world.free(box + k);
    step(world, 1);
    expect_as_fresh(world, settings);
    step(world, 20);
    EXPECT_LT(world.pose(2).position.y, held.position.y - 0.3);
    EXPECT_LE(strain(world), settings.method == Method::relax ? 1e-2 : 1e-9);
  });
}

TEST(LinkageEdits, FreeAFigureFromItsAnchor) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene;
    add_figure(scene, {0, 2, 0});
    scene.particles[1].fixed = true;
    add_rope(scene, scene.particles[1].position, {0, 0, 1}, true, 0);
    scene.rods[scene.rods.size() - 4].a = 1;  // the rope hangs from the figure's anchor, too
    World world(scene, settings);
    step(world, 10);
    world.free(1);
    step(world, 1);
    EXPECT_EQ(world.info().islands, 1u);
    const Momentum before = momentum(world, settings);
    step(world, 6);
    const double mass = 2 + 4 * 0.1;
    EXPECT_NEAR(momentum(world, settings).linear.y - before.linear.y, -9.81 * mass * 6 * frame, 1e-9);
    EXPECT_NEAR(momentum(world, settings).linear.x, before.linear.x, 1e-9);
    expect_as_fresh(world, settings);
  });
}

// Ropes, crates and figures come together, and momentum and angular momentum stay.
TEST(LinkageEdits, JoinAllToAll) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene = several();
    scene.gravity = {};
    for (Particle& each : scene.particles) each.fixed = false;
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      scene.particles[i].velocity = {0.3 * (i % 3), -0.2 * (i % 5), 0.1};
    World world(scene, settings);
    step(world, 3);
    const Momentum before = momentum(world, settings);
    const auto join = [&](std::uint32_t a, std::uint32_t b, const RodLaw& law = {}) {
      return world.join({.a = a, .b = b, .law = law});
    };
    const Handle<Rod> first = join(figure + 6, bare), second = join(bare + 4, shaped);
    join(shaped + 4, box + 1);
    join(box + 2, hose, {.stiffness = 2e3, .damping = 1});
    join(figure, hose + 3);  // a ring of all
    world.step(frame / 100);
    EXPECT_EQ(world.info().islands, 1u);
    const Momentum after = momentum(world, settings);
    const bool is_relaxed = settings.method == Method::relax;
    EXPECT_LE(norm(after.linear - before.linear), is_relaxed ? 1e-9 : 1e-10);
    if (!is_relaxed) {
      EXPECT_LE(norm(after.angular - before.angular), 1e-3 * norm(before.angular));
    }
    step(world, 20);
    expect_as_fresh(world, settings);
    EXPECT_LE(strain(world), is_relaxed ? 5e-2 : 1e-9);
    world.cut(world.number(first));
    world.cut(world.number(second));
    step(world, 1);
    EXPECT_EQ(world.info().islands, 2u);
    expect_as_fresh(world, settings);
    EXPECT_TRUE(world.problems().empty());
  });
}

// A rod with mass along it comes with half of that for each end where masses are lumped, and ropes with
// shapes get rods that give.
TEST(LinkageEdits, JoinRodsWithMassThatGive) {
  for_jointed_settings([](const Settings& settings) {
    World world(several(), settings);
    step(world, 3);
    world.join({.a = box, .b = shaped + 3, .mass = 0.2});
    world.join({.a = hose + 3, .b = hose + 1, .length = 0.21, .law = {.stiffness = 500, .damping = 1}});
    step(world, 1);
    expect_as_fresh(world, settings);
    world.join({.a = shaped + 4, .b = bare + 4, .law = {.stiffness = 800, .one_sided = true}});
    step(world, 2);
    EXPECT_EQ(world.info().islands, 3u);
    expect_as_fresh(world, settings);
    world.set_mass(box, 0.4);
    world.free(shaped);
    world.free(hose);
    step(world, 1);
    expect_as_fresh(world, settings);
  });
}

// What holds a thing up is its weight, whichever of its particles stand, once it hangs still.
TEST(LinkageEdits, KnowWhatHolds) {
  for (const Method method : {Method::direct, Method::relax}) {
    SCOPED_TRACE(to_string(method));
    Settings settings{.method = method, .gradient = Gradient::mid, .substeps = 8, .tensions = true};
    if (method == Method::relax) settings.stop.sweeps = 200;
    World world(several(), settings);
    step(world, 2);
    for (const std::uint32_t k : {0u, 1u, 2u}) world.fix(box + k);
    step(world, 10);
    Vec3 sum;
    for (const std::uint32_t k : {0u, 1u, 2u}) sum += world.reaction(box + k);
    const double left = method == Method::relax ? 0.1 : 1e-6;  // what 200 sweeps leave
    EXPECT_NEAR(sum.y, 9.81, left);
    EXPECT_NEAR(sum.x, 0, left);
    world.free(box + 1);
    world.free(box + 2);
    step(world, 1);
    world.fix(box + 1);
    step(world, 1);
    expect_refusal("particle 10", [&] { world.reaction(box + 2); });
    EXPECT_TRUE(is_finite(world.reaction(box)));
  }
}

// A winch lowers a rope before, while and after a figure comes to hang from it, without a jerk.
TEST(LinkageEdits, GoOnWinding) {
  constexpr std::uint32_t winch = 22;  // the first rod of the rope without shapes
  for_jointed_settings([](const Settings& settings) {
    World world(several(), settings);
    double length = 0.1;
    const auto wind = [&] {
      length += 0.002;
      world.set_length(winch, length);
      world.step(frame);
    };
    for (int i = 0; i < 10; ++i) wind();
    world.join({.a = bare + 4, .b = figure + 1});
    wind();
    EXPECT_LE(std::abs(norm(world.position(bare + 1) - world.position(bare)) - length), 1e-3);
    wind();
    EXPECT_NEAR(world.velocity(bare + 1).y, -0.002 / frame, 0.05);
    for (int i = 0; i < 10; ++i) wind();
    EXPECT_LE(std::abs(norm(world.position(bare + 1) - world.position(bare)) - length), 1e-3);
    step(world, 2);
    expect_as_fresh(world, settings);
    world.set_length(winch, 0.5 * length);
    step(world, 2);
    EXPECT_LE(std::abs(norm(world.position(bare + 1) - world.position(bare)) - 0.5 * length), 1e-3);
  });
}

// Snapshots, other settings and threads know of all that.
TEST(LinkageEdits, ComeBackFromSnapshots) {
  for_jointed_settings([](const Settings& settings) {
    const Scene scene = several();
    World world(scene, settings);
    const auto edit = [&] {
      step(world, 3);
      world.set_length(22, 0.12);
      step(world, 2);
      world.fix(figure + 5);
      world.join({.a = box, .b = bare + 4, .mass = 0.1});
      step(world, 4);
      world.fix(box + 1);
      world.free(bare);
      step(world, 4);
      world.free(box + 1);
      world.join({.a = hose + 3, .b = shaped + 4});
      step(world, 2);
    };
    edit();
    std::vector<std::byte> state(world.snapshot_size());
    world.save(state);
    World other(scene, settings);
    other.restore(state);
    EXPECT_EQ(other.state_hash(), world.state_hash());
    std::vector<std::byte> again(other.snapshot_size());
    other.save(again);
    EXPECT_EQ(again, state);
    for (World* const each : {&world, &other}) {
      step(*each, 2);
      each->free(figure + 5);
      each->fix(bare + 2);
      step(*each, 10);
    }
    EXPECT_EQ(other.state_hash(), world.state_hash());
    Settings finer = settings;
    finer.substeps = 8;
    finer.method = settings.method == Method::relax ? Method::direct : Method::relax;
    finer.stop = {};
    const std::vector<Vec3> before = test::positions_of(world);
    world.set_settings(finer);
    EXPECT_EQ(test::positions_of(world), before);
    step(world, 1);
    world.set_settings(settings);
    world.fix(hose + 3);
    step(world, 10);
    EXPECT_TRUE(test::all_finite(world));
    World back(scene, settings);
    back.restore(state);
    EXPECT_EQ(back.state_hash(), [&] {
      World once(scene, settings);
      once.restore(state);
      return once.state_hash();
    }());
  });
}

TEST(LinkageEdits, AreTheSameOnTwoThreads) {
  for (const Method method : {Method::automatic, Method::relax}) {
    std::vector<std::uint64_t> hashes;
    for (const unsigned threads : {1u, 2u}) {
      World world(several(), {.method = method, .substeps = 4, .threads = threads});
      step(world, 3);
      world.join({.a = box, .b = bare + 4});
      world.fix(figure + 2);
      step(world, 3);
      world.free(bare);
      world.fix(box + 3);
      step(world, 30);
      hashes.push_back(world.state_hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]) << to_string(method);
  }
}

// Equal crates are of one kind, which knows where the first of them stood: each keeps its own mass there.
TEST(LinkageEdits, BringTogetherWhatIsAlike) {
  for_jointed_settings([](const Settings& settings) {
    Scene scene;
    for (const double x : {2.0, 2.5, 3.25}) add_crate(scene, {x, 2, 0});  // alike to the last bit
    World world(scene, settings);
    step(world, 5);
    world.join({.a = 5, .b = 10});
    const Momentum before = momentum(world, settings);
    step(world, 1);
    EXPECT_LE(norm(momentum(world, settings).linear - before.linear - Vec3{0, -9.81 * 3 * frame, 0}), 1e-12);
    expect_as_fresh(world, settings);
    EXPECT_EQ(world.info().islands, 2u);
  });
}

TEST(LinkageEdits, RefuseWhatLeavesNothingToMove) {
  World world(several(), {});
  for (const std::uint32_t k : {0u, 1u, 2u}) world.fix(box + k);
  expect_refusal("particle 11: cannot be fixed, since nothing of body 2 could move then",
                 [&] { world.fix(box + 3); });
  step(world, 1);
  expect_refusal("particle 11: cannot be fixed, since nothing of body 2 could move then",
                 [&] { world.fix(box + 3); });
  world.free(box);
  world.fix(box + 3);
  step(world, 1);
  world.fix(hose + 2);
  expect_refusal("particle 23: cannot be fixed, since both ends of a rod of bend 0 would be",
                 [&] { world.fix(hose + 1); });
  Scene ground = several();
  std::erase_if(ground.rods, [](const Rod& rod) { return rod.a >= box && rod.a < box + 4; });
  for (const std::uint32_t k : {0u, 1u, 2u, 3u}) ground.particles[box + k].fixed = true;
  ground.hulls.clear();
  World standing(ground, {});
  expect_refusal("particle 8: is of body 2, which is ground", [&] { standing.free(box); });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
