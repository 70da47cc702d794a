#pragma once

#include <cstdint>
#include <vector>

#include "plumb/inertia.hpp"
#include "plumb/scene.hpp"

/// A figure alone in the air: 22 bodies of the sizes and masses of human limbs, held together by 21 hinges.
namespace plumb::bench {

/// A body and the hinge that holds it to its parent. World's axes, as the figure starts.
struct Limb {
  static constexpr std::int32_t none = -1;

  const char* name = "";
  std::int32_t parent = none;  ///< index of a limb before this one; none: it floats
  Vec3 joint{};                ///< m, where the hinge is; of the first limb its centre
  Vec3 axis{};                 ///< of the hinge, of length one
  double rate = 0;             ///< rad/s, how the limb turns against its parent
  MassProperties body{};       ///< its inertia has nothing off the diagonal
};

/// How a limb starts.
struct Motion {
  Vec3 velocity{};  ///< m/s, of its centre
  Vec3 spin{};      ///< rad/s
};

/// Parents before children. Hips, ankles, shoulders and the waist are hinges one after the other, with small
/// limbs between them.
std::vector<Limb> make_figure();

/// What the first limb does and what all hinges do, together.
std::vector<Motion> motions_of(const std::vector<Limb>& limbs);

/// The figure as bodies on four particles each and hinges by add_revolute(), without gravity.
Scene scene_of(const std::vector<Limb>& limbs);
/// The same figure with hinges of two particles each, which both limbs have: half the unknowns.
Scene shared_scene_of(const std::vector<Limb>& limbs);

}  // namespace plumb::bench
