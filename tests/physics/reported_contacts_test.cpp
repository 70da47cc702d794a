// What a world says of contact: who touched whom and where, by which impulse, how fast they met, and when
// that began and ended. Impulses of all contacts, with gravity, make the change of momentum.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "plumb/shapes/contact.hpp"
#include "scenes/spec.hpp"
#include "support/ground.hpp"
#include "support/mechanisms.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::earth;
using test::frame;

constexpr ShapeId capsule(std::uint32_t i) {
  return {ShapeKind::capsule, i};
}
constexpr ShapeId plane{ShapeKind::plane, 0};

Settings reporting(std::uint32_t substeps = 1, bool sleep = false) {
  Settings settings = test::body_settings(substeps, sleep);
  settings.contacts = true;
  return settings;
}
Settings relaxing(std::uint32_t substeps, std::uint32_t sweeps) {
  Settings settings = reporting(substeps);
  settings.method = Method::relax;
  settings.stop.sweeps = sweeps;
  return settings;
}

std::vector<Contact> list_of(const World& world) {
  return {world.contacts().begin(), world.contacts().end()};
}
bool is_movable(const ShapeId& id) {
  return id.kind <= ShapeKind::hull;
}
double mass_of(const Scene& scene) {
  double mass = 0;
  for (const Particle& each : scene.particles) mass += each.mass;
  for (const Rod& each : scene.rods) mass += each.mass;
  for (const Body& each : scene.bodies) mass += each.mass;
  return mass;
}

/// A ball of 2 kg and 0.1 m that flies down onto a plane.
Scene falling_ball(double height, double speed, double restitution, Vec3 gravity) {
  Scene scene;
  scene.gravity = gravity;
  const Surface surface{.friction = 0, .restitution = restitution};
  scene.planes.push_back({.surface = surface});
  test::add_ball(scene, {0.3, 0.1 + height, -0.2}, 0.1, 2, {0, -speed, 0}, surface);
  return scene;
}

// Without gravity a blow is one impulse, m (1 + e) v at v, whatever the substep: to rounding where it is
// solved. Gradient new meets the plane by moving there, and leaves it with what that leaves of v.
TEST(ReportedContacts, OfABlowHaveItsImpulseAndSpeed) {
  constexpr double v = 3;
  for (const double e : {0.0, 0.4, 1.0})
    for (const std::uint32_t substeps : {1u, 5u}) {
      World world(falling_ball(0.12, v, e, {}), reporting(substeps));
      std::vector<std::string> phases;
      Vec3 impulse{};
      for (int i = 0; i < 8; ++i) {
        world.step(frame);
        for (const Contact& each : world.contacts()) {
          phases.emplace_back(to_string(each.phase));
          EXPECT_EQ(each.a, capsule(0));
          EXPECT_EQ(each.b, plane);
          EXPECT_EQ(each.normal, (Vec3{0, 1, 0}));
          EXPECT_LE(norm(each.point - Vec3{0.3, 0, -0.2}), 1e-12);
          impulse += each.impulse;
          if (each.phase == ContactPhase::began) {
            EXPECT_NEAR(each.approach_speed, v, 1e-12);
          }
          if (each.phase == ContactPhase::ended) {
            EXPECT_EQ(each.impulse, Vec3{});
            EXPECT_EQ(each.approach_speed, 0);
          }
        }
      }
      EXPECT_LE(norm(impulse - Vec3{0, 2 * (1 + e) * v, 0}), 1e-12 * 6) << e;
      // What stays lies there without weight, so that nothing pushes it any more.
      EXPECT_EQ(phases, (std::vector<std::string>{"began", "ended"})) << e << ", " << substeps;
    }
}

// With gravity v is that of the fall, sqrt(2 g height), whatever part of a substep is left when they meet: to
// the rounding of up to 240 substeps where it is solved. Relaxed, with gradient new, a velocity is that of a
// substep's end or middle, which are g h/2 = 0.02 m/s apart; half as much again is room.
TEST(ReportedContacts, MeetAtTheSpeedOfTheFall) {
  for (const double height : {0.05, 0.2, 0.77, 1.3})
    for (const bool relaxes : {false, true}) {
      World world(falling_ball(height, 0, 0.5, {0, -earth, 0}), relaxes ? relaxing(4, 10) : reporting(4));
      while (world.time() < 1 && world.contacts().empty()) world.step(frame);
      ASSERT_EQ(world.contacts().size(), 1u);
      EXPECT_NEAR(world.contacts()[0].approach_speed, std::sqrt(2 * earth * height), relaxes ? 0.03 : 1e-9)
          << height << relaxes;
    }
}

// A ball bounces off a floor until it rests: every contact begins, may persist, and ends, and the last one
// stays. Between bounces there is nothing.
TEST(ReportedContacts, BeginAndEndWithEveryBounce) {
  World world(falling_ball(1, 0, 0.6, {0, -earth, 0}), reporting(4));
  int began = 0, ended = 0;
  ContactPhase last = ContactPhase::ended;
  double speed = 1e30;
  for (int i = 0; i < 300; ++i) {
    world.step(frame);
    ASSERT_LE(world.contacts().size(), 1u);
    if (world.contacts().empty()) {
      EXPECT_EQ(last, ContactPhase::ended);
      continue;
    }
    const Contact& now = world.contacts()[0];
    EXPECT_EQ(now.phase == ContactPhase::began, last == ContactPhase::ended) << i;
    if (now.phase == ContactPhase::began) {
      ++began;
      EXPECT_LT(now.approach_speed, 0.61 * speed);
      speed = now.approach_speed;
    }
    ended += now.phase == ContactPhase::ended;
    last = now.phase;
  }
  EXPECT_GE(began, 6);
  EXPECT_EQ(ended, began - 1);
  EXPECT_EQ(last, ContactPhase::persisted);
}

// Three balls of 1, 2 and 3 kg stand on each other. Each carries what is above, and the plane is a scale.
TEST(ReportedContacts, OfAStackCarryWhatIsAbove) {
  Scene scene;
  scene.planes.push_back({.offset = -7, .surface = test::smooth});
  scene.planes.push_back({.surface = test::smooth});
  for (int i = 0; i < 3; ++i) test::add_ball(scene, {0, 0.2 + 0.4 * i, 0}, 0.2, 1 + i);
  Settings settings = reporting();
  settings.tensions = true;
  settings.contact.sweep_tolerance = 1e-11;
  settings.contact.length_scale = 1e-3;
  World world(scene, settings);
  test::run(world, frame, 900);
  const std::vector<Contact> all = list_of(world);
  ASSERT_EQ(all.size(), 3u);
  const std::tuple<ShapeId, ShapeId, double> wanted[] = {
      {capsule(0), capsule(1), -5}, {capsule(0), {ShapeKind::plane, 1}, 6}, {capsule(1), capsule(2), -3}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [a, b, kg] = wanted[i];
    EXPECT_EQ(all[i].a, a);
    EXPECT_EQ(all[i].b, b);
    EXPECT_EQ(all[i].phase, ContactPhase::persisted);
    EXPECT_LE(norm(all[i].impulse - Vec3{0, kg * earth * frame, 0}), 1e-8 * earth * frame) << i;
    EXPECT_LE(norm(all[i].normal - Vec3{0, kg < 0 ? -1.0 : 1.0, 0}), 1e-12);
    EXPECT_LE(all[i].approach_speed, 1e-9);
  }
  EXPECT_LE(norm(all[0].point - Vec3{0, 0.4, 0}), 1e-5);
  EXPECT_NEAR(world.contact_force({ShapeKind::plane, 1}).y, -6 * earth, 1e-8 * earth);
  EXPECT_EQ(world.contact_force(plane), Vec3{});
  EXPECT_EQ(world.contact_force(capsule(2)), world.contact_force(2));
}

// Two rods collide in the air: one entry, whose impulse is what one gains and the other loses. Both are
// level, so that they meet along the vertical, at the 2 m/s of the one that moves. Speeds of approach are of
// first order in the substep: 1e-3 and 0.05 m/s bound what was measured, solved and with what 50 sweeps
// leave.
TEST(ReportedContacts, BetweenBodiesAreOppositeAndListedOnce) {
  for (const bool relaxes : {false, true}) {
    Scene scene;
    scene.gravity = {};
    const Surface surface{.friction = 0.4, .restitution = 0.5};
    test::add_capsule_rod(scene, {-0.5, 0.3, 0.1}, {0.5, 0.3, 0}, 3, 0.1, surface);
    test::add_capsule_rod(scene, {0.1, 0, -0.5}, {0, 0, 0.5}, 2, 0.05, surface);
    for (const std::uint32_t i : {0u, 1u}) scene.particles[i].velocity = {0.5, -2, 0};
    World world(scene, relaxes ? relaxing(4, 50) : reporting(4));
    const auto momentum_of = [&](std::uint32_t rod) {
      const RodMass mass = rod_mass(scene, rod, MassModel::consistent);
      return (mass.aa + mass.ab) * (world.velocity(2 * rod) + world.velocity(2 * rod + 1));
    };
    const Vec3 before[] = {momentum_of(0), momentum_of(1)};
    Vec3 sum{};
    int entries = 0;
    double speed = 0;
    for (int i = 0; i < 20; ++i) {
      world.step(frame);
      ASSERT_LE(world.contacts().size(), 1u);
      for (const Contact& each : world.contacts()) {
        EXPECT_EQ(std::tuple(each.a, each.b), std::tuple(capsule(0), capsule(1)));
        sum += each.impulse;
        entries += each.phase != ContactPhase::ended;
        speed = std::max(speed, each.approach_speed);
      }
    }
    EXPECT_GE(entries, 1);
    EXPECT_GT(norm(sum), 1);
    EXPECT_NEAR(speed, 2, relaxes ? 0.05 : 1e-3);
    EXPECT_LE(norm(momentum_of(0) - before[0] - sum), 1e-9) << relaxes;
    EXPECT_LE(norm(momentum_of(1) - before[1] + sum), 1e-9) << relaxes;
  }
}

/// How far the impulses of all contacts, and gravity, are from the change of momentum in a step, at most, in
/// N s. Steps are left out whose energy was held back, since that takes motion without a force.
struct Balance {
  double worst = 0;
  std::size_t most = 0;    ///< contacts at once
  std::size_t of_own = 0;  ///< pairs of two shapes of the scene
  std::uint64_t halvings = 0, fallbacks = 0, repeated = 0;
  int counted = 0;
};
Balance balance(const Scene& scene, const Settings& settings, int steps, double dt = frame) {
  World world(scene, settings);
  const MassModel mass = mass_model_of(settings);
  const auto momentum = [&] {
    return measure_momentum(scene, test::positions_of(world), test::velocities_of(world), mass).linear;
  };
  const Vec3 weight = mass_of(scene) * scene.gravity;
  Balance out;
  Vec3 last = momentum();
  for (int i = 0; i < steps; ++i) {
    const StepReport report = world.step(dt);
    EXPECT_EQ(report.unsolved, 0u);
    out.halvings += report.halvings;
    out.fallbacks += report.fallbacks;
    out.repeated += report.repeated_steps;
    Vec3 sum = dt * weight;
    for (const Contact& each : world.contacts()) {
      out.of_own += is_movable(each.b);
      if (!is_movable(each.b)) sum += each.impulse;
    }
    out.most = std::max(out.most, world.contacts().size());
    const Vec3 now = momentum();
    if (report.guarded_energy + report.trimmed_energy == 0) {
      out.worst = std::max(out.worst, norm(now - last - sum));
      ++out.counted;
    }
    last = now;
  }
  return out;
}

/// Balls, rods, a box with a hull, and a rope that falls on itself, over ground of all kinds.
Scene jumble() {
  Scene scene;
  const Surface surface{.friction = 0.4, .restitution = 0.2};
  scene.planes.push_back({.normal = {0.6, 0.8, 0}, .offset = -0.4, .surface = surface});
  scene.boxes.push_back({.center = {0, -1, 0}, .half_size = {2, 1, 2}, .surface = surface});
  scene.ground_capsules.push_back({{0.4, 0.05, -1}, {0.4, 0.05, 1}, 0.1, surface});
  scene.meshes.push_back({{{-1, 0.1, -1}, {-1, 0.1, 1}, {0.1, 0.02, 1}, {0.1, 0.02, -1}},
                          {{0, 1, 2}, {0, 2, 3}},
                          false,
                          surface});
  for (int i = 0; i < 4; ++i)
    test::add_ball(scene, {0.3 * i - 0.4, 0.5 + 0.1 * i, 0.2}, 0.1, 0.5, {}, surface);
  test::add_capsule_rod(scene, {-0.5, 0.4, 0.1}, {0.6, 0.7, 0.3}, 2, 0.05, surface);
  const MassProperties box = [] {
    MassProperties out = solid_box(2, {0.3, 0.2, 0.4});
    out.center = {0.2, 0.9, 0};
    return out;
  }();
  const std::uint32_t body = add_body(scene, box);
  scene.hulls.push_back(box_on_body(body, {.center = box.center,
                                           .half_size = {0.15, 0.1, 0.2},
                                           .orientation = {1, 0, 0, 0},
                                           .surface = surface}));
  return scene;
}

// Impulses here are of some N s.
TEST(ReportedContacts, MakeTheChangeOfMomentum) {
  for (const std::uint32_t substeps : {1u, 4u}) {
    const Balance off = balance(jumble(), reporting(substeps), 180, frame / 2);
    EXPECT_LE(off.worst, 1e-11) << substeps;
    EXPECT_GE(off.most, 7u);
    EXPECT_GE(off.counted, 20);
  }
}

// Relaxed, velocities are those of the moves: to rounding, but for what blows to hulls wind up.
TEST(ReportedContacts, MakeTheChangeOfMomentumWhereRelaxed) {
  Scene scene = jumble();
  scene.hulls.clear();
  const Balance off = balance(scene, relaxing(8, 10), 90);
  EXPECT_LE(off.worst, 1e-11);
  EXPECT_GE(off.most, 6u);
}

/// A rope that falls upright onto a plane and touches itself.
Scene folding_rope(std::uint32_t links) {
  Scene scene;
  for (std::uint32_t i = 0; i <= links; ++i) {
    scene.particles.push_back(
        test::movable({0.02 * std::sin(0.9 * i), 0.03 + 0.05 * i, 0.02 * std::cos(1.7 * i)}, 0.02));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1),
                              .b = point_at(i),
                              .radius = 0.012,
                              .surface = {.friction = 0.3},
                              .filter = {.own_island = true}});
  }
  scene.planes.push_back({.surface = {.friction = 0.3}});
  return scene;
}

// A substep that is cut or repeated, for contact or for an accuracy, does not count.
TEST(ReportedContacts, CountWhatStandsAlone) {
  const Balance cut = balance(folding_rope(24), reporting(2), 60);
  EXPECT_LE(cut.worst, 1e-11);
  EXPECT_GT(cut.halvings, 0u);
  EXPECT_GT(cut.of_own, 0u) << "it touches itself";
  Settings settings = reporting(1);
  settings.accuracy = 1e-3;
  const Balance repeated = balance(jumble(), settings, 40);
  EXPECT_LE(repeated.worst, 1e-11);
  EXPECT_GT(repeated.repeated, 0u);
}

/// Ropes in a heap.
Scene heap(int ropes) {
  Scene scene;
  scene.planes.push_back({.surface = {.friction = 0.4}});
  for (int r = 0; r < ropes; ++r) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (std::uint32_t i = 0; i <= 8; ++i) {
      const double along = 0.1 * i - 0.4;
      const Vec3 at = r % 2 == 0 ? Vec3{along, 0.06 + 0.06 * r, 0.04 * (r % 3)}
                                 : Vec3{0.04 * (r % 3), 0.06 + 0.06 * r, along};
      scene.particles.push_back(test::movable(at, 0.05));
      if (i == 0) continue;
      scene.rods.push_back({.a = first + i - 1, .b = first + i});
      scene.capsules.push_back({.a = point_at(first + i - 1),
                                .b = point_at(first + i),
                                .radius = 0.02,
                                .surface = {.friction = 0.4}});
    }
  }
  return scene;
}

// Method auto relaxes what touches in many places, and brings rods to their lengths after each step, which
// keeps momentum.
TEST(ReportedContacts, MakeTheChangeOfMomentumInAHeap) {
  Settings settings{.sleep = false, .contacts = true, .threads = 1};
  const Balance off = balance(heap(14), settings, 60);
  EXPECT_LE(off.worst, 1e-11);
  EXPECT_GE(off.most, 25u);
  EXPECT_GE(off.counted, 20);
}

bool same(const std::vector<Contact>& one, const std::vector<Contact>& other) {
  return std::equal(
      one.begin(), one.end(), other.begin(), other.end(), [](const Contact& a, const Contact& b) {
        return a.a == b.a && a.b == b.b && a.phase == b.phase && a.point == b.point && a.normal == b.normal &&
               a.impulse == b.impulse && a.approach_speed == b.approach_speed;
      });
}

// Lists are in order, and are the same on every number of threads and instruction set.
TEST(ReportedContacts, AreTheSameOnThreadsAndInstructionSets) {
  for (const Method method : {Method::direct, Method::relax}) {
    Scene scene = jumble();
    if (method == Method::relax) scene.hulls.clear();
    for (int i = 0; i < 20; ++i)
      test::add_ball(scene, {0.1 * i - 1, 1 + 0.02 * i, 0.7}, 0.06, 0.2, {}, {.friction = 0.3});
    std::vector<std::vector<Contact>> first;
    for (const Isa isa : all_isas())
      for (const unsigned threads : {1u, 2u}) {
        if (!is_supported(isa)) continue;
        Settings settings = reporting(2);
        settings.method = method;
        settings.isa = isa;
        settings.threads = threads;
        World world(scene, settings);
        std::vector<std::vector<Contact>> lists;
        for (int i = 0; i < 60; ++i) {
          world.step(frame);
          lists.push_back(list_of(world));
          EXPECT_TRUE(std::is_sorted(lists.back().begin(), lists.back().end(),
                                     [](const Contact& a, const Contact& b) {
                                       return std::tuple(a.a, a.b) < std::tuple(b.a, b.b);
                                     }));
        }
        if (first.empty()) first = lists;
        for (std::size_t i = 0; i < lists.size(); ++i)
          ASSERT_TRUE(same(first[i], lists[i])) << to_string(isa) << ", " << threads << ", step " << i;
      }
  }
}

// What sleeps goes on touching as it did, and its scale shows its weight. What takes it away ends that.
TEST(ReportedContacts, PersistThroughSleep) {
  Scene scene;
  scene.planes.push_back({.surface = {}});
  const std::uint32_t block = test::add_block(scene, {}, {});
  Settings settings = reporting(4, true);
  settings.tensions = true;
  World world(scene, settings);
  std::vector<Contact> before;
  StepReport report;
  for (int i = 0; i < 120; ++i) {
    before = list_of(world);
    if (world.step(frame).awake_islands == 0) break;
  }
  ASSERT_EQ(before.size(), 4u) << "balls at the corners of its bottom";
  for (int i = 0; i < 30; ++i) {
    report = world.step(frame);
    ASSERT_EQ(report.awake_islands, 0u);
    ASSERT_EQ(world.contacts().size(), 4u);
    for (const Contact& each : world.contacts()) EXPECT_EQ(each.phase, ContactPhase::persisted);
    EXPECT_NEAR(world.contact_force(plane).y, -test::block_mass * earth, 1e-3 * earth);
  }
  for (const std::uint32_t i : scene.bodies[block].particles) world.set_force(i, {0, 50, 0});
  world.step(frame);
  ASSERT_EQ(world.contacts().size(), 4u);
  for (const Contact& each : world.contacts()) EXPECT_EQ(each.phase, ContactPhase::ended);
  world.step(frame);
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_EQ(world.contact_force(plane), Vec3{});
}

/// A kind of ground, flat at y = 0, and its name.
struct Floor {
  Scene scene;
  ShapeId id;
};
std::vector<Floor> floors() {
  std::vector<Floor> out;
  const auto add = [&](ShapeKind kind, std::uint32_t number) -> Scene& {
    out.push_back({{}, {kind, number}});
    return out.back().scene;
  };
  add(ShapeKind::plane, 1).planes = {{.offset = -3}, {}};
  add(ShapeKind::box, 1).boxes = {{.center = {0, -9, 0}, .half_size = {1, 1, 1}},
                                  {.center = {0, -1, 0}, .half_size = {2, 1, 2}}};
  Scene& lift = add(ShapeKind::box, 0);
  lift.platforms.emplace_back();
  lift.boxes = {{.center = {0, -1, 0}, .half_size = {2, 1, 2}, .motion = {.platform = 0}},
                {.center = {0, -9, 0}, .half_size = {1, 1, 1}}};
  add(ShapeKind::ground_capsule, 1).ground_capsules = {{{0, -8, 0}, {0, -8, 0}, 1},
                                                       {{-2, -1, 0}, {2, -1, 0}, 1}};
  Scene& hull = add(ShapeKind::ground_hull, 0);
  hull.boxes = {{.center = {0, -9, 0}, .half_size = {1, 1, 1}}};
  hull.ground_hulls.emplace_back();
  for (const double x : {-2.0, 2.0})
    for (const double z : {-2.0, 2.0})
      for (const double y : {0.0, -1.0}) hull.ground_hulls[0].points.push_back({x, y, z});
  add(ShapeKind::mesh, 0).meshes = {
      {{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}, {{0, 1, 2}, {0, 2, 3}}}};
  add(ShapeKind::height_field, 0).height_fields = {{.corner = {-2, 0, -2},
                                                    .cell_x = 2,
                                                    .cell_z = 2,
                                                    .columns = 3,
                                                    .heights = std::vector<double>(9, 0.0)}};
  Scene& anchored = add(ShapeKind::capsule, 0);
  anchored.particles = {test::fixed({-2, -1, 0}), test::fixed({2, -1, 0})};
  anchored.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 1}};
  return out;
}

// Every kind of ground is a scale, and says what stands on it. The ball is held above the middle of round
// ones.
TEST(ReportedContacts, MakeAScaleOfAllGround) {
  for (const Floor& floor : floors())
    for (const bool relaxes : {false, true}) {
      SCOPED_TRACE(std::string(to_string(floor.id.kind)) + (relaxes ? ", relaxed" : ""));
      Scene scene = floor.scene;
      test::add_ball(scene, {0, 0.1, 0}, 0.1, 3, {});
      const auto ball = static_cast<std::uint32_t>(scene.capsules.size() - 1);
      Settings settings = relaxes ? relaxing(4, 10) : reporting(4);
      settings.tensions = true;
      World world(scene, settings);
      EXPECT_TRUE(std::isnan(world.contact_force(floor.id).y)) << "before the first step";
      test::run(world, frame, 120);
      ASSERT_EQ(world.contacts().size(), 1u);
      const Contact& only = world.contacts()[0];
      const bool ball_first = capsule(ball) < floor.id;
      EXPECT_EQ(ball_first ? only.a : only.b, capsule(ball));
      EXPECT_EQ(ball_first ? only.b : only.a, floor.id);
      EXPECT_NEAR((ball_first ? 1 : -1) * only.impulse.y, 3 * earth * frame, 1e-4 * earth);
      EXPECT_NEAR((ball_first ? 1 : -1) * only.normal.y, 1, 1e-9);
      EXPECT_NEAR(world.contact_force(floor.id).y, -3 * earth, 1e-4 * 3 * earth);
      EXPECT_NEAR(world.contact_force(ball).y, 3 * earth, 1e-4 * 3 * earth);
      EXPECT_NEAR(only.point.y, 0, 1e-3);
    }
}

// A rope that lies holds its contacts in its own matrix: one a rod, each with its share of the weight.
TEST(ReportedContacts, OfALyingRopeAreOneForEachRod) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 300; ++i) {
    scene.particles.push_back(test::movable({0.05 * i, 0.01, 0}, 0.05));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.01});
  }
  scene.planes.push_back({});
  World world(scene, reporting(2));
  test::run(world, frame, 120);
  EXPECT_GE(world.contacts().size(), 300u);
  double sum = 0;
  for (const Contact& each : world.contacts()) {
    sum += each.impulse.y;
    EXPECT_EQ(each.b, plane);
    EXPECT_NE(each.phase, ContactPhase::began);
  }
  EXPECT_NEAR(sum, 301 * 0.05 * earth * frame, 1e-9);
}

// Counting changes no bits of the motion.
TEST(ReportedContacts, LeaveTheMotionAlone) {
  std::uint64_t hashes[2];
  for (const bool counts : {false, true}) {
    Settings settings = test::body_settings(2);
    settings.contacts = counts;
    World world(jumble(), settings);
    test::run(world, frame, 60);
    hashes[counts] = world.state_hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(ReportedContacts, ThatAreNotThereAreRefused) {
  const Scene scene = falling_ball(1, 0, 0, {});
  World silent(scene, test::body_settings());
  EXPECT_EQ(test::refusal([&] { (void)silent.contacts(); }),
            "contacts are not known: Settings::contacts asks for them");
  EXPECT_EQ(test::refusal([&] { (void)silent.contact_force(plane); }),
            "tensions are not known: Settings::tensions asks for them");
  EXPECT_EQ(test::refusal([&] {
              (void)silent.contact_force(ShapeId{ShapeKind::mesh, 2});
            }),
            "mesh 2: unknown, the world has 0 of them");
  World world(scene, reporting());
  EXPECT_TRUE(world.contacts().empty()) << "before the first step";
  Scene bare;
  bare.particles = {test::movable({}, 1)};
  World lonely(bare, {.contacts = true});
  lonely.step(frame);
  EXPECT_TRUE(lonely.contacts().empty());
}

/// Bricard's mechanism: six bars of 1 m, each hinged across the one before.
Scene bricard() {
  Scene scene;
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  std::uint32_t bars[6];
  bars[0] = test::add_fixed_body(scene);
  for (int i = 1; i < 6; ++i) {
    const Vec3 from = corners[i], to = corners[(i + 1) % 6], along = to - from;
    const double thin = 1e-4, long_ = 1.0 / 12;
    MassProperties bar{.mass = 1, .center = 0.5 * (from + to)};
    bar.inertia = {
        along.x != 0 ? thin : long_, along.y != 0 ? thin : long_, along.z != 0 ? thin : long_, 0, 0, 0};
    bars[i] = add_body(scene, bar);
  }
  for (int i = 0; i < 6; ++i) {
    const Vec3 before = corners[i] - corners[(i + 5) % 6], after = corners[(i + 1) % 6] - corners[i];
    add_revolute(scene, bars[(i + 5) % 6], bars[i], corners[i], cross(before, after));
  }
  return scene;
}

/// Two double pendulums that swing past each other, closely enough to be solved together, and never touch.
Scene near_pendulums() {
  Scene scene;
  for (std::uint32_t k = 0; k < 2; ++k) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    const double z = 0.15 * k, dip = 0.1 * k;
    scene.particles.push_back(test::fixed({0, 0, z}));
    for (const double x : {0.3, 0.6, 0.9}) scene.particles.push_back(test::movable({x, dip, z}, 1));
    for (const std::uint32_t i : {0u, 1u, 2u}) scene.rods.push_back({.a = first + i, .b = first + i + 1});
    scene.capsules.push_back({.a = point_at(first + 1), .b = point_at(first + 3), .radius = 0.05});
  }
  return scene;
}

// What nothing touches keeps its energy by itself, alone and beside others: none of its substeps is held
// back.
TEST(GuardedEnergy, IsNoneOfConservativeMechanisms) {
  const Scene closed = bricard();
  World world(closed, test::body_settings(4));
  const StepReport alone = test::run(world, frame, 250);
  EXPECT_GT(norm(world.velocity(closed.bodies[3].particles[0])), 0.1) << "it moves";
  EXPECT_EQ(alone.direct_substeps, 1000u);
  EXPECT_EQ(alone.guarded_energy, 0u);
  EXPECT_EQ(alone.trimmed_energy, 0u);
  World pair(near_pendulums(), test::body_settings(4));
  const StepReport near = test::run(pair, frame, 240);
  EXPECT_EQ(near.contact_points, 0u);
  EXPECT_EQ(near.guarded_energy, 0u);
  EXPECT_EQ(near.trimmed_energy, 0u);
}

// Blows to figures would now and then gain more than a hundredth. Their rest, which gains shares of nothing,
// does not count.
TEST(GuardedEnergy, CountsBlowsThatWouldGain) {
  Scene scene = scenes::load_scene("crowd:humanoids=8,hit=8");
  for (Particle& particle : scene.particles) particle.asleep = false;
  World world(scene, test::body_settings());
  const StepReport report = test::run(world, frame, 240);
  EXPECT_GT(report.guarded_energy, 0u);
  EXPECT_LT(report.guarded_energy, report.direct_substeps / 100);
  EXPECT_GT(report.trimmed_energy, report.guarded_energy);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
