// Blocks of relaxation: their numbers by slot, their description, and one substep.

#include "relax/block.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "relax/constants.hpp"
#include "relax/describe.hpp"
#include "relax/plan.hpp"
#include "relax/relax.hpp"
#include "scenes/generators/generators.hpp"
#include "support/islands.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// The blocks of a scene, at its positions and at rest, without loads.
std::vector<Block<double>> blocks_of(const Scene& scene, LayoutChoice layout = LayoutChoice::automatic) {
  const test::IslandsOf of(scene);
  const Constants constants = make_constants(scene);
  const std::vector<std::uint8_t> common(scene.rods.size(), 0);
  std::vector<Block<double>> out;
  for (layouts::Packing& packing : plan_blocks(of.sets, layout, common, layouts::lane_width<double>, 8)) {
    Block<double>& block = out.emplace_back(std::move(packing), false);
    block.set_weights({constants, Weights::mass, SweepOrder::gauss_seidel, 1});
    for (std::uint32_t slot = 0; slot < block.packing().slot_vertex.size(); ++slot)
      block.write(block.x(), slot, scene.particles[block.packing().slot_vertex[slot]].position);
  }
  return out;
}

RelaxSettings<double> one_substep(std::uint32_t sweeps) {
  return {&simd::kernels<double>(Isa::scalar),
          Gradient::new_,
          SweepOrder::gauss_seidel,
          {.sweeps = sweeps},
          1,
          1.0};
}

TEST(Constants, AreOfTheSceneAsItIs) {
  Scene scene;
  scene.particles = {test::fixed({0, 0, 0}), test::movable({3, 4, 0}, 4), test::movable({3, 4, 9}, 0.5)};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2, .length = 10}};
  const Constants constants = make_constants(scene);
  EXPECT_EQ(constants.length2, (Array<double>{25, 100}));
  EXPECT_EQ(constants.inverse_mass, (Array<double>{0, 0.25, 2}));
  EXPECT_EQ(constants.valence, (Array<std::uint32_t>{1, 2, 1}));
}

// In every layout: what is written to a slot is read from it, and from no other.
TEST(Block, KeepsSlotsApart) {
  for (const LayoutChoice layout : {LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa}) {
    for (Block<double>& block : blocks_of(scenes::make_net(5, 4), layout)) {
      const auto slots = static_cast<std::uint32_t>(block.packing().slot_vertex.size());
      for (std::uint32_t slot = 0; slot < slots; ++slot)
        block.write(block.kick(), slot, {1.0 * slot, 0.5 * slot, -1.0 * slot});
      for (std::uint32_t slot = 0; slot < slots; ++slot)
        EXPECT_EQ(block.read(block.kick(), slot), (Vec3{1.0 * slot, 0.5 * slot, -1.0 * slot}));
    }
  }
}

// An island that is cut or removed leaves no lengths to follow in its lanes; others keep theirs.
TEST(Block, ForgetsLengthsOfWhatWasTakenOut) {
  Scene scene = scenes::make_chain(4);
  const auto particles = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i < particles; ++i) {
    scene.particles.push_back(scene.particles[i]);
    scene.particles.back().position.z += 1;
    if (i > 0) scene.rods.push_back({.a = particles + i - 1, .b = particles + i});
  }
  for (Block<double>& block : blocks_of(scene)) {
    const auto& edges = block.packing().lane_edge;
    const auto lane_of = [&](std::uint32_t rod) {
      return static_cast<std::size_t>(std::find(edges.begin(), edges.end(), rod) - edges.begin());
    };
    for (std::size_t lane = 0; lane < edges.size(); ++lane)
      if (edges[lane] == 1 || edges[lane] == 5) block.set_length(lane, 0.1, 0.5);
    const auto& vertices = block.packing().slot_vertex;
    const auto slot = std::find(vertices.begin(), vertices.end(), particles + 1) - vertices.begin();
    block.freeze_island(static_cast<std::uint32_t>(slot));
    EXPECT_EQ(block.rate(lane_of(1)), 0.5);
    EXPECT_EQ(block.rate(lane_of(5)), 0);
  }
}

TEST(Block, SubstepsSwapDisplacements) {
  std::vector<Block<double>> blocks = blocks_of(scenes::make_chain(10));
  Block<double>& block = blocks.front();
  const double *newest = block.displacement(0), *before = block.displacement(1);
  block.count_substeps(3);
  EXPECT_EQ(block.displacement(0), before);
  EXPECT_EQ(block.displacement(1), newest);
  block.count_substeps(2);
  EXPECT_EQ(block.displacement(0), before);
}

// Blocks hold every rod once, whatever stands in their lanes twice, and what is listed adds up to them.
TEST(Block, CountsRodsOnce) {
  const Scene scene = scenes::make_ensemble({.chains = 13, .links = 4});
  std::vector<BlockInfo> list;
  std::uint32_t rods = 0;
  for (Block<double>& block : blocks_of(scene)) {
    rods += block.rods();
    std::uint32_t by_position = 0;
    for (std::uint32_t q = 0; q < block.packing().positions; ++q) by_position += block.rods(q, q + 1);
    EXPECT_EQ(by_position, block.rods());
    add_to_list(list, describe(block));
    add_to_list(list, describe(block));
  }
  EXPECT_EQ(rods, scene.rods.size());
  ASSERT_EQ(list.size(), 1u) << "equal blocks stand once";
  EXPECT_EQ(list[0].rods, 2 * rods);
  EXPECT_EQ(list[0].islands, 2 * 13u);
  EXPECT_EQ(list[0].particles, 2 * scene.particles.size());
}

/// A rod of 1 m between masses of 1 and 3 kg, 10 % too long.
Scene long_rod() {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}, 1), test::movable({1.1, 0, 0}, 3)};
  scene.rods = {{.a = 0, .b = 1, .length = 1}};
  return scene;
}

// One projection leaves a quarter of the strain cubed (Halley), and the centre of mass where it was.
TEST(Relax, ProjectsARodToItsLength) {
  std::vector<Block<double>> blocks = blocks_of(long_rod());
  Block<double>& block = blocks.front();
  StepReport report;
  relax_alone(block, 0, block.packing().positions, one_substep(1), report);
  Vec3 x[2];
  for (std::uint32_t slot = 0; slot < block.packing().slot_vertex.size(); ++slot)
    x[block.packing().slot_vertex[slot]] = block.read(block.x(), slot);
  const double strain = x[1].x - x[0].x - 1;
  EXPECT_NEAR(std::abs(strain), 0.1 * 0.1 * 0.1 / 4, 0.5e-4);
  EXPECT_NEAR(x[0].x + 3 * x[1].x, 3.3, 1e-15);
}

// A substep of half the length of the one before takes back a quarter, and of the rest another quarter. One
// that is as long takes back all.
TEST(Relax, KeepsAShareOfAViolation) {
  const Scene scene = long_rod();
  const Constants constants = make_constants(scene);
  std::vector<Block<double>> blocks = blocks_of(scene);
  Block<double>& block = blocks.front();
  RelaxSettings<double> settings = one_substep(50);
  settings.constants = &constants;
  settings.leftovers.pass(1e-2);
  block.begin_keeping();
  for (const auto& [h, left] : {std::pair(5e-3, 9.0 / 16), std::pair(1e-2, 0.0)}) {
    settings.h = h;
    StepReport report;
    relax_alone(block, 0, block.packing().positions, settings, report);
    settings.leftovers.pass(h);
    Vec3 x[2];
    for (std::uint32_t slot = 0; slot < block.packing().slot_vertex.size(); ++slot) {
      x[block.packing().slot_vertex[slot]] = block.read(block.x(), slot);
      for (double* field : {block.displacement(0), block.displacement(1)}) block.write(field, slot, {});
    }
    EXPECT_NEAR(dot(x[1] - x[0], x[1] - x[0]), 1 + left * (1.1 * 1.1 - 1), 1e-14);
  }
}

// A team does what one thread does, to the bit.
TEST(Relax, OfATeamIsThatOfOneThread) {
  const Scene scene = scenes::make_net(12, 9);
  std::vector<Block<double>> alone = blocks_of(scene), shared = blocks_of(scene);
  Team team(3);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    for (Block<double>* block : {&alone[k], &shared[k]})
      for (std::uint32_t slot = 0; slot < block->packing().slot_vertex.size(); ++slot)
        if (!scene.particles[block->packing().slot_vertex[slot]].fixed)
          block->write(block->kick(), slot, {0, -1e-3 * slot, 0});
    StepReport report;
    relax_alone(alone[k], 0, alone[k].packing().positions, one_substep(5), report);
    alone[k].count_substeps(1);
    team.lead(nullptr, [&] { relax_block(shared[k], one_substep(5), 0, report, team); });
    for (std::uint32_t slot = 0; slot < alone[k].packing().slot_vertex.size(); ++slot) {
      EXPECT_EQ(alone[k].read(alone[k].x(), slot), shared[k].read(shared[k].x(), slot));
      EXPECT_EQ(alone[k].read(alone[k].displacement(0), slot),
                shared[k].read(shared[k].displacement(0), slot));
    }
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
