#pragma once

#include <array>
#include <cstddef>
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
  /// Finds those of all bodies, by the positions and velocities of all particles. They are the same to the
  /// bit.
  void copy_poses(std::span<const Vec3> positions, std::span<Pose> out) const;
  void copy_motions(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                    std::span<BodyMotion> out) const;

 private:
  /// What is linear in places of the scene is a sum over the particles, with these weights and gradients.
  struct Reference {
    std::array<std::uint32_t, 4> particles;
    std::array<double, 4> center;   ///< of the centre of mass
    std::array<Vec3, 4> gradients;  ///< 1/m
  };

  /// So many bodies are found at once, enough for the widest vectors.
  static constexpr std::uint32_t side_by_side = 8;

  /// Finds the poses of `count` bodies from `first` on, which ask for their particles in turn.
  template <std::size_t count, class At>
  void find_poses(std::uint32_t first, At&& position, Pose* out) const;
  template <std::size_t count, class At, class Speed>
  void find_motions(std::uint32_t first, At&& position, Speed&& velocity, BodyMotion* out) const;

  std::vector<Reference> bodies_;
};

}  // namespace plumb::detail
