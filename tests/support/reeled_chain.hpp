#pragma once

#include <algorithm>
#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::test {

/// This is a chain of particles of `mass` (kg) and rods of `length` (m) on a drum at the origin. Of it `out`
/// (m) hangs straight along a unit vector; 0 means all of it.
struct ReeledChain {
  std::uint32_t rods = 10;
  double length = 0.1, mass = 0.2;
  Vec3 direction{0, -1, 0};
  double out = 0;
  RodLaw law{};

  double whole() const { return rods * length; }
};

inline Scene make_reeled(const ReeledChain& of) {
  Scene scene;
  Reel reel{.particles = {0}, .out = of.out};
  scene.particles.push_back(fixed({}));
  const double out = of.out != 0 ? of.out : of.whole();
  for (std::uint32_t i = 1; i <= of.rods; ++i) {
    const double from_drum = std::max(0.0, out - (of.rods - i) * of.length);
    scene.particles.push_back(movable(from_drum * of.direction, of.mass));
    scene.rods.push_back({.a = i - 1, .b = i, .length = of.length, .law = of.law});
    reel.particles.push_back(i);
  }
  scene.reels.push_back(reel);
  return scene;
}

}  // namespace plumb::test
