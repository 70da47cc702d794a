#include "reference/featherstone/articulated_body.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "reference/featherstone/turning.hpp"

namespace plumb::detail {
namespace {

using Eigen::VectorXd;

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

ArticulatedBody::ArticulatedBody(Array<Link> links) : links_(std::move(links)) {
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

/// Returns whether the link is slender along x, so that the passes need only its direction.
bool ArticulatedBody::is_rod(std::uint32_t i) const {
  const Link& link = links_[i];
  const auto along_x = [](Vec3 v) { return v.y == 0 && v.z == 0; };
  const Inertia& own = link.inertia;
  return link.joint == Joint::spherical && along_x(link.center) && along_x(link.grip) && own.xx == 0 &&
         own.xy == 0 && own.xz == 0 && own.yz == 0 && own.yy == own.zz &&
         (nodes_[i].second > 0 || link.grip.x != 0);
}

/// Returns whether the link has no inertia about an axis through its joint, and sets that axis.
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
  Array<Vec3> axis(n);
  Array<std::uint8_t> slender(n), rod(n);
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

void ArticulatedBody::accelerations(const VectorXd& q, const VectorXd& v, const BodyLoad& load,
                                    VectorXd& out) {
  out.resize(speeds_);
  place_general(q, v);
  const auto force_on = [&](std::uint32_t i) { return load.forces.empty() ? Vec3{} : load.forces[i]; };
  for (const std::uint32_t i : general_links_)
    start_general(general_[nodes_[i].general], links_[i], force_on(i),
                  load.moments.empty() ? Vec3{} : load.moments[i]);
  for (Slot& slot : slots_) slot.load = {};
  eliminate(q, v, load);
  accelerate(load, out.data());
}

/// Eliminates a rod of direction u that carries mass M and force f at its tip, with P = 1 - u uᵀ. Its
/// direction accelerates by beta across and by -|u'|² u along it, its tip by a + L (beta - |u'|² u), so that
///
///   (second P + L² P M P) beta + P (first + L M) a + L P (f - L |u'|² M u) = 0
///
/// and its joint feels (mass + M) a + (first + L M) beta + f - |u'|² (first + L M) u.
ArticulatedBody::PointLoad ArticulatedBody::eliminate_rod(std::uint32_t i, const VectorXd& q,
                                                          const VectorXd& v, const BodyLoad& load,
                                                          const PointLoad& tip) {
  const Node& node = nodes_[i];
  const double length = node.tip;
  RodWork& work = rods_[i];
  const Quaternion turned = load_quaternion(&q[node.q]);
  const Vec3 u = first_axis(turned, 2 / norm2(turned)), turn = cross(load3(&v[node.v]), u);
  const double speed2 = dot(turn, turn);
  const Vec3 y = length * (tip.mass * u);
  const double along = length * dot(u, y);
  // Across u the matrix is that of the equation. Along u it may be anything that keeps it well conditioned.
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
  return {{node.mass + tip.mass.xx + dot(g.x, w.x), tip.mass.xy + dot(g.x, w.y), tip.mass.xz + dot(g.x, w.z),
           node.mass + tip.mass.yy + dot(g.y, w.y), tip.mass.yz + dot(g.y, w.z),
           node.mass + tip.mass.zz + dot(g.z, w.z)},
          z - (speed2 * node.first) * u + transposed_times(g, work.w0)};
}

/// This pass goes from the tips to the base.
void ArticulatedBody::eliminate(const VectorXd& q, const VectorXd& v, const BodyLoad& load) {
  PointLoad carried;  // what rod i + 1 hands on, if it follows
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
    const PointLoad up = eliminate_rod(i, q, v, load, tip);
    if (node.follows)
      carried = up;
    else
      hand_on(i, up);
  }
}

/// This pass goes from the base to the tips.
void ArticulatedBody::accelerate(const BodyLoad& load, double* rates) {
  const Vec3 base = load.base_acceleration - load.gravity;
  Vec3 last{};  // acceleration of the last rod's tip
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
    // The rate of a quaternion q is half the quaternion (0, omega) times q.
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
