// Islands of springs, rods that give and bends that nothing drives: whatever the substeps, their energy stays
// below a bound.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/random_trees.hpp"
#include "support/sprung_rods.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Gains are taken back beyond a quarter of the largest energy of motion and elastics, which without weight
/// is all of it: E - E0 <= E/4.
constexpr double most = 4.0 / 3;

/// Returns the largest energy of a world without weight in so many seconds, over that at its start.
double highest_energy(const Scene& scene, const Settings& settings, double dt, double seconds) {
  World world(scene, settings);
  const double first = test::energy_of(scene, world).total();
  double highest = first;
  for (double t = 0; t < seconds; t += dt) {
    EXPECT_EQ(world.step(dt).unsolved, 0u);
    highest = std::max(highest, test::energy_of(scene, world).total());
  }
  return highest / first;
}

// Stretched rods carry the vector of a bend farther in a substep than its secant is true.
TEST(PassiveElastics, BendsBesideElasticRodsGainNoMoreThanTheBound) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed)
    EXPECT_LE(
        highest_energy(test::bent_and_sprung(seed), {.method = Method::direct, .threads = 1}, 1.0 / 120, 5),
        most)
        << seed;
}

/// A stiff spring that closes a chain of rigid and elastic rods, thrown about an anchor.
Scene closed_chain(std::uint64_t seed) {
  test::Random random(seed);
  Scene scene;
  scene.gravity = {};
  scene.particles = {{.fixed = true}};
  const std::array<std::uint32_t, 5> parents{0, 0, 1, 2, 3};
  for (std::uint32_t i = 1; i <= 5; ++i) {
    Vec3 away = test::random_vector(random);
    away = (0.4 / norm(away)) * away;
    scene.particles.push_back({.position = scene.particles[parents[i - 1]].position + away,
                               .velocity = 2 * test::random_vector(random),
                               .mass = test::evenly_in_log(0.1, 2, random)});
    scene.rods.push_back({.a = parents[i - 1], .b = i, .length = 0.4});
  }
  scene.rods[1].law.stiffness = 131;
  scene.rods[3].law.stiffness = 707;
  scene.springs = {{.a = point_at(0), .b = point_at(5), .length = 0.19, .stiffness = 1.3e5}};
  return scene;
}

TEST(PassiveElastics, StiffSpringsOverChainsGainNoMoreThanTheBound) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const double dt : {1.0 / 60, 1.0 / 240})
      EXPECT_LE(highest_energy(closed_chain(seed), {.method = Method::direct, .threads = 1}, dt, 2), most)
          << seed << ' ' << dt;
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
