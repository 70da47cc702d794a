#include "scenes/humanoid/humanoid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid_arms.hpp"
#include "scenes/humanoid/humanoid_limbs.hpp"

namespace plumb::scenes {
namespace {

/// Returns where the particles of a figure at the origin are, in m.
std::array<Vec3, 10> joints_of(const Build& build) {
  std::array<Vec3, 10> places{};
  for (std::size_t i = 0; i < limb_shapes.size(); ++i) {
    const LimbShape& limb = limb_shapes[i];
    const double down = std::sqrt(1 - limb.sideways * limb.sideways);
    places[i + 1] = places[limb.joint] + (limb.length * inch) * Vec3{0, -down, limb.sideways};
  }
  // The balls at the ends of the shins, which are the lowest, touch the ground.
  const double lift = build.radii.back() * inch - places.back().y;
  for (Vec3& place : places) place.y += lift;
  return places;
}

void require_share(double value, const char* name) {
  if (!(value >= 0 && value <= 1)) throw InputError(std::string(name) + " must be from 0 to 1");
}

void require_from_zero(double value, const char* name) {
  if (!(value >= 0) || !std::isfinite(value))
    throw InputError(std::string(name) + " must be at least 0 and finite");
}

/// Adds particles as place(joint) says, with limbs between them.
template <class Place>
void append_figure(Scene& scene, const Build& build, const std::array<Vec3, 10>& joints,
                   const Surface& surface, Place&& place) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (const Vec3& joint : joints) scene.particles.push_back(place(joint));
  for (std::uint32_t i = 0; i < limb_shapes.size(); ++i) {
    const std::uint32_t a = first + limb_shapes[i].joint, b = first + i + 1;
    const double length = limb_shapes[i].length * inch, mass = build.masses[i] * pound,
                 radius = build.radii[i] * inch;
    scene.rods.push_back(
        {.a = a, .b = b, .length = length, .mass = mass, .inertia = inertia_across(mass, radius, length)});
    scene.capsules.push_back({.a = point_at(a), .b = point_at(b), .radius = radius, .surface = surface});
  }
}

/// Returns a particle that sleeps at a place (m).
Particle sleeper(Vec3 position) {
  return {.position = position, .asleep = true};
}

/// Returns how far from a place on its axis a figure reaches, in m, whatever way it is turned.
double reach_of(const Build& build, const std::array<Vec3, 10>& joints, Vec3 from) {
  double reach = 0;
  for (std::size_t i = 0; i < limb_shapes.size(); ++i)
    for (const Vec3& end : {joints[limb_shapes[i].joint], joints[i + 1]})
      reach = std::max(reach, norm(end - from) + build.radii[i] * inch);
  return reach;
}

/// Returns how long a ball that flies through `target` with `velocity` can have been on its way, in s. It is
/// at most `longest`, and the ball was never lower than its radius.
double time_above_ground(Vec3 target, Vec3 velocity, Vec3 gravity, double radius, double longest) {
  // Its height was target.y - velocity.y t + gravity.y t^2 / 2. The way begins at the first t > 0 at which
  // that is the radius.
  const double a = gravity.y / 2, b = -velocity.y, c = target.y - radius;
  if (c <= 0) return 0;
  double t = longest;
  if (a == 0) {
    if (b < 0) t = std::min(t, -c / b);
    return t;
  }
  const double root = std::sqrt(std::max(0.0, b * b - 4 * a * c));
  for (const double crossing : {(-b - root) / (2 * a), (-b + root) / (2 * a)})
    if (crossing > 0) t = std::min(t, crossing);
  return t;
}

}  // namespace

const Build& build_of(BodyType body) {
  if (body == BodyType::none) throw InputError("body must be thin, medium or wide");
  return body == BodyType::thin ? thin : body == BodyType::medium ? medium : wide;
}

double inertia_across(double mass, double radius, double length) {
  return mass * (3 * radius * radius + length * length) / 12;
}

Scene ground_with(double friction, double joint_drag) {
  require_from_zero(friction, "friction");
  require_from_zero(joint_drag, "joint_drag");
  Scene scene;
  scene.joint_drag = joint_drag;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0, .surface = {.friction = friction}});
  return scene;
}

std::string_view to_string(BodyType body) {
  switch (body) {
    case BodyType::none:
      return "none";
    case BodyType::thin:
      return "thin";
    case BodyType::medium:
      return "medium";
    case BodyType::wide:
      return "wide";
  }
  return "";
}

Scene make_humanoid() {
  Scene scene;
  scene.particles.push_back({.position = {0, 0, 0}, .fixed = true});
  for (std::size_t i = 0; i < limb_shapes.size(); ++i) {
    const LimbShape& limb = limb_shapes[i];
    const double along = std::sqrt(1 - limb.sideways * limb.sideways);
    const Vec3 way{along * limb.length * inch, 0, limb.sideways * limb.length * inch};
    const auto end = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.push_back({.position = scene.particles[limb.joint].position + way});
    scene.rods.push_back({.a = limb.joint, .b = end, .mass = medium.masses[i] * pound});
  }
  return scene;
}

Scene make_humanoid(const HumanoidShape& shape) {
  if (shape.body == BodyType::none) {
    if (shape.friction != HumanoidShape{}.friction)
      throw InputError("friction is of a figure that stands; give body=thin, medium or wide");
    if (shape.joint_drag != usual_joint_drag)
      throw InputError("joint_drag is of a figure that stands; give body=thin, medium or wide");
    if (shape.arms != 0) throw InputError("arms are of a figure that stands; give body=thin, medium or wide");
    return make_humanoid();
  }
  if (shape.arms > 1) throw InputError("arms must be 0 or 1");
  if (shape.arms == 1) return make_humanoid_with_arms(shape);
  const Build& build = build_of(shape.body);
  Scene scene = ground_with(shape.friction, shape.joint_drag);
  append_figure(scene, build, joints_of(build), {.friction = shape.friction}, sleeper);
  return scene;
}

Scene make_crowd(const CrowdShape& shape) {
  constexpr double apart = 2.5;  // Distance of neighbouring figures, in m.
  require_at_least(shape.humanoids, 1, "humanoids");
  if (shape.hit > shape.humanoids)
    throw InputError("hit must be at most the number of humanoids, " + std::to_string(shape.humanoids));
  require_countable(10 * std::uint64_t{shape.humanoids} + shape.hit);
  const Build& build = build_of(shape.body);
  const std::array<Vec3, 10> joints = joints_of(build);
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(shape.humanoids))));
  const auto place = [&](std::uint64_t i) {
    return Vec3{apart * static_cast<double>(i % side), 0, apart * static_cast<double>(i / side)};
  };
  Scene scene = ground_with(shape.friction, shape.joint_drag);
  for (std::uint32_t i = 0; i < shape.humanoids; ++i)
    append_figure(scene, build, joints, {.friction = shape.friction},
                  [&](Vec3 joint) { return sleeper(joint + place(i)); });
  for (std::uint64_t k = 0; k < shape.hit; ++k) {
    const Vec3 stands = place(k * shape.humanoids / shape.hit);
    // The ball starts half way to the next figure, which it then does not touch.
    throw_ball(scene, {.speed = shape.speed, .friction = shape.friction, .distance = apart / 2},
               stands + torso_center({.body = shape.body}));
  }
  return scene;
}

Scene make_pile(const PileShape& shape) {
  require_at_least(shape.figures, 1, "figures");
  require_positive(shape.gap, "gap");
  require_countable(10 * std::uint64_t{shape.figures});
  const Build& build = build_of(shape.body);
  const std::array<Vec3, 10> joints = joints_of(build);
  const Vec3 middle{0, 0.5 * (joints.front().y + joints.back().y), 0};
  // Legs are spread in the layer, so that a figure is as thick as its thickest limb.
  const double thick = 2 * *std::max_element(build.radii.begin(), build.radii.end()) * inch;
  const double apart = 2 * reach_of(build, joints, middle) + shape.gap, above = thick + shape.gap;
  const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(static_cast<double>(shape.figures))));
  Random random(shape.seed);
  Scene scene = ground_with(shape.friction, shape.joint_drag);
  for (std::uint32_t i = 0; i < shape.figures; ++i) {
    const std::uint32_t layer = i / (side * side), column = i % side, row = i / side % side;
    // Every other layer is shifted by half a place, so that figures land on several others.
    const double shift = layer % 2 == 0 ? -0.25 : 0.25;
    const Vec3 place{apart * (column - 0.5 * (side - 1) + shift), 0.5 * thick + shape.gap + above * layer,
                     apart * (row - 0.5 * (side - 1) + shift)};
    const double angle = random.between(0, 2 * std::numbers::pi);
    const Vec3 front{0, random.chance(0.5) ? 1.0 : -1.0, 0}, up{std::cos(angle), 0, std::sin(angle)};
    append_figure(scene, build, joints, {.friction = shape.friction}, [&](Vec3 joint) {
      const Vec3 of = joint - middle;
      return Particle{.position = place + of.x * front + of.y * up + of.z * cross(front, up)};
    });
  }
  return scene;
}

std::uint32_t throw_ball(Scene& scene, const Ball& ball, Vec3 target) {
  require_positive(ball.speed, "the ball's speed");
  require_positive(ball.radius, "the ball's radius");
  require_positive(ball.mass, "the ball's mass");
  require_positive(ball.distance, "the ball's distance");
  require_share(ball.elasticity, "the ball's elasticity");
  require_from_zero(ball.friction, "the ball's friction");
  const double length = norm(ball.direction);
  require_positive(length, "the length of the ball's direction");
  const Vec3 velocity = (ball.speed / length) * ball.direction;
  const Vec3 gravity = scene.gravity;
  const double t = time_above_ground(target, velocity, gravity, ball.radius, ball.distance / ball.speed);
  const auto particle = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back({.position = target - t * velocity + (t * t / 2) * gravity,
                             .velocity = velocity - t * gravity,
                             .mass = ball.mass});
  scene.capsules.push_back({.a = point_at(particle),
                            .b = point_at(particle),
                            .radius = ball.radius,
                            .surface = {.friction = ball.friction, .restitution = ball.elasticity}});
  return particle;
}

Vec3 torso_center(const HumanoidShape& shape) {
  if (shape.arms != 0) return torso_center_with_arms(shape);
  const std::array<Vec3, 10> joints = joints_of(build_of(shape.body));
  return 0.5 * (joints[limb_shapes[torso].joint] + joints[torso + 1]);
}

}  // namespace plumb::scenes
