#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "direct/attempts/elastic_tree.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Lane groups of one topology share the rules of their steps, and working memory for every thread.
template <class T>
struct TreeKind {
  struct Crew {
    TreeWorkspace<T> work;
    ElasticTree<T> elastic;  ///< It takes what no halving solves.
    LoneTree<T> alone;
    /// A single tree needs no other memory for these: by then it is done with the first.
    std::unique_ptr<TreeWorkspace<T>> work_of_alone;

    TreeWorkspace<T>& alone_work() { return work_of_alone ? *work_of_alone : work; }
    TreeCrew<T> view() { return {work, alone, alone_work(), &elastic}; }
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

    bool operator==(const Rules&) const = default;
  };

  TreeKind(const layouts::Tree& tree, std::uint32_t lanes, const Rules& rules, LineBends bends = {});

  /// Makes the lone trees of all crews, so that steps do not.
  void make_alone() {
    for (Crew& crew : crews) crew.alone.get();
  }

  /// Substeps estimate errors of second order by themselves. Others show when substeps are compared.
  bool estimates() const {
    return rules.controlled && rules.time_order == 2 && rules.gradient != Gradient::new_;
  }

  Rules rules;
  std::shared_ptr<const TreeTopology> topology;
  std::uint32_t lanes;
  TreeStepper<T> stepper;
  std::optional<TreeStepper<T>>
      calm_stepper;   ///< It has gradient mid, and is there if the gradient may change.
  Array<Crew> crews;  ///< There is one per thread.
};

extern template struct TreeKind<float>;
extern template struct TreeKind<double>;

/// Finds the kinds of trees that a world has, so that equal ones which come later share their working memory.
/// That stays in the cache from one to the next.
class TreeKinds {
 public:
  /// Returns layouts::find_tree() of an island, or null. It remembers small ones, since pieces of ropes that
  /// are cut come again and again, and finding a tree takes a tenth of a cut.
  std::shared_ptr<const layouts::Tree> tree_of(const layouts::LocalGraph& island);
  /// Returns a kind that a solver has, or a new one.
  template <class T>
  std::shared_ptr<TreeKind<T>> get(const layouts::Tree& tree, std::uint32_t lanes,
                                   const typename TreeKind<T>::Rules& rules, const LineBends& bends);

 private:
  /// Kinds by a hash of their trees. They live as long as solvers have them.
  template <class T>
  struct Known {
    std::multimap<std::uint64_t, std::weak_ptr<TreeKind<T>>> kinds;
    std::size_t full = 16;  ///< With so many, those that nobody has are looked for.
  };
  struct KnownTree {
    layouts::LocalGraph island;
    std::shared_ptr<const layouts::Tree> tree;
  };
  std::tuple<Known<float>, Known<double>> known_;
  std::multimap<std::uint64_t, KnownTree> trees_;  ///< by a hash of their islands
};

}  // namespace plumb::detail
