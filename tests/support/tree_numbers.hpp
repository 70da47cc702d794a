#pragma once

#include <cstdint>
#include <memory>

#include "direct/trees/tree_state.hpp"
#include "support/islands.hpp"

/// Equal trees of a scene, at the beginning of a substep.
namespace plumb::test {

template <class T>
struct TreeNumbers {
  /// `lanes` equal islands of the scene, or one.
  TreeNumbers(const Scene& scene, std::uint32_t lanes)
      : of(scene),
        tree(of.tree(0)),
        topology(std::make_shared<const detail::TreeTopology>(tree)),
        state(topology, lanes),
        work(*topology, lanes) {
    constexpr double h = 0.01;
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      state.fill_lane(lane, scene, MassModel::lumped, tree,
                      {of.islands.vertices(lane), of.islands.edges(lane)});
      work.ratio[lane] = static_cast<T>(h);  // u is a velocity
      work.kick[lane] = static_cast<T>(0.5 * h * h);
      work.inverse_kick[lane] = 1 / work.kick[lane];
      work.u_delta[lane] = work.active[lane] = 1;
    }
    for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] = static_cast<T>(0.1 * (i % 7));
    work.is_line = true;  // no displacements are guessed
    work.keeps_acceleration = false;
  }
  simd::TreeView<T> view() { return work.view(state); }

  IslandsOf of;
  layouts::Tree tree;
  std::shared_ptr<const detail::TreeTopology> topology;
  detail::TreeState<T> state;
  detail::TreeWorkspace<T> work;
};

}  // namespace plumb::test
