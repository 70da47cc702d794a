#pragma once

#include <cstdint>
#include <string_view>

#include "plumb/scene.hpp"

/// These functions make the thesis's humanoid (section 4.5, figure 4.9, appendix B), standing, and the ball
/// that is thrown at it.
namespace plumb::scenes {

/// These are the units of the thesis's numbers. Masses are in pounds (figure 4.9). Lengths have no unit
/// there. As inches they make a figure as tall as a person, so plumb takes them as inches.
inline constexpr double inch = 0.0254;       ///< In m.
inline constexpr double pound = 0.45359237;  ///< In kg.

/// The thesis has three builds (figure 4.9). None is the frontier's tree, which does not stand.
enum class BodyType : std::uint8_t { none, thin, medium, wide };
std::string_view to_string(BodyType);

/// Figures that stand have this Scene::joint_drag, in 1/s. Limbs on two points swing for ever if nothing
/// brakes their joints. The thesis's came to rest because its relaxation loses energy by its error. A passive
/// human joint does it by friction. So do these joints, and the rate does not depend on the step.
inline constexpr double usual_joint_drag = 3;

struct HumanoidShape {
  BodyType body = BodyType::none;
  double friction = 0.6;                 ///< Coulomb's coefficient between limbs, ball and ground.
  double joint_drag = usual_joint_drag;  ///< Scene::joint_drag, in 1/s.
  std::uint32_t arms = 0;                ///< 1 makes the fuller figure of humanoid_arms.hpp.
};

/// Without a body it makes make_humanoid() of generators.hpp. With one, nine limbs are capsules around rods,
/// from the head down. The figure stands free and asleep on the plane y = 0 above the origin, and its feet's
/// balls just touch the ground. Its front is towards +x, and its legs are apart along z. Throws InputError on
/// a friction or a joint drag that is no number from 0 on. It also throws on one of them, or arms, that
/// nothing would have.
Scene make_humanoid(const HumanoidShape& shape);

/// A crowd stands in a square field, 2.5 m apart along x and z, on one plane.
struct CrowdShape {
  std::uint32_t humanoids = 10000;
  std::uint32_t hit = 100;  ///< So many figures, evenly strewn, have a ball flying at them.
  BodyType body = BodyType::medium;
  double friction = 0.6;
  double joint_drag = usual_joint_drag;  ///< Scene::joint_drag, in 1/s.
  double speed = 10;                     ///< Speed of the balls, in m/s.
};
/// Makes the humanoids first, one after another, then the balls. Figures of one build differ only in where
/// they stand.
Scene make_crowd(const CrowdShape& shape);

/// Figures lie in layers above a plane, and fall on it and on each other to one heap. A layer is a square of
/// places, and there are about as many layers as places along its side.
struct PileShape {
  std::uint32_t figures = 100;
  double gap = 0.1;  ///< Between figures, and above the plane, in m, at least.
  BodyType body = BodyType::medium;
  double friction = 0.6;
  double joint_drag = usual_joint_drag;  ///< Scene::joint_drag, in 1/s.
  std::uint32_t seed = 1;                ///< Of the ways in which figures lie.
};
/// Makes the figures from the lowest layer up. Each lies on its back or belly, its head anywhere. Throws
/// InputError with the value that makes no sense.
Scene make_pile(const PileShape& shape);

/// A ball is a single particle. Mass and radius are the thesis's numbers (appendix B), taken as pounds and
/// inches. Its elasticity is a slider there.
struct Ball {
  double speed = 10;         ///< Speed where it meets its target, in m/s.
  Vec3 direction{-1, 0, 0};  ///< Direction of that velocity, of any length.
  double radius = 5 * inch;
  double mass = 5 * pound;
  double elasticity = 0.5;  ///< Restitution, 0 to 1.
  double friction = 0.6;
  double distance = 80 * inch;  ///< Longest way that it flies, in m.
};

/// Adds the ball so that it flies freely through `target` (m) with the speed and direction asked for, if
/// nothing is in its way. It starts `distance` away along its flight's direction, or later, so that it does
/// not start below the ground y = 0. Returns its particle. Throws InputError naming the value that makes no
/// sense.
std::uint32_t throw_ball(Scene& scene, const Ball& ball, Vec3 target);

/// Returns the middle of the upper torso of a figure at the origin, in m, where the ball is aimed.
Vec3 torso_center(const HumanoidShape& shape);

}  // namespace plumb::scenes
