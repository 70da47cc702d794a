// Crates, jointed bodies, springs and air that are added to a world while it runs, and removed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scene/lists/by_kind.hpp"
#include "scene/lists/digest.hpp"
#include "scene/lists/scene_members.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::expect_refusal;

constexpr double frame = 1.0 / 60, half = 0.1;

using test::add_crate;
using test::add_figure;
using test::add_hose;
using test::crate;
using test::figure;
using test::floor_alone;
using test::for_jointed_settings;
using test::hose;

void step(World& world, int times) {
  for (int i = 0; i < times; ++i) world.step(frame);
}

/// Expects two worlds to be the same to the bit in all that can be read. NaN is what is not known yet.
void expect_alike(const World& one, const World& other) {
  ASSERT_EQ(one.state_hash(), other.state_hash());
  ASSERT_EQ(one.body_count(), other.body_count());
  for (std::uint32_t i = 0; i < one.body_count(); ++i) {
    EXPECT_EQ(one.pose(i), other.pose(i)) << i;
    EXPECT_EQ(one.motion(i), other.motion(i)) << i;
  }
  EXPECT_EQ(one.pin_force(0), other.pin_force(0));
  EXPECT_EQ(one.angle_torque(0), other.angle_torque(0));
  EXPECT_EQ(one.spring_force(0), other.spring_force(0));
  EXPECT_EQ(one.torsion_torque(0), other.torsion_torque(0));
  EXPECT_EQ(one.torsion_angle(0), other.torsion_angle(0));
  for (std::uint32_t i = 0; i < one.rod_count(); ++i) EXPECT_EQ(one.tension(i), other.tension(i)) << i;
  ASSERT_EQ(one.contacts().size(), other.contacts().size());
  for (std::size_t i = 0; i < one.contacts().size(); ++i) {
    EXPECT_EQ(one.contacts()[i].a, other.contacts()[i].a);
    EXPECT_EQ(one.contacts()[i].b, other.contacts()[i].b);
    EXPECT_EQ(one.contacts()[i].impulse, other.contacts()[i].impulse);
  }
}

TEST(ByKind, ListsAllOfAScene) {
  Scene scene = floor_alone();
  add_figure(scene, {0, 1, 0});
  add_crate(scene, {1, 1, 0});
  add_hose(scene, {2, 1, 0}, true);
  const detail::ByKind<std::uint32_t> sizes = detail::sizes_of(scene);
  EXPECT_EQ(sizes.particles, scene.particles.size());
  EXPECT_EQ(sizes.alignments, 1u);
  EXPECT_EQ(sizes.hulls, 1u);
  std::uint32_t moved = 0;
  detail::for_lists(
      [&](std::size_t, auto& list) {
        for (auto& item : list) detail::for_particles(item, [&](std::uint32_t&) { ++moved; });
      },
      scene);
  const std::uint32_t of_points = 4 * (2 * (sizes.pins + sizes.springs + sizes.capsules) +
                                       4 * (sizes.alignments + sizes.angles) + 6 * sizes.torsions);
  EXPECT_EQ(moved, 2 * sizes.rods + 3 * sizes.bends + 4 * sizes.bodies + of_points);
}

TEST(Digest, TellsWhatDiffersInOneMember) {
  const auto digest_of = [](const Capsule& capsule) {
    detail::Digest out;
    out(capsule);
    return out.value();
  };
  const Capsule capsule{.a = point_at(1), .b = point_at(2), .radius = 0.1};
  EXPECT_EQ(digest_of(capsule), digest_of(Capsule(capsule)));
  const auto differs = [&](auto&& change) {
    Capsule other = capsule;
    change(other);
    return digest_of(other) != digest_of(capsule);
  };
  EXPECT_TRUE(differs([](Capsule& of) { of.a.particles[0] = 3; }));
  EXPECT_TRUE(differs([](Capsule& of) { of.b.weights[0] = 0.5; }));
  EXPECT_TRUE(differs([](Capsule& of) { of.radius = 0.2; }));
  EXPECT_TRUE(differs([](Capsule& of) { of.surface.spinning = 1; }));
  EXPECT_TRUE(differs([](Capsule& of) { of.filter.own_island = true; }));
}

// Everything that is added in turn moves as if the world began with it.
TEST(AddingBodies, DoAsTheyWouldFromTheStart) {
  Scene whole = floor_alone();
  add_figure(whole, {0, 0.9, 0});
  add_crate(whole, {0.1, 1.5, 0.02});
  add_hose(whole, {0.3, 0.5, -0.05}, true);
  for_jointed_settings([&](const Settings& settings) {
    if (settings.method == Method::relax && settings.gradient == Gradient::new_) return;  // not its own
    World begun(whole, settings), grown(floor_alone(), settings);
    EXPECT_EQ(grown.add(figure({0, 0.9, 0})).torsion, 0u);
    const Added box = grown.add(crate({0.1, 1.5, 0.02}));
    EXPECT_EQ(box.body, 2u);
    EXPECT_EQ(box.hull, 0u);
    EXPECT_EQ(grown.add(hose({0.3, 0.5, -0.05}, true)).capsule, 2u);
    EXPECT_EQ(grown.info().islands, begun.info().islands);
    EXPECT_EQ(grown.info().linkages, begun.info().linkages);
    for (int i = 0; i < 40; ++i) {
      begun.step(frame);
      grown.step(frame);
      ASSERT_NO_FATAL_FAILURE(expect_alike(begun, grown));
      EXPECT_EQ(begun.reaction(12), grown.reaction(12)) << "of the hose";
    }
    EXPECT_FALSE(grown.contacts().empty());
  });
}

// A world that began with ground alone keeps an accuracy for what comes.
TEST(AddingBodies, KeepTheAccuracyOfTheWorld) {
  Scene whole = floor_alone();
  add_crate(whole, {0, 0.5, 0});
  add_figure(whole, {3, 1.5, 0});
  for (const Method method : {Method::automatic, Method::direct}) {
    const Settings settings{.method = method, .accuracy = 1e-3};
    World grown(floor_alone(), settings), begun(whole, settings);
    grown.add(crate({0, 0.5, 0}));
    grown.add(figure({3, 1.5, 0}));
    step(grown, 30);
    step(begun, 30);
    // The accuracy is relative to the size of the first addition, and of the whole scene.
    for (std::uint32_t i = 0; i < 3; ++i)
      EXPECT_LE(norm(grown.pose(i).position - begun.pose(i).position), 1e-2);
  }
}

// A crate that is dropped on another comes to rest on it, its forces are its weight, and its number goes on.
TEST(AddingBodies, GetTheNumbersOfThoseThatAreGone) {
  Scene scene = floor_alone();
  add_crate(scene, {0, half, 0});
  add_figure(scene, {3, 1, 0});
  World world(scene, {.tensions = true, .events = true});
  const Added first = world.add(crate({0, 3 * half + 0.01, 0}));
  EXPECT_EQ(first.body, 3u);
  EXPECT_EQ(first.hull, 1u);
  step(world, 120);
  EXPECT_NEAR(world.pose(3).position.y, 3 * half, 1e-3);
  EXPECT_NEAR(world.contact_force({ShapeKind::hull, 1}).y, 9.81, 0.2);
  std::vector<Vec3> forces(4);
  world.copy_contact_forces(forces);
  EXPECT_EQ(forces[3], world.contact_force(ShapeId{ShapeKind::hull, 1})) << "added hulls come last";
  EXPECT_EQ(forces[3], world.contact_force(3u));

  // What lies on the removed one wakes and falls.
  world.remove(0);
  step(world, 60);
  EXPECT_NEAR(world.pose(3).position.y, half, 2e-3);
  expect_refusal("body 0: was removed", [&] { (void)world.pose(0); });
  EXPECT_FALSE(world.has_shape({ShapeKind::hull, 0}));
  std::vector<Pose> poses(world.body_count());
  world.copy_poses(poses);
  EXPECT_EQ(poses[0], Pose{});
  EXPECT_EQ(poses[3], world.pose(3));
  const Added again = world.add(crate({1, half, 0}));
  EXPECT_EQ(again.body, 0u);
  EXPECT_EQ(again.hull, 0u);
  EXPECT_EQ(again.particle, 0u);
  EXPECT_NEAR(world.pose(0).position.x, 1, 1e-12);

  // A figure goes with all its joints, from any of its particles.
  const std::uint32_t of_figure = 4 + 7;
  world.remove(of_figure);
  expect_refusal("pin 0: was removed", [&] { (void)world.pin_force(0); });
  expect_refusal("angle 0: was removed", [&] { (void)world.angle_torque(0); });
  expect_refusal("spring 0: was removed", [&] { world.set_spring(0, {.length = 1}); });
  expect_refusal("torsion 0: was removed", [&] { (void)world.torsion_angle(0); });
  expect_refusal("particle 4: was removed", [&] { (void)world.velocity(4); });
  EXPECT_EQ(world.add(figure({3, 1, 0})).pin, 0u);
  step(world, 10);
  EXPECT_TRUE(std::isfinite(norm(world.pin_force(0))));
}

// Removing and adding keeps memory, and a fresh world that is restored goes on alike.
TEST(AddingBodies, ComeBackWithSnapshots) {
  for_jointed_settings([](const Settings& settings) {
    World world(floor_alone(), settings);
    const Added gone = world.add(figure({5, 0.9, 0}));
    world.add(crate({0, 0.3, 0}));
    step(world, 6);
    world.remove(gone.particle);
    world.add(hose({0.05, 0.6, 0}, true));
    world.add(figure({0.1, 1.2, 0}));
    world.set_spring(0, {.length = 0.3, .stiffness = 8});
    step(world, 6);
    std::vector<std::byte> kept(world.snapshot_size());
    world.save(kept);
    const auto go_on = [](World& of) {
      step(of, 30);
      return of.state_hash();
    };
    const std::uint64_t hash = go_on(world);
    const Pose pose = world.pose(2);
    World fresh(floor_alone(), settings);
    fresh.restore(kept);
    EXPECT_EQ(go_on(fresh), hash);
    EXPECT_EQ(fresh.pose(2), pose);
    world.remove(world.body_count() > 0 ? 8 : 0);
    world.restore(kept);
    EXPECT_EQ(go_on(world), hash);
    EXPECT_EQ(world.pose(2), pose);
  });
}

TEST(AddingBodies, LeaveNothingOnceTheyAreGone) {
  World world(floor_alone(), {.tensions = true});
  world.add(hose({-1, 0.5, 0}, true));
  std::size_t size = 0;
  for (int i = 0; i < 20; ++i) {
    const Added added = world.add(figure({1.0 + i, 0.5, 0}));
    EXPECT_EQ(added.body, 0u);
    world.step(frame);
    world.remove(added.particle + 5);
    world.step(frame);
    if (i == 1) size = world.snapshot_size();
  }
  EXPECT_LE(world.snapshot_size(), size);
}

// Other settings take them over, edits know them, and motion goes on without a jump.
TEST(AddingBodies, AreMovedByOtherSettings) {
  for_jointed_settings([](const Settings& settings) {
    World world(floor_alone(), settings);
    const Added added = world.add(figure({0, 0.9, 0}));
    const Added hung = world.add(hose({1, 0.5, 0}, true));
    step(world, 10);
    const Pose before = world.pose(1);
    const double turned = world.torsion_angle(0);
    Settings changed = settings;
    changed.method = settings.method == Method::relax ? Method::direct : Method::relax;
    changed.gradient = Gradient::mid;
    changed.stop = changed.method == Method::relax ? StopRule{.sweeps = 30} : StopRule{};
    world.set_settings(changed);
    EXPECT_EQ(world.pose(1), before);
    EXPECT_NEAR(world.torsion_angle(0), turned, 1e-6);
    step(world, 2);
    EXPECT_LE(norm(world.pose(1).position - before.position), 0.2);
    world.cut(hung.rod + 1);
    step(world, 60);
    EXPECT_LE(world.position(hung.particle + 3).y, 0.05) << "it fell";
    EXPECT_GE(world.position(hung.particle + 1).y, 0.3) << "it hangs";
    world.remove(hung.particle + 3);
    EXPECT_TRUE(world.handle<Particle>(hung.particle + 1)) << "the rest hangs still";
    world.remove(hung.particle + 1);
    EXPECT_FALSE(world.handle<Particle>(hung.particle)) << "and took its anchor along";
    world.remove(added.particle);
    step(world, 2);
    EXPECT_EQ(world.info().islands, 0u);
  });
}

// What is added asleep stands still until something touches it, whatever sizes there are.
TEST(AddingBodies, SleepOnIfTheyDoSo) {
  World world(floor_alone(), {.events = true});
  Scene pile;
  for (int i = 0; i < 3; ++i) add_crate(pile, {0, (2 * i + 1) * half, 0});
  for (Particle& each : pile.particles) each.asleep = true;
  world.add(pile);
  for (int i = 0; i < 40; ++i) {
    Scene bead;
    bead.particles.push_back({.position = {2 + 0.03 * i, 0.01, 0}, .mass = 0.01, .asleep = true});
    bead.capsules.push_back({.a = point_at(0), .b = point_at(0), .radius = 0.01});
    world.add(bead);
  }
  const Vec3 top = world.pose(2).position;
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(world.step(frame).awake_islands, 0u);
    EXPECT_TRUE(world.events().empty());
  }
  EXPECT_EQ(world.pose(2).position, top);
  const Added ball = world.add(crate({0.05, 0.9, 0}));
  step(world, 30);
  EXPECT_NE(world.pose(2).position, top) << "it was hit";
  std::vector<std::byte> kept(world.snapshot_size());
  world.save(kept);
  World fresh(floor_alone(), {.events = true});
  fresh.restore(kept);
  step(world, 30);
  step(fresh, 30);
  EXPECT_EQ(fresh.state_hash(), world.state_hash());
  world.remove(ball.particle);
  step(world, 200);
  EXPECT_EQ(world.step(frame).awake_islands, 0u) << "all sleep again";
}

// Beads that touch and come together, asleep, do as they would from the start: one is hit, and all sleep
// again.
TEST(AddingBodies, SleepTogetherAsFromTheStart) {
  Scene beads, whole = floor_alone();
  for (int i = 0; i < 20; ++i) {
    beads.particles.push_back({.position = {0.1 * i, 0.05, 0}, .mass = 0.1, .asleep = true});
    const auto number = static_cast<std::uint32_t>(i);
    beads.capsules.push_back({.a = point_at(number), .b = point_at(number), .radius = 0.05});
  }
  whole.particles = beads.particles;
  whole.capsules = beads.capsules;
  World grown(floor_alone(), {.tensions = true}), begun(whole, {.tensions = true});
  const Added first = grown.add(beads);
  const Added ball = grown.add(crate({0.35, 0.5, 0}));
  begun.add(crate({0.35, 0.5, 0}));
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(grown.step(frame).awake_islands, begun.step(frame).awake_islands) << i;
    ASSERT_EQ(grown.state_hash(), begun.state_hash()) << i;
  }
  EXPECT_EQ(grown.step(frame).awake_islands, 0u);
  for (std::uint32_t i = 0; i < 20; ++i) grown.remove(first.particle + i);
  step(grown, 5);
  EXPECT_EQ(grown.contact_force({ShapeKind::capsule, 3}), Vec3{});
  EXPECT_TRUE(grown.has_shape({ShapeKind::hull, ball.hull}));
}

// What came and went leaves numbers, of which a restored world and other settings know nothing more.
TEST(AddingBodies, LeaveNumbersThatNothingPushes) {
  World world(floor_alone(), {.tensions = true});
  const Added gone = world.add(crate({0, 0.1, 0}));
  step(world, 2);
  world.remove(gone.particle);
  std::vector<std::byte> kept(world.snapshot_size());
  world.save(kept);
  World fresh(floor_alone(), {.tensions = true});
  fresh.restore(kept);
  world.set_settings({.substeps = 2, .tensions = true});
  for (World* const each : {&world, &fresh}) {
    std::vector<Vec3> forces(1);
    each->copy_contact_forces(forces);
    EXPECT_EQ(forces[0], Vec3{});
    EXPECT_EQ(each->contact_force({ShapeKind::hull, gone.hull}), Vec3{});
    EXPECT_FALSE(each->has_shape({ShapeKind::hull, gone.hull}));
  }
}

// Two bodies on one anchor: what holds it is what hangs from it, while they come and go.
TEST(AddingBodies, PullAtAnchorsAsLongAsTheyHang) {
  Scene scene;
  const auto hang = [](Scene& to, Vec3 at) {
    const std::uint32_t body =
        add_body(to, {.mass = 2, .center = at, .inertia = {.xx = 0.1, .yy = 0.1, .zz = 0.1}});
    to.particles[to.bodies[body].particles[0]].fixed = true;
  };
  hang(scene, {0, 0, 0});
  World world(scene, {.gradient = Gradient::mid, .tensions = true});
  Scene more;
  hang(more, {5, 0, 0});
  const Added added = world.add(more);
  const auto momentum = [&](std::uint32_t body) { return 2 * world.motion(body).velocity; };
  for (int i = 0; i < 30; ++i) {
    const Vec3 before = momentum(1);
    world.step(frame);
    const Vec3 gained = momentum(1) - before, held = world.reaction(added.particle);
    EXPECT_LE(norm(gained - frame * (held - Vec3{0, 2 * 9.81, 0})), 1e-6) << i;
  }
  world.remove(added.particle + 1);
  EXPECT_FALSE(world.handle<Particle>(added.particle));
  step(world, 5);
  EXPECT_TRUE(std::isfinite(norm(world.reaction(0))));
}

TEST(AddingBodies, AreFoundByQueriesAndDrawn) {
  Scene scene = floor_alone();
  add_crate(scene, {0, half, 0});
  World world(scene, {});
  Queries queries(scene, {.rod_radius = 0.01, .particle_radius = 0.01});
  const auto look = [&](double x) {
    queries.update(world);
    return queries.cast_ray({.origin = {x, 5, 0}, .direction = {0, -1, 0}, .length = 10});
  };
  const QueryTarget ground{QueryTarget::Kind::shape, ShapeKind::plane, 0};
  EXPECT_EQ(look(2).target, ground);
  const Added added = world.add(crate({2, 1, 0}));
  Hit hit = look(2);
  EXPECT_EQ(hit.target, (QueryTarget{QueryTarget::Kind::shape, ShapeKind::hull, added.hull}));
  EXPECT_NEAR(hit.distance, 4 - half, 1e-12);
  EXPECT_EQ(look(0).target, (QueryTarget{QueryTarget::Kind::shape, ShapeKind::hull, 0}));
  world.remove(0);
  EXPECT_EQ(look(0).target, ground);
  const Added again = world.add(crate({0, 1, 0}));
  EXPECT_EQ(again.hull, 0u);
  hit = look(0);
  EXPECT_EQ(hit.target, (QueryTarget{QueryTarget::Kind::shape, ShapeKind::hull, 0}));
  EXPECT_NEAR(hit.distance, 4 - half, 1e-12) << "where it is, not where the first was";
  World other(scene, {});
  Scene large;
  const std::uint32_t body =
      add_body(large, {.mass = 1, .center = {2, 1, 0}, .inertia = {.xx = 0.1, .yy = 0.1, .zz = 0.1}});
  large.hulls.push_back(box_on_body(body, {.center = {2, 1, 0}, .half_size = {0.5, 0.5, 0.5}}));
  other.add(large);
  queries.update(other);
  EXPECT_NEAR(queries.cast_ray({.origin = {2, 5, 0}, .direction = {0, -1, 0}, .length = 10}).distance, 3.5,
              1e-12)
      << "of the same name, in another world";
  const Added limbs = world.add(figure({4, 1, 0}));
  EXPECT_EQ(look(4).target, (QueryTarget{QueryTarget::Kind::shape, ShapeKind::capsule, limbs.capsule}));
}

TEST(AddingBodies, AreRefusedWithAReason) {
  World world(floor_alone(), {});
  Scene dragged = crate({0, 1, 0});
  dragged.joint_drag = 1;
  expect_refusal("joint drag: what is added has 1 1/s, and the world has 0", [&] { world.add(dragged); });
  Scene grounded = crate({0, 1, 0});
  grounded.boxes.push_back({.half_size = {1, 1, 1}});
  expect_refusal("box 0: cannot be added", [&] { world.add(grounded); });
  Scene pulled = hose({0, 1, 0}, false);
  pulled.tackles.push_back({.particles = {0, 3}});
  expect_refusal("tackle 0: its island has joints or shapes", [&] { world.add(pulled); });
  Scene standing = crate({0, 1, 0});
  for (Particle& each : standing.particles) each.fixed = true;
  standing.rods.clear();
  expect_refusal("cannot move; use ground hulls", [&] { world.add(standing); });
  World heavy(floor_alone(), {.method = Method::relax, .stop = {.sweeps = 10}});
  Scene uneven;
  for (const Vec3 at : {Vec3{0, 1, 0}, Vec3{0.1, 1, 0}, Vec3{0, 1.1, 0}, Vec3{0, 1, 0.1}})
    uneven.particles.push_back({.position = at});
  add_body(uneven, {0, 1, 2, 3},
           {.mass = 1, .center = {0.05, 1.05, 0.05}, .inertia = {.xx = 0.1, .yy = 0.1, .zz = 0.1}});
  expect_refusal("which method relax cannot move", [&] { heavy.add(uneven); });
  Scene rope;
  rope.particles = {{.mass = 1}};
  World bare(rope, {});
  expect_refusal("began without them and without ground", [&] { bare.add(crate({0, 1, 0})); });
  EXPECT_EQ(world.particle_count(), 0u);
  EXPECT_EQ(heavy.body_count(), 0u);
  step(world, 1);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
