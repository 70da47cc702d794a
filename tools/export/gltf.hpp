#pragma once

#include <array>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::tools {

/// This writes an animation as glTF 2.0, which Blender, three.js and game engines open. Capsules, rods
/// without one and loose particles have a node each. Its translation and rotation change over time, and +y
/// points from its first end to its second. Nodes of rods also have a scale, since rods may stretch. All
/// share a cylinder and a ball of radius and length one. Planes and boxes are nodes that do not move.
class GltfAnimation {
 public:
  /// Keeps a reference to the scene, which must outlive the animation.
  explicit GltfAnimation(const Scene& scene);
  explicit GltfAnimation(Scene&&) = delete;
  void add(const Frame& frame);
  /// Returns a .glb file's bytes, or a .gltf file's JSON with its numbers in base64. Throws InputError
  /// without frames, or if the numbers exceed 2 GB, which such files cannot hold.
  std::string to_text(bool binary) const;

 private:
  /// A track moves a node, frame after frame.
  struct Track {
    std::vector<float> translations;         ///< Translations: x, y, z in m for each frame.
    std::vector<float> rotations;            ///< Rotations: x, y, z, w for each frame.
    std::vector<float> scales;               ///< Scales of rods: x, y, z for each frame.
    Vec3 axis{0, 1, 0};                      ///< Direction in the last frame, of length one.
    std::array<double, 4> turn{0, 0, 0, 1};  ///< Rotation in the last frame: x, y, z, w.
  };

  const Scene& scene_;
  std::vector<scenes::Limb> limbs_;
  std::vector<Track> tracks_;  ///< Tracks, one for each limb.
  std::vector<float> times_;   ///< Times of the frames, in s.
  double thin_ = 0.01;         ///< Radius of rods and particles that have none, in m.
};

}  // namespace plumb::tools
