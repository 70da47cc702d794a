#pragma once

#include <cstdint>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "scene/lists/by_kind.hpp"

namespace plumb::detail {

/// Returns what is named of a scene as a scene of its own. Particles are named as SceneParts has them:
/// movable ones first, and both in ascending order.
Scene part_of(const Scene& whole, const Names& names);

/// Cuts a scene into its islands, each a scene of its own with the movable particles first. Fixed particles
/// are in every island that hangs from them. The scene must outlive this. Throws InputError on a joint or
/// shape that nothing movable has.
class SceneParts {
 public:
  explicit SceneParts(const Scene& scene);

  std::uint32_t count() const { return static_cast<std::uint32_t>(names_.size()); }
  /// Makes the scene of an island, which takes time by its size.
  Scene part(std::uint32_t i) const { return part_of(scene_, names_[i]); }
  /// Returns the numbers of what an island has in the whole scene.
  const Names& names(std::uint32_t i) const { return names_[i]; }
  const Array<std::uint32_t>& particles(std::uint32_t i) const { return names_[i].particles; }

  /// Names what a part has of the whole scene: the part's number, and its own number there.
  struct Share {
    std::uint32_t part, number;
  };
  /// Lists where the scene's rods, bends, bodies, joints, springs and shapes are.
  const ByKind<Array<Share>>& shares() const { return shares_; }

 private:
  void hand_out();
  template <class Item, class Owner>
  void hand_out(const std::vector<Item>& list, Owner&& owner);
  std::uint32_t movable_of(const Point& point) const;
  template <class... Points>
  std::uint32_t island_of(const Points&... points) const;

  static constexpr std::uint32_t none = 0xffffffff;

  const Scene& scene_;
  Array<std::uint32_t> island_of_;  ///< by particle
  Array<Names> names_;
  ByKind<Array<Share>> shares_;
};

/// Returns whether anything may touch, now or once it is added, or an island may have more than particles and
/// rods.
bool needs_contact_stage(const Scene& scene);
/// Returns whether air brakes any rod.
bool has_air(const Scene& part);
/// Returns whether an island has nothing but particles, rods that hold it together, and shapes on its
/// particles or between the ends of rods. Solvers of particles and rods can move it where nothing touches it.
bool is_plain(const Scene& part);
/// Gives the mass of rods to their ends, as the solver of their home does, so that an island weighs the same
/// in both solvers.
void lump_masses(Scene& part);

/// Returns everything about an island but where it is and its gravity, as numbers. Islands with equal numbers
/// are alike.
Array<double> likeness(const Scene& part);

}  // namespace plumb::detail
