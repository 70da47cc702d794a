#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"

/// Scenes that truths are tested on, and how far two solutions lie apart.
namespace plumb::test {

inline Particle anchor(Vec3 position) {
  return {.position = position, .velocity = {}, .mass = 0, .fixed = true};
}
inline Particle loose(Vec3 position, double mass = 0) {
  return {.position = position, .velocity = {}, .mass = mass, .fixed = false};
}

/// Two point masses on massless rods, one 20 times the other, in space.
inline Scene double_pendulum() {
  Scene scene;
  scene.particles = {anchor({0, 0, 0}), loose({0.7, 0.1, 0}, 1), loose({1.1, -0.3, 0.2}, 20)};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  return scene;
}

/// A box of rods that hangs from one corner, every face and the inside braced: 28 rods on 8 particles, of
/// which 18 would hold it rigid.
inline Scene braced_box(double rod_mass = 0) {
  Scene scene;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? 1.0 : 0.0, i & 2 ? 0.7 : 0.0, i & 4 ? 0.4 : 0.0};
    scene.particles.push_back(loose(corner, 1 + 0.1 * i));
    for (std::uint32_t j = 0; j < i; ++j) scene.rods.push_back({.a = j, .b = i, .mass = rod_mass});
  }
  scene.particles[0].fixed = true;
  return scene;
}

/// A closed ring of rods, off its plane, that hangs from two anchors; every other rod has mass.
inline Scene hung_ring(double rod_mass) {
  Scene scene;
  scene.particles = {anchor({-1, 1, 0}), anchor({1.2, 1.1, 0.1})};
  constexpr std::uint32_t n = 7;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 0.3 + 6.283185307179586 * i / n;
    scene.particles.push_back(
        loose({std::cos(angle), std::sin(angle), 0.2 * std::sin(2 * angle)}, i % 3 == 0 ? 0.5 : 1.5));
    scene.rods.push_back({.a = 2 + i, .b = 2 + (i + 1) % n, .mass = i % 2 ? rod_mass : 3 * rod_mass});
  }
  scene.rods.push_back({.a = 0, .b = 5});
  scene.rods.push_back({.a = 3, .b = 1, .mass = rod_mass});
  return scene;
}

/// Largest differences of a coordinate, in m and m/s.
struct Apart {
  double position = 0;
  double velocity = 0;
};
inline Apart apart(const Frame& a, const Frame& b) {
  const auto most = [](const std::vector<Vec3>& p, const std::vector<Vec3>& q) {
    double worst = p.size() == q.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i) {
      const Vec3 d = p[i] - q[i];
      worst = std::max({worst, std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    }
    return worst;
  };
  return {most(a.positions, b.positions), most(a.velocities, b.velocities)};
}

}  // namespace plumb::test
