// These are the passes of the articulated-body algorithm over links that are not rods.

#include "reference/featherstone/articulated_body.hpp"
#include "reference/featherstone/turning.hpp"

namespace plumb::detail {

using Eigen::VectorXd;

/// Turns the links that are not rods into space, parents first.
void ArticulatedBody::place_general(const VectorXd& q, const VectorXd& v) {
  static const General ground{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (const std::uint32_t i : general_links_) {
    const Link& link = links_[i];
    const Node& node = nodes_[i];
    General& general = general_[node.general];
    // The children of a rod are spherical and need nothing of it but where its tip is.
    const bool on_rod = link.parent != Link::base && nodes_[link.parent].general == none;
    const General& parent =
        link.parent == Link::base || on_rod ? ground : general_[nodes_[link.parent].general];
    general.turn_bias = {};
    Vec3 slide{};
    general.arm = parent.rotation * link.place;
    switch (link.joint) {
      case Joint::spherical:
        general.rotation = rotation(load_quaternion(&q[node.q]));
        general.angular_velocity = load3(&v[node.v]);
        general.axis = general.rotation * general.slender;
        break;
      case Joint::revolute: {
        general.axis = parent.rotation * link.axis;
        const Vec3 turn = v[node.v] * general.axis;
        general.rotation = rotation(general.axis, q[node.q]) * parent.rotation;
        general.angular_velocity = parent.angular_velocity + turn;
        general.turn_bias = cross(parent.angular_velocity, turn);
        break;
      }
      case Joint::prismatic:
        general.axis = parent.rotation * link.axis;
        slide = v[node.v] * general.axis;
        general.arm += q[node.q] * general.axis;
        general.rotation = parent.rotation;
        general.angular_velocity = parent.angular_velocity;
        break;
      case Joint::translation:
        general.rotation = parent.rotation;
        general.angular_velocity = {};
        break;
    }
    const Vec3 omega = parent.angular_velocity;
    general.bias = cross(omega, cross(omega, general.arm)) + 2 * cross(omega, slide);
  }
}

/// Starts with the link's own inertia about its joint, and with what its velocity and the force on it make of
/// that.
void ArticulatedBody::start_general(General& general, const Link& link, Vec3 force, Vec3 moment) const {
  const Mat3& r = general.rotation;
  const Sym3 turning = symmetric(r * full(tensor(link.inertia)) * transposed(r));
  const Vec3 c = r * link.center, omega = general.angular_velocity;
  Articulated& own = general.articulated;
  own.a = turning + point_inertia(link.mass, c);
  own.b = link.mass * cross_matrix(c);
  own.m = Sym3::diagonal(link.mass);
  own.f = link.mass * cross(omega, cross(omega, c));
  own.n = cross(omega, turning * omega) + cross(c, own.f);
  own.f -= force;
  own.n -= cross(r * link.grip, force) + moment;
}

/// Adds what a child feels at its joint, `arm` away, where accelerations differ by the biases.
void ArticulatedBody::add_child(General& parent, const Articulated& child, Vec3 arm, Vec3 turn_bias,
                                Vec3 bias) const {
  Articulated& sum = parent.articulated;
  const Mat3 x = cross_matrix(arm), m = full(child.m);
  const Vec3 f = child.f + transposed_times(child.b, turn_bias) + child.m * bias;
  sum.n += child.n + child.a * turn_bias + child.b * bias + cross(arm, f);
  sum.f += f;
  const Mat3 b = child.b + x * m;
  sum.a += symmetric(full(child.a) - b * x + x * transposed(child.b));
  sum.b = sum.b + b;
  sum.m += child.m;
}

/// Hands on to the parent of a spherical joint, which passes on forces alone.
void ArticulatedBody::hand_on(std::uint32_t i, const PointLoad& load) {
  const std::uint32_t p = nodes_[i].parent;
  if (p == Link::base) return;
  if (nodes_[p].general == none) {
    slots_[nodes_[p].slot].load.mass += load.mass;
    slots_[nodes_[p].slot].load.force += load.force;
    return;
  }
  General& parent = general_[nodes_[p].general];
  const Vec3 arm = parent.rotation * links_[i].place, omega = parent.angular_velocity;
  add_child(parent, {.a = {}, .b = {}, .m = load.mass, .n = {}, .f = load.force}, arm, {},
            cross(omega, cross(omega, arm)));
}

void ArticulatedBody::eliminate_general(std::uint32_t i, const BodyLoad& load) {
  const Node& node = nodes_[i];
  General& general = general_[node.general];
  const Articulated& all = general.articulated;
  const auto torque = [&](std::uint32_t k) { return load.torques.empty() ? 0 : load.torques[node.v + k]; };
  switch (links_[i].joint) {
    case Joint::translation:
      general.h = inverse(all.m);
      return;
    case Joint::spherical: {
      // There is no inertia about the axis. Any value will do there, since nothing turns about it.
      general.h = inverse(all.a + outer(trace(all.a), general.axis));
      const Vec3 left = all.n - Vec3{torque(0), torque(1), torque(2)};
      const Mat3 hb{general.h * all.b.x, general.h * all.b.y, general.h * all.b.z};
      hand_on(i,
              {all.m - symmetric(transposed(all.b) * hb), all.f - transposed_times(all.b, general.h * left)});
      return;
    }
    case Joint::revolute:
      general.un = all.a * general.axis;
      general.uf = transposed_times(all.b, general.axis);
      general.over = 1 / dot(general.axis, general.un);
      general.torque = torque(0) - dot(general.axis, all.n);
      break;
    case Joint::prismatic:
      general.un = all.b * general.axis;
      general.uf = all.m * general.axis;
      general.over = 1 / dot(general.axis, general.uf);
      general.torque = torque(0) - dot(general.axis, all.f);
      break;
  }
  if (node.parent == Link::base) return;
  const double q = general.over * general.torque;
  const Articulated up{.a = all.a - outer(general.over, general.un),
                       .b = all.b - outer(general.over * general.un, general.uf),
                       .m = all.m - outer(general.over, general.uf),
                       .n = all.n + q * general.un,
                       .f = all.f + q * general.uf};
  add_child(general_[nodes_[node.parent].general], up, general.arm, general.turn_bias, general.bias);
}

/// Returns the acceleration of the link's joint as the parent carries it. It is not for rods that follow
/// their parent.
Vec3 ArticulatedBody::joint_acceleration(std::uint32_t i, Vec3 base) const {
  const std::uint32_t p = nodes_[i].parent;
  if (p == Link::base) return base;
  if (nodes_[p].general == none) return slots_[nodes_[p].slot].acceleration;
  const General& parent = general_[nodes_[p].general];
  const bool is_rod = nodes_[i].general == none;
  const Vec3 arm = is_rod ? parent.rotation * links_[i].place : general_[nodes_[i].general].arm;
  const Vec3 bias = is_rod ? cross(parent.angular_velocity, cross(parent.angular_velocity, arm))
                           : general_[nodes_[i].general].bias;
  return parent.acceleration + cross(parent.angular_acceleration, arm) + bias;
}

void ArticulatedBody::accelerate_general(std::uint32_t i, const BodyLoad& load, double* out) {
  const Node& node = nodes_[i];
  General& general = general_[node.general];
  const Articulated& all = general.articulated;
  const Vec3 base = load.base_acceleration - load.gravity;
  const auto torque = [&](std::uint32_t k) { return load.torques.empty() ? 0 : load.torques[node.v + k]; };
  Vec3& a = general.acceleration;
  Vec3& alpha = general.angular_acceleration;
  a = joint_acceleration(i, base);
  switch (links_[i].joint) {
    case Joint::translation:
      a = general.h * (Vec3{torque(0), torque(1), torque(2)} - all.f);
      alpha = {};
      store3(out + node.v, a - base);
      return;
    case Joint::spherical:
      alpha = general.h * (Vec3{torque(0), torque(1), torque(2)} - all.n - all.b * a);
      store3(out + node.v, alpha);
      return;
    case Joint::revolute:
    case Joint::prismatic:
      break;
  }
  alpha = general.turn_bias;
  if (node.parent != Link::base) alpha += general_[nodes_[node.parent].general].angular_acceleration;
  const double rate = general.over * (general.torque - dot(general.un, alpha) - dot(general.uf, a));
  out[node.v] = rate;
  (links_[i].joint == Joint::revolute ? alpha : a) += rate * general.axis;
}

}  // namespace plumb::detail
