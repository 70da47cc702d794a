#pragma once

#include <cstdint>
#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "contact/spatial_hash.hpp"
#include "plumb/layouts/memory.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// This is the broad phase. It knows which islands are awake, and which of them and of the sleepers may touch
/// within a step. A cluster is a set of such islands in the order of their numbers.
///
/// Sleepers that touch each other are a heap. A blow to one goes through all of it within a step, so that a
/// cluster has whole heaps, which wake as one.
class Clusters {
 public:
  /// Finds which islands sleep. The states must outlive this object and stay where they are. Shapes nearer
  /// than `margin` (m) may touch.
  void start(std::span<LinkageState> islands, double margin);

  /// Takes in where all islands are now, and makes room for those that begin() is to know.
  void grow(std::span<LinkageState> islands);
  /// Begins to know an island, which is awake.
  void begin(std::uint32_t island);
  /// Ends an island, which must be awake. Its state lists none from now on, and nothing wakes it.
  void end(std::uint32_t island);

  std::span<const std::uint32_t> awake() const { return awake_; }  ///< island numbers, ascending
  /// Returns whether any island of the scene has a shape.
  bool any_shapes() const { return any_shapes_; }

  /// Forms the clusters of a step, with the sleepers nearby. Several threads call `reach(state)`, which
  /// returns where an awake island with shapes can come within the step.
  template <class Reach>
  void form(Team& team, Reach&& reach) {
    members_ = awake_;
    for (const std::uint32_t i : awake_) root_[i] = i;
    if (any_shapes_) {
      team.for_each(static_cast<std::uint32_t>(awake_.size()), [&](std::uint32_t k, unsigned) {
        LinkageState& state = islands_[awake_[k]];
        if (state.linkage->has_shapes()) bounds_[state.number] = reach(state);
      });
      join_near();
    }
    sort_members();
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(starts_.size() - 1); }
  std::span<LinkageState* const> operator[](std::uint32_t cluster) const {
    return {members_of_.data() + starts_[cluster], starts_[cluster + 1] - starts_[cluster]};
  }
  /// Lets the islands of a cluster know what went wrong with it in the step.
  void tell(std::uint32_t cluster, Troubles troubles);
  /// Returns the box that an island can reach within the step.
  const Bounds& reach_of(std::uint32_t island) const { return bounds_[island]; }
  /// Lets an island sleep here that its own solver has put to rest.
  void fall_asleep(std::uint32_t island);

  /// Lists who is awake and where sleepers are, once the states are listed.
  template <class Archive>
  void archive(Archive& archive) {
    auto& [islands, awake, sleepers, walkers, any_shapes, cell, begun, margin, bounds, marks, root, members,
           mark, order, members_of, starts] = *this;
    archive(awake, bounds);
    if (archive.restores()) list_sleepers();
  }

  /// Wakes an island, and the sleepers that may lie on it or under it.
  void wake(std::uint32_t island);
  /// Ends a step. Takes in the islands that were woken within it, and puts the clusters to sleep that `rests`
  /// marks. Returns how many islands fell asleep.
  std::uint32_t settle(std::span<const std::uint8_t> rests);

 private:
  void find_cell();
  void list_sleepers();
  bool may_meet(std::uint32_t a, std::uint32_t b) const;
  std::uint32_t root(std::uint32_t island);
  void join(std::uint32_t a, std::uint32_t b);
  void join_near();
  void gather_heap(std::uint32_t sleeper);
  void sort_members();
  void put_to_sleep(LinkageState& state);

  std::span<LinkageState> islands_;
  Array<std::uint32_t> awake_;  ///< numbers of awake islands, ascending
  SpatialHash sleepers_, walkers_;
  bool any_shapes_ = false;
  double cell_ = 1;        ///< size of a cell, m
  std::size_t begun_ = 0;  ///< islands that began since it was found
  double margin_ = 0;      ///< distance within which shapes may touch, m
  Array<Bounds> bounds_;   ///< by island: for a sleeper as it is listed, for others the step's reach
  Array<std::uint32_t> marks_, root_, members_;
  std::uint32_t mark_ = 0;
  Array<std::uint64_t> order_;
  Array<LinkageState*> members_of_;  ///< members of all clusters, one cluster after the other
  Array<std::uint32_t> starts_{0};   ///< where each cluster begins in members_of_, and the end
};

}  // namespace plumb::detail
