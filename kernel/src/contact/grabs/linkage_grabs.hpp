#pragma once

#include <cstdint>
#include <memory>

#include "contact/linkage/linkage.hpp"
#include "interface/grab.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds the grabs of an island, as the contact solver moves it: each is three elastics along the axes of
/// space, between a place and a fixed particle that stands for the target. An island that something grabs is
/// of a kind of its own; others of its kind keep theirs.
struct IslandGrabs {
  struct One : HeldGrab {
    Combination at{};  ///< of the island's particles
    Vec3 began{};      ///< m, where the place was as the step began
  };
  std::uint32_t island = 0;
  std::size_t kind = 0;  ///< the number of the linkage that it has else
  Array<One> all{};
  std::unique_ptr<Linkage> linkage{};
};

/// Places follow from who grabbed what.
template <class Archive>
void visit_members(Archive& archive, IslandGrabs& of) {
  for (IslandGrabs::One& each : of.all) archive(static_cast<HeldGrab&>(each));
}

}  // namespace plumb::detail
