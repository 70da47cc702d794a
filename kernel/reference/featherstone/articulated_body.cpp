#include "reference/featherstone/articulated_body.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace plumb::detail {
namespace {

using Eigen::VectorXd;

struct Quaternion {
  double w;
  Vec3 v;
};
Quaternion load_quaternion(const double* q) {
  return {q[0], {q[1], q[2], q[3]}};
}
double norm2(const Quaternion& q) {
  return q.w * q.w + dot(q.v, q.v);
}
/// Of a quaternion of any length, so that the stages of an integrator need not keep it at one.
Mat3 rotation(const Quaternion& q) {
  const double s = 2 / norm2(q);
  const Vec3 v = q.v;
  return {{1 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y + q.w * v.z), s * (v.x * v.z - q.w * v.y)},
          {s * (v.x * v.y - q.w * v.z), 1 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z + q.w * v.x)},
          {s * (v.x * v.z + q.w * v.y), s * (v.y * v.z - q.w * v.x), 1 - s * (v.x * v.x + v.y * v.y)}};
}
/// Where it takes x; `s` is 2 / norm2(q).
Vec3 first_axis(const Quaternion& q, double s) {
  const Vec3 v = q.v;
  return {1 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y + q.w * v.z), s * (v.x * v.z - q.w * v.y)};
}
/// Rodrigues' formula.
Mat3 rotation(Vec3 axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Mat3 one{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return c * one + s * cross_matrix(axis) + (1 - c) * outer(axis, axis);
}

Sym3 tensor(const Inertia& i) {
  return {i.xx, i.xy, i.xz, i.yy, i.yz, i.zz};
}
/// m (|c|² - c cᵀ).
Sym3 point_inertia(double mass, Vec3 c) {
  return Sym3::diagonal(mass * dot(c, c)) - outer(mass, c);
}

std::uint32_t count_coordinates(Joint joint) {
  switch (joint) {
    case Joint::revolute:
    case Joint::prismatic:
      return 1;
    case Joint::spherical:
      return 4;
    case Joint::translation:
      break;
  }
  return 3;
}
std::uint32_t count_speeds(Joint joint) {
  return joint == Joint::spherical ? 3 : count_coordinates(joint);
}

}  // namespace

ArticulatedBody::ArticulatedBody(std::vector<Link> links) : links_(std::move(links)) {
  for (std::uint32_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    if (link.parent != Link::base && link.parent >= i)
      throw std::invalid_argument("link " + std::to_string(i) + ": its parent must come before it");
    if (link.joint == Joint::translation && link.parent != Link::base)
      throw std::invalid_argument("link " + std::to_string(i) + ": a translation must be on the base");
    nodes_.push_back({.mass = link.mass,
                      .first = link.mass * link.center.x,
                      .second = link.inertia.yy + link.mass * link.center.x * link.center.x,
                      .tip = link.grip.x,
                      .q = static_cast<std::uint32_t>(coordinates_),
                      .v = static_cast<std::uint32_t>(speeds_),
                      .parent = link.parent,
                      .slot = none,
                      .general = none,
                      .joint = link.joint,
                      .follows = false});
    coordinates_ += count_coordinates(link.joint);
    speeds_ += count_speeds(link.joint);
  }
  rods_.resize(links_.size());
  find_kinds();
}

/// Whether it is slender along x, so that the passes need only its direction.
bool ArticulatedBody::is_rod(std::uint32_t i) const {
  const Link& link = links_[i];
  const auto along_x = [](Vec3 v) { return v.y == 0 && v.z == 0; };
  const Inertia& own = link.inertia;
  return link.joint == Joint::spherical && along_x(link.center) && along_x(link.grip) && own.xx == 0 &&
         own.xy == 0 && own.xz == 0 && own.yz == 0 && own.yy == own.zz &&
         (nodes_[i].second > 0 || link.grip.x != 0);
}

/// Whether the link has no inertia about an axis through its joint, and which.
bool ArticulatedBody::is_slender(std::uint32_t i, Vec3& axis) const {
  const Link& link = links_[i];
  if (link.joint != Joint::spherical) return false;
  const Sym3 own = tensor(link.inertia) + point_inertia(link.mass, link.center);
  Eigen::Matrix3d matrix;
  matrix << own.xx, own.xy, own.xz, own.xy, own.yy, own.yz, own.xz, own.yz, own.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  constexpr double rounding = 1e-14;
  if (solver.eigenvalues()[2] == 0 || solver.eigenvalues()[0] > rounding * solver.eigenvalues()[2])
    return false;
  const Eigen::Vector3d along = solver.eigenvectors().col(0);
  axis = load3(along.data());
  return true;
}

void ArticulatedBody::find_kinds() {
  const auto n = static_cast<std::uint32_t>(links_.size());
  std::vector<Vec3> axis(n);
  std::vector<std::uint8_t> slender(n), rod(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    rod[i] = is_rod(i);
    slender[i] = rod[i] || is_slender(i, axis[i]);
    if (rod[i]) axis[i] = {1, 0, 0};
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const Link& link = links_[i];
    if (link.parent == Link::base) continue;
    const std::uint32_t p = link.parent;
    const bool is_free = link.joint == Joint::spherical;
    slender[p] = slender[p] && is_free && norm(cross(axis[p], link.place)) <= 1e-14 * norm(link.place);
    rod[p] = rod[p] && is_free && link.place == links_[p].grip;
  }
  std::uint32_t slots = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!rod[i]) {
      nodes_[i].general = static_cast<std::uint32_t>(general_.size());
      general_.emplace_back();
      if (slender[i]) general_.back().slender = axis[i];
      general_links_.push_back(i);
    }
    const std::uint32_t p = links_[i].parent;
    if (p == Link::base || !rod[p]) continue;
    nodes_[i].follows = rod[i] && p + 1 == i;
    if (!nodes_[i].follows && nodes_[p].slot == none) nodes_[p].slot = slots++;
  }
  slots_.resize(slots);
}

/// Turns the links that are not rods into space, parents first.
void ArticulatedBody::place_general(const VectorXd& q, const VectorXd& v) {
  static const General ground{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (const std::uint32_t i : general_links_) {
    const Link& link = links_[i];
    const Node& node = nodes_[i];
    General& general = general_[node.general];
    // A rod's children are spherical, and need nothing of it.
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

/// Its own inertia about its joint and what its velocity and the force on it make of it.
void ArticulatedBody::start_general(General& general, const Link& link, Vec3 force) const {
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
  own.n -= cross(r * link.grip, force);
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

/// To the parent of a spherical joint, which passes on forces alone.
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
      // Without inertia about the axis: any at all will do, since nothing turns about it.
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

/// Of the link's joint as the parent carries it. Not for rods that follow their parent.
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

void ArticulatedBody::accelerations(const VectorXd& q, const VectorXd& v, const BodyLoad& load,
                                    VectorXd& out) {
  out.resize(speeds_);
  place_general(q, v);
  const auto force_on = [&](std::uint32_t i) { return load.forces.empty() ? Vec3{} : load.forces[i]; };
  for (const std::uint32_t i : general_links_)
    start_general(general_[nodes_[i].general], links_[i], force_on(i));
  for (Slot& slot : slots_) slot.load = {};

  // Tips to base. For a rod of direction u, P = 1 - u uᵀ, that carries mass M and force f at its tip: its
  // direction accelerates by beta across and -|u'|² u along it, its tip by a + L (beta - |u'|² u), so that
  //
  //   (second P + L² P M P) beta + P (first + L M) a + L P (f - L |u'|² M u) = 0
  //
  // and its joint feels (mass + M) a + (first + L M) beta + f - |u'|² (first + L M) u.
  PointLoad carried;  // from i + 1, if it follows
  for (auto i = static_cast<std::uint32_t>(nodes_.size()); i-- > 0;) {
    const Node& node = nodes_[i];
    if (node.general != none) {
      eliminate_general(i, load);
      continue;
    }
    PointLoad tip = carried;
    carried = {};
    if (node.slot != none) {
      tip.mass += slots_[node.slot].load.mass;
      tip.force += slots_[node.slot].load.force;
    }
    if (!load.forces.empty()) tip.force -= load.forces[i];
    const double length = node.tip;
    RodWork& work = rods_[i];
    const Quaternion turned = load_quaternion(&q[node.q]);
    const Vec3 u = first_axis(turned, 2 / norm2(turned)), turn = cross(load3(&v[node.v]), u);
    const double speed2 = dot(turn, turn);
    const Vec3 y = length * (tip.mass * u);
    const double along = length * dot(u, y);
    // Across u; along it anything that keeps the matrix well conditioned.
    const Sym3 lm = length * tip.mass;
    const double filler = length * trace(lm);
    const Sym3 k =
        Sym3::diagonal(node.second) + length * lm - outer_both(length * u, y) + outer(along + filler, u);
    const Sym3 h = inverse(k);
    const Vec3 e = node.first * u + y;
    const Sym3 g0 = Sym3::diagonal(node.first) + lm;
    const Mat3 g{{g0.xx - e.x * u.x, g0.xy - e.x * u.y, g0.xz - e.x * u.z},
                 {g0.xy - e.y * u.x, g0.yy - e.y * u.y, g0.yz - e.y * u.z},
                 {g0.xz - e.z * u.x, g0.yz - e.z * u.y, g0.zz - e.z * u.z}};
    const Vec3 z = tip.force - speed2 * y;
    Vec3 across = length * (z - dot(u, z) * u);
    if (!load.torques.empty()) across -= cross(load3(&load.torques[node.v]), u);
    work.u = u;
    work.speed2 = speed2;
    work.w = {h * (-1 * g.x), h * (-1 * g.y), h * (-1 * g.z)};
    work.w0 = h * (-1 * across);
    const Mat3& w = work.w;
    const PointLoad up{{node.mass + tip.mass.xx + dot(g.x, w.x), tip.mass.xy + dot(g.x, w.y),
                        tip.mass.xz + dot(g.x, w.z), node.mass + tip.mass.yy + dot(g.y, w.y),
                        tip.mass.yz + dot(g.y, w.z), node.mass + tip.mass.zz + dot(g.z, w.z)},
                       z - (speed2 * node.first) * u + transposed_times(g, work.w0)};
    if (node.follows)
      carried = up;
    else
      hand_on(i, up);
  }

  // Base to tips.
  const Vec3 base = load.base_acceleration - load.gravity;
  double* rates = out.data();
  Vec3 last{};  // acceleration of the tip of the rod before
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.general != none) {
      accelerate_general(i, load, rates);
      continue;
    }
    const Vec3 a = node.follows ? last : joint_acceleration(i, base);
    const RodWork& work = rods_[i];
    const Vec3 beta = work.w * a + work.w0;
    store3(rates + node.v, cross(work.u, beta));
    last = a + node.tip * (beta - work.speed2 * work.u);
    if (node.slot != none) slots_[node.slot].acceleration = last;
  }
}

void ArticulatedBody::rates(const VectorXd& q, const VectorXd& v, VectorXd& out) const {
  out.resize(coordinates_);
  for (const Node& node : nodes_) {
    if (node.joint != Joint::spherical) {
      for (std::uint32_t k = 0; k < count_coordinates(node.joint); ++k) out[node.q + k] = v[node.v + k];
      continue;
    }
    // Half the quaternion (0, omega) times q.
    const Quaternion now = load_quaternion(&q[node.q]);
    const Vec3 half = 0.5 * load3(&v[node.v]);
    out[node.q] = -dot(half, now.v);
    store3(&out[node.q + 1], now.w * half + cross(half, now.v));
  }
}

void ArticulatedBody::settle(VectorXd& q, VectorXd& v) const {
  for (const Node& node : nodes_) {
    if (node.joint != Joint::spherical) continue;
    const double over = 1 / std::sqrt(norm2(load_quaternion(&q[node.q])));
    for (std::uint32_t k = 0; k < 4; ++k) q[node.q + k] *= over;
    const Quaternion now = load_quaternion(&q[node.q]);
    const Vec3 axis =
        node.general == none ? first_axis(now, 2) : rotation(now) * general_[node.general].slender;
    const Vec3 omega = load3(&v[node.v]);
    store3(&v[node.v], omega - dot(omega, axis) * axis);
  }
}

void ArticulatedBody::motions(const VectorXd& q, const VectorXd& v, Vec3 base_position, Vec3 base_velocity,
                              std::span<LinkMotion> out) const {
  const LinkMotion ground{base_position, base_velocity, {}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    const Link& link = links_[i];
    const LinkMotion& parent = node.parent == Link::base ? ground : out[node.parent];
    LinkMotion& motion = out[i];
    Vec3 arm = parent.rotation * link.place, slide{};
    switch (link.joint) {
      case Joint::spherical:
        motion.rotation = rotation(load_quaternion(&q[node.q]));
        motion.angular_velocity = load3(&v[node.v]);
        break;
      case Joint::revolute: {
        const Vec3 axis = parent.rotation * link.axis;
        motion.rotation = rotation(axis, q[node.q]) * parent.rotation;
        motion.angular_velocity = parent.angular_velocity + v[node.v] * axis;
        break;
      }
      case Joint::prismatic: {
        const Vec3 axis = parent.rotation * link.axis;
        arm += q[node.q] * axis;
        slide = v[node.v] * axis;
        motion.rotation = parent.rotation;
        motion.angular_velocity = parent.angular_velocity;
        break;
      }
      case Joint::translation:
        arm += load3(&q[node.q]);
        slide = load3(&v[node.v]);
        motion.rotation = parent.rotation;
        motion.angular_velocity = parent.angular_velocity;
        break;
    }
    motion.position = parent.position + arm;
    motion.velocity = parent.velocity + cross(parent.angular_velocity, arm) + slide;
  }
}

}  // namespace plumb::detail
