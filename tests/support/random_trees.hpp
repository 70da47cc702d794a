#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "plumb/scene.hpp"
#include "support/graphs.hpp"

/// Trees of rods to test the direct solve on, each made from its seed alone.
namespace plumb::test {

struct TreeShape {
  std::uint32_t movable = 10;
  std::uint32_t anchors = 2;  ///< fixed particles; each holds one rod or two
  std::uint32_t ties = 2;     ///< rods to fixed particles at one particle, at most; three hold it for good
  double masses = 1;          ///< of particles: from 1/masses to masses kg, evenly in the logarithm
  double rod_mass = 0;        ///< kg, at most; 0: massless
  bool straggling = true;     ///< parents anywhere; otherwise close by, so that the tree is deep
};

inline Vec3 random_vector(Random& random) {
  const double x = signed_unit(random), y = signed_unit(random), z = signed_unit(random);
  return {x, y, z};
}

/// At rest, under gravity, rods of 0.3 to 2 m, some of them with their mass off the middle. Numbers and
/// directions are shuffled.
inline Scene random_tree(Random& random, const TreeShape& shape) {
  const std::uint32_t n = shape.movable, all = n + shape.anchors;
  Ids name = identity(all);
  shuffle(name, random);
  Scene scene;
  scene.particles.resize(all);
  const auto add_rod = [&](std::uint32_t a, std::uint32_t b) {
    Rod rod{.a = name[a], .b = name[b]};
    if (below(random, 2) == 0) std::swap(rod.a, rod.b);
    if (shape.rod_mass > 0 && below(random, 4) != 0) {
      rod.mass = shape.rod_mass * (0.05 + std::abs(signed_unit(random)));
      if (below(random, 2) == 0) {
        rod.center = 0.5 + 0.3 * signed_unit(random);
        rod.inertia = rod.mass * 0.05;
      }
    }
    scene.rods.push_back(rod);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    Particle& particle = scene.particles[name[i]];
    particle.mass = std::pow(shape.masses, signed_unit(random));
    if (i == 0) continue;
    const std::uint32_t parent = shape.straggling ? below(random, i) : i - 1 - below(random, std::min(i, 2u));
    Vec3 way = random_vector(random);
    while (norm(way) < 0.3) way = random_vector(random);
    particle.position = scene.particles[name[parent]].position + way;
    add_rod(parent, i);
  }
  std::vector<std::uint32_t> ties(n, 0);
  const auto find_free = [&] {
    std::uint32_t i = below(random, n);
    for (std::uint32_t tries = 0; ties[i] >= shape.ties && tries < n; ++tries) i = (i + 1) % n;
    return i;
  };
  for (std::uint32_t i = n; i < all; ++i) {
    Particle& particle = scene.particles[name[i]];
    particle.fixed = true;
    const std::uint32_t held = find_free();
    if (ties[held]++ >= shape.ties) continue;  // no particle is free: this one holds nothing
    Vec3 way = random_vector(random);
    while (norm(way) < 0.3) way = random_vector(random);
    particle.position = scene.particles[name[held]].position + way;
    add_rod(held, i);
    const std::uint32_t other = below(random, n);
    if (other == held || ties[other] >= shape.ties || below(random, 3) != 0) continue;
    ++ties[other];
    add_rod(other, i);
  }
  shuffle(scene.rods, random);
  return scene;
}

}  // namespace plumb::test
