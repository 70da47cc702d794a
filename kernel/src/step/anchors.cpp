#include "step/anchors.hpp"

#include <algorithm>

namespace plumb::detail {

Anchors::Anchors(const Scene& scene) : has_target_(scene.particles.size(), 0) {
  for (const Particle& particle : scene.particles) {
    fixed_.push_back(particle.fixed);
    positions_.push_back(particle.position);
  }
  targets_ = positions_;
}

void Anchors::set_target(std::uint32_t particle, Vec3 target) {
  targets_[particle] = target;
  if (has_target_[particle] != 0) return;
  has_target_[particle] = 1;
  moving_.push_back(particle);
}

void Anchors::begin_step(double dt, const Places& places, std::span<const std::unique_ptr<Solver>> solvers) {
  concerned_ = settling_;
  for (const std::uint32_t particle : moving_)
    for (const Place place : places.of(particle)) {
      solvers[place.solver]->move_anchor(place.slot, {positions_[particle], targets_[particle], dt});
      concerned_.push_back(place.solver);
    }
  std::sort(concerned_.begin(), concerned_.end());
  concerned_.erase(std::unique(concerned_.begin(), concerned_.end()), concerned_.end());
  for (const std::uint32_t solver : concerned_) solvers[solver]->begin_anchors();
}

void Anchors::end_step(const Places& places, std::span<const std::unique_ptr<Solver>> solvers) {
  for (const std::uint32_t solver : concerned_) solvers[solver]->end_anchors();
  settling_.clear();
  for (const std::uint32_t particle : moving_) {
    for (const Place place : places.of(particle)) {
      solvers[place.solver]->place_anchor(place.slot, targets_[particle]);
      settling_.push_back(place.solver);
    }
    positions_[particle] = targets_[particle];
    has_target_[particle] = 0;
  }
  std::sort(settling_.begin(), settling_.end());
  settling_.erase(std::unique(settling_.begin(), settling_.end()), settling_.end());
  moving_.clear();
}

}  // namespace plumb::detail
