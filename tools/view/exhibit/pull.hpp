#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/world.hpp"

/// How a hand pulls a particle. All of it is here, so that another way takes its place in one file.
namespace plumb::view {

/// What is pulled where to.
struct Hand {
  std::uint32_t particle = 0;
  Vec3 target{};  ///< In m.
};

/// Holds a particle of a world. An anchor moves by a fifth of its way a step. Others are grabbed
/// (World::grab()) by a spring that gives by a hundredth of the scene's diagonal under the weight of all that
/// hangs together, with gravity of 9.81 m/s². Alone on that spring it would be damped critically.
class Grip {
 public:
  /// Takes hold. Throws InputError if the world refuses. `islands` are those of find_islands().
  Grip(Hand hand, World& world, const Scene& scene, const std::vector<std::uint32_t>& islands);

  const Hand& hand() const { return hand_; }
  /// Pulls to another target. Throws InputError if the world refuses it; all is then as before.
  void move(World& world, const Scene& scene, Vec3 target);
  /// Pulls during the next step. Returns whether it still holds.
  bool pull(World& world, const Scene& scene);
  void let_go(World& world);

 private:
  Hand hand_;
  std::optional<Handle<Grab>> grab_{};  ///< None of an anchor.
};

}  // namespace plumb::view
