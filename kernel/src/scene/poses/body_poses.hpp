#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

/// Holds a number of each of `count` bodies, which are found side by side: all do the same arithmetic, so
/// that compilers make vectors of it. One body alone is found by the same, to the same bits.
template <std::size_t count>
using Lanes = std::array<double, count>;
/// Holds nine numbers of each, row by row.
template <std::size_t count>
using Matrices = std::array<Lanes<count>, 9>;
/// Holds three numbers for each of the four particles of a body.
template <std::size_t count>
using Corners = std::array<Lanes<count>, 12>;

/// Says where bodies are by where their particles are, against how the scene stood.
class BodyPoses {
 public:
  BodyPoses() = default;
  explicit BodyPoses(const Scene& scene);

  std::uint32_t count() const { return count_; }
  /// Takes in a body, or another one by its number, as the scene has it.
  void take(const Scene& scene, std::uint32_t body);
  /// Returns the four particles of a body.
  const std::array<std::uint32_t, 4>& particles(std::uint32_t body) const {
    return groups_[body / side_by_side].particles[body % side_by_side];
  }
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
  /// So many bodies are found at once, enough for the widest vectors.
  static constexpr std::uint32_t side_by_side = 8;

  /// What is linear in places of the scene is a sum over the particles, with these weights and gradients.
  template <std::size_t count>
  struct Weights {
    std::array<Lanes<count>, 4> center;  ///< of the centre of mass
    Corners<count> gradients;            ///< 1/m
  };
  struct Group {
    std::array<std::array<std::uint32_t, 4>, side_by_side> particles{};
    Weights<side_by_side> weights{};
  };

  template <std::size_t count>
  const Weights<count>& weights_from(std::uint32_t first, Weights<1>& one) const;
  /// Finds the poses of `count` bodies from `first` on, which ask for their particles in turn.
  template <std::size_t count, class At>
  void find_poses(std::uint32_t first, At&& position, Pose* out) const;
  template <std::size_t count, class At, class Speed>
  void find_motions(std::uint32_t first, At&& position, Speed&& velocity, BodyMotion* out) const;

  std::uint32_t count_ = 0;
  Array<Group> groups_;
};

}  // namespace plumb::detail
