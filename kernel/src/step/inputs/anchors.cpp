#include "step/inputs/anchors.hpp"

#include <algorithm>
#include <utility>

namespace plumb::detail {

Anchors::Anchors(const Scene& scene, std::size_t solvers)
    : has_target_(scene.particles.size(), 0), is_concerned_(solvers, 0) {
  fixed_.reserve(scene.particles.size());
  positions_.reserve(scene.particles.size());
  for (const Particle& particle : scene.particles) {
    fixed_.push_back(particle.fixed);
    positions_.push_back(particle.position);
  }
  will_be_fixed_ = fixed_;
  targets_ = positions_;
  // The space is reserved here, so that steps that move anchors allocate nothing.
  moving_.reserve(static_cast<std::size_t>(std::count(fixed_.begin(), fixed_.end(), std::uint8_t{1})));
  moved_.reserve(moving_.capacity());
  concerned_.reserve(solvers);
  settling_.reserve(solvers);
}

void Anchors::concern(std::uint32_t solver) {
  if (is_concerned_[solver] != 0) return;
  is_concerned_[solver] = 1;
  concerned_.push_back(solver);
}

void Anchors::set_target(std::uint32_t particle, Vec3 target) {
  targets_[particle] = target;
  if (has_target_[particle] != 0) return;
  has_target_[particle] = 1;
  moving_.push_back(particle);
  moved_.reserve(moving_.capacity());
}

void Anchors::forget_target(std::uint32_t particle) {
  if (std::exchange(has_target_[particle], std::uint8_t{0}) != 0) std::erase(moving_, particle);
}

void Anchors::order(std::uint32_t particle, bool is_fixed) {
  will_be_fixed_[particle] = is_fixed ? 1 : 0;
  if (!is_fixed && fixed_[particle] == 0) forget_target(particle);
}

void Anchors::fix(std::uint32_t particle, Vec3 position, Vec3 velocity, double dt) {
  if (velocity != Vec3{}) moved_.push_back({particle, {position - dt * velocity, position, dt}});
  fixed_[particle] = will_be_fixed_[particle] = 1;
  positions_[particle] = position;
  if (has_target_[particle] == 0) targets_[particle] = position;
}

void Anchors::put(std::uint32_t particle, Vec3 position) {
  const Vec3 way = position - positions_[particle];
  for (auto& [moved, path] : moved_)
    if (moved == particle) path = {path.from + way, path.to + way, path.dt};
  positions_[particle] = targets_[particle] = position;
  forget_target(particle);
}

void Anchors::free(std::uint32_t particle) {
  fixed_[particle] = will_be_fixed_[particle] = 0;
  forget_target(particle);
  std::erase_if(moved_, [&](const auto& of) { return of.first == particle; });
}

void Anchors::grow(std::size_t particles) {
  if (particles <= fixed_.size()) return;
  for (Array<std::uint8_t>* const of : {&fixed_, &will_be_fixed_}) of->resize(particles, 1);
  for (Array<Vec3>* const of : {&positions_, &targets_}) of->resize(particles);
  has_target_.resize(particles, 0);
}

void Anchors::add(std::uint32_t particle, bool is_fixed, Vec3 position) {
  fixed_[particle] = will_be_fixed_[particle] = is_fixed ? 1 : 0;
  positions_[particle] = targets_[particle] = position;
}

void Anchors::remove(std::uint32_t particle) {
  forget_target(particle);
  if (fixed_[particle] != 0) std::erase_if(moved_, [&](const auto& of) { return of.first == particle; });
  add(particle, true, {});
}

void Anchors::forget(std::uint32_t solver) {
  std::erase(settling_, solver);
  std::erase(concerned_, solver);
  is_concerned_[solver] = 0;
}

void Anchors::go_on_from(const Anchors& from) {
  const std::size_t solvers = is_concerned_.size();
  *this = from;
  is_concerned_.assign(solvers, 0);
  concerned_.clear();
  settling_.clear();
  resize(solvers);
  moving_.reserve(from.moving_.capacity());
  moved_.reserve(from.moved_.capacity());
}

Vec3 Anchors::last_velocity(std::uint32_t particle) const {
  for (const auto& [moved, path] : moved_)
    if (moved == particle) return path.velocity();
  return {};
}

void Anchors::begin_step(double dt, const Places& places, std::span<const std::unique_ptr<Solver>> solvers) {
  dt_ = dt;
  for (const std::uint32_t solver : settling_) concern(solver);
  settling_.clear();
  for (const std::uint32_t particle : moving_)
    for (const Place place : places.of(particle)) {
      solvers[place.solver]->move_anchor(place.slot, {positions_[particle], targets_[particle], dt});
      concern(place.solver);
    }
  for (const std::uint32_t solver : concerned_) solvers[solver]->begin_anchors();
}

void Anchors::end_step(const Places& places, std::span<const std::unique_ptr<Solver>> solvers) {
  for (const std::uint32_t solver : concerned_) solvers[solver]->end_anchors();
  for (const std::uint32_t solver : concerned_) is_concerned_[solver] = 0;
  concerned_.clear();
  moved_.clear();
  for (const std::uint32_t particle : moving_) {
    moved_.push_back({particle, {positions_[particle], targets_[particle], dt_}});
    for (const Place place : places.of(particle)) {
      solvers[place.solver]->place_anchor(place.slot, targets_[particle]);
      concern(place.solver);
    }
    positions_[particle] = targets_[particle];
    has_target_[particle] = 0;
  }
  std::swap(settling_, concerned_);
  for (const std::uint32_t solver : settling_) is_concerned_[solver] = 0;
  moving_.clear();
}

}  // namespace plumb::detail
