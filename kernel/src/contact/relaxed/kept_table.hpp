#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Finds what held the contacts of a cluster's islands in the last substep, by key, in constant time.
class KeptTable {
 public:
  /// Takes in what islands keep, which must not change until the next time.
  void gather(std::span<LinkageState* const> cluster) {
    std::size_t count = 0;
    for (const LinkageState* const state : cluster) count += state->kept.size();
    slots_.assign(std::bit_ceil(2 * count + 1), nullptr);
    for (std::uint32_t i = 0; i < cluster.size(); ++i)
      for (const KeptContact& each : cluster[i]->kept) {
        std::size_t slot = first_slot(i, each.key);
        while (slots_[slot] != nullptr) slot = (slot + 1) & (slots_.size() - 1);
        slots_[slot] = &each;
      }
  }

  /// Forgets them, where they are not likely to be asked for.
  void clear() { slots_.clear(); }
  bool is_gathered() const { return !slots_.empty(); }

  /// Returns what held a contact of an island of the cluster, or null. Contacts are found in about the order
  /// in which they were kept, so that the search looks at number `next` of the island first, and leaves there
  /// the one that follows.
  const KeptContact* find(const LinkageState& state, std::uint32_t island, std::uint64_t key,
                          std::size_t& next) const {
    const KeptContact* const own = state.kept.data();
    if (next < state.kept.size() && own[next].key == key) return &own[next++];
    for (std::size_t slot = first_slot(island, key); slots_[slot] != nullptr;
         slot = (slot + 1) & (slots_.size() - 1)) {
      const KeptContact* const each = slots_[slot];
      if (each->key != key || each < own || each >= own + state.kept.size()) continue;
      next = static_cast<std::size_t>(each - own) + 1;
      return each;
    }
    return nullptr;
  }

 private:
  /// Keys are mixed, but islands that are alike have the same ones. The factor is that of the golden ratio.
  std::size_t first_slot(std::uint32_t island, std::uint64_t key) const {
    const std::uint64_t mixed = key ^ (island * std::uint64_t{0x9e3779b97f4a7c15});
    return static_cast<std::size_t>(mixed >> 7) & (slots_.size() - 1);
  }

  Array<const KeptContact*> slots_;  ///< a power of two, at least half of them null
};

}  // namespace plumb::detail
