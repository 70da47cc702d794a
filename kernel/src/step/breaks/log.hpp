#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "step/breaks/addition.hpp"
#include "step/breaks/edits.hpp"

namespace plumb::detail {

/// Holds what one call of Breaks::take_out() took, and how what it made anew was then; or what was added or
/// removed at once. With all of them in turn, a world that is compiled anew becomes alike.
struct Split {
  Array<std::uint32_t> rods{};  ///< They broke; by number in the whole scene.
  Edits edits{};
  Array<Vec3> positions{}, velocities{};  ///< m and m/s, of Fallen::particles
  Array<double> lengths{};                ///< m, of Fallen::rods, of its tackles, and of rods it holds
  Array<Addition> added{};                ///< one at most
  Array<std::uint32_t> removed{};         ///< one particle of an island at most
  Array<std::uint32_t> seats{};           ///< numbers of the solvers that were made
  Array<std::uint32_t> islands{};         ///< numbers that the contact solver gave
  Array<std::uint32_t> spheres{};         ///< numbers of capsules that are at ends of what was cut

  friend bool operator==(const Split&, const Split&) = default;
};
template <class Archive>
void visit_members(Archive& archive, Split& of) {
  auto& [rods, edits, positions, velocities, lengths, added, removed, seats, islands, spheres] = of;
  archive(rods, edits, positions, velocities, lengths, added, removed, seats, islands, spheres);
}

/// Lists what a world did to the islands of its scene. Of what was added nothing stays once it is removed,
/// with all that it came together with: what was done to that meanwhile goes, too.
class Log {
 public:
  /// Numbers a group of entries that depend on each other, and end together.
  using Group = std::uint32_t;

  /// Takes an addition.
  void push_addition(Split split);
  /// Returns the group of what is done to particles, whose groups become one. It ends with the world if the
  /// scene had one of them.
  Group join(std::span<const std::uint32_t> particles);
  /// Takes what was done to particles of a group.
  void push(Split split, Group group);
  /// Takes a removal of particles.
  void push_removal(Split split, std::span<const std::uint32_t> particles);

  Array<Split> splits() const;
  bool is_empty() const { return entries_.empty(); }
  bool is_of(std::span<const Split> splits) const;

  /// Writes splits() without a copy. What restores reads them as they are.
  template <class Archive>
  void archive_entries(Archive& archive) {
    std::uint64_t count = entries_.size();
    archive(count);
    for (auto& [serial, split] : entries_) archive(split);
  }

 private:
  using Serial = std::uint32_t;
  static constexpr Group of_scene = 0;  ///< that never ends
  struct Members {
    Array<Serial> entries{};
    Array<std::uint32_t> particles{};  ///< those that were added; removed ones may be among them
    std::uint32_t left = 0;            ///< how many of them are still there
  };
  Group group_of(std::uint32_t particle) const {
    return particle < groups_.size() ? groups_[particle] : of_scene;
  }
  Group merge(Group one, Group other);

  std::map<Serial, Split> entries_;
  std::map<Group, Members> members_;
  Array<Group> groups_;  ///< by particle
  Serial last_ = 0;
  Group last_group_ = of_scene;
};

}  // namespace plumb::detail
