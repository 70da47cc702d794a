#pragma once

#include <array>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::tools {

/// An animation as glTF 2.0, which Blender, three.js and game engines open. A node for each limb (capsules,
/// rods without one, loose particles) with its translation and rotation over time, +y from its first end to
/// its second, and, of rods, its scale, since they may stretch. All share a cylinder and a ball of radius and
/// length one. Planes and boxes are nodes that do not move.
class GltfAnimation {
 public:
  /// Keeps a reference to the scene.
  explicit GltfAnimation(const Scene& scene);
  explicit GltfAnimation(Scene&&) = delete;
  void add(const Frame& frame);
  /// A .glb file's bytes, or a .gltf file's JSON with its numbers in base64. Throws InputError without frames
  /// or if the animation is too long for a file of this kind, 2 GB of numbers.
  std::string to_text(bool binary) const;

 private:
  /// What moves a node, frame after frame.
  struct Track {
    std::vector<float> translations;         ///< x, y, z
    std::vector<float> rotations;            ///< x, y, z, w
    std::vector<float> scales;               ///< x, y, z; of rods alone
    Vec3 axis{0, 1, 0};                      ///< the last frame's, of length one
    std::array<double, 4> turn{0, 0, 0, 1};  ///< the last frame's rotation, x, y, z, w
  };

  const Scene& scene_;
  std::vector<scenes::Limb> limbs_;
  std::vector<Track> tracks_;  ///< one for each limb
  std::vector<float> times_;   ///< s
  double thin_ = 0.01;         ///< m, radius of rods and particles that have none
};

}  // namespace plumb::tools
