#include "step/inputs/loads.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "plumb/inertia.hpp"
#include "scene/refuse.hpp"
#include "scene/second_moments.hpp"

namespace plumb::detail {

Loads::Loads(const Scene& scene) : constant_(scene.particles.size()) {
  for (const Particle& particle : scene.particles) fixed_.push_back(particle.fixed);
}

void Loads::set(Load load) {
  load_ = std::move(load);
  last_dt_ = 0;
  if (!load_) return std::fill(asked_.begin(), asked_.end(), Vec3{});
  make_room(constant_.size());
}

/// Makes the space that a load needs, so that steps allocate nothing.
void Loads::make_room(std::size_t particles) {
  for (Array<Vec3>* const of : {&loaded_, &asked_, &positions_, &velocities_, &last_velocities_})
    of->resize(particles);
}

void Loads::grow(std::size_t particles) {
  if (particles <= constant_.size()) return;
  constant_.resize(particles);
  fixed_.resize(particles, true);
  if (load_ || !asked_.empty()) make_room(particles);
}

void Loads::add(std::uint32_t particle, bool is_fixed, Vec3 velocity) {
  remove(particle);  // a load may have said forces of what was not there
  fixed_[particle] = is_fixed;
  if (!last_velocities_.empty()) last_velocities_[particle] = velocity;
}

void Loads::remove(std::uint32_t particle) {
  fix(particle, true);
  for (Array<Vec3>* const of : {&loaded_, &asked_, &last_velocities_})
    if (!of->empty()) (*of)[particle] = {};
}

Vec3 Loads::set_force(std::uint32_t particle, Vec3 force) {
  constant_[particle] = force;
  any_constant_ = true;
  return force + loaded(particle);
}

void Loads::predict(std::uint32_t particle, double dt, const Motion& motion) {
  const auto& [position, velocity, is_known] = motion;
  positions_[particle] = position + dt / 2 * velocity;
  velocities_[particle] = velocity;
  if (!is_known && last_dt_ > 0)
    velocities_[particle] += dt / (2 * last_dt_) * (velocity - last_velocities_[particle]);
  last_velocities_[particle] = velocity;
}

void Loads::ask_at(double middle, double dt) {
  std::fill(asked_.begin(), asked_.end(), Vec3{});
  last_dt_ = 0;  // what is refused is no step
  load_({middle, positions_, velocities_}, asked_);
  for (std::size_t i = 0; i < asked_.size(); ++i)
    if (!is_finite(asked_[i])) refuse("particle ", i, ": the load's force is not finite: ", asked_[i]);
  last_dt_ = dt;
  was_asked_ = true;
}

}  // namespace plumb::detail

namespace plumb {

Vec3 position_of(const Point& point, std::span<const Vec3> positions) {
  Vec3 out;
  for (std::size_t k = 0; k < point.particles.size(); ++k)
    if (point.weights[k] != 0) out += point.weights[k] * positions[point.particles[k]];
  return out;
}

void add_force(const Point& point, Vec3 force, std::span<Vec3> forces) {
  for (std::size_t k = 0; k < point.particles.size(); ++k)
    if (point.weights[k] != 0) forces[point.particles[k]] += point.weights[k] * force;
}

void add_torque(const Body& body, Vec3 torque, std::span<const Vec3> positions, std::span<Vec3> forces) {
  std::array<PointMass, 4> points;
  for (std::size_t k = 0; k < points.size(); ++k) points[k] = {positions[body.particles[k]], 1};
  const auto [mass, middle, turn] = mass_properties(points);
  // With forces f = alpha x r on particles at r from their middle, the couple, the sum of r x f, is turn
  // alpha.
  const Vec3 alpha = inverse(detail::Sym3{turn.xx, turn.xy, turn.xz, turn.yy, turn.yz, turn.zz}) * torque;
  for (const std::uint32_t particle : body.particles)
    forces[particle] += cross(alpha, positions[particle] - middle);
}

}  // namespace plumb
