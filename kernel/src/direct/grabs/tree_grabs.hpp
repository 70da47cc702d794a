#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "interface/grab.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

template <class T>
struct TreeState;
template <class T>
struct TreeWorkspace;

/// Holds a grab of a tree in a lane: of a node, or of a place on a rod whose mass couples its ends.
struct TreeGrab : HeldGrab {
  /// The place is a sum of nodes, and of a tie's anchor.
  struct Part {
    std::uint32_t entry = 0;  ///< a node, or a tie
    double share = 0;
    bool is_tie = false;
    std::uint32_t node_of_line = 0;  ///< that of the whole, if a line is cut into segments
  };
  std::uint32_t lane = 0, count = 0;
  std::array<Part, 2> parts{};
  GrabSubstep substep{};  ///< the one under way

  std::span<const Part> all() const { return {parts.data(), count}; }
};

/// Holds the grabs of equal trees, in the order of their lanes. Within a substep they change masses and
/// forces, so that all solves see heavier nodes. Between substeps those are what they were.
template <class T>
struct TreeGrabs {
  Array<TreeGrab> all;
  Array<std::pair<T*, T>> changed;  ///< numbers of the state, and what they are else

  bool any() const { return !all.empty(); }
  void put_back() {
    while (!changed.empty()) {
      *changed.back().first = changed.back().second;
      changed.pop_back();
    }
  }
  void change(T& number, double by) {
    changed.emplace_back(&number, number);
    number = static_cast<T>(number + by);
  }
  /// Takes the grabs of a lane from another, or gives them back.
  void copy_lane(std::uint32_t lane, const TreeGrabs& from, std::uint32_t from_lane);
};

/// Begins a substep of h (s) in all lanes that take part, once factors of the substep are known.
template <class T>
void begin_grabs(TreeState<T>& state, double h, Gradient gradient, TreeWorkspace<T>& work);
/// Ends it in lanes that are active, where velocities of gradient mid have been found. They decay by `drag`
/// (1/s).
template <class T>
void end_grabs(TreeState<T>& state, double h, Gradient gradient, double drag, TreeWorkspace<T>& work);
/// Lets velocities at the end of the last substep be found with what grabs do there, of gradient old.
template <class T>
void hold_at_end(TreeState<T>& state, TreeWorkspace<T>& work);

template <class Archive>
void visit_members(Archive& archive, TreeGrab::Part& of) {
  auto& [entry, share, is_tie, node_of_line] = of;
  archive(entry, share, is_tie, node_of_line);
}
template <class Archive>
void visit_members(Archive& archive, TreeGrab& of) {
  archive(static_cast<HeldGrab&>(of), of.lane, of.count, of.parts);
}
template <class Archive, class T>
void visit_members(Archive& archive, TreeGrabs<T>& of) {
  auto& [all, changed] = of;
  archive(all);
}

}  // namespace plumb::detail
