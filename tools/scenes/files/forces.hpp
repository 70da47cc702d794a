#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/world.hpp"

/// Files of forces have the header `t,kind,number,x,y,z`. A row is one anchor, ball joint, spring, shape,
/// angle or torsion at one saved time. Forces are in N along the axes of space. Torques are in N m and stand
/// in x alone. What is not known is left empty.
namespace plumb::scenes {

inline constexpr std::string_view forces_header = "t,kind,number,x,y,z\n";

/// These are the means over a step of what holds and pushes a scene, beside the tensions of rods.
struct Forces {
  std::vector<Vec3> reactions{};   ///< In N, by particle; movable ones have zero.
  std::vector<Vec3> pins{};        ///< In N, on the places a.
  std::vector<Vec3> springs{};     ///< In N, on the places a.
  std::vector<Vec3> contacts{};    ///< In N, by capsule.
  std::vector<double> angles{};    ///< In N m, of limits, friction and drives.
  std::vector<double> torsions{};  ///< In N m, on the sides of v.

  bool is_empty() const { return reactions.empty(); }
};

/// Makes room for a scene's forces.
Forces make_forces(const Scene& scene);
/// Copies those of a world whose settings ask for tensions.
void copy_forces(const World& world, Forces& forces);
/// Appends the rows of one saved time (s), for the anchors of the scene and all that is not a particle.
void append_forces(std::string& csv, double t, const Scene& scene, const Forces& forces);

}  // namespace plumb::scenes
