// This file describes a world as it is now, as a scene.

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "contact/platforms/platforms.hpp"
#include "contact/surroundings.hpp"
#include "plumb/joints.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/barycentric.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/rod_table.hpp"
#include "step/world_impl.hpp"

namespace plumb {
namespace detail {
namespace {

/// What is out but has mass along it, which joins its ends, goes on as a rod that pulls next to nothing
/// (N/m).
constexpr double faint = 1e-30;

/// Lets a body be where its particles are (m), with the mass matrix that it has. Where sweeps have left a
/// strain, its mass is strained alike.
void move(Body& body, const std::array<std::array<double, 4>, 4>& mass, const std::array<Vec3, 4>& at) {
  body.center = {};
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < 4; ++k) body.center += (mass[j][k] / body.mass) * at[j];
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;  // second moments, kg m²
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 a = mass[j][k] * (at[j] - body.center), b = at[k] - body.center;
      xx += a.x * b.x;
      yy += a.y * b.y;
      zz += a.z * b.z;
      xy += a.x * b.y;
      xz += a.x * b.z;
      yz += a.y * b.z;
    }
  body.inertia = {yy + zz, xx + zz, xx + yy, -xy, -xz, -yz};
}

/// Copies what there is of a world, with new numbers.
class Present {
 public:
  explicit Present(const Step& step) : step_(step), all_(step.scene()), there_(step.population()) {}

  Scene make(std::span<const Pose> platforms) {
    out_ = {};
    out_.gravity = step_.gravity();
    out_.drag = step_.drag();
    out_.joint_drag = step_.joint_drag();
    copy_particles();
    copy_rods();
    copy_elements();
    copy_bodies();
    copy_joints();
    copy_shapes();
    copy_ground(platforms);
    return std::move(out_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  /// Calls f(i, item) with copies of those of a list that there are, whose particles have their new numbers.
  template <class Item, class F>
  void for_those(const std::vector<Item>& list, const Numbers& numbers, F&& f) {
    for (std::uint32_t i = 0; i < list.size(); ++i) {
      if (!numbers.has(i)) continue;
      Item item = list[i];
      for_particles(item, [&](std::uint32_t& particle) {
        particle = particle < particles_.size() && particles_[particle] != none ? particles_[particle] : 0;
      });
      f(i, item);
    }
  }

  void copy_particles() {
    particles_.assign(all_.particles.size(), none);
    for_those(all_.particles, there_.particles, [&](std::uint32_t i, Particle& particle) {
      particles_[i] = static_cast<std::uint32_t>(out_.particles.size());
      particle.position = step_.position(i);
      particle.fixed = step_.is_fixed(i);
      particle.velocity = particle.fixed ? Vec3{} : step_.velocity(i);
      particle.mass = step_.breaks().own_mass(i) + step_.breaks().taken_mass(i);
      particle.asleep = false;
      out_.particles.push_back(particle);
    });
  }

  void copy_rods() {
    for_those(all_.rods, there_.rods, [&](std::uint32_t i, Rod& rod) {
      if (step_.waits<Rod>(i) || (out_.particles[rod.a].fixed && out_.particles[rod.b].fixed)) return;
      wind(rod, rod_length(all_, i), step_.length(i));
      const bool is_taken = step_.breaks().is_taken(i);
      if (is_taken || (step_.is_broken(i) && !step_.is_ordered(i))) {
        const RodMass mass = rod_mass(all_, i, mass_model_of(step_.settings()));
        if (mass.ab == 0) {
          if (!is_taken) out_.particles[rod.a].mass += mass.aa;
          if (!is_taken) out_.particles[rod.b].mass += mass.bb;
          return;
        }
        rod.law = {.stiffness = faint};
      }
      out_.rods.push_back(rod);
    });
  }

  void copy_elements() {
    const RodTable rods(out_, [&](std::size_t i) { return out_.rods[i].law.stiffness != faint; });
    for_those(all_.bends, there_.bends, [&](std::uint32_t i, const Bend& bend) {
      if (!step_.breaks().has_ended(i) && !lacks_rod(out_, rods, particles_of(bend)))
        out_.bends.push_back(bend);
    });
    for_those(all_.tackles, there_.tackles, [&](std::uint32_t i, Tackle& tackle) {
      tackle.length = step_.length(step_.tackle_cord(i));
      out_.tackles.push_back(tackle);
    });
    const auto rename = [&](std::vector<std::uint32_t>& chain) {
      for (std::uint32_t& particle : chain) particle = particles_[particle];
    };
    for (std::uint32_t i = 0; i < all_.twists.size(); ++i) {
      Twist twist = all_.twists[i];
      rename(twist.particles);
      twist.angle = step_.twist(i);
      if (!lacks_rod(out_, rods, twist.particles)) out_.twists.push_back(std::move(twist));
    }
    for (std::uint32_t i = 0; i < all_.reels.size(); ++i) {
      Reel reel = all_.reels[i];
      rename(reel.particles);
      reel.out = step_.length(step_.reel_cord(i));
      out_.reels.push_back(std::move(reel));
    }
  }

  std::array<Vec3, 4> positions_of(const std::array<std::uint32_t, 4>& particles) const {
    std::array<Vec3, 4> out;
    for (std::size_t k = 0; k < 4; ++k) out[k] = step_.position(particles[k]);
    return out;
  }

  void copy_bodies() {
    bodies_.assign(all_.bodies.size(), none);
    for_those(all_.bodies, there_.bodies, [&](std::uint32_t i, Body& body) {
      bodies_[i] = static_cast<std::uint32_t>(out_.bodies.size());
      move(body, body_mass(all_, i), positions_of(all_.bodies[i].particles));
      out_.bodies.push_back(body);
    });
  }

  void copy_joints() {
    for_those(all_.pins, there_.pins, [&](std::uint32_t i, const Pin& pin) {
      if (!step_.waits<Pin>(i)) out_.pins.push_back(pin);
    });
    for_those(all_.alignments, there_.alignments, [&](std::uint32_t i, const Alignment& each) {
      if (!step_.waits<Alignment>(i)) out_.alignments.push_back(each);
    });
    const auto copy = [&](const auto& from, const Numbers& numbers, auto& to) {
      for_those(from, numbers, [&](std::uint32_t i, auto& item) {
        if (step_.waits<std::remove_cvref_t<decltype(item)>>(i)) return;
        step_.contact().read_law(i, item);
        to.push_back(item);
      });
    };
    copy(all_.angles, there_.angles, out_.angles);
    copy(all_.springs, there_.springs, out_.springs);
    copy(all_.torsions, there_.torsions, out_.torsions);
  }

  void copy_shapes() {
    for_those(all_.capsules, there_.capsules, [&](std::uint32_t i, Capsule& capsule) {
      if (!step_.has_shape({ShapeKind::capsule, i})) return;
      if (const auto middle = step_.middle_of(i)) capsule.a = capsule.b = point_at(particles_[*middle]);
      out_.capsules.push_back(capsule);
    });
    for_those(all_.hulls, there_.hulls, [&](std::uint32_t i, Hull& hull) {
      if (!step_.has_shape({ShapeKind::hull, i})) return;
      const auto& four = all_.bodies[hull.body].particles;
      const std::array<Vec3, 4> are = positions_of(four);
      std::array<Vec3, 4> were;
      for (std::size_t k = 0; k < 4; ++k) were[k] = all_.particles[four[k]].position;
      const Barycentric places(were);
      for (Vec3& point : hull.points) point = weighted(places.weights(point), are);
      hull.body = bodies_[hull.body];
      out_.hulls.push_back(std::move(hull));
    });
  }

  /// Ground is described as it is while platforms have the poses of a scene, which are those of now.
  void copy_ground(std::span<const Pose> poses) {
    const Scene& first = step_.first_scene();
    out_.planes = first.planes;
    out_.boxes = first.boxes;
    out_.platforms.assign(poses.begin(), poses.end());
    out_.ground_capsules = first.ground_capsules;
    out_.ground_hulls = first.ground_hulls;
    out_.meshes = first.meshes;
    out_.height_fields = first.height_fields;
    Platforms platforms(first);
    for (std::uint32_t i = 0; i < poses.size(); ++i) platforms.set_target(i, poses[i]);
    platforms.end_step();
    for (Plane& plane : out_.planes) {
      if (!plane.motion.platform) continue;
      const PlatformPose now = platforms.at(*plane.motion.platform, 0);
      plane = posed(plane, now);
      plane.motion.belt = now.direction(plane.motion.belt);
    }
    for (Box& box : out_.boxes) {
      if (!box.motion.platform) continue;
      const std::uint32_t number = *box.motion.platform;
      const PlatformPose now = platforms.at(number, 0);
      if (now.is_home) continue;
      box.center = now.place(box.center);
      const Quaternion turn =
          product(poses[number].orientation, conjugate(first.platforms[number].orientation));
      box.orientation = product(turn, box.orientation);
      box.motion.belt = now.direction(box.motion.belt);
    }
  }

  const Step& step_;
  const Scene& all_;
  const Population& there_;
  Scene out_;
  Array<std::uint32_t> particles_, bodies_;  ///< by number in the world: that in the scene
};

}  // namespace
}  // namespace detail

Scene World::scene() const {
  if (!impl_->step->has_archive())
    detail::refuse("scene: springs, multipliers and featherstone describe none; relax, direct and auto do");
  return detail::Present(*impl_->step).make(impl_->platforms);
}

}  // namespace plumb
