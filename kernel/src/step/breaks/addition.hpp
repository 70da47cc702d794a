#pragma once

#include "interface/archive.hpp"
#include "scene/lists/by_kind.hpp"
#include "scene/lists/scene_members.hpp"

namespace plumb::detail {

/// Holds what was added to a world at once, as the program described it, and which numbers it got.
struct Addition {
  Scene scene;                  ///< Of this the lists of kinds are kept, and nothing else.
  ByKind<std::uint32_t> first;  ///< numbers in the world

  Addition() = default;
  Addition(const Scene& of, const ByKind<std::uint32_t>& numbers) : first(numbers) {
    for_lists([](std::size_t, auto& to, const auto& from) { to = from; }, scene, of);
  }

  /// All members are compared, to the bit.
  friend bool operator==(const Addition& a, const Addition& b) { return saved(a) == saved(b); }
};

template <class Archive>
void visit_members(Archive& archive, Addition& of) {
  for_lists([&](std::size_t, auto& list) { archive(list); }, of.scene);
  archive(of.first);
}

}  // namespace plumb::detail
