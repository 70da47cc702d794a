#pragma once

#include <cstdint>
#include <functional>
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
  Names severed{};                                    ///< joints and springs, by kind
  Array<std::pair<std::uint32_t, double>> heavier{};  ///< particles, and by how much, kg
  Array<std::uint32_t> fixed{};                       ///< particles that stand from now on
  Array<std::uint32_t> freed{};                       ///< particles that move from now on
  /// Gives numbers to spheres at ends that have no other shape after a cut, where one end has that of the
  /// capsule.
  std::function<std::uint32_t()> number_of_sphere{};

  bool any() const {
    return !cut.empty() || lists_any(severed) || !heavier.empty() || !fixed.empty() || !freed.empty();
  }
};

/// Holds islands as a scene, with the numbers that its parts have in the whole one.
class NamedPart {
 public:
  Scene scene{};
  Names names{};

  template <class Item>
  void add(std::uint32_t number, const Item& item) {
    names.all()[kind_of<Item>()]->push_back(number);
    list_of<Item>(scene).push_back(item);
  }
  /// Returns this part with its particles, if it names those of a whole scene.
  NamedPart with_particles(const std::vector<Particle>& of_whole) const;
  /// Takes a rod out, and what lies along it: bends and capsules. One whose mass joins its ends goes on as
  /// one that pulls nothing. An end that moves and would have no shape without such a capsule gets a sphere.
  void cut(std::uint32_t rod, const PartEdits& edits);
  /// Takes out those of the joints and springs listed that are here.
  void sever(const Names& joints);
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

 private:
  /// Ends capsules along a rod that goes, between two particles, which ascend.
  void end_capsules_along(const Array<std::uint32_t>& ends, const PartEdits& edits);
  /// Returns whether a particle moves and has no shape but capsules along that rod.
  bool is_bare_without(const Array<std::uint32_t>& ends, std::uint32_t particle) const;
};

/// Returns what parts have, in the order of numbers. What several have is as the first has it.
NamedPart joined(std::span<const NamedPart> parts);

}  // namespace plumb::detail
