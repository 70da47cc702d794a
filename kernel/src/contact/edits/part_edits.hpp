#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plumb/layouts/memory.hpp"
#include "scene/lists/by_kind.hpp"

namespace plumb::detail {

/// Erases the entries of a list that `ends` names, and their numbers.
template <class Item, class Ends>
void erase_numbered(std::vector<Item>& list, Array<std::uint32_t>& numbers, Ends&& ends) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (ends(list[i])) continue;
    if (kept != i) list[kept] = std::move(list[i]);
    numbers[kept++] = numbers[i];
  }
  list.resize(kept);
  numbers.resize(kept);
}

/// Lists what is done to islands that the contact solver knows. All have the numbers of the whole scene.
struct PartEdits {
  Array<std::uint32_t> cut{};                         ///< rods
  Array<std::pair<std::uint32_t, double>> heavier{};  ///< particles, and by how much, kg
  Array<std::uint32_t> fixed{};                       ///< particles that stand from now on
  Array<std::uint32_t> freed{};                       ///< particles that move from now on

  bool any() const { return !cut.empty() || !heavier.empty() || !fixed.empty() || !freed.empty(); }
};

/// Holds islands as a scene, with the numbers that its parts have in the whole one.
class NamedPart {
 public:
  Scene scene{};
  Names names{};

  /// Takes a rod out, and what lies along it: bends and capsules. One whose mass joins its ends goes on as
  /// one that pulls nothing.
  void cut(std::uint32_t rod);
  /// Returns a particle by its number, or null if it is not here.
  Particle* find(std::uint32_t particle);
  /// Fixes and frees particles.
  void refix(const PartEdits& edits);
  /// Ends rods and capsules that no movable particle has.
  void end_fixed();
  /// Ends capsules between places that nothing else joins any more. `before` is the scene as it was, or null
  /// where rods held each island together.
  void end_torn_capsules(const Scene* before);
  /// Returns what has no movable particle though it needs one, such as "pin 3", or nothing.
  std::string held() const;
};

/// Returns what parts have, in the order of numbers. What several have is as the first has it.
NamedPart joined(std::span<const NamedPart> parts);

}  // namespace plumb::detail
