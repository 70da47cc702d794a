#include "plumb/reference/impact.hpp"

#include <algorithm>
#include <cmath>

#include "scene/refuse.hpp"
#include "scene/second_moments.hpp"

namespace plumb {
namespace {

using detail::refuse;

void require_motion(const RigidMotion& body, const char* name) {
  if (!(body.mass > 0)) refuse("body ", name, ": mass must be positive, got ", body.mass, " kg");
  if (!is_finite(body.center)) refuse("body ", name, ": center of mass is not finite");
  if (!is_finite(body.velocity)) refuse("body ", name, ": velocity is not finite");
  if (!is_finite(body.angular_velocity)) refuse("body ", name, ": angular velocity is not finite");
}

void require_impact(const RigidMotion& a, const RigidMotion& b, Vec3 normal, double restitution) {
  require_motion(a, "a");
  require_motion(b, "b");
  if (std::isinf(a.mass) && std::isinf(b.mass)) refuse("bodies a and b: both masses are infinite");
  if (!(std::abs(norm(normal) - 1) <= 1e-9)) refuse("normal must be of length 1, not ", norm(normal));
  if (!(restitution >= 0 && restitution <= 1)) refuse("restitution must be from 0 to 1, got ", restitution);
}

/// Returns the inverse inertia. It is zero for a body of infinite mass, which nothing turns.
detail::Sym3 inverse_inertia(const RigidMotion& body, const char* name) {
  if (std::isinf(body.mass)) return {};
  const Inertia& i = body.inertia;
  if (!detail::is_finite(i)) refuse("body ", name, ": inertia is not finite");
  const double minor = i.xx * i.yy - i.xy * i.xy;
  const double determinant = i.zz * minor - i.xx * i.yz * i.yz - i.yy * i.xz * i.xz + 2 * i.xy * i.xz * i.yz;
  if (!(i.xx > 0 && minor > 0 && determinant > 0))
    refuse("body ", name, ": inertia is not positive definite");
  return inverse(detail::Sym3{i.xx, i.xy, i.xz, i.yy, i.yz, i.zz});
}

/// Holds what an impulse of 1 kg m/s along the normal changes, in m/s and rad/s.
struct Response {
  double speed;
  Vec3 spin;
  double at_contact;  ///< Velocity along the normal of what is there, in m/s.
};
Response response(const RigidMotion& body, Vec3 contact, Vec3 normal, const char* name) {
  const Vec3 arm = contact - body.center;
  const Vec3 spin = inverse_inertia(body, name) * cross(arm, normal);
  return {1 / body.mass, spin, 1 / body.mass + dot(cross(spin, arm), normal)};
}

/// Returns the impulse that turns the velocity `apart` of a against b, along the normal, into -restitution
/// times it.
double impulse_of(double apart, double restitution, double given_way) {
  return std::max(-(1 + restitution) * apart / given_way, 0.0);
}

struct Impact {
  Response a, b;
  double impulse;
};
Impact impact(const RigidMotion& a, const RigidMotion& b, Vec3 contact, Vec3 normal, double restitution) {
  require_impact(a, b, normal, restitution);
  if (!is_finite(contact)) refuse("contact is not finite");
  const Response of_a = response(a, contact, normal, "a"), of_b = response(b, contact, normal, "b");
  const double apart = dot(velocity_at(a, contact) - velocity_at(b, contact), normal);
  return {of_a, of_b, impulse_of(apart, restitution, of_a.at_contact + of_b.at_contact)};
}

}  // namespace

Vec3 velocity_at(const RigidMotion& body, Vec3 place) {
  return body.velocity + cross(body.angular_velocity, place - body.center);
}

double impulse(const RigidMotion& a, const RigidMotion& b, Vec3 normal, double restitution) {
  require_impact(a, b, normal, restitution);
  return impulse_of(dot(a.velocity - b.velocity, normal), restitution, 1 / a.mass + 1 / b.mass);
}

double impulse(const RigidMotion& a, const RigidMotion& b, Vec3 contact, Vec3 normal, double restitution) {
  return impact(a, b, contact, normal, restitution).impulse;
}

void collide(RigidMotion& a, RigidMotion& b, Vec3 normal, double restitution) {
  const double j = impulse(a, b, normal, restitution);
  a.velocity += (j / a.mass) * normal;
  b.velocity -= (j / b.mass) * normal;
}

void collide(RigidMotion& a, RigidMotion& b, Vec3 contact, Vec3 normal, double restitution) {
  const auto [of_a, of_b, j] = impact(a, b, contact, normal, restitution);
  a.velocity += j * of_a.speed * normal;
  a.angular_velocity += j * of_a.spin;
  b.velocity -= j * of_b.speed * normal;
  b.angular_velocity -= j * of_b.spin;
}

}  // namespace plumb
