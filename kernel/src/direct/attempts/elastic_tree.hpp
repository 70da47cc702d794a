#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "direct/loops/loop_stepper.hpp"
#include "direct/trees/tree_state.hpp"

namespace plumb::detail {

/// Takes substeps of trees whose rods do not fit together, as a line between anchors that are too far apart.
/// The tree is an island for the solver of loops then, whose rods may give. A line with bends that fails is
/// one, too. That island is made when a tree first needs it, since most never do.
template <class T>
class ElasticTree {
 public:
  /// It serves one tree at a time, of this topology, with the rules of its steps.
  ElasticTree(std::shared_ptr<const TreeTopology> tree, Gradient gradient, double drag, Isa isa)
      : topology_(std::move(tree)), stepper_(gradient, drag), isa_(isa) {}

  /// Lets rods that gave be rigid again, where that is the whole of a fallback (let_rods_give()).
  void bound_frames() { stepper_.bound_frames(); }

  /// Takes one substep of a tree alone (LoopStepper::advance_elastic()). Multipliers are forgotten.
  void advance(TreeState<T>& tree, double h, Tally& counters);
  /// Takes one substep of a tree alone as an island of any shape would, in halves where that helps.
  void advance_as_island(TreeState<T>& tree, double h, Tally& counters);

  /// Brings every tree that starts off its lengths to the place of detail::settle(), in `alone`. Returns how
  /// many do not fit there.
  std::uint32_t settle(TreeState<T>& trees, TreeState<T>& alone);

 private:
  struct Island {
    Island(const TreeTopology& tree, Isa isa);
    LoopState state;
    LoopWorkspace work;
  };

  Island& load(const TreeState<T>& tree);
  void store(TreeState<T>& tree) const;

  std::shared_ptr<const TreeTopology> topology_;
  LoopStepper stepper_;
  Isa isa_;
  std::unique_ptr<Island> island_;
};

extern template class ElasticTree<float>;
extern template class ElasticTree<double>;

}  // namespace plumb::detail
