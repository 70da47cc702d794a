// What every solver of particles and rods promises, whoever makes it: where its particles are, and that a
// piece can be taken back.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "direct/direct_solvers.hpp"
#include "direct/trees/tree_solver.hpp"
#include "interface/island_sets.hpp"
#include "interface/made_solver.hpp"
#include "interface/solver.hpp"
#include "interface/state_hash.hpp"
#include "interface/tally.hpp"
#include "reference/reference_solver.hpp"
#include "relax/relax_solver.hpp"
#include "scenes/generators/generators.hpp"
#include "support/islands.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// Two equal chains, a chain of another length and a ring, each somewhere else.
Scene four_islands() {
  Scene scene = scenes::make_chain(6);
  const auto append = [&scene](Scene other, double z) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    for (Particle particle : other.particles) {
      particle.position.z += z;
      scene.particles.push_back(particle);
    }
    for (Rod rod : other.rods) {
      rod.a += first;
      rod.b += first;
      scene.rods.push_back(rod);
    }
  };
  append(scenes::make_chain(6), 1);
  append(scenes::make_chain(3), 2);
  append(test::hanging_net(3, 2), 3);
  return scene;
}

struct Maker {
  const char* name;
  Method method;
};

Array<MadeSolver> make(const Maker& maker, const Scene& scene, const test::IslandsOf& of,
                       StartReport& report) {
  const Settings settings{.method = maker.method, .accuracy = std::nullopt, .threads = 1};
  if (maker.method == Method::relax) return make_relax_solvers(scene, of.sets, settings, report);
  if (maker.method == Method::multipliers) return make_reference_solvers(scene, of.sets, settings, report);
  return make_direct_solvers(scene, of.sets, settings, {.gradient = Gradient::old}, report);
}

class Solvers : public testing::TestWithParam<Maker> {};

// Every particle of the islands has a place, and stands there where the scene has it, to the rounding of the
// projection that brings rods to their lengths.
TEST_P(Solvers, PlaceEveryParticle) {
  const Scene scene = four_islands();
  const test::IslandsOf of(scene);
  StartReport report{.kinds = std::make_shared<TreeKinds>()};
  std::set<std::uint32_t> seen;
  std::uint32_t islands = 0;
  for (const MadeSolver& made : make(GetParam(), scene, of, report)) {
    for (const auto& [particle, slot] : made.places) {
      seen.insert(particle);
      EXPECT_LE(norm(made.solver->position(slot) - scene.particles[particle].position), 1e-12);
      EXPECT_EQ(made.solver->velocity(slot), Vec3{}) << "at rest";
    }
    for (std::uint32_t piece = 0; piece < made.solver->pieces(); ++piece)
      islands += made.solver->islands(piece);
  }
  EXPECT_EQ(seen.size(), scene.particles.size());
  EXPECT_EQ(islands, 4u);
  EXPECT_EQ(report.unprojected_islands, 0u);
  EXPECT_EQ(report.projected_velocity, 0);
}

// A substep moves what is free and leaves what is fixed.
TEST_P(Solvers, MoveWhatIsMovable) {
  const Scene scene = four_islands();
  const test::IslandsOf of(scene);
  StartReport report{.kinds = std::make_shared<TreeKinds>()};
  Team team(1);
  int moved = 0;
  for (const MadeSolver& made : make(GetParam(), scene, of, report)) {
    Tally counters;
    made.solver->begin_step(0.01, team);
    for (std::uint32_t piece = 0; piece < made.solver->pieces(); ++piece) {
      made.solver->begin_piece(piece, 0);
      made.solver->advance(piece, 0.01, 1, 0, counters);
      made.solver->end_piece(piece, 0.01, 0);
    }
    made.solver->end_step(counters);
    for (const auto& [particle, slot] : made.places) {
      const double by = norm(made.solver->position(slot) - scene.particles[particle].position);
      if (scene.particles[particle].fixed) {
        EXPECT_EQ(by, 0);
      }
      moved += by > 1e-6;
    }
  }
  EXPECT_GT(moved, 4);
}

INSTANTIATE_TEST_SUITE_P(Every, Solvers,
                         testing::Values(Maker{"relax", Method::relax}, Maker{"direct", Method::direct},
                                         Maker{"multipliers", Method::multipliers}),
                         [](const auto& test) { return std::string(test.param.name); });

std::uint64_t hash_of(const MadeSolver& made) {
  StateHash hash;
  for (const auto& [particle, slot] : made.places) made.solver->add_to_hash(slot, hash);
  return hash.value();
}

// What is saved comes back to the bit, and how far a piece has come is measured from its mark.
TEST(Solvers, TakePiecesBackToTheBit) {
  const Scene scene = four_islands();
  const test::IslandsOf of(scene);
  StartReport report{.kinds = std::make_shared<TreeKinds>()};
  Team team(1);
  const Settings settings{.method = Method::direct, .accuracy = 1e-3, .threads = 1};
  for (const MadeSolver& made :
       make_direct_solvers(scene, of.sets, settings, {.gradient = Gradient::old}, report)) {
    Tally counters;
    made.solver->begin_step(0.02, team);
    made.solver->begin_piece(0, 0);
    made.solver->advance(0, 0.01, 1, 0, counters);
    const std::uint64_t before = hash_of(made);
    made.solver->save(0, Saved::step);
    made.solver->mark(0);
    EXPECT_EQ(made.solver->distance_from_mark(0), 0);
    made.solver->advance(0, 0.01, 1, 0, counters);
    EXPECT_NE(hash_of(made), before);
    EXPECT_GT(made.solver->distance_from_mark(0), 1e-6);
    made.solver->restore(0, Saved::step);
    EXPECT_EQ(hash_of(made), before);
    EXPECT_EQ(made.solver->distance_from_mark(0), 0);
  }
}

// Slots of a lane group: nodes by lane, then ties, none twice.
TEST(TreeSolver, NumbersItsSlotsOnce) {
  Scene scene = scenes::make_ensemble({.chains = 8, .links = 3});
  const test::IslandsOf of(scene);
  const layouts::Tree tree = of.tree(0);
  const auto kind = std::make_shared<TreeKind<double>>(
      tree, 8u, TreeKind<double>::Rules{Gradient::old, 2, false, false, false, 0, best_isa(), 1});
  TreeSolver<double> solver(kind, 8);
  for (std::uint32_t lane = 0; lane < 8; ++lane)
    solver.fill_lane(lane, scene, MassModel::consistent, tree,
                     {of.islands.vertices(lane), of.islands.edges(lane)});
  solver.finish_layout();
  std::set<Slot> slots;
  for (std::uint32_t lane = 0; lane < 8; ++lane) {
    for (std::uint32_t node = 0; node < tree.nodes(); ++node) {
      EXPECT_TRUE(slots.insert(solver.node_slot(node, lane)).second);
      EXPECT_EQ(solver.position(solver.node_slot(node, lane)),
                scene.particles[of.islands.vertices(lane)[tree.vertex[node]]].position);
    }
    for (std::uint32_t tie = 0; tie < tree.ties.size(); ++tie)
      EXPECT_TRUE(slots.insert(solver.tie_slot(tie, lane)).second);
  }
  EXPECT_EQ(slots.size(), 8 * (tree.nodes() + tree.ties.size()));
  EXPECT_EQ(*slots.rbegin(), slots.size() - 1);
}

TEST(AnchorMove, HasTheVelocityOfItsPath) {
  EXPECT_EQ((AnchorMove{{1, 2, 3}, {2, 2, 1}, 0.5}.velocity()), (Vec3{2, 0, -4}));
}

// A try that is taken back leaves its work and nothing else, and what is left of the bound is what it may
// take.
TEST(Tally, CountsTheWorkOfWhatIsTakenBack) {
  Tally tally;
  tally.most_work = 10;
  tally.direct_substeps = 3;
  Tally tried = tally.begin_try();
  EXPECT_EQ(tried.most_work, 7u);
  tried.direct_substeps = 2;
  tried.newton = 4;
  EXPECT_FALSE(tried.is_spent());
  Tally keeper = tally;
  keeper.keep(tried);
  EXPECT_EQ(keeper.direct_substeps, 5u);
  EXPECT_EQ(keeper.work(), 9u);
  tally.take_back(tried);
  EXPECT_EQ(tally.direct_substeps, 3u) << "they were not taken";
  EXPECT_EQ(tally.work(), 9u) << "but they were work";
  EXPECT_FALSE(tally.is_spent());
  tally.halvings = 1;
  EXPECT_TRUE(tally.is_spent());
}

// What is late has not spent its work, unless it is a try that will be taken back anyway.
TEST(Tally, IsSpentWhenLateOnlyInTries) {
  Tally tally;
  tally.deadline = std::chrono::steady_clock::time_point{};
  EXPECT_FALSE(tally.is_spent());
  EXPECT_FALSE(tally.was_late);
  tally.gives_up_late = true;
  Tally tried = tally.begin_try();
  EXPECT_TRUE(tried.is_spent());
  EXPECT_FALSE(tried.has_spent_work());
  tally.take_back(tried);
  EXPECT_TRUE(tally.was_late);
}

// FNV-1a as published: of the empty string, and of the bytes of "a" followed by zeros, in long arithmetic.
TEST(StateHash, IsFnv1aOfTheBytes) {
  const std::uint64_t empty = StateHash().value();
  EXPECT_EQ(empty, 0xcbf29ce484222325u);
  StateHash hash;
  hash.add(std::bit_cast<float>(std::uint32_t{'a'}));
  std::uint64_t wanted = empty;
  for (const unsigned byte : {0x61u, 0u, 0u, 0u}) wanted = (wanted ^ byte) * 0x100000001b3u;
  EXPECT_EQ(hash.value(), wanted);
  StateHash plus, minus;
  plus.add(0.0);
  minus.add(-0.0);
  EXPECT_NE(plus.value(), minus.value()) << "bits count, not values";
}

// Equal trees share their kind while some solver has it.
TEST(TreeKinds, AreSharedByWhatIsAlike) {
  const auto tree_of = [](const Scene& scene) {
    const test::IslandsOf of(scene);
    return *layouts::find_tree(layouts::local_graph(of.sets.graph, of.sets.islands, 0).view());
  };
  const layouts::Tree tree = tree_of(scenes::make_chain(6)), other = tree_of(scenes::make_chain(5));
  const TreeKind<double>::Rules rules{Gradient::mid, 2, false, false, false, 0, Isa::scalar, 1};
  TreeKind<double>::Rules dragged = rules;
  dragged.drag = 1;
  TreeKinds kinds;
  const auto kind = kinds.get<double>(tree, 1, rules, {});
  EXPECT_EQ(kinds.get<double>(tree, 1, rules, {}), kind);
  EXPECT_NE(kinds.get<double>(tree, 8, rules, {}), kind);
  EXPECT_NE(kinds.get<double>(tree, 1, dragged, {}), kind);
  EXPECT_NE(kinds.get<double>(other, 1, rules, {}), kind);
  EXPECT_EQ(kinds.get<float>(tree, 1, {Gradient::mid, 2, false, false, false, 0, Isa::scalar, 1}, {})->lanes,
            1u);
  std::weak_ptr<TreeKind<double>> gone = kinds.get<double>(tree, 2, rules, {});
  EXPECT_TRUE(gone.expired());
  for (std::uint32_t lanes = 1; lanes < 100; ++lanes) kinds.get<double>(other, lanes, rules, {});
  EXPECT_EQ(kinds.get<double>(tree, 1, rules, {}), kind);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
