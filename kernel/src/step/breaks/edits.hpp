#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "contact/edits/part_edits.hpp"
#include "interface/archive.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "scene/lists/by_kind.hpp"
#include "scene/lists/scene_members.hpp"

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

template <class Archive>
void visit_members(Archive& archive, NamedPart& of) {
  for_lists([&](std::size_t, auto& list) { archive(list); }, of.scene);
  archive(of.names);
}

/// Lists what a program ordered between two steps that makes islands anew. A particle has one order of each
/// kind at most, the last, and none to be what it is.
struct Edits {
  /// Has what is joined before all else is done: rods whose lengths are known, joints and springs. They name
  /// particles of the world, in all slots of places.
  NamedPart joined;
  Array<std::uint32_t> cut;                        ///< rods
  Names severed;                                   ///< joints and springs, by kind; they ascend
  Array<std::pair<std::uint32_t, double>> masses;  ///< particles, and their own masses in kg
  Array<std::pair<std::uint32_t, bool>> fixed;     ///< particles, and whether they are fixed now
  /// Lists a particle of each island that is made anew, side by side: of those that were added by themselves
  /// since the last step, and, once it `packs`, of all that do not lie well.
  Array<std::uint32_t> side_by_side;
  bool packs = false;

  /// Calls f(kind, number, particle) for all particles of what is joined.
  template <class F>
  void for_joined(F&& f) const {
    for_lists(
        [&](std::size_t kind, auto list) {  // a copy, since for_particles() may change what it visits
          for (std::size_t k = 0; k < list.size(); ++k)
            for_particles(list[k],
                          [&](std::uint32_t each) { f(kind, (*joined.names.all()[kind])[k], each); });
        },
        joined.scene);
  }
  /// Returns the joints and springs that are joined.
  NamedPart joints() const {
    NamedPart out = joined;
    out.names.rods.clear();
    out.scene.rods.clear();
    return out;
  }
  bool any() const {
    return lists_any(joined.names) || !cut.empty() || lists_any(severed) || !masses.empty() ||
           !fixed.empty() || !side_by_side.empty() || packs;
  }
  /// All members are compared, to the bit.
  friend bool operator==(const Edits& a, const Edits& b) { return saved(a) == saved(b); }
};
template <class Archive>
void visit_members(Archive& archive, Edits& of) {
  auto& [joined, cut, severed, masses, fixed, side_by_side, packs] = of;
  archive(joined, cut, severed, masses, fixed, side_by_side, packs);
}

}  // namespace plumb::detail
