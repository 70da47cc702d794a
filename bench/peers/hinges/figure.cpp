#include "figure.hpp"

#include <cmath>

#include "plumb/joints.hpp"

namespace plumb::bench {
namespace {

enum class Along { x, y, z };

MassProperties placed(MassProperties body, Vec3 center) {
  body.center = center;
  return body;
}

/// A capsule along one of the axes; `length` without the half spheres.
MassProperties capsule(double mass, double radius, double length, Along along, Vec3 center) {
  MassProperties body = placed(solid_capsule(mass, radius, length), center);
  const double own = body.inertia.xx, across = body.inertia.yy;
  body.inertia.xx = along == Along::x ? own : across;
  body.inertia.yy = along == Along::y ? own : across;
  body.inertia.zz = along == Along::z ? own : across;
  return body;
}

Vec3 unit(Vec3 v) {
  return (1 / norm(v)) * v;
}

class Builder {
 public:
  std::int32_t add(Limb limb) {
    limb.axis = limb.parent == Limb::none ? Vec3{} : unit(limb.axis);
    limbs_.push_back(limb);
    return static_cast<std::int32_t>(limbs_.size()) - 1;
  }

  void add_leg(const char* const (&names)[6], std::int32_t pelvis, double side, const double (&rates)[6]) {
    const Vec3 hip{-0.02, 0.1 * side, 0.83}, knee{-0.02, 0.11 * side, 0.45}, ankle{-0.02, 0.11 * side, 0.07};
    const std::int32_t a =
        add({names[0], pelvis, hip, {1, 0, 0}, rates[0], placed(solid_sphere(0.5, 0.05), hip)});
    const std::int32_t b = add({names[1], a, hip, {0, 0, 1}, rates[1], placed(solid_sphere(0.5, 0.05), hip)});
    const Vec3 thigh{-0.02, 0.105 * side, 0.64}, shin{-0.02, 0.11 * side, 0.26},
        foot{0.03, 0.11 * side, 0.04};
    const std::int32_t c =
        add({names[2], b, hip, {0, 1, 0}, rates[2], capsule(4.5, 0.055, 0.3, Along::z, thigh)});
    const std::int32_t d =
        add({names[3], c, knee, {0, 1, 0}, rates[3], capsule(2.6, 0.045, 0.28, Along::z, shin)});
    const std::int32_t e =
        add({names[4], d, ankle, {0, 1, 0}, rates[4], placed(solid_sphere(0.4, 0.04), ankle)});
    add({names[5], e, ankle, {1, 0, 0.5}, rates[5], placed(solid_box(1.1, {0.22, 0.08, 0.06}), foot)});
  }

  void add_arm(const char* const (&names)[3], std::int32_t torso, double side, const double (&rates)[3]) {
    const Vec3 shoulder{0, 0.18 * side, 1.36}, elbow{0, 0.46 * side, 1.36};
    const Vec3 upper{0, 0.31 * side, 1.36}, lower{0, 0.61 * side, 1.36};
    const std::int32_t a =
        add({names[0], torso, shoulder, {2, side, 1}, rates[0], placed(solid_sphere(0.6, 0.05), shoulder)});
    const std::int32_t b =
        add({names[1], a, shoulder, {0, -1, side}, rates[1], capsule(1.6, 0.04, 0.2, Along::y, upper)});
    add({names[2], b, elbow, {0, side, -1}, rates[2], capsule(1.3, 0.032, 0.24, Along::y, lower)});
  }

  std::vector<Limb> limbs() && { return std::move(limbs_); }

 private:
  std::vector<Limb> limbs_;
};

/// Of the torso.
constexpr Motion start{.velocity = {0.3, -0.2, 0.1}, .spin = {1.0, 2.0, -0.5}};

}  // namespace

std::vector<Limb> make_figure() {
  Builder out;
  const Vec3 chest{0, 0, 1.25}, waist{-0.01, 0, 1.04}, loins{-0.02, 0, 0.92};
  const std::int32_t torso =
      out.add({"torso", Limb::none, chest, {}, 0, placed(solid_box(16, {0.18, 0.3, 0.36}), chest)});
  const std::int32_t link =
      out.add({"waist", torso, waist, {0, 0, 1}, 1.5, placed(solid_sphere(1, 0.06), waist)});
  const std::int32_t belly =
      out.add({"belly", link, waist, {0, 1, 0}, -1.2, capsule(4, 0.08, 0.1, Along::y, {-0.01, 0, 0.98})});
  const std::int32_t pelvis =
      out.add({"pelvis", belly, loins, {1, 0, 0}, 0.9, capsule(6.5, 0.09, 0.14, Along::y, {-0.02, 0, 0.87})});
  out.add_leg({"right hip", "right groin", "right thigh", "right shin", "right ankle", "right foot"}, pelvis,
              -1, {0.8, -1.6, -2.2, 3.1, -1.9, 2.4});
  out.add_leg({"left hip", "left groin", "left thigh", "left shin", "left ankle", "left foot"}, pelvis, 1,
              {-1.1, 1.3, 2.6, -2.8, 2.1, -1.7});
  out.add_arm({"right shoulder", "right upper arm", "right lower arm"}, torso, -1, {2.3, -1.8, 3.0});
  out.add_arm({"left shoulder", "left upper arm", "left lower arm"}, torso, 1, {-2.0, 2.7, -2.5});
  return std::move(out).limbs();
}

std::vector<Motion> motions_of(const std::vector<Limb>& limbs) {
  std::vector<Motion> out{start};
  for (std::size_t i = 1; i < limbs.size(); ++i) {
    const auto parent = static_cast<std::size_t>(limbs[i].parent);
    const Vec3 spin = out[parent].spin + limbs[i].rate * limbs[i].axis;
    const Vec3 at_joint =
        out[parent].velocity + cross(out[parent].spin, limbs[i].joint - limbs[parent].body.center);
    out.push_back({at_joint + cross(spin, limbs[i].body.center - limbs[i].joint), spin});
  }
  return out;
}

Scene scene_of(const std::vector<Limb>& limbs) {
  Scene scene;
  scene.gravity = {};
  const std::vector<Motion> motions = motions_of(limbs);
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const std::uint32_t body = add_body(scene, limbs[i].body);
    for (const std::uint32_t k : scene.bodies[body].particles)
      scene.particles[k].velocity =
          motions[i].velocity + cross(motions[i].spin, scene.particles[k].position - limbs[i].body.center);
  }
  for (std::uint32_t i = 1; i < limbs.size(); ++i)
    add_revolute(scene, static_cast<std::uint32_t>(limbs[i].parent), i, limbs[i].joint, limbs[i].axis);
  return scene;
}

}  // namespace plumb::bench
