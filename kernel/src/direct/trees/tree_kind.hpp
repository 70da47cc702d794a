#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "direct/attempts/elastic_tree.hpp"
#include "direct/trees/tree_stepper.hpp"

namespace plumb::detail {

/// Lane groups of one topology share the rules of their steps, and working memory for every thread.
template <class T>
struct TreeKind {
  struct Crew {
    TreeWorkspace<T> work;
    TreeState<T> alone;  ///< It is one tree, for substeps that are halved.
    TreeWorkspace<T> alone_work;
    ElasticTree<T> elastic;  ///< It takes what no halving solves.

    TreeCrew<T> view() { return {work, alone, alone_work, &elastic}; }
  };

  /// These rules come from the settings and say how trees are moved.
  struct Rules {
    Gradient gradient;
    std::uint32_t time_order;
    bool controlled;        ///< It says whether an accuracy is set.
    bool changes_gradient;  ///< Trees may take gradient mid while they are calm.
    bool bounds_frames;     ///< Substeps may take so many times the usual work (Effort).
    double drag;            ///< It is in 1/s.
    Isa isa;
    unsigned threads;
  };

  TreeKind(const layouts::Tree& tree, std::uint32_t lanes, const Rules& rules, LineBends bends = {});

  /// Substeps estimate errors of second order by themselves. Others show when substeps are compared.
  bool estimates() const {
    return rules.controlled && rules.time_order == 2 && rules.gradient != Gradient::new_;
  }

  Rules rules;
  std::shared_ptr<const TreeTopology> topology;
  std::uint32_t lanes;
  TreeStepper<T> stepper;
  std::optional<TreeStepper<T>>
      calm_stepper;         ///< It has gradient mid, and is there if the gradient may change.
  std::vector<Crew> crews;  ///< There is one per thread.
};

extern template struct TreeKind<float>;
extern template struct TreeKind<double>;

}  // namespace plumb::detail
