#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "scene/lists/by_kind.hpp"

namespace plumb::detail {

/// Where a program puts the ends of rods, these may be off their lengths by this share of them.
inline constexpr double fits = 1e-6;
/// Returns by how much (m) a rod does not fit between ends that are so far apart, or 0 if it need not.
inline double misfit(double distance, double length, const RodLaw& law) {
  if (law.is_elastic()) return 0;
  return law.one_sided ? std::max(0.0, distance - length) : std::abs(distance - length);
}

/// Lets a rod be as long as it is now (m), with the mass matrix of the length in the scene that describes it.
void wind(Rod& rod, double described, double now);

/// Returns whether islands with shapes may have a rod, and still go home to solvers of particles and rods.
inline bool is_plain_rod(const Rod& rod) {
  return rod.law.is_rigid() && rod.linear_drag == 0 && rod.orthogonal_drag == 0;
}

/// Says what a rod is that a program joins to particles that are there, and which number it got.
struct Joined {
  std::uint32_t number = 0;
  Rod rod{};  ///< Its ends are particles of the world, and its length is known.

  friend bool operator==(const Joined&, const Joined&) = default;
};
template <class Archive>
void visit_members(Archive& archive, Joined& of) {
  auto& [number, rod] = of;
  archive(number, rod);
}

/// Lists what a program ordered between two steps that makes islands anew. A particle has one order of each
/// kind at most, the last, and none to be what it is.
struct Edits {
  Array<Joined> joined;                            ///< They are done before all else.
  Array<std::uint32_t> cut;                        ///< rods
  Names severed;                                   ///< joints and springs, by kind; they ascend
  Array<std::pair<std::uint32_t, double>> masses;  ///< particles, and their own masses in kg
  Array<std::pair<std::uint32_t, bool>> fixed;     ///< particles, and whether they are fixed now
  /// Lists a particle of each island that is made anew, side by side: of those that were added by themselves
  /// since the last step, and, once it `packs`, of all that do not lie well.
  Array<std::uint32_t> side_by_side;
  bool packs = false;

  bool any() const {
    return !joined.empty() || !cut.empty() || lists_any(severed) || !masses.empty() || !fixed.empty() ||
           !side_by_side.empty() || packs;
  }
  friend bool operator==(const Edits&, const Edits&) = default;
};
template <class Archive>
void visit_members(Archive& archive, Edits& of) {
  auto& [joined, cut, severed, masses, fixed, side_by_side, packs] = of;
  archive(joined, cut, severed, masses, fixed, side_by_side, packs);
}

}  // namespace plumb::detail
