#include "scenes/humanoid/humanoid_arms.hpp"

#include <cmath>
#include <numbers>

#include "plumb/inertia.hpp"
#include "plumb/joints.hpp"
#include "scenes/humanoid/humanoid_limbs.hpp"

namespace plumb::scenes {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double apart = 10 * degree;       ///< Angle of the legs from the vertical.
constexpr double most_bent = 140 * degree;  ///< Largest angle of knees and elbows.
constexpr double tilt = 20 * degree;        ///< Angle that add_hinge() explains.
constexpr double hip_share = 0.6;           ///< Share of the basin's radius, to either side.
constexpr double arm_length = 20 * inch;    ///< Length of either half, in m.
constexpr double arm_thickness = 0.8;       ///< Share of the leg's radius.
constexpr double upper_arm_share = 0.28, forearm_share = 0.22;  ///< Shares of the thigh's mass.
constexpr double shoulder_drop = 4 * inch;   ///< Distance below the top of the torso, in m.
constexpr double shoulder_gap = 0.5 * inch;  ///< Distance between arm and torso, in m.
const Vec3 front{1, 0, 0};

/// A straight limb has its size in m and kg.
struct Cylinder {
  Vec3 from{}, to{};
  double radius = 0, mass = 0;

  double length() const { return norm(to - from); }
};

/// Adds limbs to a scene and joins them.
class Figure {
 public:
  Figure(Scene& scene, const Surface& surface) : scene_(scene), surface_(surface) {}

  std::uint32_t add(const Cylinder& c) {
    const std::uint32_t body = add_body(scene_, solid_cylinder(c.mass, c.radius, c.from, c.to));
    scene_.capsules.push_back({.a = point_on_body(scene_, body, c.from),
                               .b = point_on_body(scene_, body, c.to),
                               .radius = c.radius,
                               .surface = surface_});
    return body;
  }

  /// Adds a rod from one body to another, which is free to turn at both ends.
  void add_link(const Cylinder& c, std::uint32_t above, std::uint32_t below) {
    const auto first = static_cast<std::uint32_t>(scene_.particles.size());
    scene_.particles.push_back({.position = c.from});
    scene_.particles.push_back({.position = c.to});
    scene_.rods.push_back({.a = first,
                           .b = first + 1,
                           .length = c.length(),
                           .mass = c.mass,
                           .inertia = inertia_across(c.mass, c.radius, c.length())});
    scene_.capsules.push_back(
        {.a = point_at(first), .b = point_at(first + 1), .radius = c.radius, .surface = surface_});
    add_spherical(scene_, point_on_body(scene_, above, c.from), point_at(first));
    add_spherical(scene_, point_on_body(scene_, below, c.to), point_at(first + 1));
  }

  void add_ball_joint(std::uint32_t a, std::uint32_t b, Vec3 position) {
    add_spherical(scene_, point_on_body(scene_, a, position), point_on_body(scene_, b, position));
  }

  /// Joins a lower limb to a straight upper one so that it bends towards `forward`, from straight to
  /// most_bent. `forward` has length one and lies across both. The angle that is held is to a direction of
  /// the upper limb tilted the other way. Angles near 0 and pi have no good derivative.
  void add_hinge(std::uint32_t upper, std::uint32_t lower, Vec3 position, Vec3 axis, Vec3 forward) {
    add_revolute(scene_, upper, lower, position, cross(axis, forward));
    const Vec3 tilted = std::cos(tilt) * axis - std::sin(tilt) * forward;
    scene_.angles.push_back({.u = direction(upper, position, tilted),
                             .v = direction(lower, position, axis),
                             .lower = tilt,
                             .upper = tilt + most_bent});
  }

 private:
  Direction direction(std::uint32_t body, Vec3 position, Vec3 way) const {
    constexpr double reach = 10 * inch;
    return {.from = point_on_body(scene_, body, position),
            .to = point_on_body(scene_, body, position + reach * way)};
  }

  Scene& scene_;
  Surface surface_;
};

/// These are the heights of the joints between the limbs of the trunk above y = 0, from the top of the head
/// to the hips, in m.
std::array<double, 6> trunk_heights(const Build& build) {
  std::array<double, 6> heights{};
  heights[5] = build.radii[shin] * inch +
               std::cos(apart) * (limb_shapes[thigh].length + limb_shapes[shin].length) * inch;
  for (std::size_t i = 5; i-- > 0;) heights[i] = heights[i + 1] + limb_shapes[i].length * inch;
  return heights;
}

void add_leg(Figure& figure, const Build& build, std::uint32_t on, Vec3 hip, double side) {
  const Vec3 down{0, -std::cos(apart), side * std::sin(apart)};
  const Vec3 knee = hip + (limb_shapes[thigh].length * inch) * down;
  const Vec3 ankle = knee + (limb_shapes[shin].length * inch) * down;
  const std::uint32_t upper = figure.add({hip, knee, build.radii[thigh] * inch, build.masses[thigh] * pound});
  const std::uint32_t lower = figure.add({knee, ankle, build.radii[shin] * inch, build.masses[shin] * pound});
  figure.add_ball_joint(on, upper, hip);
  figure.add_hinge(upper, lower, knee, down, -1.0 * front);
}

void add_arm(Figure& figure, const Build& build, std::uint32_t on, Vec3 shoulder) {
  const Vec3 down{0, -1, 0};
  const Vec3 elbow = shoulder + arm_length * down, wrist = elbow + arm_length * down;
  const double radius = arm_thickness * build.radii[thigh] * inch;
  const double thigh_mass = build.masses[thigh] * pound;
  const std::uint32_t upper = figure.add({shoulder, elbow, radius, upper_arm_share * thigh_mass});
  const std::uint32_t lower = figure.add({elbow, wrist, radius, forearm_share * thigh_mass});
  figure.add_ball_joint(on, upper, shoulder);
  figure.add_hinge(upper, lower, elbow, down, front);
}

}  // namespace

Scene make_humanoid_with_arms(const HumanoidShape& shape) {
  const Build& build = build_of(shape.body);
  Scene scene = ground_with(shape.friction, shape.joint_drag);
  Figure figure(scene, {.friction = shape.friction});
  const std::array<double, 6> heights = trunk_heights(build);
  const auto limb = [&](std::size_t i) {
    return Cylinder{.from = {0, heights[i], 0},
                    .to = {0, heights[i + 1], 0},
                    .radius = build.radii[i] * inch,
                    .mass = build.masses[i] * pound};
  };
  const std::uint32_t skull = figure.add(limb(head));
  const std::uint32_t chest = figure.add(limb(torso));
  const std::uint32_t pelvis = figure.add(limb(basin));
  figure.add_link(limb(neck), skull, chest);
  figure.add_link(limb(spine), chest, pelvis);
  const double leg_radius = build.radii[thigh] * inch;
  const double hip = hip_share * build.radii[basin] * inch;
  const double shoulder = build.radii[torso] * inch + arm_thickness * leg_radius + shoulder_gap;
  for (const double side : {1.0, -1.0}) {
    add_leg(figure, build, pelvis, {0, heights[5], side * hip}, side);
    add_arm(figure, build, chest, {0, heights[torso] - shoulder_drop, side * shoulder});
  }
  for (Particle& particle : scene.particles) particle.asleep = true;
  return scene;
}

Vec3 torso_center_with_arms(const HumanoidShape& shape) {
  const std::array<double, 6> heights = trunk_heights(build_of(shape.body));
  return {0, (heights[torso] + heights[torso + 1]) / 2, 0};
}

}  // namespace plumb::scenes
