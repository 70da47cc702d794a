#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "interface/solver.hpp"
#include "plumb/scene.hpp"
#include "step/places.hpp"

namespace plumb::detail {

/// Knows how long cords are, and how long they will be after the next step. Cords are rods, then tackles,
/// then reels, whose length is what is out.
class Lengths {
 public:
  explicit Lengths(const Scene& scene);

  double length(std::uint32_t rod) const { return lengths_[rod]; }
  /// Returns the rate (m/s) of a cord's length in the last step, and in the one before.
  double rate(std::uint32_t rod) const { return rates_[rod]; }
  double rate_before(std::uint32_t rod) const { return rates_before_[rod]; }
  /// Lets a rod become `target` (m) long during the next step, at a constant rate.
  void set_target(std::uint32_t rod, double target);
  /// Returns the rods that change their length in the next step, or did so in the last.
  std::span<const std::uint32_t> moving() const { return moving_; }

  /// Lists those that have ever changed, since most have not.
  template <class Archive>
  void archive(Archive& archive) {
    auto& [made, lengths, targets, rates, rates_before, is_moving, is_changed, changed, moving, stopped] =
        *this;
    if (archive.restores())
      for (const std::uint32_t cord : changed) {
        lengths[cord] = targets[cord] = made[cord];
        rates[cord] = rates_before[cord] = 0;
        is_moving[cord] = is_changed[cord] = 0;
      }
    archive(changed, moving, stopped);
    for (const std::uint32_t cord : changed) {
      archive(lengths[cord], targets[cord], rates[cord], rates_before[cord], is_moving[cord]);
      is_changed[cord] = 1;
    }
  }
  /// Tells solvers the lengths and their rates in a step of dt (s). Once it is done, lengths are their
  /// targets exactly, and rods without a new one will stop.
  void begin_step(double dt, const Places& places, std::span<const std::unique_ptr<Solver>> solvers);
  void end_step(const Places& places, std::span<const std::unique_ptr<Solver>> solvers);

 private:
  std::vector<double> made_;                  ///< m, by rod: its length in the scene
  std::vector<double> lengths_, targets_;     ///< m, by rod
  std::vector<double> rates_, rates_before_;  ///< m/s, by rod
  std::vector<std::uint8_t> is_moving_;       ///< by rod; 2 if it has a target for the next step
  std::vector<std::uint8_t> is_changed_;      ///< by rod
  std::vector<std::uint32_t> changed_;        ///< They have ever had a target, in the order of their first.
  std::vector<std::uint32_t> moving_, stopped_;  ///< The latter stood in the last step, after they moved.
};

}  // namespace plumb::detail
