// Reels of random ropes, drums and rates: nothing breaks, what is out is right, and momentum comes from what
// holds and pulls.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Draws numbers that are the same with every library.
class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double from(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(engine_() % count); }
  Vec3 direction() {
    const Vec3 way{from(-1, 1), from(-1, 1), from(-1, 1)};
    return 1 / std::max(norm(way), 1e-3) * way;
  }

 private:
  std::mt19937 engine_;
};

RodLaw random_law(Draw& draw, std::uint32_t kind) {
  RodLaw law{.one_sided = kind % 2 == 1};
  if (kind < 2) return law;
  law.stiffness = std::pow(10, draw.from(2, 7));
  law.damping = draw.below(2) * draw.from(0, 10);
  return law;
}

/// A rope of up to twelve unequal rods, of which a random part is out along a random line, with velocities.
Scene random_rope(Draw& draw) {
  Scene scene;
  const std::uint32_t rods = 1 + draw.below(12), kind = draw.below(4);
  scene.particles = {test::fixed({})};
  Reel reel{.particles = {0}};
  double whole = 0;
  for (std::uint32_t i = 1; i <= rods; ++i) {
    scene.rods.push_back({.a = i - 1, .b = i, .length = draw.from(0.05, 0.3), .law = random_law(draw, kind)});
    reel.particles.push_back(i);
    whole += scene.rods.back().length;
  }
  reel.out = draw.from(0.1, 1) * whole;
  const Vec3 along = draw.direction(), velocity = draw.direction();
  double behind = whole;
  for (const Rod& rod : scene.rods) {
    behind -= rod.length;
    scene.particles.push_back(test::movable(std::max(0.0, reel.out - behind) * along, draw.from(0.1, 2),
                                            draw.from(-1, 1) * velocity));
  }
  scene.reels = {reel};
  return scene;
}

TEST(RandomReels, KeepRodsLengthsAndMomentum) {
  std::uint64_t elastic = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Draw draw(seed);
    const Scene scene = random_rope(draw);
    const bool is_mid = draw.below(4) != 0;
    World world(scene, {.method = Method::direct,
                        .gradient = is_mid ? Gradient::mid : Gradient::new_,
                        .substeps = 1 + draw.below(8),
                        .tensions = true});
    double whole = 0, mass = 0, rate = 0, out = world.reel_out(0);
    for (const Rod& rod : scene.rods) whole += rod.length;
    for (const Particle& particle : scene.particles) mass += particle.mass;
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
    };
    const Vec3 start = momentum();
    Vec3 impulse{};
    StepReport report;
    for (int i = 0; i < 200; ++i) {
      if (i % 20 == 0) rate = draw.from(-0.7, 0.7) * whole;
      out = std::clamp(out + rate / 60, 0.1 * whole, whole);
      world.set_reel(0, out);
      if (draw.below(50) == 0) world.move_anchor(0, 0.1 * draw.direction());
      report += world.step(1.0 / 60);
      impulse += 1.0 / 60 * world.reaction(0);
      ASSERT_NEAR(world.reel_out(0), out, 1e-14) << seed;  // the chain is added up from its end
      ASSERT_TRUE(test::all_finite(world)) << seed;
      ASSERT_TRUE(world.problems(1e-7).empty()) << seed << " at " << i;
    }
    EXPECT_EQ(report.unsolved + report.frozen_islands, 0u) << seed;
    elastic += report.elastic_substeps;
    if (!is_mid) continue;  // gradient new knows its velocities to first order
    // Newton's method ends at changes of 1e-8 of a rod. Where anchors jump, substeps are cut to 1e-4 s and
    // less, so that this is 1e-5 m/s.
    const Vec3 lost = momentum() - start - impulse - 200.0 / 60 * mass * scene.gravity;
    EXPECT_LT(norm(lost), 1e-5 * mass * 9.81) << seed;
  }
  // Six substeps of 1,000 such ropes, which whip round their drums, were solved with elastic rods alone.
  EXPECT_LE(elastic, 2u);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
