// Random lines, nets, bridges, cranes, graphs and loads between lines, with default settings.

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>

#include "stability/hangings/hangings.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

// All are solved or named, and what is slack moves. `plumb stability --hangings 1000` hangs up more of them.
TEST(RandomHangings, AreSolvedOrNamed) {
  std::set<std::string> kinds;
  int dear = 0;
  const int count = 100;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const scenes::HangingResult result = scenes::hang(seed, 1);
    EXPECT_EQ(result.fault(), "") << result.kind << ", seed " << seed;
    EXPECT_EQ(result.total.capped_steps, 0u) << result.kind << ", seed " << seed;
    kinds.insert(result.kind);
    dear += result.is_dear();
  }
  EXPECT_EQ(kinds.size(), 6u);
  EXPECT_LE(dear, count / 25) << "frames above 20 times the median one";
}

// Lines and spiders that come taut: in each, elastic rods once found no place in some substeps.
TEST(RandomHangings, RodsThatGiveFindAPlace) {
  for (const std::uint64_t seed : {202u, 1091u, 1382u, 1414u, 1913u}) {
    const scenes::HangingResult result = scenes::hang(seed, 3);
    EXPECT_EQ(result.fault(), "") << "seed " << seed;
    EXPECT_EQ(result.total.unsolved, 0u) << "seed " << seed;
    EXPECT_GT(result.total.elastic_substeps, 0u) << "seed " << seed;
  }
}

// These lines hold after a few substeps with elastic rods, or without any. In a trial such substeps went on
// for ever, where gradient new got too few iterations.
TEST(RandomHangings, RodsHoldAgainAfterTheyGave) {
  for (const std::uint64_t seed : {1u, 166u, 527u}) {
    const scenes::HangingResult result = scenes::hang(seed, 3);
    EXPECT_LE(result.total.elastic_substeps, 10u) << "seed " << seed;
  }
}

// Cranes hold their loads by straight cables of many rods from the first frame on. All of them are taut, and
// none is found only after the one before it. The last crane catches its load: it takes 41, and took 175
// where rods were found one by one.
TEST(RandomHangings, CablesComeTautInFewIterations) {
  for (const std::uint64_t seed : {29u, 114u, 654u, 484u}) {
    const scenes::HangingResult result = scenes::hang(seed, 0.5);
    ASSERT_EQ(result.kind, "crane");
    EXPECT_EQ(result.total.fallbacks + result.total.elastic_substeps, 0u) << "seed " << seed;
    EXPECT_LE(result.worst_work, seed == 484 ? 60 : 5) << "seed " << seed;
  }
}

// These cranes catch their loads within ten frames and rest. Gradient mid left speeds along their cables that
// swung about zero, and frames at rest took up to 43 Newton steps. A blow that is stopped takes one frame
// with a try in vain, and then each takes one step.
TEST(RandomHangings, WhatCablesCaughtRests) {
  for (const std::uint64_t seed : {421u, 445u, 2299u}) {
    const scenes::HangingResult result = scenes::hang(seed, 0.5);
    ASSERT_EQ(result.kind, "crane");
    EXPECT_EQ(result.fault(), "") << "seed " << seed;
    EXPECT_EQ(result.total.fallbacks + result.total.elastic_substeps, 0u) << "seed " << seed;
    EXPECT_EQ(result.total.halvings, 0u) << "seed " << seed;
    EXPECT_EQ(result.median_work, 1) << "seed " << seed;
    EXPECT_FALSE(result.is_dear()) << "seed " << seed << ": " << result.worst_work;
  }
}

// Spiders that come tight, of the 1,000 those with the worst frames. In the last of them softest rods once
// found no minimum.
TEST(RandomHangings, RodsThatGiveTakeFewSteps) {
  for (const std::uint64_t seed : {626u, 746u, 751u, 370u}) {
    const scenes::HangingResult result = scenes::hang(seed, 3);
    EXPECT_EQ(result.total.unsolved, 0u) << "seed " << seed;
    EXPECT_FALSE(result.is_dear()) << "seed " << seed << ": " << result.work_ratio();
  }
}

// A seed is a scene.
TEST(RandomHangings, DependOnTheirSeedAlone) {
  const scenes::Hanging one = scenes::random_hanging(5), again = scenes::random_hanging(5);
  EXPECT_EQ(one.kind, again.kind);
  ASSERT_EQ(one.scene.particles.size(), again.scene.particles.size());
  for (std::size_t i = 0; i < one.scene.particles.size(); ++i)
    EXPECT_EQ(one.scene.particles[i].position, again.scene.particles[i].position);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
