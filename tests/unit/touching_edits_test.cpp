// Edits of islands that touch others, and of those with springs and bodies.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "contact/edits/part_edits.hpp"
#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;

constexpr double frame = 1.0 / 60;

/// Appends a rope of rods of 0.1 m with capsules along them.
void add_rope(Scene& scene, Vec3 from, Vec3 way, std::uint32_t rods, bool is_anchored, Vec3 velocity = {}) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back({.position = from + 0.1 * i * way,
                               .velocity = is_anchored ? Vec3{} : velocity,
                               .mass = 0.1,
                               .fixed = is_anchored && i == 0});
  for (std::uint32_t i = 0; i < rods; ++i) {
    scene.rods.push_back({.a = first + i, .b = first + i + 1});
    scene.capsules.push_back({.a = point_at(first + i), .b = point_at(first + i + 1), .radius = 0.02});
  }
}

/// Two ropes that fly into each other, and a third one that hangs far away.
Scene crossing() {
  Scene scene;
  scene.gravity = {};
  add_rope(scene, {0, 0, 0}, {1, 0, 0}, 12, false);
  add_rope(scene, {0.62, 0.03, -0.5}, {0, 0, 1}, 10, false, {0, -1, 0});
  add_rope(scene, {9, 0, 0}, {0, 1, 0}, 6, true);
  return scene;
}
constexpr std::uint32_t flying = 24;  // particles of the first two

/// A rope that lies on another one, on a floor.
Scene lying() {
  Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  add_rope(scene, {0, 0.02, 0}, {1, 0, 0}, 12, false);
  add_rope(scene, {0.62, 0.07, -0.5}, {0, 0, 1}, 10, false);
  add_rope(scene, {9, 2, 0}, {1, 0, 0}, 6, true);
  return scene;
}

Vec3 momentum(const World& world, std::uint32_t count) {
  Vec3 sum;
  for (std::uint32_t i = 0; i < count; ++i) sum += 0.1 * world.velocity(i);
  return sum;
}

Settings settings_of(Method method, unsigned threads = 1) {
  Settings settings{.method = method,
                    .substeps = 4,
                    .tensions = true,
                    .contacts = true,
                    .events = true,
                    .threads = threads};
  if (method == Method::relax) settings.stop.sweeps = 50;
  return settings;
}

template <class F>
void for_all(F&& f) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax}) {
    SCOPED_TRACE(std::string(to_string(method)));
    f(settings_of(method));
  }
}

/// Returns the step in which the ropes of crossing() first touch, counted from 1.
int steps_until_contact(World& world) {
  for (int step = 1; step <= 60; ++step) {
    world.step(frame / 4);
    if (!world.contacts().empty()) return step;
  }
  return 0;
}

TEST(PartEdits, AreNoneUntilOneIsListed) {
  detail::PartEdits edits;
  EXPECT_FALSE(edits.any());
  edits.cut.push_back(1);
  EXPECT_TRUE(edits.any());
}

// Nothing but the ropes' pushes on each other acts, whose sum is zero.
TEST(TouchingEdits, KeepMomentumInACut) {
  for_all([](const Settings& settings) {
    World world(crossing(), settings);
    ASSERT_GT(steps_until_contact(world), 0);
    const Vec3 before = momentum(world, flying);
    std::vector<Vec3> x = test::positions_of(world), v = test::velocities_of(world);
    world.cut(5);
    world.cut(16);
    EXPECT_EQ(test::positions_of(world), x);
    EXPECT_EQ(test::velocities_of(world), v);
    const StepReport report = world.step(frame / 4);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_EQ(world.info().islands, 5u);
    for (int i = 0; i < 40; ++i) world.step(frame / 4);
    EXPECT_LE(norm(momentum(world, flying) - before), 1e-12 * norm(before) + 1e-14);
    EXPECT_GT(norm(world.position(5) - world.position(6)), 0.1 + 1e-6);
    EXPECT_TRUE(world.is_broken(5));
    EXPECT_EQ(world.tension(5), 0);
  });
}

// The rope flies freely until it is fixed, and touches the other one after that.
TEST(TouchingEdits, FixWhatFliesWhereItIs) {
  Scene scene = crossing();
  for (std::uint32_t i = 13; i < flying; ++i) scene.particles[i].position.y += 0.15;
  for_all([&](const Settings& settings) {
    World world(scene, settings);
    world.step(frame);
    ASSERT_TRUE(world.contacts().empty());
    const Vec3 place = world.position(23);
    world.fix(23);
    EXPECT_GT(steps_until_contact(world), 0);
    EXPECT_LE(norm(world.position(23) - place), 1e-15);
  });
}

// Parts of a rope are near each other in their first step, and go home when they are not.
TEST(TouchingEdits, GoHomeAfterTheFirstStep) {
  for_all([](Settings settings) {
    for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
      settings.gradient = gradient;
      settings.accuracy = 1e-3;
      Scene scene;
      add_rope(scene, {0, 1.3, 0}, {0.6, -0.8, 0}, 4, true);
      for (Rod& rod : scene.rods) rod.mass = 0.1;
      World world(scene, settings);
      test::run(world, frame / 2, 2);
      world.fix(2);
      test::run(world, frame / 2, 1);
      world.fix(3);
      EXPECT_EQ(test::run(world, frame / 2, 5).frozen_islands, 0u);
      EXPECT_GT(norm(world.velocity(4)), 0.1);
    }
  });
}

// Both halves go on lying, and what is not touched keeps its bits.
TEST(TouchingEdits, LeaveOthersTheirBits) {
  for_all([](const Settings& settings) {
    World world(lying(), settings), other(lying(), settings);
    test::run(world, frame, 30);
    test::run(other, frame, 30);
    EXPECT_FALSE(world.contacts().empty());
    world.cut(5);
    world.set_mass(15, 0.3);
    world.fix(2);
    test::run(world, frame, 60);
    test::run(other, frame, 60);
    for (std::uint32_t i = flying; i < world.particle_count(); ++i) {
      EXPECT_EQ(world.position(i), other.position(i)) << i;
      EXPECT_EQ(world.velocity(i), other.velocity(i)) << i;
    }
    for (std::uint32_t i = 0; i < flying; ++i) EXPECT_GT(world.position(i).y, 0.015) << i;
    EXPECT_EQ(world.velocity(2), Vec3{});
    EXPECT_TRUE(world.problems().empty());
  });
}

// The capsule along a rod ends with it: nothing touches it, nor is it listed.
TEST(TouchingEdits, EndTheCapsuleAlongACutRod) {
  for_all([](const Settings& settings) {
    World world(lying(), settings);
    test::run(world, frame, 30);
    EXPECT_GT(norm(world.contact_force(ShapeId{ShapeKind::capsule, 5})), 0);
    world.cut(5);
    test::run(world, frame, 3);
    EXPECT_EQ(world.contact_force(ShapeId{ShapeKind::capsule, 5}), Vec3{});
    EXPECT_GT(norm(world.contact_force(ShapeId{ShapeKind::capsule, 1})), 0);
    std::size_t named = 0;
    for (const Contact& contact : world.contacts()) {
      EXPECT_FALSE((contact.a == ShapeId{ShapeKind::capsule, 5})) << "it has ended";
      named += contact.a.kind == ShapeKind::capsule;
    }
    EXPECT_GT(named, 0u);
  });
}

// Ropes that share a solver of rods: what is removed while it touches others leaves those that fly moving.
TEST(TouchingEdits, LetOthersFlyWhenWhatTouchesIsRemoved) {
  for_all([](const Settings& settings) {
    Scene scene = crossing();
    add_rope(scene, {5, 0, 0}, {1, 0, 0}, 10, false, {0, 1, 0});
    World world(scene, settings);
    ASSERT_GT(steps_until_contact(world), 0);
    world.cut(5);
    world.step(frame / 4);
    world.remove(23);
    const double before = world.position(33).y;
    test::run(world, frame, 6);
    EXPECT_NEAR(world.position(33).y - before, 0.1, 1e-9);
    EXPECT_GT(norm(world.velocity(0)), 1e-3);
    const Vec3 place = world.position(0);
    test::run(world, frame, 1);
    EXPECT_NEAR(norm(world.position(0) - place), frame * norm(world.velocity(0)), 1e-4);
  });
}

// What lay on a rope goes on without it, as in a world that has it no more, and the rope is known no more.
TEST(TouchingEdits, RemoveWhatLies) {
  for_all([](const Settings& settings) {
    World world(lying(), settings);
    test::run(world, frame, 20);
    Scene left;
    left.planes = lying().planes;
    add_rope(left, {}, {1, 0, 0}, 10, false);
    for (std::uint32_t i = 0; i < 11; ++i) {
      left.particles[i].position = world.position(13 + i);
      left.particles[i].velocity = world.velocity(13 + i);
    }
    for (Rod& rod : left.rods) rod.length = 0.1;
    World fresh(left, settings);
    world.remove(3);
    expect_refusal("particle 3: was removed", [&] { (void)world.position(3); });
    EXPECT_EQ(world.info().islands, 2u);
    test::run(world, frame, 2);
    test::run(fresh, frame, 2);
    for (std::uint32_t i = 0; i < 11; ++i)
      EXPECT_LE(norm(world.position(13 + i) - fresh.position(i)), 1e-4) << i;
    EXPECT_EQ(world.contact_force(ShapeId{ShapeKind::capsule, 3}), Vec3{});
  });
}

// Where nothing touches a rope, its home makes it anew as a world that begins there does.
TEST(TouchingEdits, EqualAWorldThatIsCompiledAfresh) {
  const Scene start = crossing();
  const Settings settings{.gradient = Gradient::mid, .substeps = 4, .threads = 1};
  World world(start, settings);
  test::run(world, frame / 4, 2);
  Scene scene = start;
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    scene.particles[i].position = world.position(i);
    if (!scene.particles[i].fixed) scene.particles[i].velocity = world.velocity(i);
  }
  for (Rod& rod : scene.rods) rod.length = 0.1;
  scene.particles[4].mass = 0.25;
  scene.rods.erase(scene.rods.begin() + 7);
  scene.capsules.erase(scene.capsules.begin() + 7);
  World fresh(scene, settings);
  world.cut(7);
  world.set_mass(4, 0.25);
  world.step(1e-4);
  fresh.step(1e-4);
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    EXPECT_LE(norm(world.position(i) - fresh.position(i)), 1e-12) << i;
    EXPECT_LE(norm(world.velocity(i) - fresh.velocity(i)), 1e-9) << i;
  }
}

// A spring that was changed keeps its law when its island is made anew, and parts without one go.
TEST(TouchingEdits, KeepTheLawsOfSprings) {
  Scene scene;
  scene.gravity = {};
  add_rope(scene, {0, 0, 0}, {1, 0, 0}, 8, false);
  scene.springs.push_back({.a = point_at(0), .b = point_at(2), .length = 0.2, .stiffness = 5});
  for_all([&](const Settings& settings) {
    World world(scene, settings);
    test::run(world, frame, 3);
    Spring drawn = scene.springs[0];
    drawn.length = 0.15;
    world.set_spring(0, drawn);
    world.cut(4);
    test::run(world, frame, 1);
    EXPECT_EQ(world.info().islands, 2u);
    EXPECT_NEAR(norm(world.spring_force(0)), 5 * 0.05, 0.02);
    EXPECT_NEAR(norm(momentum(world, 9)), 0, 1e-12);
    world.set_mass(2, 0.4);
    test::run(world, frame, 1);
    world.join({.a = 2, .b = 6});
    test::run(world, frame, 1);
    EXPECT_EQ(world.info().islands, 1u);
    EXPECT_NEAR(norm(world.spring_force(0)), 5 * 0.05, 0.02);
    EXPECT_NEAR(norm(momentum(world, 9) + 0.3 * world.velocity(2)), 0, 1e-12);
  });
}

// A snapshot repeats what was done, whoever reads it, and threads change no bits.
TEST(TouchingEdits, AreKnownToSnapshots) {
  for_all([](const Settings& settings) {
    Settings with_two = settings;
    with_two.threads = 2;
    World world(lying(), settings), two(lying(), with_two), late(lying(), settings);
    for (World* const each : {&world, &two}) {
      test::run(*each, frame, 20);
      each->cut(5);
      each->set_mass(15, 0.3);
      test::run(*each, frame, 5);
      each->cut(9);
      each->fix(1);
      test::run(*each, frame, 5);
    }
    EXPECT_EQ(world.state_hash(), two.state_hash());
    std::vector<std::byte> bytes(world.snapshot_size());
    world.save(bytes);
    late.restore(bytes);
    EXPECT_EQ(world.state_hash(), late.state_hash());
    for (World* const each : {&world, &two, &late}) {
      each->cut(18);
      test::run(*each, frame, 20);
    }
    EXPECT_EQ(world.state_hash(), late.state_hash());
    EXPECT_EQ(world.state_hash(), two.state_hash());
  });
}

// A grab goes on pulling what it pulled.
TEST(TouchingEdits, KeepGrabs) {
  for_all([](const Settings& settings) {
    World world(lying(), settings);
    test::run(world, frame, 10);
    const Handle<Grab> grab =
        world.grab({.at = point_at(12), .target = {1.2, 0.5, 0}, .stiffness = 200, .damping = 5});
    test::run(world, frame, 10);
    world.cut(5);
    test::run(world, frame, 60);
    EXPECT_TRUE(world.has(grab));
    EXPECT_GT(world.position(12).y, 0.3);
    EXPECT_LT(world.position(0).y, 0.1);
  });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
