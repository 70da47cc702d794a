#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/settings.hpp"
#include "plumb/world.hpp"

/// Where a method holds and where it breaks: straight, horizontal chains that fall from rest about one fixed
/// end, over the mass of the last particle, the number of links and the step.
namespace plumb::scenes {

/// A way to solve, as the grid names it: "relax-mid", "direct-old", ...
struct StabilityMethod {
  std::string name;
  Method method = Method::relax;
  std::optional<Gradient> gradient{};
  SweepOrder order = SweepOrder::gauss_seidel;
};
/// All that can be asked for. The last is `auto`; the default grid leaves it out, as it is one of the others
/// on every chain.
const std::vector<StabilityMethod>& all_stability_methods();
std::vector<StabilityMethod> default_stability_methods();

/// One cell of the grid.
struct StabilityCase {
  StabilityMethod method;
  double ratio = 1;  ///< of the last particle's mass to that of each other, 1 kg
  std::uint32_t links = 1;
  double dt = 1.0 / 60;        ///< s, of a step; no substeps
  std::uint64_t frames = 180;  ///< of dt

  double simulated_s() const { return dt * static_cast<double>(frames); }
};

struct StabilityGrid {
  std::vector<StabilityMethod> methods = default_stability_methods();
  std::vector<double> ratios = {1, 10, 100, 1e3, 1e4, 1e5, 1e6};
  std::vector<std::uint32_t> links = {5, 20, 100, 1000, 10000};
  std::vector<double> dts = {0.001, 0.003, 0.01, 1.0 / 60, 0.033, 0.1};  ///< s
  double at_dt = 1.0 / 60;                                               ///< s, of the plane ratio × links
  std::uint32_t at_links = 100;                                          ///< of the plane ratio × dt
  bool full = false;    ///< the whole box, not these two planes of it
  double duration = 3;  ///< s, rounded to whole steps
};

/// Each cell once, methods outermost. Throws InputError if a list is empty, a value makes no sense, or at_dt
/// or at_links is not one of the values.
std::vector<StabilityCase> list_cells(const StabilityGrid& grid);

/// In the order in which they are looked for.
enum class Outcome : std::uint8_t {
  survived,
  not_finite,     ///< a position or a velocity
  frozen,         ///< an island was put back to its last finite state and stands still
  unsolved,       ///< a substep that the direct method could not take
  stretched,      ///< a rod was off by more than most_stretch
  gained_energy,  ///< more than most_gain
  too_slow        ///< sound as far as it came within its time
};
std::string_view to_string(Outcome outcome);

/// Of a rod's length. Chains are of some use up to there; the measured stretch tells more.
inline constexpr double most_stretch = 0.5;
/// Of energy_range(): as much as falling through the whole chain gives.
inline constexpr double most_gain = 1;

/// What became of a cell. Stretch and energy are over the ends of the frames done, the energy relative to
/// energy_range(); NaN or infinite if the state was.
struct StabilityResult {
  StabilityCase cell;
  Outcome outcome = Outcome::survived;
  std::uint64_t frames = 0;  ///< done
  bool finite = true;
  double stretch_max = 0;
  double energy_drift = 0;  ///< largest distance from the energy at first
  double energy_gain = 0;   ///< most above it
  StepReport total{};
  double wall_s = 0;  ///< in World::step alone

  /// Milliseconds of stepping per simulated second.
  double ms_per_s() const;
};

/// The criterion.
Outcome judge(const StabilityResult& result);

/// Steps the cell on one thread in double, relaxation with `sweeps` a step. After `budget_s` of wall-clock
/// time, set-up and measures included, it goes no further; a frame begun is ended, and no step of any method
/// is endless.
StabilityResult measure_stability(const StabilityCase& cell, std::uint32_t sweeps, double budget_s);

/// The results, one line each, with a header.
std::string stability_csv(const std::vector<StabilityResult>& results);

}  // namespace plumb::scenes
