#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/settings.hpp"
#include "plumb/world.hpp"

/// Grids show where a method holds and where it breaks. Chains and nets hang, and their last particle's mass,
/// their size and the step vary. Ropes, nets and boxes land, and their speed and the step vary.
namespace plumb::scenes {

/// What a grid moves. The last three land.
enum class StabilityScene : std::uint8_t {
  chains,  ///< Straight, horizontal at first, from one fixed end.
  nets,    ///< Square, from two corners, slack.
  ropes,   ///< Level, onto a plane.
  drapes,  ///< Level nets, onto a sphere on a plane.
  boxes    ///< Solid boxes, onto a plane and each other.
};
std::string_view to_string(StabilityScene);
bool is_landing(StabilityScene);

/// A method is a way to solve, as the grid names it: "relax-mid", "direct-old" and others.
struct StabilityMethod {
  std::string name;
  Method method = Method::relax;
  std::optional<Gradient> gradient{};
  SweepOrder order = SweepOrder::gauss_seidel;
  std::optional<Integrator> integrator{};  ///< That of springs.
};
/// Returns all ways that can be asked for. The last is `auto`. The default grid leaves it out, as it is one
/// of the others on every chain. Springs are so stiff that the weight of all stretches one by
/// give_of_springs.
const std::vector<StabilityMethod>& all_stability_methods();
std::vector<StabilityMethod> default_stability_methods();

/// The methods that move what lands.
std::vector<StabilityMethod> landing_methods();
inline constexpr double give_of_springs = 0.01;

/// A case is one cell of the grid.
struct StabilityCase {
  StabilityMethod method;
  /// Mass of the last particle over that of each other, which is 1 kg. Of what lands, its speed in m/s.
  double severity = 1;
  std::uint32_t size = 1;      ///< Links of a chain or a rope, particles along a net's side, or boxes.
  double dt = 1.0 / 60;        ///< Length of a step in s, without substeps.
  std::uint64_t frames = 180;  ///< Number of steps of dt.
  StabilityScene scene = StabilityScene::chains;

  double simulated_s() const { return dt * static_cast<double>(frames); }
};

/// Makes the scene of a cell.
Scene make_stability_scene(const StabilityCase& cell);

struct StabilityGrid {
  StabilityScene scene = StabilityScene::chains;
  std::vector<StabilityMethod> methods = default_stability_methods();
  std::vector<double> severities = {1, 10, 100, 1e3, 1e4, 1e5, 1e6};
  std::vector<std::uint32_t> sizes = {5, 20, 100, 1000, 10000};
  std::vector<double> dts = {0.001, 0.003, 0.01, 1.0 / 60, 0.033, 0.1};  ///< Lengths of a step, in s.
  double at_dt = 1.0 / 60;      ///< Step of the plane severity × size, in s.
  std::uint32_t at_size = 100;  ///< Size of the plane severity × dt.
  bool full = false;            ///< Whether the whole box is measured, and not only these two planes of it.
  double duration = 3;          ///< Simulated time in s, rounded to whole steps.
};

/// Returns the grid that is measured of a scene if nothing else is asked for.
StabilityGrid default_grid(StabilityScene scene);

/// Lists each cell once, methods outermost. Throws InputError if a list is empty, a value makes no sense, or
/// at_dt or at_size is not one of the values.
std::vector<StabilityCase> list_cells(const StabilityGrid& grid);

/// Outcomes come in the order in which they are looked for.
enum class Outcome : std::uint8_t {
  survived,
  not_finite,     ///< A position or a velocity was not finite.
  frozen,         ///< An island was put back to its last finite state and stands still.
  unsolved,       ///< The direct method could not take a substep.
  stretched,      ///< The strain of a rod was above most_stretch.
  sank,           ///< Something was deeper in the ground than most_depth.
  gained_energy,  ///< The energy rose by more than most_gain_of().
  too_slow        ///< The cell was sound as far as it came within its time.
};
std::string_view to_string(Outcome outcome);

/// A cell that survives has at most this strain. Chains are of some use up to there, and the measured strain
/// tells more.
inline constexpr double most_stretch = 0.5;
/// A cell that survives gains at most this energy. What hangs may gain energy_range(), as falling through
/// the whole chain gives as much; what lands, a hundredth of that and its kinetic energy at first.
double most_gain_of(StabilityScene scene);
/// A cell that survives is at most so deep in the ground, as a share of a capsule's radius or, of boxes, of
/// half a side.
inline constexpr double most_depth = 0.5;

/// A result says what became of a cell. Strain, depth and energy are over the ends of the frames done. Energy
/// is relative to energy_range() and the kinetic energy at first. All are NaN or infinite if the state was.
struct StabilityResult {
  StabilityCase cell;
  Outcome outcome = Outcome::survived;
  std::uint64_t frames = 0;  ///< Frames that were done.
  bool finite = true;
  double stretch_max = 0;
  double depth_max = 0;     ///< As a share, as most_depth is.
  double energy_drift = 0;  ///< Largest distance from the energy at first.
  double energy_gain = 0;   ///< Largest rise above the energy at first.
  StepReport total{};
  double wall_s = 0;  ///< Time in World::step alone, in s.

  /// Returns milliseconds of stepping per simulated second.
  double ms_per_s() const;
};

/// Decides what became of a cell.
Outcome judge(const StabilityResult& result);

/// Steps the cell on one thread in double. Relaxation makes `sweeps` a step. It goes no further once a state
/// is not finite or an island is frozen, nor after `budget_s` of wall-clock time, set-up and measures
/// included. A frame that has begun is ended, and no step of any method is endless.
StabilityResult measure_stability(const StabilityCase& cell, std::uint32_t sweeps, double budget_s);

/// Returns a header and the results, one line each.
std::string stability_csv(const std::vector<StabilityResult>& results);

}  // namespace plumb::scenes
