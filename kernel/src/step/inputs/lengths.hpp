#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "step/inputs/cords.hpp"

namespace plumb::detail {

/// Knows how long cords are, and how long they will be after the next step. The length of a reel is what is
/// out.
class Lengths {
 public:
  explicit Lengths(const Scene& scene);

  double length(std::uint32_t cord) const { return lengths_[cord]; }
  double target(std::uint32_t cord) const { return targets_[cord]; }
  /// Returns whether a cord will change its length in the next step.
  bool will_change(std::uint32_t cord) const { return targets_[cord] != lengths_[cord]; }
  /// Returns the rate (m/s) of a cord's length in the last step, and in the one before.
  double rate(std::uint32_t cord) const { return rates_[cord]; }
  double rate_before(std::uint32_t cord) const { return rates_before_[cord]; }
  /// Lets a rod become `target` (m) long during the next step, at a constant rate.
  void set_target(std::uint32_t cord, double target);
  /// Returns the rods that change their length in the next step, or did so in the last.
  std::span<const std::uint32_t> moving() const { return moving_; }
  /// Returns those that have ever changed their length, or will.
  std::span<const std::uint32_t> changed() const { return changed_; }

  /// Takes at least so many rods, reels and tackles. New ones have no length before add().
  void grow(std::size_t rods, std::size_t lines);
  void add(std::uint32_t cord, double length) { made_[cord] = lengths_[cord] = targets_[cord] = length; }
  /// Lets a cord be as if it had never changed.
  void remove(std::uint32_t cord);

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
  /// Tells of lengths and their rates in a step of dt (s). Once it is done, lengths are their targets
  /// exactly, and rods without a new one will stop.
  using Tell = std::function<void(std::uint32_t cord, double length, double rate)>;
  void begin_step(double dt, const Tell& tell);
  void end_step(const Tell& tell);

 private:
  CordTable<double> made_;                  ///< m: the length in the scene
  CordTable<double> lengths_, targets_;     ///< m
  CordTable<double> rates_, rates_before_;  ///< m/s
  CordTable<std::uint8_t> is_moving_;       ///< 2 if it has a target for the next step
  CordTable<std::uint8_t> is_changed_;
  Array<std::uint32_t> changed_;           ///< They have ever had a target, in the order of their first.
  Array<std::uint32_t> moving_, stopped_;  ///< The latter stood in the last step, after they moved.
};

}  // namespace plumb::detail
