#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "direct/displacements/displacement_newton.hpp"
#include "direct/elastic_nets/net_newton.hpp"
#include "direct/loops/loop_state.hpp"
#include "direct/nets/loop_lines.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

class Archive;

/// A thread needs this while it steps one island. It belongs to the island, so that a factorisation can be
/// used again.
struct LoopWorkspace {
  LoopWorkspace(const LoopState& state, Gradient gradient, Isa isa);

  /// The factor of a system is made when first asked for.
  struct Factor {
    Factor(const LoopSystem& system, Isa isa);
    const LoopSystem* system;
    SparseLdu ldu;
    Array<double> values, smallest, right;
    Array<std::uint8_t> acts;     ///< By rod: it was in the equations; slack cables are not.
    bool worth_carrying() const;  ///< Says whether to keep it for the next substep.
    double theta = 0, h = 0;  ///< They are of the substep it was made for; h is 0 if it is not worth keeping.
  };
  /// Lists what the next substep starts from. The state has been listed already.
  void archive(Archive& archive, const LoopState& state);
  /// Prepares for the nodes that are locked from now on.
  void take_locks(const LoopState& state);
  /// Says whether there is a cheaper way than to factorise.
  bool is_wide() const { return lines || net; }
  /// Returns a factor with couplings, or without if the topology's system does not have them.
  Factor& factor(bool couples);
  /// Returns the one that lines give way to. It is made when first asked for.
  DisplacementFactor& displacement_factor();

  std::shared_ptr<const LoopTopology> topology;
  Isa isa;
  std::unique_ptr<LineWorkspace>
      lines;  ///< They are here as long as they lead anywhere, if the topology has them.
  std::unique_ptr<NetWorkspace> net;  ///< It is here if the topology has one.
  std::unique_ptr<LoopSystem>
      coupled;  ///< It is made when the topology has none with couplings and it is needed.
  std::unique_ptr<Factor> first, second;
  std::unique_ptr<DisplacementFactor> displacements;  ///< It is made when lines do not lead to a solution.
  std::unique_ptr<Factor>
      projection;  ///< Gradient mid has none, as it projects in steps alone, not when asked for velocities.
  Array<double> delta;      ///< Displacements of this substep have 3 numbers per vertex, in m.
  Array<double> load;       ///< It has 3 numbers per node.
  Array<double> d, excess;  ///< d has 3 numbers per rod, in m, and excess is (|d|^2 - L^2)/2, in m^2.
  Array<double> mu_start, trial, start;
  Array<Vec3> fixed_jump;    ///< Anchors have changed their velocity by so much, in m/s.
  Array<Vec3> fixed_rest;    ///< Zeros: jumps begin there.
  Array<double> blows;       ///< They are the multipliers of a projection of velocities, as mu.
  Array<BendNumbers> bends;  ///< They hold for this substep.
  Array<Vec3> bend_starts;   ///< w of every bend at the start of this substep (curvature.hpp).
  TackleWorkspace tackles;
  Array<TwistSubstep> twists;
  Array<ReelSubstep> reels;
  Array<double> resists;  ///< Bends resist a node's displacement by so much; it has one per node.
  LawWorkspace laws;
  bool draws_cables = false;  ///< Rods that give a little are sought with their pulls (rod_terms()).
  LoopMotion saved;
};

/// This acts on velocities while they are projected: forces for a time (s), and fixed vertices that jump from
/// one velocity to another.
struct Projected {
  double kick = 0;
  bool jumps = false;
  bool as_before = false;  ///< Rods lie and pull as in the projection before, so that its factor serves.
};

/// Advances islands with loops (rings, ladders, trusses, nets) by substeps in which all rods are solved at
/// once. The schemes and the guard are those of TreeStepper: see there.
///
/// Wide islands of massless rods are solved by their lines (see iterate_by_lines()), in time that grows with
/// the rods. It takes some 0.1 us a rod and substep on one thread of a Xeon at 2.5 GHz. If a substep is too
/// long for that it is halved, and with gradients mid and new it is soon factorised instead (see
/// DisplacementFactor). Where lines are no help the island is factorised, after a few such substeps always.
///
/// Wide islands of elastic rods take conjugate gradients in displacements (see iterate_net()), and shorter
/// substeps where those do not converge.
///
/// Of others Newton's linear systems are factorised as they are, unsymmetric, displacements and multipliers
/// together (see LoopSystem). A factorisation serves for more than one iteration, and for later substeps, as
/// long as they converge fast. Nets of 32, 64 and 128 particles squared cost 3.4 + 0.25, 34 + 2.3 and 370 +
/// 12 ms for a factorisation and a solution with gradient old and lumped masses. Displacements then couple
/// through rods only. Otherwise they cost 18 + 1.4, 200 + 8.4 and 1500 + 45 ms.
///
/// Rods that others make redundant are those whose pivot vanishes against what both ends could yield. They
/// are left out where they are found, so that rods that fit together are all kept. Where rods do not fit
/// together, nothing converges. The island then takes the whole substep with gradient new and slightly
/// elastic rods (advance_elastic()). After that, or a fallback, the next substeps are taken with gradient
/// new.
class LoopStepper {
 public:
  LoopStepper(Gradient gradient, double drag, std::uint32_t time_order = 2);

  /// Sets the strain (|C|/L^2, L^2 the island's mean) that substeps solved by lines may leave. Those of
  /// gradient mid are always solved to rounding, which is how they keep energy.
  void set_line_tolerance(double strain) {
    line_tolerance_ = std::clamp(strain, finest_line_tolerance, coarsest_line_tolerance);
  }

  /// Lets substeps take no more than their Effort.
  void bound_frames() { bounds_frames_ = true; }

  /// Says whether the systems of this stepper couple the ends of rods.
  static bool couples(Gradient gradient, MassModel model) {
    return gradient != Gradient::old || model == MassModel::consistent;
  }

  /// Takes one substep, composed of shares for a time order above 2. It is cut into pieces first if the last
  /// ones had to be halved.
  ///
  /// Where the state keeps accelerations, it returns an estimate of the position error that it adds (m). That
  /// is h^2/24 times their change over two substeps, RMS over the nodes, of all its pieces together. It is
  /// infinite if the substep was not solved.
  ///
  /// It allocates nothing, but the first time that gradient old with lumped masses falls back or lines do not
  /// lead to a solution.
  double advance(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const;

  /// Takes one substep with gradient new and slightly elastic rods, and counts it. It minimises
  ///
  ///   delta . M delta / 2 - load . delta + sum over rods of C^2 / (4 soft L^2),
  ///
  /// a compromise that always exists: rods that are too short for their anchors share what they lack. It is
  /// Newton's method with a line search, without the push of rods that are pressed, which would make the sum
  /// concave where they buckle. Where rods whip tight, the stiffest rods that have a minimum
  /// stand. A substep counts as unsolved if even soft ones have none. Where rods turn out to fit together
  /// they are rigid again in the end. That is a fallback, and the function returns true.
  bool advance_elastic(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const;

  /// Lets the next substeps be taken with gradient new, where there is little hope for others.
  static void damp(LoopState& state);

  /// Takes one substep as it is, if Newton's method solves it. Otherwise returns false, and only multipliers
  /// may have changed.
  bool try_substep(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const {
    if (!solve(state, h, gradient_, true, work, counters)) return false;
    accept(state, h, gradient_, work, counters);
    return true;
  }

  /// Says how many pieces a substep is cut into. Each piece has all shares.
  std::uint32_t cuts(const LoopState& state, double h) const;

  /// Takes from u, which must hold velocities, what pulls on rods.
  void project_velocities(LoopState& state, LoopWorkspace& work) const;
  /// Adds to velocities what fixed vertices and lengths that have changed their speed give to them. What
  /// velocities have along rods stays, but on reels: gradient mid keeps energy with it.
  void take_blow(LoopState& state, LoopWorkspace& work) const;

  /// Puts velocities at the end of the last substep (m/s) into work.delta, 3 per node. Those of gradient old
  /// fit the rods (RATTLE, Andersen 1983).
  void find_velocities(LoopState& state, LoopWorkspace& work) const;

 private:
  double try_advance(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const;
  struct Coefficients;
  void pass_events(LoopState& state, double soon, LoopWorkspace& work) const;
  /// Takes one substep in which no particle of a reel becomes free or carried.
  double advance_whole(LoopState& state, double h, LoopWorkspace& work, Tally& counters) const;
  Coefficients coefficients(const LoopState& state, double h, Gradient gradient) const;
  void begin(LoopState& state, double h, Gradient gradient, LoopWorkspace& work) const;
  /// Iterates with the factor of an earlier substep or not. If that does not converge, mu is as it was.
  bool iterate(LoopState& state, double h, Gradient gradient, bool carried, LoopWorkspace& work,
               Tally& counters) const;
  bool keeps_energy(const LoopState& state, const LoopWorkspace& work) const;
  bool solve(LoopState& state, double h, Gradient gradient, bool by_lines, LoopWorkspace& work,
             Tally& counters) const;
  bool solve_by_lines(LoopState& state, double h, Gradient gradient, LoopWorkspace& work,
                      Tally& counters) const;
  void stop_ringing(LoopState& state, double h, LoopWorkspace& work) const;
  /// Ends a substep and returns the estimate of its error.
  double accept(LoopState& state, double h, Gradient gradient, LoopWorkspace& work, Tally& counters) const;
  /// A part of a substep may try so much, and all parts so far came to the rest.
  struct Attempts {
    int halvings, left;
    bool by_lines;
    std::uint64_t most_newton;  ///< They end where so many are counted.
    bool probed = false;        ///< The shortest part that may be has been tried.
    bool caught = false;        ///< What cables caught was stopped.
    int deepest = 0;            ///< Parts that were taken were halved so often at most.
    double error = 0;           ///< It is in m.
    double done = 0;            ///< Parts that were taken are so long together, in s.
  };
  /// Stops what rigid cables have caught, which loses the energy of the blow.
  void end_ringing(LoopState& state, LoopWorkspace& work, Tally& counters) const;
  /// Takes a substep in so many pieces. Returns whether all were solved; otherwise the state is as it was.
  bool advance_pieces(LoopState& state, double h, std::uint32_t count, Attempts& attempts,
                      LoopWorkspace& work, Tally& counters) const;
  /// Takes it in pieces as long as the state's pace says. Those before one that is not solved stand.
  bool advance_at_pace(LoopState& state, double h, Attempts& attempts, LoopWorkspace& work,
                       Tally& counters) const;
  /// Takes one piece, with all shares.
  bool advance_piece(LoopState& state, double h, Attempts& attempts, LoopWorkspace& work,
                     Tally& counters) const;
  /// Takes a substep of a wide island by its lines, or where those need many pieces, by factorisation.
  bool advance_wide(LoopState& state, double h, Attempts& attempts, LoopWorkspace& work,
                    Tally& counters) const;
  bool advance_part(LoopState& state, double h, int depth, Attempts& attempts, LoopWorkspace& work,
                    Tally& counters) const;
  void project(LoopState& state, const Projected& acts, LoopWorkspace& work) const;
  /// Projects work.delta and says whether that is sound. Where rods are nearly straight between anchors, or
  /// drawn tight, it is not, and nothing pulls then.
  bool project_soundly(LoopState& state, const Projected& acts, LoopWorkspace& work) const;
  /// Lets go of cables that were thrown back (`thrown_back`), once the changes of velocities in work.delta
  /// are projected: they pass no blow on. One that hauls them faster than they come in is found by the next
  /// substep. Returns whether there were any; otherwise work.delta and work.blows are as they were.
  bool release_thrown_back(LoopState& state, LoopWorkspace& work) const;
  /// Elements take many Newton steps each, and hardly ever fail. Nets solved by lines have shorter ways.
  bool is_bounded(const LoopState& state) const {
    return bounds_frames_ && !state.topology->any() && !state.topology->lines;
  }

  Gradient gradient_;
  double drag_;
  std::span<const double> shares_;
  double largest_share_;
  bool bounds_frames_ = false;
  double line_tolerance_ = finest_line_tolerance;
};

/// Adds what a projection of velocities did to how cords pulled and anchors held in this step.
void count_blows(LoopState& state, const LoopWorkspace& work);

/// Archives a factor that the next substep may use.
template <class Archive>
void visit_members(Archive& archive, LoopWorkspace::Factor& of) {
  auto& [system, ldu, values, smallest, right, acts, theta, h] = of;
  archive(ldu, acts, theta, h);
}

}  // namespace plumb::detail
