#include "step/inputs/lengths.hpp"

#include <algorithm>

#include "scene/reels/reels.hpp"

namespace plumb::detail {

Lengths::Lengths(const Scene& scene) {
  Array<double> rods, lines;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) rods.push_back(rod_length(scene, i));
  if (!scene.reels.empty()) {
    const RodTable table(scene);
    for (const Reel& reel : scene.reels) lines.push_back(start_of(scene, table, reel).out);
  }
  for (std::size_t i = 0; i < scene.tackles.size(); ++i) lines.push_back(tackle_length(scene, i));
  made_ = {rods, lines};
  targets_ = lengths_ = made_;
  for (CordTable<double>* const rates : {&rates_, &rates_before_}) rates->grow(rods.size(), lines.size());
  for (CordTable<std::uint8_t>* const flags : {&is_moving_, &is_changed_})
    flags->grow(rods.size(), lines.size());
}

void Lengths::grow(std::size_t rods, std::size_t lines) {
  for (CordTable<double>* const of : {&made_, &lengths_, &targets_, &rates_, &rates_before_})
    of->grow(rods, lines);
  for (CordTable<std::uint8_t>* const of : {&is_moving_, &is_changed_}) of->grow(rods, lines);
}

void Lengths::remove(std::uint32_t cord) {
  if (is_changed_[cord] != 0)
    for (Array<std::uint32_t>* const list : {&changed_, &moving_, &stopped_}) std::erase(*list, cord);
  is_changed_[cord] = is_moving_[cord] = 0;
  rates_[cord] = rates_before_[cord] = 0;
}

void Lengths::set_target(std::uint32_t cord, double target) {
  targets_[cord] = target;
  if (is_changed_[cord] == 0) changed_.push_back(cord);
  is_changed_[cord] = 1;
  if (is_moving_[cord] == 0) moving_.push_back(cord);
  is_moving_[cord] = 2;
}

void Lengths::begin_step(double dt, const Tell& tell) {
  for (const std::uint32_t cord : stopped_) rates_before_[cord] = 0;
  stopped_.clear();
  for (const std::uint32_t cord : moving_) {
    rates_before_[cord] = rates_[cord];
    rates_[cord] = (targets_[cord] - lengths_[cord]) / dt;
    tell(cord, lengths_[cord], rates_[cord]);
  }
}

void Lengths::end_step(const Tell& tell) {
  std::size_t kept = 0;
  for (const std::uint32_t cord : moving_) {
    // The rate stays what it was, since velocities at the end of the step have it.
    lengths_[cord] = targets_[cord];
    tell(cord, lengths_[cord], rates_[cord]);
    is_moving_[cord] = is_moving_[cord] == 2 ? 1 : 0;
    if (is_moving_[cord] != 0)
      moving_[kept++] = cord;
    else
      stopped_.push_back(cord);
  }
  moving_.resize(kept);
}

}  // namespace plumb::detail
