#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "truth/model.hpp"

/// These functions find solutions to compare others with: the constrained equations of motion themselves,
/// with rods exactly as their laws say, in long double. They share nothing with what steps a World.
namespace plumb::truth {

struct Plan {
  std::vector<double> save_at;  ///< Times in s, rising, none negative.
  MassModel mass = MassModel::consistent;
  double tolerance = 1e-9;  ///< Largest difference allowed, as Accuracy has it.
  /// Frames get tensions, averaged over so many seconds before them, if that is positive. There is no time to
  /// save within, except the start, whose tensions are not a number.
  double mean_over = 0;
  std::function<void(double)> progress{};  ///< Called with the share done, 0 to 1; may be empty.
  /// Rods that are reeled in or paid out. One that starts to be so jerks: the start's velocities get the
  /// least change after which they have its rate.
  std::vector<scenes::LengthRate> rates{};
};

/// This says how far two solutions of different order and step lie apart. Positions count as the largest
/// distance of a particle divided by the scene's diagonal, and velocities as theirs divided by
/// `Truth::speed`.
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
  double speed = 0;                  ///< Speed to which velocities are relative, in m/s; see Model::speed.
  double velocity_change = 0;  ///< Change of the start's velocities so that none pulls on a rod, in m/s.
  /// Largest change between times saved, relative to energy_range(); without drag, damped rods and those
  /// whose length changes, which do work.
  double energy_drift = 0;
  double tension =
      0;  ///< How far tensions of the two solutions lie apart, relative to the largest of a frame.
  std::uint64_t steps = 0;      ///< Steps of the more accurate solution.
  std::uint64_t rows = 0;       ///< Equations of rods that close loops.
  std::uint64_t redundant = 0;  ///< How many of those the others imply, at the end.
};

/// Solves a plan. Throws InputError for a scene or plan that makes no sense, or rods that start off their
/// length, for tensions of rods that are redundant, for rods whose pull is not smooth, see make_model(), and
/// for those that are reeled in to nothing. Throws Unreachable if the two solutions differ by more than the
/// tolerance or one cannot be continued. Its message says what was reached and until when.
Truth solve(const Scene& scene, const Plan& plan);

}  // namespace plumb::truth
