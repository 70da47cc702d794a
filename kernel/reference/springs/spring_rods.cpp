// This file holds the thesis's own springs (§4.4.1). Every rod is a rigid body (§2.2.3 to 2.2.6). It has a
// position of its centre of mass, an orientation as a unit quaternion, a velocity and an angular velocity.
// Joints are springs of length zero, damped, between the ends of rods that meet, and between ends and
// anchors.
//
// Where k rods meet at a movable particle, k - 1 springs hold their ends to that of the first rod in the
// scene's order. In a chain written from its root that is the inboard one. At a fixed particle every end has
// a spring to the anchor. A particle's own mass is split evenly among the ends that meet there.
//
// Bodies are slender: forces act on the axis, so that none turns a rod about it. That freedom is left out,
// and angular velocities stay perpendicular to the axis. With one inertia I about all perpendiculars the law
// of motion is I dω/dt = torque, without a gyroscopic term.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "reference/springs/springs.hpp"
#include "scene/project_velocities.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

/// A rod counts as having its mass in one point below this share of mass · length², which is the size of
/// rounding.
constexpr double least_inertia = 1e-14;

struct Body {
  double mass = 0;              ///< Mass, in kg.
  double inertia = 0;           ///< About the centre of mass, across the rod, in kg m².
  double reach[2] = {0, 0};     ///< From the centre of mass to ends a and b along the rod, in m.
  double end_mass[2] = {0, 0};  ///< The mass as points at the ends with the same centre, in kg.
};

/// Returns how many rods meet at every particle.
Array<std::uint32_t> count_rods(const Scene& scene) {
  Array<std::uint32_t> counts(scene.particles.size());
  for (const Rod& rod : scene.rods) {
    ++counts[rod.a];
    ++counts[rod.b];
  }
  return counts;
}

/// Makes the body of a rod, from its mass matrix with the ends' shares of point mass.
///
/// The end at a fixed particle gets as large a point mass as the other one has. It stands still but for the
/// spring's give, so the motion of stiff joints is the scene's. A massless rod whose only mass is at the
/// other end can then turn about its centre of mass as any other.
Body body_of(const Scene& scene, std::size_t r, MassModel model, const Array<std::uint32_t>& rods_at) {
  const Rod& rod = scene.rods[r];
  RodMass mass = rod_mass(scene, r, model);
  const auto share = [&](std::uint32_t particle, std::uint32_t other) {
    const std::uint32_t from = scene.particles[particle].fixed ? other : particle;
    return scene.particles[from].mass / rods_at[from];
  };
  mass.aa += share(rod.a, rod.b);
  mass.bb += share(rod.b, rod.a);
  const double length = rod_length(scene, r);
  Body body;
  body.mass = mass.aa + 2 * mass.ab + mass.bb;
  if (!(body.mass > 0)) return body;
  body.end_mass[0] = mass.aa + mass.ab;
  body.end_mass[1] = mass.ab + mass.bb;
  body.reach[0] = -length * body.end_mass[1] / body.mass;
  body.reach[1] = length * body.end_mass[0] / body.mass;
  body.inertia = length * length * ((mass.aa * mass.bb - mass.ab * mass.ab) / body.mass);
  return body;
}

/// Returns the quaternion (w, x, y, z) of the shortest turn that takes the x axis to `along`, or half a turn
/// about z if the two are opposite.
///
/// Eigen has it too. It finds the axis of half a turn by singular values, which take longer to compile than
/// all else here.
Vector4d turn_from_x(const Vector3d& along) {
  const Vector3d unit = along.normalized();
  const double x = unit.x(), y = unit.y(), z = unit.z();
  // The value is 1 + x. Near x = -1 the plain sum would be all rounding.
  const double one_plus_x = x < -0.5 ? (y * y + z * z) / (1 - x) : 1 + x;
  if (one_plus_x == 0) return {0, 0, 0, 1};
  const double twice_w = std::sqrt(2 * one_plus_x), inverse = 1 / twice_w;
  return {twice_w * 0.5, 0, -z * inverse, y * inverse};
}

class SpringRods final : public SpringSystem {
 public:
  SpringRods(const Scene& island, const Settings& settings)
      : SpringSystem(island, settings), ends_(island.particles.size()), end_mass_(island.particles.size()) {
    const Array<std::uint32_t> rods_at = count_rods(island);
    for (std::uint32_t r = 0; r < island.rods.size(); ++r) {
      bodies_.push_back(body_of(island, r, mass_model_of(settings), rods_at));
      ends_[island.rods[r].a].push_back({r, 0});
      ends_[island.rods[r].b].push_back({r, 1});
    }
    for (std::uint32_t i = 0; i < ends_.size(); ++i) {
      if (ends_[i].empty() && !island.particles[i].fixed) add_point(i);
      for (const End end : ends_[i]) end_mass_[i] += bodies_[end.body].end_mass[end.side];
      add_joints(i);
    }
    masses_.resize(6 * size());
    for (Index i = 0; i < size(); ++i) {
      masses_.segment<3>(6 * i).setConstant(bodies_[static_cast<std::size_t>(i)].mass);
      masses_.segment<3>(6 * i + 3).setConstant(bodies_[static_cast<std::size_t>(i)].inertia);
    }
  }

  MechanicalState initial_state(const Drive&) const override {
    const std::vector<Particle>& particles = scene().particles;
    // A rigid rod has no place for velocities that would stretch it.
    std::vector<double> inverse_masses = lumped_masses(scene());
    for (double& mass : inverse_masses) mass = 1 / mass;
    Array<Vec3> velocities;
    velocities.reserve(particles.size());
    for (const Particle& particle : particles)
      velocities.push_back(particle.fixed ? Vec3{} : particle.velocity);
    project_velocities(scene(), inverse_masses, velocities);

    MechanicalState state{VectorXd::Zero(7 * size()), VectorXd::Zero(6 * size())};
    for (Index i = 0; i < size(); ++i) state.q[7 * i + 3] = 1;
    for (std::uint32_t i = 0; i < ends_.size(); ++i)
      if (ends_[i].size() == 1 && ends_[i].front().body >= scene().rods.size()) {
        state.q.segment<3>(7 * Index(ends_[i].front().body)) = to_eigen(particles[i].position);
        state.v.segment<3>(6 * Index(ends_[i].front().body)) = to_eigen(velocities[i]);
      }
    for (std::size_t r = 0; r < scene().rods.size(); ++r) {
      const Rod& rod = scene().rods[r];
      const auto row = static_cast<Index>(r);
      const Vector3d a = to_eigen(particles[rod.a].position), b = to_eigen(particles[rod.b].position);
      const Vector3d va = to_eigen(velocities[rod.a]), vb = to_eigen(velocities[rod.b]);
      const double length = rod_length(scene(), r), toward_b = bodies_[r].end_mass[1] / bodies_[r].mass;
      const Vector3d along = (b - a).squaredNorm() > 0 ? Vector3d((b - a).normalized()) : Vector3d::UnitX();
      state.q.segment<3>(7 * row) = (1 - toward_b) * a + toward_b * b;
      state.q.segment<4>(7 * row + 3) = turn_from_x(along);
      state.v.segment<3>(6 * row) = (1 - toward_b) * va + toward_b * vb;
      state.v.segment<3>(6 * row + 3) = along.cross(vb - va) / length;
    }
    return state;
  }

  /// Gives dq/dt = ½ (0, ω) q for the quaternion q of an orientation, with ω in the world's axes.
  void rates(const MechanicalState& state, VectorXd& out) const override {
    out.resize(7 * size());
    for (Index i = 0; i < size(); ++i) {
      const Vector3d spin = state.v.segment<3>(6 * i + 3), vec = state.q.segment<3>(7 * i + 4);
      const double w = state.q[7 * i + 3];
      out.segment<3>(7 * i) = state.v.segment<3>(6 * i);
      out[7 * i + 3] = -0.5 * spin.dot(vec);
      out.segment<3>(7 * i + 4) = 0.5 * (w * spin + spin.cross(vec));
    }
  }

  /// Restores unit quaternions and takes spin about an axis away: both drift by the integrator's error.
  void settle(MechanicalState& state, const Drive&, double) override {
    for (Index i = 0; i < size(); ++i) {
      state.q.segment<4>(7 * i + 3).normalize();
      const Vector3d along = axis(state, i);
      state.v.segment<3>(6 * i + 3) -= along.dot(state.v.segment<3>(6 * i + 3)) * along;
    }
  }

  Index body_size() const override { return 6; }

  void find_forces(const MechanicalState& state, const Drive& drive, double t, VectorXd& out) override {
    const Vector3d gravity = to_eigen(scene().gravity);
    out.resize(masses_.size());
    out = -scene().drag * masses_.cwiseProduct(state.v);
    for (Index i = 0; i < size(); ++i) out.segment<3>(6 * i) += masses_[6 * i] * gravity;
    const auto push = [&](End end, const Vector3d& force) {
      out.segment<3>(6 * Index(end.body)) += force;
      out.segment<3>(6 * Index(end.body) + 3) += arm(state, end).cross(force);
    };
    for (std::uint32_t i = 0; i < ends_.size(); ++i) {
      if (drive.forces[i] == Vec3{}) continue;
      for (const End end : ends_[i]) push(end, weight(i, end) * to_eigen(drive.forces[i]));
    }
    for (const Joint& joint : joints_) {
      const Vector3d force = pull(joint, state, drive, t);
      push(joint.outer, force);
      if (!joint.to_anchor) push(joint.inner, -force);
    }
  }

  void linearize(const MechanicalState& state, const Drive& drive, double t, Linearization& out) override {
    out.springs.resize(joints_.size());
    out.turning.setZero(size());
    const auto turn = [&](End end, const Vector3d& force) {
      // A force f on the end u s of an axis u changes its torque by -s (u·f) dθ when the axis turns by dθ.
      out.turning[end.body] += arm(state, end).dot(force);
    };
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const Joint& joint = joints_[i];
      LinearSpring& spring = out.springs[i];
      const Vector3d force = pull(joint, state, drive, t);
      spring.a = joint.outer.body;
      spring.arm_a = arm(state, joint.outer);
      turn(joint.outer, force);
      if (!joint.to_anchor) {
        spring.b = joint.inner.body;
        spring.arm_b = arm(state, joint.inner);
        turn(joint.inner, -force);
      }
      spring.stiffness = settings().springs.stiffness * Matrix3d::Identity();
      spring.damping = joint.damping * Matrix3d::Identity();
    }
    out.turning = out.turning.cwiseMax(0);
  }

  double energy(const MechanicalState& state, const Drive& drive) const override {
    double sum = 0.5 * state.v.cwiseAbs2().dot(masses_);
    for (Index i = 0; i < size(); ++i)
      sum -= masses_[6 * i] * to_eigen(scene().gravity).dot(state.q.segment<3>(7 * i));
    for (const Joint& joint : joints_)
      sum += 0.5 * settings().springs.stiffness * gap(joint, state, drive, 0).squaredNorm();
    return sum;
  }

  void report(const MechanicalState& state, const Drive& drive, StepReport& out) override {
    SpringSystem::report(state, drive, out);
    double squares = 0;
    for (const Joint& joint : joints_) {
      const double square = gap(joint, state, drive, 0).squaredNorm();
      squares += square;
      out.largest_gap = std::max(out.largest_gap, std::sqrt(square));
    }
    if (!joints_.empty())
      out.rms_gap = std::max(out.rms_gap, std::sqrt(squares / static_cast<double>(joints_.size())));
  }

  Vec3 position(const MechanicalState& state, std::uint32_t particle) const override {
    Vector3d sum{0, 0, 0};
    for (const End end : ends_[particle])
      sum += weight(particle, end) * (state.q.segment<3>(7 * Index(end.body)) + arm(state, end));
    return to_vec3(sum);
  }
  Vec3 velocity(const MechanicalState& state, std::uint32_t particle) const override {
    Vector3d sum{0, 0, 0};
    for (const End end : ends_[particle]) sum += weight(particle, end) * end_velocity(state, end);
    return to_vec3(sum);
  }

 private:
  struct End {
    std::uint32_t body = 0;
    std::uint32_t side = 0;  ///< 0 is end a of a rod, 1 is end b.
  };
  struct Joint {
    std::uint32_t particle = 0;
    End outer{}, inner{};
    bool to_anchor = false;
    double damping = 0;  ///< damping, N s/m
  };

  Index size() const { return static_cast<Index>(bodies_.size()); }

  /// Makes the body of a particle without rods. Nothing ever turns it, so its inertia only has to be a
  /// number.
  void add_point(std::uint32_t particle) {
    const double mass = scene().particles[particle].mass;
    ends_[particle].push_back({static_cast<std::uint32_t>(bodies_.size()), 0});
    bodies_.push_back({.mass = mass, .inertia = mass, .end_mass = {mass, 0}});
  }

  void add_joints(std::uint32_t particle) {
    const bool fixed = scene().particles[particle].fixed;
    const Array<End>& ends = ends_[particle];
    for (std::size_t i = fixed ? 0 : 1; i < ends.size(); ++i) {
      const double inner_mass =
          fixed ? std::numeric_limits<double>::infinity() : bodies_[ends.front().body].mass;
      joints_.push_back({particle, ends[i], ends.front(), fixed,
                         spring_damping(settings().springs, bodies_[ends[i].body].mass, inner_mass)});
    }
  }

  /// Gives the share of a particle's position, force and mass that an end has.
  double weight(std::uint32_t particle, End end) const {
    return bodies_[end.body].end_mass[end.side] / end_mass_[particle];
  }

  /// Gives the direction of the body's x axis, of length one even between settlings.
  Vector3d axis(const MechanicalState& state, Index body) const {
    const auto q = state.q.segment<4>(7 * body + 3);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    return Vector3d(w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)) /
           (w * w + x * x + y * y + z * z);
  }
  Vector3d arm(const MechanicalState& state, End end) const {
    return bodies_[end.body].reach[end.side] * axis(state, end.body);
  }
  Vector3d end_velocity(const MechanicalState& state, End end) const {
    return state.v.segment<3>(6 * Index(end.body)) +
           state.v.segment<3>(6 * Index(end.body) + 3).cross(arm(state, end));
  }

  /// Gives the gap: from the outer end to where it should be, in m.
  Vector3d gap(const Joint& joint, const MechanicalState& state, const Drive& drive, double t) const {
    const Vector3d outer = state.q.segment<3>(7 * Index(joint.outer.body)) + arm(state, joint.outer);
    if (joint.to_anchor) return to_eigen(drive.anchor(joint.particle, t)) - outer;
    return state.q.segment<3>(7 * Index(joint.inner.body)) + arm(state, joint.inner) - outer;
  }
  /// Gives the force on the outer end, in N (thesis eq. 3.11 with d = 0, and damping).
  Vector3d pull(const Joint& joint, const MechanicalState& state, const Drive& drive, double t) const {
    const Vector3d inner_velocity = joint.to_anchor ? to_eigen(drive.anchor_velocities[joint.particle])
                                                    : end_velocity(state, joint.inner);
    return settings().springs.stiffness * gap(joint, state, drive, t) +
           joint.damping * (inner_velocity - end_velocity(state, joint.outer));
  }

  Array<Body> bodies_;      ///< Bodies of the rods, then of particles without any.
  Array<Array<End>> ends_;  ///< Ends that meet at every particle, in the order of the rods.
  Array<double> end_mass_;  ///< Sum of the ends' masses at every particle, in kg.
  Array<Joint> joints_;
};

}  // namespace

std::unique_ptr<SpringSystem> make_spring_rods(const Scene& island, const Settings& settings) {
  return std::make_unique<SpringRods>(island, settings);
}

void require_spring_bodies(const Scene& scene, const Settings& settings) {
  if (settings.springs.model != SpringModel::rigid_rods) return;
  const Array<std::uint32_t> rods_at = count_rods(scene);
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Body body = body_of(scene, r, mass_model_of(settings), rods_at);
    const double length = rod_length(scene, r);
    if (body.inertia > least_inertia * body.mass * length * length) continue;
    refuse("rod ", r, ": has no inertia to turn by as a rigid body, since ",
           body.mass > 0 ? "all of its mass is in one point" : "neither it nor its particles have mass",
           "; springs between particles take it");
  }
}

}  // namespace plumb::detail
