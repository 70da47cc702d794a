// Islands as the contact solver has them: their masses and constraints, the boxes around them, and visits.

#include "contact/linkage/linkage.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/linkage/linkage_state.hpp"
#include "contact/linkage/scene_parts.hpp"
#include "contact/linkage/visitor.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/linkages.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

Scene figure() {
  Scene scene = scenes::load_scene("humanoid:body=thin");
  for (Particle& particle : scene.particles) particle.asleep = false;
  return scene;
}

void give_random_velocities(LinkageState& state, unsigned seed) {
  test::Random random(seed);
  for (std::uint32_t i = 0; i < state.linkage->movable(); ++i) state.v[i] = test::random_vector(random);
}

// p = M v, and v·p is twice the kinetic energy, to rounding of some 60 numbers.
TEST(Linkage, MomentaAndEnergyAreOfOneMassMatrix) {
  test::Linkages islands(figure());
  LinkageState& state = islands.states.front();
  give_random_velocities(state, 31);
  std::vector<Vec3> p(state.linkage->movable());
  state.linkage->momenta(state.v, p);
  double twice = 0;
  Vec3 sum{};
  for (std::size_t i = 0; i < p.size(); ++i) {
    twice += dot(p[i], state.v[i]);
    sum += p[i];
  }
  EXPECT_NEAR(twice, 2 * state.linkage->kinetic(state.v), 1e-12 * twice);

  // Of a motion of the whole, momentum is the whole mass times its velocity.
  std::fill(state.v.begin(), state.v.end(), Vec3{1, 2, 3});
  state.linkage->momenta(state.v, p);
  sum = {};
  for (const Vec3 each : p) sum += each;
  EXPECT_LE(norm(sum - state.linkage->mass() * Vec3{1, 2, 3}), 1e-12 * norm(sum));
}

// The rest beside a rigid motion has no energy if the motion is rigid, and is what was added otherwise.
TEST(Linkage, SplitLeavesNothingOfARigidMotion) {
  test::Linkages islands(figure());
  LinkageState& state = islands.states.front();
  ASSERT_FALSE(state.linkage->is_grounded());
  for (std::size_t i = 0; i < state.v.size(); ++i)
    state.v[i] = Vec3{1, 0, -1} + cross({0.5, 2, -1}, state.x[i]);
  std::vector<Vec3> rigid(state.v.size());
  EXPECT_LE(state.linkage->split(state.x, state.v, rigid), 1e-12 * state.linkage->kinetic(state.v));
  give_random_velocities(state, 32);
  EXPECT_GT(state.linkage->split(state.x, state.v, rigid), 0.01 * state.linkage->kinetic(state.v));
}

// Constraints hold at the start, and a strain ε of a rod violates its own by ε + ε²/2.
TEST(Linkage, ViolationsAreStrains) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}), test::movable({2, 0, 0})};
  scene.rods = {{.a = 0, .b = 1, .length = 2}};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  test::Linkages islands(scene);
  LinkageState& state = islands.states.front();
  Array<simd::Quad> numbers_of(state.linkage->plan().columns());
  const std::span<double> right = numbers(numbers_of);
  EXPECT_EQ(state.linkage->violations(state.x, {}, right), 0);
  state.x[1].x = 2.2;
  EXPECT_NEAR(state.linkage->violations(state.x, {}, right), 0.1 + 0.005, 1e-15);
}

// Newton by mass: constraints hold afterwards, and what is heavy has moved the least.
TEST(Visitor, ProjectionsMakeConstraintsHold) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}, 9), test::movable({1, 0, 0}, 1)};
  scene.rods = {{.a = 0, .b = 1, .length = 1}};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  test::Linkages islands(scene);
  LinkageState& state = islands.states.front();
  ProjectionWork work;
  state.x[1].x = 1.1;
  project_positions(state, work);
  EXPECT_NEAR(state.x[1].x - state.x[0].x, 1, 1e-9);
  EXPECT_NEAR(state.x[0].x, 0.01, 1e-9) << "a tenth of the way";

  state.v = {{0, 0, 0}, {1, 3, 0}};
  EXPECT_NEAR(project_velocities(state, work), 0.9, 1e-9);
  EXPECT_NEAR(state.v[0].x, 0.1, 1e-9) << "momentum is shared";
  EXPECT_NEAR(state.v[1].x, 0.1, 1e-9);
  EXPECT_NEAR(state.v[1].y, 3, 1e-9) << "across the rod nothing pulls";
  EXPECT_FALSE(Visitor().has_home());
}

TEST(TermPool, LetsSumsStayWhereTheyAre) {
  TermPool pool;
  const auto sum_of = [](std::uint32_t number) {
    Combination out;
    for (std::uint32_t i = 0; i <= number % 8; ++i) out.add(number + i, number - 0.5 * i);
    return out;
  };
  for (int round = 0; round < 2; ++round) {
    Array<Terms> kept;
    for (std::uint32_t number = 0; number < 100; ++number) kept.push_back(pool.keep(sum_of(number)));
    for (std::uint32_t number = 0; number < 100; ++number) {
      ASSERT_EQ(kept[number].size(), number % 8 + 1);
      for (std::size_t i = 0; i < kept[number].size(); ++i) {
        EXPECT_EQ(kept[number][i].particle, number + i);
        EXPECT_EQ(kept[number][i].weight, number - 0.5 * static_cast<double>(i));
      }
    }
    pool.clear();
  }
}

TEST(LinkageBounds, HoldEveryShape) {
  test::Linkages islands(figure());
  const LinkageState& state = islands.states.front();
  const Bounds tight = bounds_of(*state.linkage, state.x, 0);
  for (const Linkage::Shape& shape : state.linkage->shapes())
    for (const Terms end : {shape.a, shape.b}) {
      const Vec3 p = end.of(state.x);
      for (const double by : {-shape.radius, shape.radius}) {
        EXPECT_GE(p.x + by, tight.low.x - 1e-12);
        EXPECT_LE(p.y + by, tight.high.y + 1e-12);
        EXPECT_LE(p.z + by, tight.high.z + 1e-12);
      }
    }
  const Bounds wide = bounds_of(*state.linkage, state.x, 0.5);
  EXPECT_NEAR(wide.high.y - tight.high.y, 0.5, 1e-12);
  EXPECT_TRUE(nowhere.is_empty());
  EXPECT_FALSE(tight.is_empty());
}

// Boxes overlap where no axis keeps them apart.
TEST(LinkageBounds, DistanceIsNegativeWhereBoxesOverlap) {
  test::Random random(33);
  int overlapping = 0;
  for (int i = 0; i < 500; ++i) {
    Bounds a = nowhere, b = nowhere;
    include(a, test::random_vector(random), 0.6 + 0.5 * test::signed_unit(random));
    include(b, test::random_vector(random), 0.6 + 0.5 * test::signed_unit(random));
    EXPECT_EQ(a.overlaps(b), distance(a, b) <= 0);
    EXPECT_EQ(distance(a, b), distance(b, a));
    overlapping += a.overlaps(b);
  }
  EXPECT_GT(overlapping, 50);
  EXPECT_LT(overlapping, 450);
}

// What falls and flies for as long as it was asked about stays within its reach.
TEST(LinkageState, ReachHoldsWhatFalls) {
  Scene scene;
  test::add_ball(scene, {0, 0, 0}, 0.1, 1, {3, 0, 0});
  test::Linkages islands(scene);
  const LinkageState& state = islands.states.front();
  EXPECT_EQ(top_speed(state), 3);
  const double dt = 0.1;
  const Bounds bounds = reach(state, top_speed(state), dt, 0);
  EXPECT_GE(bounds.high.x, 3 * dt + 0.1);
  EXPECT_LE(bounds.low.y, -0.5 * test::earth * dt * dt - 0.1);
  EXPECT_LT(bounds.high.x, 1) << "and not much more";
}

// Every movable particle is in one island, and a fixed one in each that hangs from it.
TEST(SceneParts, ShareOutParticles) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({1, 0, 0}), test::movable({-1, 0, 0}),
                     test::movable({0, 5, 0})};
  scene.rods = {{.a = 0, .b = 1}, {.a = 0, .b = 2}};
  scene.capsules = {{.a = point_at(3), .b = point_at(3), .radius = 0.1}};
  const SceneParts parts(scene);
  ASSERT_EQ(parts.count(), 3u);
  std::vector<int> times(4, 0);
  for (std::uint32_t i = 0; i < parts.count(); ++i) {
    for (std::size_t k = 0; k < parts.particles(i).size(); ++k) {
      ++times[parts.particles(i)[k]];
      EXPECT_EQ(parts.part(i).particles[k].position, scene.particles[parts.particles(i)[k]].position);
    }
    EXPECT_FALSE(parts.part(i).particles.front().fixed) << "movable ones first";
    EXPECT_TRUE(is_plain(parts.part(i)));
  }
  EXPECT_EQ(times, (std::vector<int>{2, 1, 1, 1}));
  scene.joint_drag = 1;
  EXPECT_FALSE(is_plain(SceneParts(scene).part(0)));
}

// Where an island is and how it moves does not matter to its kind; its masses do.
TEST(SceneParts, LikenessIsOfEverythingButThePlace) {
  Scene scene;
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{5, 1, 0}, Vec3{0, 9, 9}}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back(test::movable(at, 2, at));
    scene.particles.push_back(test::movable(at + Vec3{1, 0, 0}, 3));
    scene.rods.push_back({.a = first, .b = first + 1, .length = 1});
  }
  scene.particles.back().mass = 4;
  const SceneParts parts(scene);
  EXPECT_EQ(likeness(parts.part(0)), likeness(parts.part(1)));
  EXPECT_NE(likeness(parts.part(0)), likeness(parts.part(2)));
}

// A line between two anchors forbids its middle to go along it twice where it is straight, and once where it
// hangs. Lines of equal rods are alike all the same, and each moves as it does alone.
TEST(Linkage, IsRedundantByHowAnIslandStands) {
  const auto line = [](Scene& scene, double x, double depth) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    const double half = std::sqrt(1 - depth * depth);
    scene.particles.push_back(test::movable({x, 1 - depth, 0}));
    for (const double side : {-half, half}) scene.particles.push_back(test::fixed({x + side, 1, 0}));
    for (const std::uint32_t end : {first + 1, first + 2}) {
      scene.rods.push_back({.a = first, .b = end, .length = 1});
      scene.capsules.push_back({.a = point_at(first), .b = point_at(end), .radius = 0.01});
    }
  };
  Scene both, bowed;
  line(both, 0, 0);
  line(both, 5, 0.6);
  line(bowed, 5, 0.6);
  const SceneParts parts(both);
  EXPECT_EQ(likeness(parts.part(0)), likeness(parts.part(1)));
  const Linkage straight(parts.part(0), best_isa()), hanging(parts.part(1), best_isa());
  EXPECT_TRUE(straight.is_redundant());
  EXPECT_FALSE(hanging.is_redundant());
  const std::vector<Vec3> at = {{5, 0.4, 0}, {4.2, 1, 0}, {5.8, 1, 0}},
                          along = {{0, 1, 0}, {-1, 1, 0}, {1, 1, 0}};
  for (const Linkage* const each : {&straight, &hanging}) {
    EXPECT_FALSE(each->is_redundant_at(at));
    EXPECT_TRUE(each->is_redundant_at(along));
  }
  for (Scene* const scene : {&both, &bowed}) {
    scene->joint_drag = 0.1;                    // which lets no other solver move them
    scene->particles.back().position.z = 1e-3;  // and slack, so that it swings
  }
  const Settings settings{.method = Method::direct};
  World world(both, settings), alone(bowed, settings);
  for (int i = 0; i < 30; ++i) {
    world.step(1.0 / 60);
    alone.step(1.0 / 60);
    EXPECT_EQ(world.position(3), alone.position(0)) << i;
  }
}

// So do all numbers of its surfaces: islands that resist rolling differently share no linkage.
TEST(SceneParts, LikenessKnowsSurfacesOfHulls) {
  Scene scene;
  for (const double x : {0.0, 5.0, 10.0, 15.0}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      scene.particles.push_back(test::movable(at + Vec3{x, 0, 0}));
    scene.bodies.push_back({.particles = {first, first + 1, first + 2, first + 3}});
    const auto body = static_cast<std::uint32_t>(scene.bodies.size() - 1);
    scene.hulls.push_back({.body = body,
                           .points = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x, 0, 1}},
                           .surface = {.friction = 0.5}});
  }
  scene.hulls[2].surface.rolling = 0.01;
  scene.hulls[3].surface.spinning = 0.01;
  const SceneParts parts(scene);
  ASSERT_EQ(parts.count(), 4u);
  EXPECT_EQ(likeness(parts.part(0)), likeness(parts.part(1)));
  EXPECT_NE(likeness(parts.part(0)), likeness(parts.part(2)));
  EXPECT_NE(likeness(parts.part(0)), likeness(parts.part(3)));
  EXPECT_NE(likeness(parts.part(2)), likeness(parts.part(3)));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
