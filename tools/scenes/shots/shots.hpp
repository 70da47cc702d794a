#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/scene.hpp"
#include "scenes/shots/cores.hpp"
#include "scenes/shots/targets.hpp"

/// Random things are shot at walls of ground, at ropes, nets, figures and boxes, without gravity. Tests and
/// the command share these scenes.
namespace plumb::scenes {

/// What is shot.
enum class Missile : std::uint8_t { ball, rod, rope, box };
std::string_view to_string(Missile);

/// A shot is known by its number among those of a seed.
struct ShotShape {
  std::uint64_t number = 0;
  std::uint64_t seed = 1;
};

/// A shot is a scene and what is needed to judge it. Radii are from 5 mm to 1 m, speeds up to 100 m/s
/// relative to the target, and steps from 1/240 to 1/15 s.
struct Shot {
  Scene scene;  ///< The target's particles and shapes come first, then the missile's.
  Target target{};
  Missile missile{};
  double radius = 0;               ///< Radius of what is shot, or half its least side, in m.
  Vec3 out{};                      ///< Direction from the target to where the missile is, of length 1.
  Vec3 approach{};                 ///< Velocity of the missile relative to the target, in m/s.
  double dt = 1.0 / 60;            ///< Length of a step, in s.
  std::uint32_t steps = 8;         ///< Steps until it is judged.
  std::uint32_t first = 0;         ///< The missile's first particle.
  std::uint32_t net = 0;           ///< Particles along a side of the target, if it is a net.
  std::vector<Core> targets{};     ///< Cores of the target, unless that is a wall.
  std::vector<Core> missiles{};    ///< Cores of the missile.
  std::vector<Point> outermost{};  ///< All ends and corners of the missile.

  /// Says what is shot at what, how fast, and in which steps.
  std::string text() const;
};

/// Makes a shot, the same with every compiler.
Shot make_shot(const ShotShape& shape);
/// Makes its scene alone.
Scene make_shot_scene(const ShotShape& shape);

/// Returns the scene's positions, in m.
std::vector<Vec3> start_of(const Scene& scene);

}  // namespace plumb::scenes
