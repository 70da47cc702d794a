// What the relaxation of touching islands is made of: crowds of particles, their joints and contacts.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <random>
#include <vector>

#include "contact/cluster_mover.hpp"
#include "contact/colored_rods.hpp"
#include "contact/relaxed/blows/crowd_blows.hpp"
#include "contact/relaxed/blows/rigid_velocities.hpp"
#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/crowd_contacts.hpp"
#include "contact/relaxed/crowd_ends.hpp"
#include "contact/relaxed/crowd_joints.hpp"
#include "contact/relaxed/kept_table.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"
#include "contact/relaxed/pairs/ways.hpp"
#include "contact/relaxed/places/crowd_places.hpp"
#include "contact/relaxed/places/middle.hpp"
#include "contact/relaxed/places/placed_line.hpp"
#include "contact/rows.hpp"
#include "contact/shapes/sweep.hpp"
#include "plumb/joints.hpp"
#include "plumb/layouts/packing.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// One island of a scene, as relaxation takes it.
struct One {
  explicit One(const Scene& scene)
      : kind(scene, best_isa(), Linkage::Use::relaxed), state(kind, 0, scene), cluster{&state} {}

  Linkage kind;
  LinkageState state;
  std::vector<LinkageState*> cluster;
};

const auto& records = simd::kernels<double>(best_isa()).access[static_cast<int>(layouts::Access::records)];

/// A movable particle of mass 1 at `at`, and one of mass 3 a metre further along x.
Scene dumbbell(double length) {
  Scene scene;
  scene.particles = {{.position = {}, .mass = 1}, {.position = {1, 0, 0}, .mass = 3}};
  scene.rods = {{.a = 0, .b = 1, .length = length}};
  scene.gravity = {};
  return scene;
}

// A sweep shares a correction by inverse mass (thesis eq. 4.7), and a rod off by e needs e/2 of its square.
TEST(Crowds, ShareCorrectionsByMass) {
  One one(dumbbell(0.9));
  Crowd<double> crowd;
  crowd.gather(one.cluster, {});
  crowd.predict(0.01, Gradient::old);
  crowd.prepare(records, true);
  EXPECT_NEAR(crowd.violation(records), (1 - 0.81) / 0.81, 1e-12);
  for (int i = 0; i < 60; ++i) crowd.sweep(records, Gradient::new_, true);
  EXPECT_LT(crowd.violation(records), 1e-12);
  crowd.advance(0.01, Gradient::new_);
  crowd.scatter(one.state, 0);
  EXPECT_NEAR(one.state.x[0].x, 0.075, 1e-12);
  EXPECT_NEAR(one.state.x[1].x, 0.975, 1e-12);
  EXPECT_NEAR(one.state.v[0].x, 7.5, 1e-9);
}

TEST(Crowds, LayRodsOutByColors) {
  Scene scene = dumbbell(0);
  for (std::uint32_t i = 2; i < 30; ++i) {
    scene.particles.push_back({.position = {1.0 * i, 0, 0}, .mass = 1});
    scene.rods.push_back({.a = i - 1, .b = i});
  }
  const Linkage kind(scene, best_isa(), Linkage::Use::relaxed);
  ASSERT_EQ(kind.colored().colors(), 2u);
  std::size_t rods = 0;
  for (std::uint32_t color = 0; color < kind.colored().colors(); ++color) {
    std::vector<std::uint32_t> ends;
    for (const ColoredRods::Rod& rod : kind.colored().of(color)) {
      ends.push_back(rod.a);
      ends.push_back(rod.b);
      EXPECT_NEAR(rod.length2, 1, 1e-15);
    }
    std::sort(ends.begin(), ends.end());
    EXPECT_EQ(std::adjacent_find(ends.begin(), ends.end()), ends.end()) << "no particle twice";
    rods += kind.colored().of(color).size();
  }
  EXPECT_EQ(rods, 29u);
}

/// A skew net of 16 × 20 particles, the last of which is an anchor.
Scene net() {
  constexpr std::uint32_t width = 16, height = 20;
  Scene scene;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t own = y * width + x;
      scene.particles.push_back(
          {.position = {0.1 * x, 0.001 * x * y, 0.1 * y}, .mass = 1, .fixed = own + 1 == width * height});
      if (x > 0) scene.rods.push_back({.a = own - 1, .b = own, .length = 0.1});
      if (y > 0) scene.rods.push_back({.a = own - width, .b = own, .length = 0.1});
    }
  return scene;
}

// Every particle of a net has a place of its own and every rod a lane, whose ends are what it joins. Rods of
// a colour share no particle.
TEST(Crowds, LayNetsInRows) {
  const Scene scene = net();
  One one(scene);
  Crowd<double> crowd;
  crowd.gather(one.cluster, {});
  const CrowdPlaces& places = crowd.places();
  ASSERT_EQ(places.access(), layouts::Access::rows);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t k = 0; k < places.particles(); ++k)
    for (std::uint32_t c = 0; c < 3; ++c) numbers.push_back(places.at(k) + c * places.component_stride());
  std::sort(numbers.begin(), numbers.end());
  EXPECT_EQ(std::adjacent_find(numbers.begin(), numbers.end()), numbers.end());
  EXPECT_LT(numbers.back(), places.numbers());
  const auto lanes = static_cast<std::uint32_t>(layouts::lane_width<double>);
  std::vector<int> seen(scene.rods.size(), 0);
  for (const auto [begin, end] : places.colors()) {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t lane = begin * lanes; lane < end * lanes; ++lane) {
      const CrowdPlaces::Rod& rod = places.rods()[lane];
      if (rod.island == CrowdPlaces::none) continue;
      EXPECT_EQ(places.at(rod.a), places.address_a()[lane / lanes] + lane % lanes);
      EXPECT_EQ(places.at(rod.b), places.address_b()[lane / lanes] + lane % lanes);
      ++seen[rod.number];
      ends.insert(ends.end(), {rod.a, rod.b});
    }
    std::sort(ends.begin(), ends.end());
    EXPECT_EQ(std::adjacent_find(ends.begin(), ends.end()), ends.end()) << "no particle twice";
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<long>(seen.size()));
  EXPECT_EQ(crowd.rods(), scene.rods.size());
}

// What relaxation converges to does not depend on where particles lie: beside a dumbbell far away, they are
// records.
TEST(Crowds, RowsAndRecordsConvergeToTheSame) {
  One alone(net()), beside(net()), other(dumbbell(1));
  std::vector<LinkageState*> both{&beside.state, &other.state};
  const auto relax = [](std::span<LinkageState* const> cluster, layouts::Access access) {
    const auto& kernels = simd::kernels<double>(best_isa()).access[static_cast<int>(access)];
    Crowd<double> crowd;
    crowd.gather(cluster, {});
    EXPECT_EQ(crowd.places().access(), access);
    crowd.predict(0.01, Gradient::new_);
    crowd.prepare(kernels, true);
    for (int i = 0; i < 6000; ++i) crowd.sweep(kernels, Gradient::old, true);
    EXPECT_LT(crowd.violation(kernels), 1e-12);
    cluster[0]->pulls.counts = true;
    cluster[0]->pulls.rods.assign(cluster[0]->linkage->rods(), 0);
    cluster[0]->pulls.fixed.assign(1, {});
    crowd.count_pulls(0.01, Gradient::old, cluster);
    const double moved = crowd.most_moved(), energy = crowd.kinetic_of_moves(0.01);
    crowd.advance(0.01, Gradient::new_);
    EXPECT_NEAR(crowd.kinetic(), energy, 1e-9 * energy);
    crowd.scatter(*cluster[0], 0);
    EXPECT_FALSE(crowd.stop_if_broken(*cluster[0], 0));
    return moved;
  };
  EXPECT_NEAR(relax(alone.cluster, layouts::Access::rows), relax(both, layouts::Access::records), 1e-9);
  for (std::size_t k = 0; k < alone.state.x.size(); ++k) {
    EXPECT_LT(norm(alone.state.x[k] - beside.state.x[k]), 1e-9) << k;
    EXPECT_LT(norm(alone.state.v[k] - beside.state.v[k]), 1e-7) << k;
  }
  for (std::size_t k = 0; k < alone.state.pulls.fixed.size(); ++k)
    EXPECT_LT(norm(alone.state.pulls.fixed[k] - beside.state.pulls.fixed[k]),
              1e-6 * norm(beside.state.pulls.fixed[k]));
}

// In rows as in records, those are listed that start in the box and are displaced by more than a millimetre.
TEST(Crowds, ListWhatIsFastInABox) {
  constexpr double h = 0.01, least = 1e-3;
  const Bounds box{{0.25, -1, 0.25}, {0.85, 1, 0.75}};
  One alone(net()), beside(net()), other(dumbbell(1));
  std::mt19937_64 random(1);
  for (std::size_t k = 0; k + 1 < alone.state.v.size(); ++k)
    alone.state.v[k] = beside.state.v[k] = {0.2 * static_cast<double>(random() >> 11) * 0x1p-53, 0, 0};
  std::vector<LinkageState*> both{&beside.state, &other.state};
  for (const std::span<LinkageState* const> cluster :
       {std::span<LinkageState* const>(alone.cluster), {both}}) {
    Crowd<double> crowd(simd::kernels<double>(best_isa()));
    crowd.gather(cluster, {});
    crowd.predict(h, Gradient::new_);
    Array<std::uint32_t> want, room;
    for (std::uint32_t k = 0; k < crowd.places().particles(); ++k) {
      const std::uint32_t at = crowd.places().at(k);
      const Vec3 there = crowd.position(at);
      if (norm(crowd.moved(at)) > least && box.contains({there, there})) want.push_back(at);
    }
    std::sort(want.begin(), want.end());
    const auto listed = crowd.list_fast(box, least, room);
    EXPECT_GT(want.size(), 10u);
    EXPECT_TRUE(std::equal(want.begin(), want.end(), listed.begin(), listed.end()));
  }
}

TEST(CrowdJoints, BallJointsAndCablesAreExactAfterOneVisit) {
  Scene scene = dumbbell(0);
  scene.rods[0].law = {.one_sided = true};
  scene.rods[0].length = 0.8;
  One cable(scene);
  Crowd<double> crowd;
  CrowdJoints<double> joints;
  crowd.gather(cable.cluster, {});
  joints.gather(cable.cluster, crowd);
  EXPECT_TRUE(joints.has_elastics());
  crowd.predict(0.01, Gradient::new_);
  joints.begin(cable.cluster, crowd, 0.01, 0);
  for (int i = 0; i < 2; ++i) joints.sweep(crowd);
  crowd.advance(0.01, Gradient::new_);
  crowd.scatter(cable.state, 0);
  EXPECT_NEAR(cable.state.x[1].x - cable.state.x[0].x, 0.8, 1e-15);

  scene.rods.clear();
  scene.pins = {{.a = point_at(0), .b = {{0, 1}, {0.25, 0.75}}}};
  One pinned(scene);
  crowd.gather(pinned.cluster, {});
  joints.gather(pinned.cluster, crowd);
  crowd.predict(0.01, Gradient::new_);
  joints.begin(pinned.cluster, crowd, 0.01, 0);
  joints.sweep(crowd);
  crowd.advance(0.01, Gradient::new_);
  crowd.scatter(pinned.state, 0);
  EXPECT_LT(norm(pinned.state.x[1] - pinned.state.x[0]), 1e-15);
  EXPECT_NEAR(pinned.state.x[0].x, 0.75, 1e-15) << "its centre of mass stays";
}

// A body that is hit at one particle moves on as a whole, with the momentum and the spin of the blow.
TEST(Crowds, MakeBodiesMoveAsOne) {
  Scene scene;
  scene.gravity = {};
  MassProperties solid = solid_box(3, {0.2, 0.4, 0.6});
  solid.center = {1, 2, 3};
  const std::uint32_t body = add_body(scene, solid);
  scene.particles[scene.bodies[body].particles[1]].velocity = {0.3, -2, 1};
  One one(scene);
  Crowd<double> crowd;
  crowd.gather(one.cluster, {});
  const auto moments = [&] {
    std::array<Vec3, 2> out{};
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Vec3 momentum = scene.particles[k].mass * one.state.v[k];
      out[0] += momentum;
      out[1] += cross(one.state.x[k], momentum);
    }
    return out;
  };
  const auto before = moments();
  make_rigid(crowd, 0, scene.bodies[body].particles);
  crowd.scatter(one.state, 0);
  const auto after = moments();
  for (const int i : {0, 1}) EXPECT_LT(norm(after[i] - before[i]), 1e-14);
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t k = 0; k < i; ++k)
      EXPECT_LT(std::abs(dot(one.state.x[i] - one.state.x[k], one.state.v[i] - one.state.v[k])), 1e-15);
  EXPECT_GT(norm(one.state.v[0]), 0.01) << "the others move, too";
}

TEST(CrowdContacts, KeepAGapOpenAndHoldWithinTheCone) {
  Scene scene;
  scene.particles = {{.position = {0, 0.1, 0}, .velocity = {1, -3, 0}, .mass = 2}};
  scene.capsules = {{.a = point_at(0), .b = point_at(0), .radius = 0.1, .surface = {.friction = 0.2}}};
  scene.planes = {{.surface = {.friction = 0.2}}};
  scene.gravity = {};
  One ball(scene);
  const Surroundings surroundings(scene);
  Crowd<double> crowd;
  CrowdContacts<double> contacts(ContactSettings{}, simd::kernels<double>(best_isa()));
  crowd.gather(ball.cluster, {});
  GroundNow ground;
  ground.find(surroundings, 0);
  contacts.find(ball.cluster, crowd, surroundings, ground, 0.01, 10);
  crowd.predict(0.01, Gradient::new_);
  ASSERT_TRUE(contacts.begin(ball.cluster, crowd, surroundings, ground, 0.01, nullptr));
  EXPECT_FALSE(contacts.is_empty());
  EXPECT_NEAR(contacts.measured_sweep(crowd, nullptr), 0.03 * std::sqrt(1 + 0.04), 1e-12);
  EXPECT_EQ(contacts.measured_sweep(crowd, nullptr), 0) << "it is solved";
  crowd.advance(0.01, Gradient::new_);
  contacts.end(ball.cluster, crowd, 0.01);
  contacts.keep(ball.cluster, crowd);
  crowd.scatter(ball.state, 0);
  EXPECT_NEAR(ball.state.x[0].y, 0.1, 1e-15);
  EXPECT_NEAR(ball.state.v[0].x, 1 - 0.2 * 3, 1e-12) << "friction takes its share of the blow";
  ASSERT_EQ(ball.state.kept.size(), 1u);
  EXPECT_NEAR(ball.state.kept[0].force.y, 2 * 3 / 0.01, 1e-9);
}

TEST(ContactRows, TakeBackAShareOfOverlapsAndBounceByTheSpeedOfArrival) {
  EXPECT_EQ(recovered(0.01, 1e-3, 0.1), 0.01) << "what is open may close";
  EXPECT_EQ(recovered(-0.5e-3, 1e-3, 0.1), 0) << "a slop stays";
  EXPECT_NEAR(recovered(-0.011, 1e-3, 0.1), -1e-3, 1e-18);
  // It is a metre above, falls with 1 m/s, and gains 2 g on the way.
  EXPECT_NEAR(bounce_of(0.5, 0.05, approach_of(1, -1 - 0.5 * 9.81, -1, 1)), 0.5 * std::sqrt(1 + 2 * 9.81),
              1e-12);
  EXPECT_EQ(bounce_of(0.5, 0.05, approach_of(0, -1e-4, -0.01, 0.01)), 0) << "too slow to bounce";
  const Combination middle = blend(combination(point_at(3)), combination(point_at(5)), 0.25);
  ASSERT_EQ(middle.count, 2u);
  EXPECT_EQ(middle.terms[0].weight, 0.75);
}

// A place between two particles is the same sum, to the last bit, whichever way it is made; ends are one
// term.
TEST(Middle, IsTheSumThatBlendMakes) {
  Scene scene = dumbbell(0);
  scene.particles[1].fixed = true;
  One one(scene);
  Crowd<double> crowd;
  crowd.gather(one.cluster, {});
  Combination a, b;
  a.add(0, 1);
  b.add(1, 1);
  const auto term_of = [&](const Combination& sum) { return crowd.term(one.kind, 0, sum.terms[0]); };
  for (const double t : {0.0, 0.3, 1.0}) {
    Array<Crowd<double>::Term> want;
    crowd.add_terms(one.kind, 0, blend(a, b, t), 1, want);
    const Middle<double> by_sum(crowd, one.kind, 0, blend(a, b, t)), by_ends(term_of(a), term_of(b), t);
    for (const auto got : {by_sum.terms(), by_ends.terms()}) {
      ASSERT_EQ(got.size(), want.size()) << t;
      for (std::size_t k = 0; k < want.size(); ++k) {
        EXPECT_EQ(got[k].at, want[k].at);
        EXPECT_EQ(got[k].weight, want[k].weight);
        EXPECT_EQ(got[k].move, want[k].move);
      }
    }
  }
}

// Lengths that change are followed rod by rod. Sweeps then do bit for bit what they do in a crowd that weighs
// all rods anew: of rods of one length or not, where others change, and where none does any more.
TEST(Crowd, FollowsLengthsAsIfAllWereWeighedAnew) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 40; ++i)
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 1, .fixed = i == 40});
  for (std::uint32_t i = 0; i < 40; ++i) scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
  One one(scene);
  const CrowdRules rules;
  const auto moved = [&](Crowd<double>& crowd) {
    const auto& kernels = simd::kernels<double>(best_isa()).access[static_cast<int>(crowd.places().access())];
    crowd.predict(0.01, Gradient::mid);
    crowd.prepare(kernels, false);
    for (int sweep = 0; sweep < 3; ++sweep) crowd.sweep(kernels, Gradient::mid, false);
    std::vector<Vec3> out;
    for (std::uint32_t k = 0; k < one.kind.particles(); ++k)
      out.push_back(crowd.moved(crowd.number_of(0, k)));
    return out;
  };
  Crowd<double> crowd;
  std::vector<Vec3> last;
  const auto expect_alike = [&](double t) {
    crowd.gather(one.cluster, rules);
    one.state.lengths.follow(t);
    crowd.follow_lengths();
    Crowd<double> fresh;
    fresh.gather(one.cluster, rules);
    const std::vector<Vec3> now = moved(crowd);
    EXPECT_EQ(now, moved(fresh));
    EXPECT_NE(now, last) << "the change must show";
    last = now;
    one.state.lengths.follow(0);
  };
  expect_alike(0);
  RodLengths& lengths = one.state.lengths;
  lengths.set(0, 40, 0.1, 0.1, 0.5);
  expect_alike(0.01);
  expect_alike(0.02);
  lengths.set(7, 40, 0.1, 0.12, -0.5);
  expect_alike(0.01);
  lengths = {};
  lengths.set(20, 40, 0.1, 0.2, 0);
  lengths.set(7, 40, 0.1, 0.2, 0);
  expect_alike(0);
  lengths = {};
  expect_alike(0);
}

// An anchor that goes on at 1 m/s and a rod that is wound at 0.5 m/s give both particles behind them their
// speeds once, and each rod the impulse of what hangs from it. What keeps its speed gets no blow.
TEST(CrowdBlows, GiveTheSpeedOfAnchorsAndLengthsOnce) {
  Scene scene;
  scene.particles = {{.position = {0, -0.1, 0}, .mass = 2},
                     {.position = {0, -0.2, 0}, .mass = 3},
                     {.position = {0, 0, 0}, .fixed = true}};  // those come last
  scene.rods = {{.a = 2, .b = 0}, {.a = 0, .b = 1}};
  One one(scene);
  LinkageState& state = one.state;
  state.pulls = one.kind.make_pulls();
  state.pulls.counts = true;
  state.v.back() = {0, 1, 0};
  state.lengths.set(0, 2, 0.1, 0.1, -0.5);
  const CrowdRules rules{.stop = {.sweeps = 500}};
  Crowd<double> crowd;
  CrowdJoints<double> joints;
  CrowdBlows<double> blows;
  crowd.gather(one.cluster, rules);
  EXPECT_TRUE(blows.give(one.cluster, crowd, joints, rules));
  EXPECT_FALSE(blows.give(one.cluster, crowd, joints, rules));
  for (std::uint32_t k = 0; k < 2; ++k)
    EXPECT_NEAR(norm(crowd.velocity(crowd.number_of(0, k)) - Vec3{0, 1.5, 0}), 0, 1e-12) << k;
  EXPECT_NEAR(state.pulls.rods[0], 1.5 * 5, 1e-12);
  EXPECT_NEAR(state.pulls.rods[1], 1.5 * 3, 1e-12);
  EXPECT_NEAR(norm(state.pulls.fixed[0] - Vec3{0, -1.5 * 5, 0}), 0, 1e-12);
  EXPECT_NEAR(state.lengths.find(0)->work, 1.5 * 5 * 0.5 / 2, 1e-12) << "at the mean of both rates";
}

// Islands that are alike keep contacts of the same keys. Each finds its own, and none what it did not keep.
TEST(KeptTable, FindsWhatAnIslandKeptByKey) {
  std::deque<One> ones;
  for (int i = 0; i < 3; ++i) ones.emplace_back(dumbbell(1));
  std::vector<LinkageState*> cluster;
  for (std::size_t i = 0; i < ones.size(); ++i) {
    for (std::uint64_t key = 1; key <= 40; ++key)
      if (key % (i + 1) == 0) ones[i].state.kept.push_back({.key = key, .force = {1.0 * key, 1.0 * i, 0}});
    cluster.push_back(&ones[i].state);
  }
  KeptTable table;
  table.gather(cluster);
  std::size_t next = 0;  // of the island before at first, and behind its last at last
  for (std::uint32_t i = 0; i < ones.size(); ++i)
    for (std::uint64_t key = 1; key <= 40; ++key) {
      const KeptContact* const found = table.find(ones[i].state, i, key, next);
      ASSERT_EQ(found != nullptr, key % (i + 1) == 0) << i << " " << key;
      if (found == nullptr) continue;
      EXPECT_EQ(found->key, key);
      EXPECT_EQ(found->force, (Vec3{1.0 * key, 1.0 * i, 0}));
      EXPECT_EQ(next, key / (i + 1));
    }
}

// Vectors read lines where their fields say.
TEST(PlacedLines, LieAsFieldsSay) {
  const PlacedLine line{
      .p = {1, 2, 3}, .radius = 4, .q = {5, 6, 7}, .moves = 8, .p_by = {9, 10, 11}, .q_by = {12, 13, 14}};
  const std::array<double, simd::line_fields::count> numbers =
      std::bit_cast<std::array<double, simd::line_fields::count>>(line);
  EXPECT_EQ(numbers[simd::line_fields::p + 2], 3);
  EXPECT_EQ(numbers[simd::line_fields::radius], 4);
  EXPECT_EQ(numbers[simd::line_fields::q], 5);
  EXPECT_EQ(numbers[simd::line_fields::moves], 8);
  EXPECT_EQ(numbers[simd::line_fields::p_by + 1], 10);
  EXPECT_EQ(numbers[simd::line_fields::q_by], 12);
  EXPECT_EQ(line.way().at.q, (Vec3{5, 6, 7}));
  EXPECT_EQ(line.way().at.radius, 4);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
