#pragma once

#include <cstdint>

#include "direct/trees/tree_state.hpp"

namespace plumb::detail {

/// Reads how the places of a line (LineBends) in a lane move in the substep that `work` has solved.
template <class T>
struct LineMotion {
  const TreeState<T>& state;
  const TreeWorkspace<T>& work;
  std::uint32_t lane;

  bool is_node(std::int64_t place) const { return place >= 0 && place < state.topology->nodes; }
  /// Returns the tie at a place that is not a node.
  std::uint32_t end(std::int64_t place) const {
    return state.topology->bends.end(place, state.topology->nodes);
  }
  /// Returns three numbers from entry `first` on.
  template <class From>
  Vec3 read(const From& from, std::size_t first) const {
    return state.read(from, first, lane);
  }
  Vec3 delta(std::int64_t place) const {
    return is_node(place) ? read(work.delta, 3 * static_cast<std::size_t>(place))
                          : read(state.tie_delta, 3 * std::size_t{end(place)});
  }
  /// Returns the way to a place from the one before where the substep starts, and by how much it changes.
  Vec3 rod(std::int64_t place) const {
    using simd::tree_fields::rod;
    const std::int64_t nodes = state.topology->nodes;
    if (place > 0 && place < nodes) return read(work.rod, rod * static_cast<std::size_t>(place));
    if (place == 0) return read(work.tie_rod, rod * std::size_t{end(-1)});
    if (place == nodes) return -1 * read(work.tie_rod, rod * std::size_t{end(nodes)});
    return read(work.clamp_rod, place < 0 ? 0 : 3);
  }
  Vec3 growth(std::int64_t place) const { return delta(place) - delta(place - 1); }
};

}  // namespace plumb::detail
