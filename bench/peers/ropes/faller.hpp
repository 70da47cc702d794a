#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plumb/scene.hpp"

/// Ropes that fall on ground of triangles, in plumb and in Bullet.
namespace plumb::bench {

inline constexpr double frame = 1.0 / 60;  ///< s

/// A rope is a run of rods of the scene, each from a particle to the next one, with a capsule around each.
struct Rope {
  std::uint32_t first = 0;  ///< of its particles
  std::uint32_t links = 0;
};

/// One program that moves the scene's ropes.
class Faller {
 public:
  virtual ~Faller() = default;
  /// Steps through a frame.
  virtual void step() = 0;
  /// Copies where particles are (m). Programs without particles copy joints and ends.
  virtual void copy_positions(std::span<Vec3> to) const = 0;
  /// Returns the largest share of its length by which a rod, or a gap of a joint, is wrong.
  virtual double strain() const = 0;
  /// Returns how many ropes are awake.
  virtual std::uint32_t awake() const = 0;
};

/// Says how one program is to be run.
struct Setting {
  std::string program{}, name{};                                 ///< without commas
  std::function<std::unique_ptr<Faller>(const Scene&)> start{};  ///< makes it anew
};

/// Returns the ropes of a scene. Throws std::invalid_argument where a rod is not of a rope.
std::vector<Rope> ropes_of(const Scene& scene);
/// Returns the place of particle k of a rope.
inline Vec3 particle_of(const Scene& scene, const Rope& rope, std::uint32_t k) {
  return scene.particles[rope.first + k].position;
}

Setting plumb_relaxed(std::uint32_t substeps, std::uint32_t sweeps, unsigned threads);
Setting plumb_automatic(unsigned threads);
/// Capsules on ball joints.
Setting bullet_rods(std::uint32_t steps, int iterations);

}  // namespace plumb::bench
