#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "truth/model.hpp"

/// Solutions to compare others with: the constrained equations of motion themselves, their rods exact, in
/// long double. Shares nothing with what steps a World.
namespace plumb::truth {

struct Plan {
  std::vector<double> save_at;  ///< Times in s, rising, none negative.
  MassModel mass = MassModel::consistent;
  double tolerance = 1e-9;                 ///< Largest difference allowed, as Accuracy has it.
  std::function<void(double)> progress{};  ///< Called with the share done, 0 to 1; may be empty.
};

/// How far two solutions of different order and step lie apart: the largest distance of a particle's
/// positions divided by the scene's diagonal, and of its velocities divided by `Truth::speed`.
struct Accuracy {
  double t = 0;  ///< Time, in s.
  double position = 0;
  double velocity = 0;

  double worst() const { return position > velocity ? position : velocity; }
};

struct Truth {
  std::vector<Frame> frames{};       ///< States at the times to save.
  std::vector<Accuracy> accuracy{};  ///< Accuracies at the same times.
  Accuracy reached{};                ///< The worst of each over all of them, and when that was.
  double diagonal = 0;               ///< Diagonal of the scene, in m.
  double speed = 0;                  ///< The greater of sqrt(g diagonal) and the fastest start, in m/s.
  double velocity_change = 0;  ///< Change of the start's velocities so that none pulls on a rod, in m/s.
  double energy_drift = 0;  ///< Largest change between times saved, relative to energy_range(); without drag.
  std::uint64_t steps = 0;  ///< Steps of the more accurate solution.
  std::uint64_t rows = 0;   ///< Equations of rods that close loops.
  std::uint64_t redundant = 0;  ///< How many of those the others imply, at the end.
};

/// Throws InputError for a scene or plan that makes no sense or rods that start off their length, and
/// Unreachable, saying what was reached and until when, if the two solutions come to differ by more than
/// the tolerance or one cannot be continued.
Truth solve(const Scene& scene, const Plan& plan);

}  // namespace plumb::truth
