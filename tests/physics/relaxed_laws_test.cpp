// Relaxation of rods that give (plumb::RodLaw). Once converged, a substep is that of method direct, whatever the
// number and the order of sweeps. Momentum is kept, stiff rods are rigid ones, and a slack cable pulls nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/worlds.hpp"

namespace plumb {
namespace {

constexpr double dt = 1.0 / 60;

Scene with_law(Scene scene, const RodLaw& law) {
  for (Rod& rod : scene.rods) rod.law = law;
  return scene;
}

/// A chain that hangs from one end, drawn aside, each of its particles heavier than the one before.
Scene aside_chain(std::uint32_t links, const RodLaw& law) {
  Scene scene = with_law(scenes::make_chain(links, 0.1, 3), law);
  return scene;
}

/// A net of cables between two corners, half of them slack, in motion.
Scene loose_net(const RodLaw& law) {
  Scene scene = with_law(scenes::make_net(5, 4), law);
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    scene.rods[i].length = rod_length(scene, i) * (i % 2 == 0 ? 1.0 : 1.15);
  return scene;
}

struct Case {
  const char* name;
  Scene scene;
};
std::vector<Case> cases() {
  return {{"elastic chain", aside_chain(6, {.stiffness = 2000})},
          {"soft chain", aside_chain(6, {.stiffness = 60})},
          {"damped chain", aside_chain(6, {.stiffness = 500, .damping = 5})},
          {"elastic cables", aside_chain(6, {.stiffness = 500, .damping = 1, .one_sided = true})},
          {"net of elastic cables", loose_net({.stiffness = 3000, .damping = 2, .one_sided = true})},
          {"net of cables", loose_net({.one_sided = true})},
          {"net of cables that may break", loose_net({.one_sided = true, .strength = 1e9})}};
}

Settings relaxed(Gradient gradient, std::uint32_t sweeps) {
  return {.method = Method::relax,
          .gradient = gradient,
          .substeps = 4,
          .stop = {.sweeps = sweeps, .tolerance = 1e-14},
          .threads = 1};
}

/// Returns the largest distance between particles of two worlds after `steps` steps, in m.
double apart(const Scene& scene, const Settings& a, const Settings& b, int steps) {
  World one(scene, a), other(scene, b);
  test::run(one, dt, steps);
  test::run(other, dt, steps);
  double most = 0;
  for (std::uint32_t p = 0; p < one.particle_count(); ++p)
    most = std::max(most, norm(one.position(p) - other.position(p)));
  return most;
}

// Substeps of both methods solve the same equation: what is apart is the tolerance of the sweeps, summed over
// 120 substeps.
TEST(RelaxedLaws, ConvergeToTheDirectSolution) {
  for (const auto& [name, scene] : cases())
    for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid}) {
      const Settings direct{.method = Method::direct, .gradient = gradient, .substeps = 4, .threads = 1};
      EXPECT_LT(apart(scene, relaxed(gradient, 20000), direct, 30), 1e-9)
          << name << ", gradient " << to_string(gradient);
    }
}

}  // namespace
}  // namespace plumb
