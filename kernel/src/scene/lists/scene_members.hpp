#pragma once

#include "plumb/scene.hpp"

namespace plumb {

// Archives and digests find these beside the structs whose members they list, all of them, so that a new one
// does not compile before it is listed. What only reads casts const away.

template <class List>
void visit_members(List& to, Particle& of) {
  auto& [position, velocity, mass, fixed, asleep] = of;
  to(position, velocity, mass, fixed, asleep);
}
template <class List>
void visit_members(List& to, RodLaw& of) {
  auto& [stiffness, damping, one_sided, strength] = of;
  to(stiffness, damping, one_sided, strength);
}
template <class List>
void visit_members(List& to, Rod& of) {
  auto& [a, b, length, mass, center, inertia, linear_drag, orthogonal_drag, law] = of;
  to(a, b, length, mass, center, inertia, linear_drag, orthogonal_drag, law);
}
template <class List>
void visit_members(List& to, Bend& of) {
  auto& [a, b, c, stiffness, angle, damping] = of;
  to(a, b, c, stiffness, angle, damping);
}
template <class List>
void visit_members(List& to, Twist& of) {
  auto& [particles, stiffness, angle] = of;
  to(particles, stiffness, angle);
}
template <class List>
void visit_members(List& to, Tackle& of) {
  auto& [particles, length, law, friction] = of;
  to(particles, length, law, friction);
}
template <class List>
void visit_members(List& to, Reel& of) {
  auto& [particles, out] = of;
  to(particles, out);
}

// --- Bodies and joints

template <class List>
void visit_members(List& to, Inertia& of) {
  auto& [xx, yy, zz, xy, xz, yz] = of;
  to(xx, yy, zz, xy, xz, yz);
}
template <class List>
void visit_members(List& to, Body& of) {
  auto& [particles, mass, center, inertia] = of;
  to(particles, mass, center, inertia);
}
template <class List>
void visit_members(List& to, Point& of) {
  auto& [particles, weights] = of;
  to(particles, weights);
}
template <class List>
void visit_members(List& to, Direction& of) {
  auto& [from, end] = of;
  to(from, end);
}
template <class List>
void visit_members(List& to, Pin& of) {
  auto& [a, b] = of;
  to(a, b);
}
template <class List>
void visit_members(List& to, Alignment& of) {
  auto& [u, v, value] = of;
  to(u, v, value);
}
template <class List>
void visit_members(List& to, AngleControl& of) {
  auto& [u, v, lower, upper, friction, target, stiffness, damping] = of;
  to(u, v, lower, upper, friction, target, stiffness, damping);
}
template <class List>
void visit_members(List& to, Spring& of) {
  auto& [a, b, length, stiffness, damping, force, one_sided] = of;
  to(a, b, length, stiffness, damping, force, one_sided);
}
template <class List>
void visit_members(List& to, Torsion& of) {
  auto& [axis, u, v, angle, stiffness, damping, torque] = of;
  to(axis, u, v, angle, stiffness, damping, torque);
}

// --- Shapes

template <class List>
void visit_members(List& to, Surface& of) {
  auto& [friction, restitution, rolling, spinning] = of;
  to(friction, restitution, rolling, spinning);
}
template <class List>
void visit_members(List& to, Filter& of) {
  auto& [category, mask, group, own_island] = of;
  to(category, mask, group, own_island);
}
template <class List>
void visit_members(List& to, Capsule& of) {
  auto& [a, b, radius, surface, filter] = of;
  to(a, b, radius, surface, filter);
}
template <class List>
void visit_members(List& to, Hull& of) {
  auto& [body, points, radius, surface, filter] = of;
  to(body, points, radius, surface, filter);
}

}  // namespace plumb
