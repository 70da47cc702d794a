#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "direct/loops/loop_state.hpp"
#include "direct/nets/loop_lines.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// What a thread needs while it steps one island; belongs to it, so that a factorisation can be used again.
struct LoopWorkspace {
  LoopWorkspace(const LoopState& state, Gradient gradient, Isa isa);

  /// The factor of a system; made when first asked for.
  struct Factor {
    Factor(const LoopSystem& system, Isa isa);
    const LoopSystem* system;
    SparseLdu ldu;
    std::vector<double> values, smallest, right;
    bool worth_carrying() const;  ///< into the next substep
    double theta = 0, h = 0;      ///< of the substep it was made for; h is 0 if it is not worth keeping
  };
  /// With couplings, or without if the topology's system does not have them.
  Factor& factor(bool couples);

  std::shared_ptr<const LoopTopology> topology;
  Isa isa;
  std::unique_ptr<LineWorkspace> lines;  ///< as long as they lead anywhere, if the topology has them
  std::unique_ptr<LoopSystem> coupled;   ///< if the topology has none with couplings and it was needed
  std::unique_ptr<Factor> first, second;
  std::unique_ptr<Factor>
      projection;  ///< but for gradient mid, which projects only in steps, not when asked for velocities
  std::vector<double> delta;      ///< m, 3 per vertex: of this substep
  std::vector<double> load;       ///< 3 per node
  std::vector<double> d, excess;  ///< 3 per rod, and (|d|^2 - L^2)/2
  std::vector<double> mu_start, trial;
  LoopMotion saved;
};

/// Advances islands with loops (rings, ladders, trusses, nets) by substeps in which all rods are solved at
/// once. The same schemes, and the same guard, as TreeStepper: see there.
///
/// Wide islands of massless rods are solved by their lines (see iterate_by_lines()), in time that grows with
/// the rods: some 0.1 us a rod and substep on one thread of a Xeon at 2.5 GHz. If a substep is too long for
/// that it is halved; where lines are no help the island is factorised, after a few such substeps always.
///
/// Of others Newton's linear systems are factorised as they are, unsymmetric, displacements and multipliers
/// together (see LoopSystem); a factorisation serves for more than one iteration, and for later substeps, as
/// long as they converge fast. For nets of 32, 64 and 128 particles squared a factorisation and a solution
/// with it cost 3.4 + 0.25, 34 + 2.3 and 370 + 12 ms for gradient old with lumped masses, where displacements
/// couple through rods only; 18 + 1.4, 200 + 8.4 and 1500 + 45 ms otherwise.
///
/// Rods that others make redundant are those whose pivot vanishes against what both ends could yield: they
/// are left out where they are found, so that rods that fit together are all kept. Where rods do not fit
/// together, nothing converges; the island then takes the whole substep with gradient new and slightly
/// elastic rods, which minimises |change|^2/2 + sum C^2/(2 soft), a compromise that always exists, and is
/// counted as unsolved. After that, or a fallback, the next substeps are taken with gradient new.
class LoopStepper {
 public:
  LoopStepper(Gradient gradient, double drag, std::uint32_t time_order = 2);

  /// Strain (|C|/L^2, L^2 the island's mean) that substeps solved by lines may leave; gradient mid's are
  /// always solved to rounding, which is how they keep energy.
  void set_line_tolerance(double strain) {
    line_tolerance_ = std::clamp(strain, finest_line_tolerance, coarsest_line_tolerance);
  }

  /// Whether the systems of this stepper couple the ends of rods.
  static bool couples(Gradient gradient, MassModel model) {
    return gradient != Gradient::old || model == MassModel::consistent;
  }

  /// One substep, composed of shares for a time order above 2; cut into pieces first if the last ones had to
  /// be halved. Returns an estimate of the position error it adds, m, where the state keeps accelerations:
  /// h^2/24 times their change over two substeps, RMS over the nodes, of all its pieces together; infinite if
  /// it was not solved.
  /// Allocates nothing, but the first time that gradient old with lumped masses falls back or lines do not
  /// lead to a solution.
  double advance(LoopState& state, double h, LoopWorkspace& work, StepReport& counters) const;

  /// How many pieces a substep is cut into. Each piece has all shares.
  std::uint32_t cuts(const LoopState& state, double h) const;

  /// Takes from u, which must hold velocities, what pulls on rods.
  void project_velocities(LoopState& state, LoopWorkspace& work) const;

  /// Velocities at the end of the last substep (m/s) into work.delta, 3 per node. Those of gradient old fit
  /// the rods (RATTLE, Andersen 1983).
  void find_velocities(LoopState& state, LoopWorkspace& work) const;

 private:
  void begin(LoopState& state, double h, Gradient gradient, LoopWorkspace& work) const;
  /// Newton with the factor of an earlier substep or not; if it does not converge, mu is as it was.
  bool iterate(LoopState& state, double h, Gradient gradient, bool carried, LoopWorkspace& work,
               StepReport& counters) const;
  bool keeps_energy(const LoopState& state, const LoopWorkspace& work) const;
  bool solve(LoopState& state, double h, Gradient gradient, LoopWorkspace& work, StepReport& counters) const;
  void compromise(LoopState& state, double h, LoopWorkspace& work, StepReport& counters) const;
  /// Returns the estimate.
  double accept(LoopState& state, double h, Gradient gradient, LoopWorkspace& work) const;
  /// What a part of a substep may try, and what all parts so far came to.
  struct Attempts {
    int halvings, left;
    bool fell_back = false;
    double shortest_half = 0;  ///< s, of those that had to be halved; 0: none had to
    double error = 0;          ///< m
  };
  bool advance_part(LoopState& state, double h, int depth, Attempts& attempts, LoopWorkspace& work,
                    StepReport& counters) const;
  void project(LoopState& state, double kick, LoopWorkspace& work) const;

  Gradient gradient_;
  double drag_;
  std::span<const double> shares_;
  double largest_share_;
  double line_tolerance_ = finest_line_tolerance;
};

}  // namespace plumb::detail
