#pragma once

#include <cstdint>
#include <span>

#include "direct/loops/loop_state.hpp"
#include "direct/nets/rod_lines.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

struct LoopWorkspace;

/// A thread needs this to solve an island by its lines. Arrays have a number by slot, or three by vertex.
struct LineWorkspace {
  LineWorkspace(const RodLines& lines, std::span<const double> mass);

  /// Says that the next substep does not follow the last one.
  void forget() { past.known = 0; }
  /// These two stand around substeps that are taken back.
  void keep_history() { kept = past; }
  void take_history_back() { past = kept; }

  /// Multipliers have this past.
  struct History {
    Array<double> before, earlier;  ///< They are of the substeps before the last one.
    double kick = 0;                ///< It is of the last substep, in s².
    int known = 0;                  ///< So many of before and earlier are of substeps like the last one.
  };

  const RodLines* lines;
  LineSolver solver;
  Array<double> d,
      excess;                ///< They are of rods at the start of a substep: d in m, (|d|² - L²)/2 in m².
  Array<double> mu, wanted;  ///< mu has multipliers, and wanted what their change is to do.
  Array<double> pushed;      ///< Rods push nodes so far, 3 numbers per node.
  Array<double> start;       ///< These are the multipliers before an iteration.
  Array<double> last_change, last_mu, last_delta;  ///< The last one did this to them, and came to this.
  History past, kept;
  int stalls = 0;  ///< It counts them without a solution between them.
};

enum class LineOutcome : std::uint8_t {
  solved,
  diverged,  ///< Directions turn too far in a substep of this length.
  stalled    ///< Conjugate gradients do not get there: rods are redundant, or lines mean nothing.
};

/// Where rounding is the limit, lines leave this of |C|/L² of a rod (its strain), and of a displacement
/// relative to a rod. L² is the island's mean.
constexpr double finest_line_tolerance = 1e-11;
/// They leave at most this. With more, iterations would be left out that multipliers must not be extrapolated
/// without.
constexpr double coarsest_line_tolerance = 1e-2;

/// Iterates on work.delta and state.mu of a substep that begin() has prepared, until strains are at most
/// `tolerance`. Of Newton's matrix only F W Fᵀ is kept, F being the directions of forces. It is symmetric and
/// definite, and lacks the geometric term. What that leaves falls by the turn of rods in a substep every
/// time.
LineOutcome iterate_by_lines(LoopState& state, double theta, double kick, double tolerance,
                             LoopWorkspace& work, Tally& counters);

/// Does what project_delta() does. Returns false if it stalled. work.delta has got its kick then, and still
/// pulls on rods.
bool project_by_lines(const LoopState& state, double kick, LoopWorkspace& work);

template <class Archive>
void visit_members(Archive& archive, LineWorkspace::History& of) {
  auto& [before, earlier, kick, known] = of;
  archive(before, earlier, kick, known);
}
/// Masses follow from locks (LoopWorkspace::take_locks()).
template <class Archive>
void visit_members(Archive& archive, LineWorkspace& of) {
  auto& [lines, solver, d, excess, mu, wanted, pushed, start, last_change, last_mu, last_delta, past, kept,
         stalls] = of;
  archive(past, stalls);
}

}  // namespace plumb::detail
