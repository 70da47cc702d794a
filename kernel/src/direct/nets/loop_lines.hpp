#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "direct/loops/loop_state.hpp"
#include "direct/nets/rod_lines.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

struct LoopWorkspace;

/// What a thread needs to solve an island by its lines. By slot, or three numbers by vertex.
struct LineWorkspace {
  LineWorkspace(const RodLines& lines, std::span<const double> mass);

  /// The next substep does not follow the last one.
  void forget() { past.known = 0; }
  /// Around substeps that are taken back.
  void keep_history() { kept = past; }
  void take_history_back() { past = kept; }

  /// Of multipliers.
  struct History {
    std::vector<double> before, earlier;  ///< those of the substeps before the last one
    double kick = 0;                      ///< of the last substep
    int known = 0;                        ///< which of before and earlier are of substeps like the last one
  };

  const RodLines* lines;
  LineSolver solver;
  std::vector<double> d, excess;   ///< of rods at the start of a substep: m, (|d|² - L²)/2
  std::vector<double> mu, wanted;  ///< multipliers; what their change is to do
  std::vector<double> pushed;      ///< 3 per node: by rods
  std::vector<double> start;       ///< multipliers before an iteration
  std::vector<double> last_change, last_mu, last_delta;  ///< what the last one did to them, and came to
  History past, kept;
  int stalls = 0;  ///< without a solution between them
};

enum class LineOutcome : std::uint8_t {
  solved,
  diverged,  ///< directions turn too far in a substep of this length
  stalled    ///< conjugate gradients do not get there: rods are redundant, or lines mean nothing
};

/// What lines leave of |C|/L² of a rod (its strain), and of a displacement relative to a rod, L² the mean of
/// the island, where rounding is the limit.
constexpr double finest_line_tolerance = 1e-11;
/// And at most: with more, iterations would be left out that multipliers must not be extrapolated without.
constexpr double coarsest_line_tolerance = 1e-2;

/// Newton's iteration of a substep that begin() has prepared, into work.delta and state.mu, until that is at
/// most `tolerance`. Of the matrix only F W Fᵀ is kept, F the directions of forces: symmetric and definite,
/// without the geometric term. What that leaves falls by the turn of rods in a substep every time.
LineOutcome iterate_by_lines(LoopState& state, double theta, double kick, double tolerance,
                             LoopWorkspace& work, StepReport& counters);

/// As project_delta(). False if stalled: work.delta has got its kick then, and still pulls on rods.
bool project_by_lines(const LoopState& state, double kick, LoopWorkspace& work);

}  // namespace plumb::detail
