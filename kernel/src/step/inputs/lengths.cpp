#include "step/inputs/lengths.hpp"

#include "scene/reels/reels.hpp"

namespace plumb::detail {

Lengths::Lengths(const Scene& scene)
    : is_moving_(scene.rods.size() + scene.tackles.size() + scene.reels.size(), 0) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i) lengths_.push_back(rod_length(scene, i));
  for (std::size_t i = 0; i < scene.tackles.size(); ++i) lengths_.push_back(tackle_length(scene, i));
  if (!scene.reels.empty()) {
    const RodTable rods(scene);
    for (const Reel& reel : scene.reels) lengths_.push_back(start_of(scene, rods, reel).out);
  }
  made_ = targets_ = lengths_;
  is_changed_ = is_moving_;
  rates_.resize(lengths_.size());
  rates_before_ = rates_;
}

void Lengths::set_target(std::uint32_t rod, double target) {
  targets_[rod] = target;
  if (is_changed_[rod] == 0) changed_.push_back(rod);
  is_changed_[rod] = 1;
  if (is_moving_[rod] == 0) moving_.push_back(rod);
  is_moving_[rod] = 2;
}

void Lengths::begin_step(double dt, const Places& places, std::span<const std::unique_ptr<Solver>> solvers) {
  for (const std::uint32_t rod : stopped_) rates_before_[rod] = 0;
  stopped_.clear();
  for (const std::uint32_t rod : moving_) {
    rates_before_[rod] = rates_[rod];
    rates_[rod] = (targets_[rod] - lengths_[rod]) / dt;
    for (const Place place : places.of(rod))
      solvers[place.solver]->set_length(place.slot, lengths_[rod], rates_[rod]);
  }
}

void Lengths::end_step(const Places& places, std::span<const std::unique_ptr<Solver>> solvers) {
  std::size_t kept = 0;
  for (const std::uint32_t rod : moving_) {
    // The rate stays what it was, since velocities at the end of the step have it.
    lengths_[rod] = targets_[rod];
    for (const Place place : places.of(rod))
      solvers[place.solver]->set_length(place.slot, lengths_[rod], rates_[rod]);
    is_moving_[rod] = is_moving_[rod] == 2 ? 1 : 0;
    if (is_moving_[rod] != 0)
      moving_[kept++] = rod;
    else
      stopped_.push_back(rod);
  }
  moving_.resize(kept);
}

}  // namespace plumb::detail
