#pragma once

#include <cstdint>
#include <vector>

#include "plumb/layouts/islands.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Holds islands that fell apart as a scene of their own.
struct Fallen {
  Scene scene;
  std::vector<std::uint32_t> particles, rods, tackles;  ///< by number in `scene`: that in the whole one

  bool any() const { return !particles.empty(); }
};

/// Holds what one call of Breaks::take_out() took out, and how what fell apart was then. With all of them in
/// turn, a world that is compiled anew falls apart alike.
struct Split {
  std::vector<std::uint32_t> rods;          ///< by number in the whole scene
  std::vector<Vec3> positions, velocities;  ///< m and m/s, of Fallen::particles
  std::vector<double> lengths;              ///< m, of Fallen::rods and then of Fallen::tackles

  friend bool operator==(const Split&, const Split&) = default;
};
template <class Archive>
void visit_members(Archive& archive, Split& of) {
  auto& [rods, positions, velocities, lengths] = of;
  archive(rods, positions, velocities, lengths);
}

/// Knows which rods broke, and cuts out the islands that fell apart by that.
///
/// A broken rod with mass of its own still joins its ends if the mass is spread along it. Where the masses of
/// rods are lumped, its ends take them. Bends and twists end with their rods. An island that a twist or a
/// reel still holds stays one, since what they remember has no place in a scene.
class Breaks {
 public:
  /// Keeps nothing unless some rod may break.
  Breaks(const Scene& scene, const Settings& settings);

  bool any_may_break() const { return !broken_.empty(); }
  bool is_broken(std::uint32_t rod) const { return rod < broken_.size() && broken_[rod] != 0; }

  /// Takes out the rods for which `has_broken` is true now. Returns what fell apart by that, where and as
  /// fast as it was in the scene that this knows: who calls says how things are now.
  template <class HasBroken>
  Fallen take_out(HasBroken&& has_broken) {
    bool any = false;
    for (std::uint32_t i = 0; i < scene_.rods.size(); ++i) {
      is_leaving_[i] = scene_.rods[i].law.strength < never && has_broken(numbers_[i]);
      any = any || is_leaving_[i] != 0;
    }
    return any ? take_out_leaving() : Fallen{};
  }

 private:
  static constexpr double never = RodLaw{}.strength;

  layouts::Islands islands() const;
  Fallen take_out_leaving();
  void remove_leaving();
  std::vector<std::uint32_t> apart(const layouts::Islands& islands) const;
  Fallen cut_out(const layouts::Islands& islands, const std::vector<std::uint32_t>& numbers) const;

  MassModel model_;
  Scene scene_;                           ///< without broken rods
  std::vector<std::uint32_t> numbers_;    ///< of its rods in the whole scene
  std::vector<std::uint8_t> is_leaving_;  ///< by rod of scene_
  std::vector<std::uint32_t> whole_;      ///< by movable particle: the island that one solver moves
  std::uint32_t wholes_ = 0;              ///< so many such islands have been numbered
  std::vector<std::uint8_t> broken_;      ///< by rod of the whole scene; empty if none may break
};

}  // namespace plumb::detail
