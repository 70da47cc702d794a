#include "relax/schedule.hpp"

#include <gtest/gtest.h>

#include "relax/compile.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb::detail {
namespace {

/// A long chain and, as another block, 40 short ones side by side: three positions of 16 lanes.
std::vector<Block<float>> blocks() {
  Scene scene = scenes::make_ensemble({.chains = 40, .links = 3});
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  const Scene chain = scenes::make_chain(2000);
  scene.particles.insert(scene.particles.end(), chain.particles.begin(), chain.particles.end());
  for (const Rod& rod : chain.rods) scene.rods.push_back({.a = rod.a + first, .b = rod.b + first});
  std::vector<layouts::Edge> edges;
  for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
  std::vector<std::uint8_t> movable;
  for (const Particle& particle : scene.particles) movable.push_back(!particle.fixed);
  const std::vector<std::uint8_t> common(edges.size(), 1);
  Plan plan = plan_blocks({static_cast<std::uint32_t>(movable.size()), edges, movable},
                          LayoutChoice::automatic, common, 16, sizeof(float));
  std::vector<Block<float>> result;
  for (auto& packing : plan.packings) result.emplace_back(std::move(packing), false);
  return result;
}

TEST(Schedule, TakesEveryPositionOnce) {
  const std::vector<Block<float>> all = blocks();
  ASSERT_EQ(all.size(), 2u);
  for (const std::uint32_t shared_rods : {1u, 2000u, 2001u, 1000000u}) {
    const Schedule schedule = make_schedule<float>(all, shared_rods);
    EXPECT_EQ(schedule.shared_blocks.size(), shared_rods <= 2000 ? 1u : 0u);
    EXPECT_EQ(schedule.shared_blocks.size() + schedule.lone_blocks.size(), all.size());
    std::vector<std::vector<int>> taken;
    for (const auto& block : all) taken.emplace_back(block.packing().positions, 0);
    for (const std::uint32_t b : schedule.shared_blocks)
      for (int& n : taken[b]) ++n;
    for (const LoneWork& work : schedule.lone_work)
      for (std::uint32_t q = work.begin; q < work.end; ++q) ++taken[work.block][q];
    for (const auto& block : taken)
      for (const int n : block) EXPECT_EQ(n, 1);
  }
}

// However many rods they have, islands side by side are worked on apart.
TEST(Schedule, CutsIndependentPositionsApart) {
  const std::vector<Block<float>> all = blocks();
  const Schedule schedule = make_schedule<float>(all, 1);
  ASSERT_EQ(schedule.lone_work.size(), 3u);
  for (const LoneWork& work : schedule.lone_work) EXPECT_EQ(work.end, work.begin + 1);
}

}  // namespace
}  // namespace plumb::detail
