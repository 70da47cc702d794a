#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "step/breaks/addition.hpp"
#include "step/breaks/edits.hpp"

namespace plumb::detail {

/// Holds what one call of Breaks::take_out() took, and how what it made anew was then; or what was added or
/// removed at once. With all of them in turn, a world that is compiled anew becomes alike.
struct Split {
  std::vector<std::uint32_t> rods{};  ///< They broke; by number in the whole scene.
  Edits edits{};
  std::vector<Vec3> positions{}, velocities{};  ///< m and m/s, of Fallen::particles
  std::vector<double> lengths{};                ///< m, of Fallen::rods and then of Fallen::tackles
  std::vector<Addition> added{};                ///< one at most
  std::vector<std::uint32_t> removed{};         ///< one particle of an island at most
  std::vector<std::uint32_t> seats{};           ///< numbers of the solvers that were made
  std::vector<std::uint32_t> islands{};         ///< numbers that the contact solver gave

  friend bool operator==(const Split&, const Split&) = default;
};
template <class Archive>
void visit_members(Archive& archive, Split& of) {
  auto& [rods, edits, positions, velocities, lengths, added, removed, seats, islands] = of;
  archive(rods, edits, positions, velocities, lengths, added, removed, seats, islands);
}

/// Lists what a world did to the islands of its scene. Of what was added, and removed again as it was added,
/// nothing stays.
class Log {
 public:
  void push(Split split);
  /// Notes that islands of particles are made anew or lose a rod, and that particles have other masses: that
  /// of an anchor touches no island.
  void keep(std::span<const std::uint32_t> particles, const Edits& edits);
  /// Ends with particles that `split` has removed.
  void push_removal(Split split, std::span<const std::uint32_t> particles);

  std::vector<Split> splits() const;
  bool is_of(std::span<const Split> splits) const;

  /// Writes splits() without a copy. What restores reads them as they are.
  template <class Archive>
  void archive_entries(Archive& archive) {
    std::uint64_t count = entries_.size();
    archive(count);
    for (auto& [serial, entry] : entries_) archive(entry.split);
  }

 private:
  using Serial = std::uint32_t;
  static constexpr Serial none = 0;
  struct Entry {
    Split split;
    std::uint32_t left = 0;          ///< particles of an addition that are still there
    bool is_kept = false;            ///< Something else was done to them.
    std::vector<Serial> removals{};  ///< of others of them
  };
  Serial put(Split split);
  void keep(std::uint32_t particle);
  Serial addition_of(std::uint32_t particle) const {
    return particle < additions_.size() ? additions_[particle] : none;
  }

  std::map<Serial, Entry> entries_;
  std::vector<Serial> additions_;  ///< by particle: the entry that has added it
  Serial last_ = none;
};

}  // namespace plumb::detail
