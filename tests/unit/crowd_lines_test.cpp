// Contacts of plain lines in a crowd: what is kept of them, what is left to others, and who shares them.

#include "contact/relaxed/lines/crowd_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "contact/relaxed/visits/share_ranges.hpp"
#include "plumb/joints.hpp"
#include "support/executors.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr double h = 0.01;

/// Two rods that cross each other at a distance of 5 mm, of which the upper one comes down.
struct Crossing {
  explicit Crossing(double speed, bool is_held = false) {
    scene.gravity = {};
    scene.particles = {{.position = {-0.1, 0, 0}, .mass = 1, .fixed = is_held},
                       {.position = {0.1, 0, 0}, .mass = 1},
                       {.position = {0, 0.045, -0.1}, .velocity = {0, -speed, 0}, .mass = 1},
                       {.position = {0, 0.045, 0.1}, .velocity = {0, -speed, 0}, .mass = 1}};
    for (const std::uint32_t i : {0u, 2u}) {
      scene.rods.push_back({.a = i, .b = i + 1});
      scene.capsules.push_back({.a = point_at(i),
                                .b = point_at(i + 1),
                                .radius = 0.02,
                                .surface = {},
                                .filter = {.own_island = true}});
    }
    scene.rods.push_back({.a = 1, .b = 2});
    kind.emplace(scene, best_isa(), Linkage::Use::relaxed);
    state.emplace(*kind, 0, scene);
    cluster = {&*state};
    begin_step();
  }
  void begin_step() {
    crowd.gather(cluster, {});
    const Surroundings surroundings(scene);
    GroundNow ground;
    ground.find(surroundings, 0);
    near.find(cluster, crowd, surroundings, ground, h);
    lines.begin_step(cluster, crowd, near);
    crowd.predict(h, Gradient::new_);
    std::vector<double> placed;
    for (const auto& body : near.bodies()) {
      const auto [p, q] = body.at;
      const double moves = std::max(norm(crowd.moved(p)), norm(crowd.moved(q)));
      for (const auto& [each, last] : {std::pair{crowd.position(p), body.radius},
                                       {crowd.position(q), moves},
                                       {crowd.moved(p), 0.0},
                                       {crowd.moved(q), 0.0}})
        placed.insert(placed.end(), {each.x, each.y, each.z, last});
    }
    lines.find(cluster, crowd, near, {placed.data(), h, 0}, nullptr);
  }
  double fallen() const {
    return crowd.moved(crowd.number_of(0, 2)).y - crowd.moved(crowd.number_of(0, 1)).y;
  }

  Scene scene;
  std::optional<Linkage> kind;
  std::optional<LinkageState> state;
  std::vector<LinkageState*> cluster;
  Crowd<double> crowd;
  CrowdPairs<double> near{ContactSettings{}};
  CrowdLines<double> lines{ContactSettings{}, simd::kernels<double>(best_isa())};
};

TEST(CrowdLines, KeepAGapOpenAndWhatHeldIt) {
  Crossing two(0.8);
  ASSERT_TRUE(two.lines.any_touch());
  EXPECT_FALSE(two.lines.any_push());
  EXPECT_NEAR(two.lines.depth(two.crowd), 0.003, 1e-15) << "8 mm, and 5 mm are free";
  two.lines.start(two.crowd);
  EXPECT_NEAR(two.lines.measured_sweep(two.crowd, nullptr), 0.003, 1e-15);
  EXPECT_NEAR(two.fallen(), -0.005, 1e-15);
  EXPECT_LT(two.lines.measured_sweep(two.crowd, nullptr), 1e-17) << "it is solved";
  EXPECT_EQ(two.lines.count_pushes(), 1u);
  two.lines.end(two.cluster, two.crowd, two.near, h);
  two.lines.keep(two.cluster, two.near);
  ASSERT_EQ(two.state->kept.size(), 1u);
  // Middles of two rods answer like two particles of 2 kg.
  EXPECT_NEAR(norm(two.state->kept[0].force), 0.003 / h / h, 1e-10);
  two.begin_step();
  EXPECT_EQ(two.lines.count_pushes(), 1u) << "it starts from there";
  two.lines.start(two.crowd);
  EXPECT_NEAR(two.fallen(), -0.005, 1e-15);
}

TEST(CrowdLines, LeaveWhatIsFastOrHangsFromAnAnchor) {
  const Crossing fast(20), held(0.8, true), slow(0.8);
  EXPECT_EQ(fast.lines.left().size(), 1u);
  EXPECT_FALSE(fast.lines.any_touch());
  EXPECT_EQ(held.lines.left().size(), 1u);
  EXPECT_FALSE(held.lines.any_touch());
  EXPECT_TRUE(slow.lines.left().empty());
}

TEST(CrowdLines, AreSharedByATeamEachOnce) {
  const std::vector<simd::ContactRange> ranges{{0, 3, 4}, {3, 100, 4}};
  Team team(2);
  test::ThreadExecutor executor(2);
  std::vector<std::uint32_t> visits(100);
  team.lead(&executor, [&] {
    share_ranges(&team, ranges, [&](std::span<const simd::ContactRange> own, unsigned) {
      for (const simd::ContactRange& range : own)
        for (std::uint32_t v = range.begin; v < range.end; ++v) ++visits[v];
    });
  });
  EXPECT_EQ(visits, std::vector<std::uint32_t>(100, 1));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
