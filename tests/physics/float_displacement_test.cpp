// Why a particle's state is a position and a displacement: in float, the difference of two stored positions
// has lost g h^2 once h is small. A chain of 20 links let go horizontally, after 1 s; errors are RMS
// distances to a truth accurate to 1e-9, relative to the scene's diagonal.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/files/trajectory.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr std::uint32_t sweeps_per_substep = 20;

/// The textbook's way, gradient old: x_next = x + (x - x_before) + g h^2, then rods along their old
/// directions. The same projections on the same float numbers as the library's, in the order of a chain's two
/// colours.
std::vector<Vec3> swing_with_two_positions(const Scene& scene, double seconds,
                                           std::uint32_t substeps_per_second) {
  struct Triple {
    float x, y, z;
  };
  const auto minus = [](Triple a, Triple b) { return Triple{a.x - b.x, a.y - b.y, a.z - b.z}; };
  const auto dot3 = [](Triple a, Triple b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const auto h = static_cast<float>(1.0 / substeps_per_second);
  const auto fall = static_cast<float>(scene.gravity.y) * h * h;
  std::vector<Triple> now, before, next;
  for (const Particle& particle : scene.particles) {
    const Vec3 x = particle.position;
    now.push_back({static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)});
    // Half of g h^2 back, so that the first step falls half of it.
    before.push_back(now.back());
    if (!particle.fixed) before.back().y += fall / 2;
  }
  next = now;
  const auto steps = static_cast<std::uint32_t>(seconds * substeps_per_second);
  for (std::uint32_t step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (scene.particles[i].fixed) continue;
      const Triple u = minus(now[i], before[i]);
      next[i] = {now[i].x + u.x, now[i].y + u.y + fall, now[i].z + u.z};
    }
    for (std::uint32_t sweep = 0; sweep < sweeps_per_substep; ++sweep)
      for (const std::size_t parity : {0u, 1u})
        for (std::size_t rod = parity; rod < scene.rods.size(); rod += 2) {
          const auto [a, b] = std::pair{scene.rods[rod].a, scene.rods[rod].b};
          const auto length2 = static_cast<float>(scene.rods[rod].length * scene.rods[rod].length);
          const Triple old = minus(now[b], now[a]), d = minus(next[b], next[a]);
          const float c = dot3(d, d) - length2;
          const float wa = scene.particles[a].fixed ? 0 : 1 / static_cast<float>(scene.particles[a].mass);
          const float wb = 1 / static_cast<float>(scene.particles[b].mass);
          const float s = c / (2 * (wa + wb) * dot3(old, d));
          next[a] = {next[a].x + s * wa * old.x, next[a].y + s * wa * old.y, next[a].z + s * wa * old.z};
          next[b] = {next[b].x - s * wb * old.x, next[b].y - s * wb * old.y, next[b].z - s * wb * old.z};
        }
    before = now;
    now = next;
  }
  std::vector<Vec3> positions;
  for (const Triple& x : now) positions.push_back({x.x, x.y, x.z});
  return positions;
}

class FloatChain : public testing::Test {
 protected:
  double error(Gradient gradient, std::uint32_t substeps, Precision precision = Precision::single) const {
    World world(scene, {.method = Method::relax,
                        .precision = precision,
                        .gradient = gradient,
                        .substeps = substeps,
                        .stop = {.sweeps = sweeps_per_substep},
                        .threads = 1});
    test::run(world, 1.0 / 60, 60);
    return test::relative_error(scene, world, truth.positions);
  }
  double two_position_error(std::uint32_t substeps) const {
    return rms_distance(swing_with_two_positions(scene, 1, 60 * substeps), truth.positions) /
           bounding_diagonal(scene);
  }

  Scene scene = scenes::make_chain(20);
  Frame truth = scenes::read_trajectory(std::string(PLUMB_TEST_DATA) + "/chain_N20_r1.csv").back();
};

TEST_F(FloatChain, SmallerStepsAreNoWorse) {
  for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
    EXPECT_LE(error(gradient, 256), error(gradient, 16)) << "gradient " << to_string(gradient);
}

// At 15,360 substeps a second g h^2 is 4e-8 m, half a unit in the last place of a float at 1 m: a difference
// of two positions keeps nothing of it, a displacement of its own all seven digits.
TEST_F(FloatChain, TwoPositionsWouldLoseThreeDigits) {
  // At large steps both stores are the same method, and the same error.
  EXPECT_NEAR(two_position_error(4) / error(Gradient::old, 4), 1, 0.1);
  const double ours = error(Gradient::old, 256), theirs = two_position_error(256);
  EXPECT_LE(ours, 5e-5);
  EXPECT_GE(theirs, 1000 * ours);
}

// What is left of the error in float is rounding of positions, not the method's.
TEST_F(FloatChain, IsAsCloseAsDoubleButForRounding) {
  // 1 unit in the last place of 2 m is 2.4e-7 m, 1.2e-7 of the diagonal; 15,360 of them add up as a random
  // walk.
  const double walk = std::sqrt(15360.0) * 1.2e-7;
  for (const Gradient gradient : {Gradient::old, Gradient::mid})
    EXPECT_LE(error(gradient, 256), error(gradient, 256, Precision::double_) + 5 * walk)
        << to_string(gradient);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
