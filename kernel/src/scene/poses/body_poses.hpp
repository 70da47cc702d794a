#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

/// Says where bodies are by where their particles are, against how the scene stood.
class BodyPoses {
 public:
  BodyPoses() = default;
  explicit BodyPoses(const Scene& scene);

  std::uint32_t count() const { return static_cast<std::uint32_t>(bodies_.size()); }
  /// Returns the four particles of a body.
  const std::array<std::uint32_t, 4>& particles(std::uint32_t body) const { return bodies_[body].particles; }
  /// Returns the pose for the positions (m) of its four particles.
  Pose pose(std::uint32_t body, const std::array<Vec3, 4>& positions) const;
  /// Returns the motion for velocities (m/s) of them, too.
  BodyMotion motion(std::uint32_t body, const std::array<Vec3, 4>& positions,
                    const std::array<Vec3, 4>& velocities) const;

 private:
  /// What is linear in places of the scene is a sum over the particles, with these weights and gradients.
  struct Reference {
    std::array<std::uint32_t, 4> particles;
    std::array<double, 4> center;   ///< of the centre of mass
    std::array<Vec3, 4> gradients;  ///< 1/m
  };

  std::vector<Reference> bodies_;
};

}  // namespace plumb::detail
