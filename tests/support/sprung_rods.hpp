#pragma once

#include <cmath>
#include <cstdint>

#include "plumb/scene.hpp"
#include "support/random_trees.hpp"

/// Rods that give with bends and springs between them, whose coarse substeps gain energy unless it is held
/// back.
namespace plumb::test {

inline double between(double low, double high, Random& random) {
  return low + (high - low) * (0.5 + 0.5 * signed_unit(random));
}
inline double evenly_in_log(double low, double high, Random& random) {
  return low * std::pow(high / low, between(0, 1, random));
}

/// Two elastic rods in a row with a bend between them, thrown, and a spring from end to end.
inline Scene bent_and_sprung(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.gravity = {};
  const double length = 0.4, stiffness = evenly_in_log(100, 1e5, random);
  for (std::uint32_t i = 0; i < 3; ++i)
    scene.particles.push_back({.position = {length * i, i == 2 ? 0.01 : 0, 0},
                               .velocity = 2 * random_vector(random),
                               .mass = evenly_in_log(0.2, 2, random)});
  for (std::uint32_t i = 0; i < 2; ++i)
    scene.rods.push_back({.a = i, .b = i + 1, .length = length, .law = {.stiffness = stiffness}});
  scene.bends = {{.a = 0, .b = 1, .c = 2, .stiffness = evenly_in_log(0.1, 20, random)}};
  scene.springs = {{.a = point_at(0),
                    .b = point_at(2),
                    .length = between(0.05, 0.8, random),
                    .stiffness = evenly_in_log(10, 1e4, random)}};
  return scene;
}

}  // namespace plumb::test
