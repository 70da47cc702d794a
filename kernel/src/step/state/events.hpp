#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "interface/archive.hpp"
#include "interface/problems.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/report.hpp"

namespace plumb::detail {

/// Lists what became of islands and rods in a step, and knows for that how they were at the end of the one
/// before. An island is known by its first movable particle, its head.
class Events {
 public:
  /// Takes at least so many particles and rods. New ones are no heads, and not broken.
  void grow(std::size_t particles, std::size_t rods);

  bool is_head(std::uint32_t particle) const { return is_head_[particle] != 0; }
  bool was_asleep(std::uint32_t head) const { return was_asleep_[head] != 0; }
  /// Calls f(particle) for each head, in their order.
  template <class F>
  void for_heads(F&& f) const {
    for (const std::uint32_t head : heads_) f(head);
  }
  /// Makes a particle the head of an island, which is asleep or not as nothing that happens to it.
  void set_head(std::uint32_t particle, bool is_asleep);
  void remove_head(std::uint32_t particle);
  /// Lets a rod be as it is, with no event.
  void set_broken(std::uint32_t rod, bool is_broken) { was_broken_[rod] = is_broken ? 1 : 0; }
  bool was_broken(std::uint32_t rod) const { return was_broken_[rod] != 0; }
  /// Makes room for as many events as a step can have, so that none allocates.
  void reserve(std::size_t weak_rods, std::size_t tasks);

  void clear() { list_.clear(); }
  /// Keeps the list of the same world before, and what it knows of islands and rods.
  void go_on_from(const Events& from);
  /// Returns whether some island may sleep now and not before, or the other way round. `changes` counts how
  /// often one fell asleep or woke, if that is counted.
  bool may_list_sleep(std::optional<std::uint64_t> changes) {
    const bool is_known = seen_ && seen_ == changes;
    seen_ = changes;
    return !is_known;
  }
  /// Appends an event for each head that sleeps now, by is_asleep(head), and did not before, or the other way
  /// round.
  template <class IsAsleep>
  void list_sleep(IsAsleep&& is_asleep) {
    for (const std::uint32_t head : heads_) {
      const bool now = is_asleep(head);
      if (was_asleep(head) == now) continue;
      list_.push_back({now ? Event::Kind::fell_asleep : Event::Kind::woke, head});
      was_asleep_[head] = now ? 1 : 0;
    }
  }
  void add_broken(std::uint32_t rod, std::uint32_t particle, double strength) {
    list_.push_back({Event::Kind::broke, particle, rod, strength});
    was_broken_[rod] = 1;
  }
  /// Gives room for the troubles of tasks.
  Array<Troubles>& troubles() { return troubles_; }
  /// Appends the troubles of islands, by the heads that they are told of. They come in the order of heads.
  void add_troubles(Troubles troubles, std::uint32_t head);
  /// Puts what was appended in order of kinds.
  void sort();

  std::span<const Event> all() const { return list_; }

  /// Heads follow from islands, and are listed with how they were.
  void archive(Archive& archive) {
    auto& [heads, is_head, was_asleep, was_broken, list, troubles, seen] = *this;
    archive(was_asleep, was_broken, list);
    if (archive.restores()) seen.reset();
  }

 private:
  Array<std::uint32_t> heads_;                             ///< sorted
  Array<std::uint8_t> is_head_, was_asleep_, was_broken_;  ///< by particle, and by rod
  Array<Event> list_;
  Array<Troubles> troubles_;
  std::optional<std::uint64_t> seen_;  ///< changes of sleep, when it was listed last
};

void visit_members(Archive& archive, Event& of);

}  // namespace plumb::detail
