// Nets of elastic rods, which a ball tears.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "scenes/basics/seeded.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// A free net of n x n light particles lies level. The middle ones, within 0.25 m, are a ball of 1 kg that
/// falls at 10 m/s. Strengths vary by a fifth.
Scene torn_net(std::uint32_t n, const RodLaw& law) {
  Scene scene = scenes::make_net(n, n);
  scene.gravity = {};
  const Vec3 middle = 0.5 * scene.particles.back().position;
  for (Particle& particle : scene.particles) {
    particle.fixed = false;
    particle.mass = 0.01;
    if (norm(particle.position - middle) >= 0.25) continue;
    particle.mass = 1.0 / 21;
    particle.velocity = {0, 0, -10};
  }
  std::mt19937_64 random(1);
  for (Rod& rod : scene.rods) {
    rod.law = law;
    rod.law.strength *= 0.8 + 0.4 * scenes::unit_double(random);
  }
  return scene;
}

struct Torn {
  StepReport total{};
  double momentum_error = 0;  ///< Largest, relative to the ball's.
};
Torn tear(const Scene& scene, const Settings& settings) {
  World world(scene, settings);
  const auto momentum = [&] {
    Vec3 sum{};
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      sum += scene.particles[i].mass * world.velocity(i);
    return sum;
  };
  const Vec3 first = momentum();
  Torn out;
  for (int i = 0; i < 30; ++i) {
    out.total += world.step(frame);
    out.momentum_error = std::max(out.momentum_error, norm(momentum() - first) / norm(first));
  }
  return out;
}

// Nothing holds it, so that its momentum stays. Pulls come in pairs, and the last change of a substep leaves
// 1e-12 of a rod a node.
TEST(BreakingNets, KeepMomentumWhileTheyTear) {
  for (const RodLaw law : {RodLaw{.stiffness = 1e4, .strength = 12},
                           RodLaw{.stiffness = 1e5, .one_sided = true, .strength = 30}})
    for (const Gradient gradient : {Gradient::mid, Gradient::new_, Gradient::old}) {
      const Torn torn =
          tear(torn_net(23, law), {.method = Method::direct, .gradient = gradient, .threads = 1});
      EXPECT_GT(torn.total.broken_rods, 5u) << to_string(gradient);
      EXPECT_EQ(torn.total.unsolved + torn.total.elastic_substeps, 0u) << to_string(gradient);
      EXPECT_LE(torn.momentum_error, 1e-9) << to_string(gradient);
    }
}

// What a step costs is linear in rods, as the number of Newton's steps does not grow with the net. Each part
// that fell off takes substeps of its own.
TEST(BreakingNets, TakeNoMoreNewtonStepsWhereTheyAreLarger) {
  const RodLaw law{.stiffness = 1e4, .strength = 20};
  const Torn small = tear(torn_net(16, law), {.threads = 1}), large = tear(torn_net(48, law), {.threads = 1});
  EXPECT_GT(large.total.broken_rods, 20u);
  const auto of_substep = [](const StepReport& total) {
    return static_cast<double>(total.newton) / static_cast<double>(total.direct_substeps);
  };
  EXPECT_LE(of_substep(large.total), 1.2 * of_substep(small.total));
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
