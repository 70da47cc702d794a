// Which islands are moved together, and how one that is alone moves.

#include "contact/clusters.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "contact/cluster_island.hpp"
#include "contact/cluster_rows.hpp"
#include "contact/contact_solver.hpp"
#include "contact/linkage/linkage_bounds.hpp"
#include "contact/linkage/scene_parts.hpp"
#include "contact/linkage/visitor.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"
#include "contact/solved/missed.hpp"
#include "contact/surroundings.hpp"
#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/linkages.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// Balls of 0.1 m along x, 1 m apart.
Scene row_of_balls(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) test::add_ball(scene, {1.0 * i, 0, 0}, 0.1, 1);
  return scene;
}

/// Clusters by their islands if everything can come `far` (m) within the step.
std::vector<std::vector<std::uint32_t>> clusters_within(Clusters& clusters, double far) {
  Team team(1);
  clusters.form(team, [&](const LinkageState& state) { return bounds_of(*state.linkage, state.x, far); });
  std::vector<std::vector<std::uint32_t>> out;
  for (std::uint32_t c = 0; c < clusters.count(); ++c) {
    out.emplace_back();
    for (const LinkageState* state : clusters[c]) out.back().push_back(state->number);
  }
  return out;
}

using Lists = std::vector<std::vector<std::uint32_t>>;

TEST(Clusters, AreIslandsThatCanReachEachOther) {
  test::Linkages islands(row_of_balls(4));
  islands.states[3].x[0].x = 10;
  Clusters clusters;
  clusters.start(islands.states, 0);
  EXPECT_EQ(clusters_within(clusters, 0.1), (Lists{{0}, {1}, {2}, {3}}));
  EXPECT_EQ(clusters_within(clusters, 0.45), (Lists{{0, 1, 2}, {3}})) << "0 and 2 through 1";
  EXPECT_EQ(clusters_within(clusters, 10), (Lists{{0, 1, 2, 3}}));
}

// Sleepers are in the clusters of who comes near, and wake with who lies on them.
TEST(Clusters, HoldSleepersNearby) {
  test::Linkages islands(row_of_balls(3));
  islands.states[1].asleep = islands.states[2].asleep = true;
  Clusters clusters;
  clusters.start(islands.states, 0);
  EXPECT_EQ(clusters.awake().size(), 1u);
  EXPECT_EQ(clusters_within(clusters, 0.1), (Lists{{0}}));
  EXPECT_EQ(clusters_within(clusters, 0.85), (Lists{{0, 1}}));
  clusters.wake(1);
  EXPECT_FALSE(islands.states[1].asleep);
  EXPECT_TRUE(islands.states[2].asleep) << "0.8 m away";
  const std::uint8_t both_rest[] = {1, 1};
  clusters_within(clusters, 0.1);
  EXPECT_EQ(clusters.settle(both_rest), 2u);
  EXPECT_TRUE(clusters.awake().empty());
}

/// A step of 1/60 s of a scene's only island.
Vec3 velocity_after(const Scene& scene, std::uint32_t substeps, int steps = 1) {
  test::Linkages islands(scene);
  LinkageState* const cluster[] = {&islands.states.front()};
  ClusterStepper stepper(Isa::scalar, ContactSettings{});
  const Surroundings around(scene);
  Tally report;
  for (int i = 0; i < steps; ++i) stepper.step(cluster, around, {.substeps = substeps}, test::frame, report);
  return cluster[0]->v.front();
}

// A ball in the air falls exactly, whatever the substeps: RATTLE is exact under constant forces.
TEST(ClusterStepper, FreeFallIsExact) {
  Scene scene;
  test::add_ball(scene, {0, 100, 0}, 0.1, 1, {2, 0, 0});
  for (const std::uint32_t substeps : {1u, 7u}) {
    const Vec3 v = velocity_after(scene, substeps, 30);
    EXPECT_NEAR(v.x, 2, 1e-12);
    EXPECT_NEAR(v.y, -test::earth * 0.5, 1e-12);
  }
}

// A rod that spins fast is turned by no more than contact_limits::most_turn in a substep, and a slow one by
// whole steps.
TEST(ClusterStepper, CutsStepsOfWhatTurnsFast) {
  for (const double spin : {1.0, 100.0}) {
    Scene scene;
    scene.gravity = {};
    test::add_capsule_rod(scene, {-0.5, 0, 0}, {0.5, 0, 0}, 1, 0.05);
    scene.particles[0].velocity = {0, -0.5 * spin, 0};
    scene.particles[1].velocity = {0, 0.5 * spin, 0};
    test::Linkages islands(scene);
    LinkageState* const cluster[] = {&islands.states.front()};
    ClusterStepper stepper(Isa::scalar, ContactSettings{});
    Tally report;
    stepper.step(cluster, Surroundings(scene), {.substeps = 1}, test::frame, report);
    const double least = spin * test::frame / contact_limits::most_turn;
    EXPECT_GE(static_cast<double>(report.direct_substeps), least);
    EXPECT_LE(static_cast<double>(report.direct_substeps), 2 * least + 1);
  }
}

// Slower than ContactSettings{}.bounce_speed nothing bounces; well above it a ball leaves with its
// restitution.
TEST(ClusterStepper, BouncesFromASpeedOn) {
  for (const double times : {0.5, 4.0}) {
    Scene scene;
    scene.gravity = {};
    scene.planes.push_back({.surface = {.restitution = 1}});
    const double speed = times * ContactSettings{}.bounce_speed;
    test::add_ball(scene, {0, 0.1 + 1e-3 * speed, 0}, 0.1, 1, {0, -speed, 0}, {.restitution = 1});
    const double left = velocity_after(scene, 4).y;
    EXPECT_NEAR(left, times < 1 ? 0 : speed, 1e-2 * speed);
  }
}

// A light ball is thrown at 164 m/s by a blow within the step, which nobody foresaw. What it would pass
// through in that substep is a MissedPair: nobody passes.
TEST(ClusterStepper, KeepsApartWhatPassesUnexpectedly) {
  Scene scene;
  scene.gravity = {};
  test::add_ball(scene, {-0.5, 0, 0}, 0.05, 1, {90, 0, 0});  // it comes from the left
  test::add_ball(scene, {0, 0, 0}, 0.05, 0.1, {});           // and throws this one
  test::add_ball(scene, {0.8, 0, 0}, 0.05, 1, {});           // through that one, unless that is found
  test::Linkages islands(scene);
  std::vector<LinkageState*> cluster;
  for (LinkageState& state : islands.states) cluster.push_back(&state);
  ClusterStepper stepper(Isa::scalar, ContactSettings{});
  const Surroundings around(scene);
  Tally report;
  for (int i = 0; i < 3; ++i) stepper.step(cluster, around, {.substeps = 1}, test::frame, report);
  EXPECT_LT(cluster[0]->x.front().x + 0.099, cluster[1]->x.front().x);
  EXPECT_LT(cluster[1]->x.front().x + 0.099, cluster[2]->x.front().x);
}

// The solver has a place for every particle of islands with shapes, where the scene puts it.
TEST(ContactSolver, PlacesParticlesWhereTheSceneDoes) {
  Scene scene = scenes::load_scene("crowd:humanoids=2,hit=1");
  for (Particle& particle : scene.particles) particle.asleep = false;
  const SceneParts parts(scene);
  ContactSolver solver(std::make_shared<const Scene>(scene), parts, {.method = Method::direct, .threads = 1});
  std::vector<int> times(scene.particles.size(), 0);
  for (const auto& [particle, slot] : solver.places()) {
    ++times[particle];
    EXPECT_EQ(solver.position(slot), scene.particles[particle].position);
    EXPECT_TRUE(solver.has(slot)) << "no island has another home";
  }
  EXPECT_EQ(times, std::vector<int>(scene.particles.size(), 1));
  EXPECT_EQ(solver.island_count(), parts.count());
  EXPECT_TRUE(solver.any_awake());
  Team team(1);
  solver.begin_step(test::frame, team);
  std::uint32_t islands = 0;
  for (std::uint32_t piece = 0; piece < solver.pieces(); ++piece) islands += solver.islands(piece);
  EXPECT_EQ(islands, parts.count()) << "every island is in one piece";
}

// What resists sliding, rolling or spinning has no push of its own where nothing presses.
TEST(ClusterRows, KnowWhatActsThroughANormal) {
  using Kind = ClusterRows::Kind;
  ClusterRows::Row row;
  for (const Kind kind : {Kind::sliding, Kind::rolling, Kind::spinning}) {
    row.kind = kind;
    EXPECT_TRUE(row.follows_normal());
  }
  for (const Kind kind : {Kind::normal, Kind::limit, Kind::brake}) {
    row.kind = kind;
    EXPECT_FALSE(row.follows_normal());
  }
  row.add_end(3, 5, 7);
  row.add_end(4, 6, 8);
  EXPECT_EQ(row.ends, 2u);
  EXPECT_EQ(row.island[1], 4u);
  EXPECT_EQ(row.side[1], 6u);
  EXPECT_EQ(row.of[1], 8u);
}

TEST(ClusterIsland, AddsUpParticlesByWeight) {
  ClusterIsland island;
  island.terms = {{0, 0.25}, {1, 0.75}};
  const std::vector<Vec3> values{{4, 0, 0}, {0, 4, 0}};
  EXPECT_EQ(island.of({0, 2}, values), (Vec3{1, 3, 0}));
  island.sides.resize(simd::kkt_lanes + 1);
  EXPECT_EQ(island.batches(), 2u);
}

/// Two rods of a metre that hang from an anchor at the height of 2 m, folded a little.
Scene folded_rods() {
  Scene scene;
  scene.particles = {{.position = {0, 2, 0}, .fixed = true},
                     {.position = {0.28, 1.04, 0}, .mass = 1},
                     {.position = {0, 0.08, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  return scene;
}

// A place that ground holds is where it lets it be, and rods keep their lengths by folding on.
TEST(ProjectPositions, HoldPlacesOutOfGround) {
  test::Linkages islands(folded_rods());
  LinkageState& state = islands.states.front();
  ProjectionWork work;
  const std::uint32_t low = state.x[0].y < state.x[1].y ? 0 : 1;
  work.holds.push_back({.at = {}, .along = {0, 1, 0}, .least = 0.3});
  work.holds[0].at.add(low, 1);
  EXPECT_EQ(project_positions(state, work), 0);
  EXPECT_NEAR(state.x[low].y, 0.3, 1e-5);
  EXPECT_NEAR(norm(state.x[low] - state.x[1 - low]), 1, 1e-8);
  EXPECT_NEAR(norm(state.x[1 - low] - state.x[2]), 1, 1e-8);
}

// What hangs from an anchor goes along with it.
TEST(ProjectVelocities, FollowAnchorsThatMove) {
  Scene scene = folded_rods();
  scene.particles[1].position = {0, 1, 0};
  scene.particles[2].position = {0, 0, 0};
  test::Linkages islands(scene);
  LinkageState& state = islands.states.front();
  state.v[2] = {0, -1, 0};
  ProjectionWork work;
  project_velocities(state, work);
  for (const Vec3 v : state.v) EXPECT_NEAR(norm(v - Vec3{0, -1, 0}), 0, 1e-9);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
