#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "scenes/humanoid/humanoid.hpp"

/// These are the thesis's numbers for its limbs, from the head down. Upper legs come before shins.
namespace plumb::scenes {

/// Lengths (in inches) are those of appendix B, CArticulatedStructure's constructor, in its order of limbs.
struct LimbShape {
  std::uint32_t joint;  ///< The particle that it hangs from. Its other end is the next one.
  double length;        ///< Length, in inches.
  double sideways;      ///< Sine of its angle to the vertical, towards +z.
};
/// Upper legs are turned by 30 degrees about x (appendix B, Reset()), and the shins hang straight down.
inline constexpr std::array<LimbShape, 9> limb_shapes = {{{0, 10, 0},
                                                          {1, 5, 0},
                                                          {2, 28, 0},
                                                          {3, 5, 0},
                                                          {4, 7, 0},
                                                          {5, 30, 0.5},
                                                          {5, 30, -0.5},
                                                          {6, 30, 0},
                                                          {7, 30, 0}}};
enum LimbNumber : std::size_t { head, neck, torso, spine, basin, thigh, other_thigh, shin, other_shin };

/// Masses (in pounds) are those of figure 4.9. Radii (in inches) are those of appendix B, Reset(), which has
/// the same masses.
struct Build {
  std::array<double, 9> masses;
  std::array<double, 9> radii;
};
inline constexpr Build thin = {{20, 5, 84, 5, 21, 30, 30, 30, 30}, {4, 2, 6, 2, 6, 2, 2, 2, 2}};
inline constexpr Build medium = {{25, 5, 140, 5, 35, 45, 45, 45, 45}, {5, 2, 10, 2, 10, 3, 3, 3, 3}};
inline constexpr Build wide = {{40, 5, 350, 25, 87.5, 90, 90, 90, 90}, {8, 2, 25, 2, 25, 6, 6, 6, 6}};

/// Returns the masses of a build. Throws InputError on BodyType::none.
const Build& build_of(BodyType body);

/// Returns a solid cylinder's inertia about an axis through its middle and across it, in kg m².
double inertia_across(double mass, double radius, double length);

/// Makes a scene with the plane y = 0 alone and joints that are braked. Throws InputError on a friction or a
/// joint drag (1/s) that is no number from 0 on.
Scene ground_with(double friction, double joint_drag);

}  // namespace plumb::scenes
