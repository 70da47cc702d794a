#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "direct/trees/line_segments.hpp"
#include "direct/trees/newton_limits.hpp"
#include "direct/trees/tree_state.hpp"
#include "interface/tally.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "time/composition.hpp"

namespace plumb::detail {

template <class T>
class ElasticTree;

/// Is one tree, for substeps that are halved. Few ever are, and it is made when it is first asked for.
template <class T>
class LoneTree {
 public:
  explicit LoneTree(std::shared_ptr<const TreeTopology> topology) : topology_(std::move(topology)) {}
  explicit LoneTree(TreeState<T>& there) : state_(&there) {}

  TreeState<T>& get() {
    if (state_ == nullptr) {
      made_ = std::make_unique<TreeState<T>>(topology_, 1);
      state_ = made_.get();
    }
    return *state_;
  }
  TreeState<T>* made() const { return state_; }  ///< or null

 private:
  std::shared_ptr<const TreeTopology> topology_;
  std::unique_ptr<TreeState<T>> made_;
  TreeState<T>* state_ = nullptr;
};

/// Steps of trees work with these buffers, which belong to a thread or to a line in segments.
template <class T>
struct TreeCrew {
  TreeWorkspace<T>& work;
  LoneTree<T>& alone;
  TreeWorkspace<T>& alone_work;  ///< It is `work` if that is of one tree.
  /// Takes what no halving solves. Without it such trees stay where they are.
  ElasticTree<T>* elastic = nullptr;
};

/// Advances trees by substeps in which all rods of a tree are solved at once by Newton's method.
///
/// Every rod has C = (|x_b - x_a|^2 - L^2)/2, and its force is along m = d + theta (change of d). The
/// equations are
///
///   M delta = load + sum over rods of mu m,    C(x + delta) = 0
///
/// theta 0 is SHAKE (Ryckaert, Ciccotti, Berendsen 1977), with load = M u + h^2 f. theta 1/2 is the
/// energy-momentum scheme (Simo, Tarnow 1992; Gonzalez 2000), with load = h M v + h^2/2 f and v_new = 2
/// delta/h - v. theta 1 is the exact limit of the thesis's projection (eq. 4.5-4.7).
///
/// Where Newton fails, the tree is put back and takes two steps of half the length, and so on. What still
/// fails at the shortest length is tried with theta 1, which is the hardest to break. If even that fails the
/// tree takes the whole substep with elastic rods (ElasticTree), and is counted. For a while it is not halved
/// then, where it fails again. A line with bends that fails takes the substep as an island of any shape does.
template <class T>
class TreeStepper {
 public:
  /// `estimates` says whether advance() is to estimate errors, of time order 2.
  TreeStepper(Gradient gradient, double drag, bool estimates, Isa isa, std::uint32_t time_order = 2);

  /// Takes one substep, composed of shares for a time order above 2, of every tree of a state. Returns an
  /// estimate of the position error that it adds, in m. That is h^2/12 times the change of acceleration, RMS
  /// over the particles of the worst tree. It is infinite where a tree had to be halved.
  double advance(TreeState<T>& state, double h, const TreeCrew<T>& crew, Tally& counters) const;

  /// Lets substeps take no more than their Effort, where one may be hard without end.
  void bound_frames() { bounds_frames_ = true; }

  /// Does the same for one line in segments.
  double advance(const LineSegments& segments, TreeState<T>& state, double h, const TreeCrew<T>& crew,
                 Tally& counters) const;

  /// Takes from u, which must hold velocities, what pulls on rods, and adds what the mass of rods passes on
  /// from fixed ends that change their velocity.
  void project_velocities(TreeState<T>& state, TreeWorkspace<T>& work) const;
  /// Adds to velocities what fixed ends and lengths that have changed their speed give to them. What
  /// velocities have along rods stays: gradient mid keeps energy with it.
  void take_blow(TreeState<T>& state, TreeWorkspace<T>& work) const;

  /// Puts velocities of all lanes at the end of the last substep (m/s) into work.velocity. Those of gradient
  /// old fit the rods (RATTLE, Andersen 1983).
  void find_velocities(TreeState<T>& state, TreeWorkspace<T>& work) const;

  /// Says whether multipliers alone are unknown, see simd/tree/lines/line_lanes.hpp.
  static bool is_line(const TreeState<T>& state, Gradient gradient) {
    return gradient == Gradient::old && state.topology->is_line && !state.is_coupled;
  }

  /// Says how many pieces a substep is cut into so that gradient old stays stable, by the tensions of the
  /// last one. Each piece has all shares: pieces of shares would be of second order.
  std::uint32_t cuts(const TreeState<T>& state, double h) const;

 private:
  /// Returns the shares of a substep. What is grabbed takes it whole: a step back would let a stiff grab
  /// push.
  std::span<const double> shares_of(const TreeState<T>& state) const {
    return state.grabs.any() ? composition(2) : shares_;
  }
  /// Returns cuts(), or fewer once the work is spent.
  std::uint32_t bounded_cuts(const TreeState<T>& state, double h, Tally& counters) const;
  double advance_piece(TreeState<T>& state, double h, const TreeCrew<T>& crew, Tally& counters) const;
  double advance_piece(const LineSegments& segments, TreeState<T>& state, double h, const TreeCrew<T>& crew,
                       Tally& counters) const;
  /// Says whether no lane that converged is beyond that limit. Those that are count as failed.
  bool is_stable(TreeState<T>& state, double h, TreeWorkspace<T>& work,
                 const LineSegments* segments = nullptr) const;
  struct Coefficients;
  /// `last` is TreeState::u_step, in s.
  Coefficients coefficients(double last, double h, Gradient gradient) const;
  void begin(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work) const;
  /// Iterates until every lane has converged or failed. Says whether all converged.
  bool solve(TreeState<T>& state, Gradient gradient, TreeWorkspace<T>& work, Tally& counters) const;
  void accept(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work,
              Tally& counters) const;
  /// Puts back those that a lane had before a substep that failed.
  void restore_multipliers(TreeState<T>& state, std::uint32_t lane) const;
  /// Takes a substep that failed in another way: of the tree crew.alone, which `load` puts there.
  enum class Rescue : std::uint8_t { none, halves, elastic };
  template <class Load>
  Rescue rescue(double h, const TreeCrew<T>& crew, Tally& counters, Load&& load) const;
  /// A tree alone is advanced by recursive halving.
  struct Attempts {
    int left;
    std::uint64_t most_newton;  ///< They end where so many are counted.
    bool probed = false;        ///< The shortest part that may be has been tried.
    int deepest = 0;            ///< Parts of this piece were halved so often at most, the piece included.
    double done = 0;            ///< This share of the substep has been taken.

    /// Says whether too little is left for halves of a part that is as deep, through the rest of the substep.
    bool are_too_few_for_halves(std::uint64_t newton, int depth) const {
      const double pieces = std::ldexp(1 - done, depth + 1);
      return static_cast<double>(newton) + tree_limits::least_for_piece * pieces >
             static_cast<double>(most_newton);
    }
  };
  /// Advances a tree alone by a substep that was not solved as a whole.
  bool advance_in_pieces(TreeState<T>& state, double h, Attempts& attempts, TreeWorkspace<T>& work,
                         Tally& counters) const;
  bool advance_alone(TreeState<T>& state, double h, int depth, Attempts& attempts, TreeWorkspace<T>& work,
                     Tally& counters) const;
  /// Solves a substep of a tree alone, if it can.
  bool try_alone(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work,
                 Tally& counters) const;
  /// Takes a substep of a tree alone with gradient new, halved at most so often.
  bool advance_damped(TreeState<T>& state, double h, int halvings, TreeWorkspace<T>& work,
                      Tally& counters) const;
  /// Sets those of this substep and the one before.
  void set_tie_displacements(TreeState<T>& state, double h, const TreeWorkspace<T>& work) const;
  void put_ties(TreeState<T>& state, std::size_t i, Vec3 delta, Vec3 u) const;
  /// Projects work.velocity onto what no rod resists when fixed ends go at tie_velocity, into work.delta.
  /// Fixed ends have velocities, and had others, in m/s. Lengths change at rates.
  struct Drive {
    const Array<Vec3>&velocity, &before;
    const typename TreeLaws<T>::template Of<double>& rate;
  };
  void project(TreeState<T>& state, const Drive& drive, TreeWorkspace<T>& work) const;
  void project_without_pushes(TreeState<T>& state, const Drive& drive, TreeWorkspace<T>& work) const;
  /// Lets go of cables that were thrown back before a blow that `jumps` give, as LoopStepper does.
  void release_thrown_back(TreeState<T>& state, const Drive& jumps, TreeWorkspace<T>& work) const;
  /// Takes what was projected, in lanes where it is not many times what was given. Rods that are nearly
  /// straight between anchors have no sound projection.
  void take_sound(const TreeState<T>& state, const Drive& drive, TreeWorkspace<T>& work,
                  std::span<T> to) const;
  const simd::TreeKernels<T>& kernels(const TreeState<T>& state) const;

  Gradient gradient_;
  double drag_;
  bool estimates_, bounds_frames_ = false;
  std::span<const double> shares_;
  double largest_share_;
  const simd::TreeKernels<T>& vector_;
  const simd::TreeKernels<T>& scalar_;
};

}  // namespace plumb::detail
