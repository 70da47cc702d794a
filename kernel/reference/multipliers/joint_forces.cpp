#include "reference/multipliers/joint_forces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/multipliers/small_matrices.hpp"
#include "scene/springs/turn.hpp"

namespace plumb::detail {
namespace {

/// Returns the angle from u to v (rad); of all turns the one nearest to `near`. A shared kernel hides its own
/// arc cosine from this library.
double turn_near(const Across& seen, double near) {
  constexpr double whole = 2 * std::numbers::pi;
  const double turned = std::atan2(dot(seen.axis, cross(seen.u, seen.v)), dot(seen.u, seen.v));
  return turned + whole * std::round((near - turned) / whole);
}

}  // namespace
JointForces::JointForces(const Scene& island, std::uint32_t movable) : movable_(movable) {
  for (const Spring& each : island.springs) ties_.push_back({way(each.a, each.b), each});
  for (const Torsion& each : island.torsions)
    torsions_.push_back({way(each.axis), way(each.u), way(each.v), each});
  for (const AngleControl& each : island.angles) drives_.push_back({way(each.u), way(each.v), each});
  Array<Vec3> x;
  for (const Particle& each : island.particles) x.push_back(each.position);
  follow(x);
}

void JointForces::push(const WeightedSum& at, Vec3 force, Eigen::VectorXd& f) const {
  for (const auto& [particle, weight] : at.terms)
    if (particle < movable_) store3(&f[3 * particle], load3(&f[3 * particle]) + weight * force);
}

void JointForces::follow(std::span<const Vec3> x) {
  for (Turning& each : torsions_)
    each.angle = turn_near(Across(each.axis.of(x), each.u.of(x), each.v.of(x)), each.angle);
}

void JointForces::add(std::span<const Vec3> x, std::span<const Vec3> v, Eigen::VectorXd& f) const {
  for (const Tie& each : ties_) pull(each, x, v, f);
  for (const Turning& each : torsions_) turn(each, x, v, f);
  for (const Driven& each : drives_) drive(each, x, v, f);
}

void JointForces::pull(const Tie& tie, std::span<const Vec3> x, std::span<const Vec3> v,
                       Eigen::VectorXd& f) const {
  const Spring& law = tie.law;
  const Vec3 apart = tie.apart.of(x), parting = tie.apart.of(v);
  const double length = norm(apart);
  const Vec3 along = length > 0 ? (1 / length) * apart : Vec3{};
  if (law.length == 0)
    return push(tie.apart, -1 * (law.stiffness * apart + law.damping * parting + law.force * along), f);
  if (law.one_sided && length <= law.length) return;
  const double pull = law.stiffness * (length - law.length) + law.damping * dot(along, parting) + law.force;
  push(tie.apart, -(law.one_sided ? std::max(pull, 0.0) : pull) * along, f);
}

/// Nothing changes where all three directions turn together, which tells how the axis alone changes the
/// angle.
void JointForces::turn(const Turning& torsion, std::span<const Vec3> x, std::span<const Vec3> v,
                       Eigen::VectorXd& f) const {
  const Torsion& law = torsion.law;
  const Vec3 axis = torsion.axis.of(x), one = torsion.u.of(x), other = torsion.v.of(x);
  const Across seen(axis, one, other);
  const Vec3 by_u = (-1 / dot(seen.u, seen.u)) * cross(seen.axis, seen.u),
             by_v = (1 / dot(seen.v, seen.v)) * cross(seen.axis, seen.v),
             by_axis = (1 / dot(axis, axis)) * cross(axis, cross(one, by_u) + cross(other, by_v));
  const double rate =
      dot(by_u, torsion.u.of(v)) + dot(by_v, torsion.v.of(v)) + dot(by_axis, torsion.axis.of(v));
  const double torque =
      law.stiffness * (law.angle - turn_near(seen, torsion.angle)) - law.damping * rate + law.torque;
  push(torsion.u, torque * by_u, f);
  push(torsion.v, torque * by_v, f);
  push(torsion.axis, torque * by_axis, f);
}

void JointForces::drive(const Driven& angle, std::span<const Vec3> x, std::span<const Vec3> v,
                        Eigen::VectorXd& f) const {
  const AngleControl& law = angle.law;
  const Vec3 one = angle.u.of(x), other = angle.v.of(x), across = cross(one, other);
  const double sine = norm(across), cosine = dot(one, other);
  if (!(sine > 0)) return;
  const Vec3 normal = (1 / sine) * across;
  const Vec3 by_u = (-1 / dot(one, one)) * cross(normal, one),
             by_v = (1 / dot(other, other)) * cross(normal, other);
  const double rate = dot(by_u, angle.u.of(v)) + dot(by_v, angle.v.of(v));
  const double torque = law.stiffness * (law.target - std::atan2(sine, cosine)) - law.damping * rate;
  push(angle.u, torque * by_u, f);
  push(angle.v, torque * by_v, f);
}

}  // namespace plumb::detail
