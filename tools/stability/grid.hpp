#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/settings.hpp"
#include "plumb/world.hpp"

/// The grid shows where a method holds and where it breaks. Straight, horizontal chains fall from rest about
/// one fixed end. The mass of the last particle, the number of links and the step vary.
namespace plumb::scenes {

/// A method is a way to solve, as the grid names it: "relax-mid", "direct-old" and others.
struct StabilityMethod {
  std::string name;
  Method method = Method::relax;
  std::optional<Gradient> gradient{};
  SweepOrder order = SweepOrder::gauss_seidel;
};
/// Returns all ways that can be asked for. The last is `auto`. The default grid leaves it out, as it is one
/// of the others on every chain.
const std::vector<StabilityMethod>& all_stability_methods();
std::vector<StabilityMethod> default_stability_methods();

/// A case is one cell of the grid.
struct StabilityCase {
  StabilityMethod method;
  double ratio = 1;  ///< Mass of the last particle over that of each other, which is 1 kg.
  std::uint32_t links = 1;
  double dt = 1.0 / 60;        ///< Length of a step in s, without substeps.
  std::uint64_t frames = 180;  ///< Number of steps of dt.

  double simulated_s() const { return dt * static_cast<double>(frames); }
};

struct StabilityGrid {
  std::vector<StabilityMethod> methods = default_stability_methods();
  std::vector<double> ratios = {1, 10, 100, 1e3, 1e4, 1e5, 1e6};
  std::vector<std::uint32_t> links = {5, 20, 100, 1000, 10000};
  std::vector<double> dts = {0.001, 0.003, 0.01, 1.0 / 60, 0.033, 0.1};  ///< Lengths of a step, in s.
  double at_dt = 1.0 / 60;       ///< Step of the plane ratio × links, in s.
  std::uint32_t at_links = 100;  ///< Links of the plane ratio × dt.
  bool full = false;             ///< Whether the whole box is measured, and not only these two planes of it.
  double duration = 3;           ///< Simulated time in s, rounded to whole steps.
};

/// Lists each cell once, methods outermost. Throws InputError if a list is empty, a value makes no sense, or
/// at_dt or at_links is not one of the values.
std::vector<StabilityCase> list_cells(const StabilityGrid& grid);

/// Outcomes come in the order in which they are looked for.
enum class Outcome : std::uint8_t {
  survived,
  not_finite,     ///< A position or a velocity was not finite.
  frozen,         ///< An island was put back to its last finite state and stands still.
  unsolved,       ///< The direct method could not take a substep.
  stretched,      ///< The strain of a rod was above most_stretch.
  gained_energy,  ///< The energy rose by more than most_gain.
  too_slow        ///< The cell was sound as far as it came within its time.
};
std::string_view to_string(Outcome outcome);

/// A cell that survives has at most this strain. Chains are of some use up to there, and the measured strain
/// tells more.
inline constexpr double most_stretch = 0.5;
/// A cell that survives gains at most this energy, relative to energy_range(). Falling through the whole
/// chain gives as much.
inline constexpr double most_gain = 1;

/// A result says what became of a cell. Strain and energy are over the ends of the frames done. Energy is
/// relative to energy_range(). Both are NaN or infinite if the state was.
struct StabilityResult {
  StabilityCase cell;
  Outcome outcome = Outcome::survived;
  std::uint64_t frames = 0;  ///< Frames that were done.
  bool finite = true;
  double stretch_max = 0;
  double energy_drift = 0;  ///< Largest distance from the energy at first.
  double energy_gain = 0;   ///< Largest rise above the energy at first.
  StepReport total{};
  double wall_s = 0;  ///< Time in World::step alone, in s.

  /// Returns milliseconds of stepping per simulated second.
  double ms_per_s() const;
};

/// Decides what became of a cell.
Outcome judge(const StabilityResult& result);

/// Steps the cell on one thread in double. Relaxation makes `sweeps` a step. It goes no further after
/// `budget_s` of wall-clock time, set-up and measures included. A frame that has begun is ended, and no step
/// of any method is endless.
StabilityResult measure_stability(const StabilityCase& cell, std::uint32_t sweeps, double budget_s);

/// Returns a header and the results, one line each.
std::string stability_csv(const std::vector<StabilityResult>& results);

}  // namespace plumb::scenes
