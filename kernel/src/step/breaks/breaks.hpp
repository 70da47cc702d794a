#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "contact/edits/part_edits.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "step/breaks/addition.hpp"
#include "step/breaks/edits.hpp"
#include "step/breaks/numbers.hpp"
#include "step/rows.hpp"

namespace plumb::detail {

/// Holds islands that are to be made anew as a scene of their own.
struct Fallen {
  Scene scene;
  Array<std::uint32_t> particles, rods, tackles;  ///< by number in `scene`: that in the whole one
  /// Lists particles and twists that leave the solvers that move them, and rods that do so and are in no
  /// scene.
  Array<std::uint32_t> leaving, leaving_rods, leaving_twists;
  Array<std::uint32_t> touched;  ///< Places of these particles may change.
  /// Lists the contact solver's islands that are made anew with them or by themselves, and how.
  Array<std::uint32_t> parts{};
  PartEdits part_edits{};
  Array<std::uint32_t> met{};          ///< those of `parts` that rods or freed particles bring together
  Array<std::uint32_t> of_linkages{};  ///< movable particles of those that have or get no home
  /// Has what comes together with islands of the contact solver that have no home, and is moved there from
  /// now on. Some of it may be there already.
  NamedPart held{};
  NamedPart joints{};  ///< those that are joined, which name particles of the whole scene

  /// Returns whether islands come together in the contact solver.
  bool meets() const { return !met.empty() || lists_any(joints.names); }
  bool is_in_contact() const { return !parts.empty() || meets(); }
  bool any() const { return !leaving.empty() || !particles.empty() || is_in_contact(); }
};

/// Knows which rods are out, and cuts out the islands that fell apart by that or are made anew by order. Work
/// grows with these islands alone, once begin() has looked at the whole scene.
///
/// A rod with mass of its own that is out still joins its ends if the mass is spread along it. Where the
/// masses of rods are lumped, its ends take them. Bends and twists end with their rods. An island that a
/// twist or a reel still holds stays one, since what they remember has no place in a scene.
class Breaks {
 public:
  /// Lists which rods may break, and waits with the rest for begin() where there is none.
  /// The scene must outlive this.
  Breaks(const Scene& scene, const Settings& settings);

  /// Looks at the islands of the scene, unless this was done. take_out() needs it.
  void begin();

  /// Returns the rods that have a strength.
  std::span<const std::uint32_t> weak() const { return weak_; }
  bool is_out(std::uint32_t rod) const { return rod < out_.size() && out_[rod] != State::in; }
  /// Lets no solver of particles and rods move the island of a particle, whatever becomes of it: others do.
  /// So it is with what the next take_out() joins to it. A fixed particle is one that is freed then.
  void hold(std::uint32_t particle) {
    if (whole_[particle] != none)
      wholes_[whole_[particle]].is_held = true;
    else
      held_freed_.push_back(particle);
  }
  /// Does so if the next take_out() makes the island of a movable particle one that has more than particles
  /// and rigid rods.
  void hold_unless_plain(std::uint32_t particle) { wholes_[whole_[particle]].is_to_be_plain = true; }
  /// Lets the next take_out() make the island of a particle anew, and others move it from then on. A fixed
  /// particle may be one that is freed then.
  void hand_over(std::uint32_t particle) {
    if (whole_[particle] == none) return held_freed_.push_back(particle);
    wholes_[whole_[particle]].is_to_be_held = true;
    along_.push_back(particle);
  }
  /// Lets is_out() say that a rod is out although it is still to be taken, or takes that back.
  void order(std::uint32_t rod, bool is_ordered) {
    if (out_[rod] != State::taken) out_[rod] = is_ordered ? State::ordered : State::in;
  }
  /// Lets the island of a movable particle be made anew by the next take_out(), too.
  void take_along(std::uint32_t particle) { along_.push_back(particle); }
  std::span<const std::uint32_t> rods_at(std::uint32_t particle) const { return rods_at_.of(particle); }
  /// Returns the scene with what was added since. Of what was removed it has what was there last.
  const Scene& scene_now() const { return grown_ ? *grown_ : first_; }

  /// Takes out what broke and what was cut, and does other edits. Returns what is to be made anew, where and
  /// as fast as it was in the scene that this knows: who calls says how things are now.
  Fallen take_out(std::span<const std::uint32_t> broken, const Edits& edits);

  // --- What is added and removed (living.cpp)

  /// Takes at least so many of each kind. New ones have nothing before add().
  void grow(const Population& to);
  void add(const Addition& what);
  void add_capsule(std::uint32_t number, const Capsule& capsule);
  /// Lists the particles, rods, bends and tackles of an island as it is, with the fixed particles that it
  /// hangs from, and all rods at its movable ones. It is that of a movable particle, or, if joints hold it
  /// together, that which has `jointed` particles. Of a fixed particle it lists that and its rods.
  Names island_to_remove(std::uint32_t particle, std::span<const std::uint32_t> jointed) const;
  /// Forgets what is listed. Where it has rods of particles that stay, they lose those.
  void remove(const Names& what);

  /// Returns the first movable particle of each island.
  Array<std::uint32_t> heads() const;
  bool is_head(std::uint32_t particle) const {
    return whole_[particle] != none && head_of(wholes_[whole_[particle]]) == particle;
  }
  /// Returns the particles of the island of a movable one, or none of a fixed one.
  std::span<const std::uint32_t> island_at(std::uint32_t particle) const {
    if (whole_[particle] == none) return {};
    return wholes_[whole_[particle]].particles;
  }
  bool joins_ends(std::uint32_t rod) const;  ///< It is not out, or has mass that does so.

  /// Returns the number of a twist that has a rod's island but not the rod. It keeps the island from being
  /// made anew.
  std::optional<std::uint32_t> twist_beside(std::uint32_t rod) const;
  std::optional<std::uint32_t> twist_at(std::uint32_t particle) const;  ///< any of its island
  /// Returns the mass (kg) of a particle without its rods.
  double own_mass(std::uint32_t particle) const {
    const auto mass = masses_.find(particle);
    return mass == masses_.end() ? scene_now().particles[particle].mass : mass->second.first;
  }
  /// Returns what it took (kg) of rods that are out.
  double taken_mass(std::uint32_t particle) const {
    const auto mass = masses_.find(particle);
    return mass == masses_.end() ? 0 : mass->second.second;
  }
  bool is_taken(std::uint32_t rod) const { return rod < out_.size() && out_[rod] == State::taken; }
  bool has_ended(std::uint32_t bend) const {
    return std::find(ended_.begin(), ended_.end(), bend) != ended_.end();
  }
  /// Returns the number of a reel of the island of a particle, which does so, too.
  std::optional<std::uint32_t> reel_at(std::uint32_t particle) const;
  std::optional<std::uint32_t> tackle_at(std::uint32_t particle) const;  ///< any of its island
  /// Returns the bends that have a particle, and have not ended.
  Array<std::uint32_t> bends_at(std::uint32_t particle) const;
  /// Returns the end of a rod that is not `particle`.
  std::uint32_t other_end(std::uint32_t rod, std::uint32_t particle) const {
    const Rod& of = scene_now().rods[rod];
    return of.a == particle ? of.b : of.a;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  enum class State : std::uint8_t { in, ordered, taken };

  /// Lists what an island has that one solver moves.
  struct Whole {
    Array<std::uint32_t> particles{}, rods{}, bends{}, tackles{}, twists{}, reels{};
    // These stand while changes are made:
    bool is_touched = false, is_forced = false;  ///< The latter is made anew by order.
    bool stays = false;                          ///< A twist or a reel keeps it as it is.
    std::uint32_t parts = 0;
    bool is_to_be_plain = false, is_to_be_held = false;
    bool is_held = false;  ///< Others move it, for good.

    bool leaves() const { return !stays && (is_forced || parts > 1); }
  };
  /// Holds islands as a scene, with their numbers in the whole one.
  struct Cutout {
    Scene scene;
    Array<std::uint32_t> particles, rods, bends, tackles, twists, reels;
  };

  /// Lists islands of a cutout that go on by themselves: those that get solvers, and those that others move.
  struct Parts {
    Array<std::uint32_t> homes, held;
  };
  class Copy;

  std::uint32_t head_of(const Whole& whole) const;  ///< It is none if nothing moves.
  std::uint32_t spare_whole();
  void remove_from_wholes(const Names& what);
  std::uint32_t whole_at(std::uint32_t rod) const;
  void touch(std::uint32_t whole, bool is_forced);
  void touch_rod(std::uint32_t rod, bool is_forced);
  void take_rod(std::uint32_t rod);
  void join(const Edits& edits);
  std::pair<double, double>& mass_at(std::uint32_t particle);
  void edit(const Edits& edits);
  void list_touched(Cutout& out) const;
  Cutout cutout();
  void end_elements(Cutout& of);
  Parts leaving_parts(const Cutout& of, const layouts::Islands& islands);
  bool is_held(const Cutout& of, const layouts::Islands& islands, std::uint32_t part, bool bends) const;
  bool is_new(const Cutout& of, const layouts::Islands& islands, std::uint32_t part) const;
  void renumber(const Cutout& of, const layouts::Islands& islands, const Parts& parts);
  Fallen cut_out(const Cutout& from, const layouts::Islands& islands, const Parts& parts) const;

  bool has_begun_ = false;
  MassModel model_;
  Array<std::uint32_t> weak_;   ///< rods
  const Scene& first_;          ///< the scene as it began
  std::optional<Scene> grown_;  ///< with what was added, once anything was
  Array<std::uint8_t> fixed_;   ///< by particle
  /// Lists particles whose masses (kg) are others: their own, and what they took of rods that are out.
  std::map<std::uint32_t, std::pair<double, double>> masses_;
  Array<State> out_;             ///< by rod; empty before begin()
  Rows<std::uint32_t> rods_at_;  ///< by particle
  Array<std::uint32_t> ended_;   ///< bends that lack a rod
  Array<Whole> wholes_;
  Array<std::uint32_t> whole_;       ///< by particle, and none for fixed ones
  Array<std::uint32_t> touched_;     ///< wholes
  Array<std::uint32_t> freed_;       ///< particles
  Array<std::uint32_t> held_freed_;  ///< those of them that others are to move
  Array<std::uint32_t> joined_;      ///< rods
  Array<std::uint32_t> along_;       ///< particles of islands that are made anew beside what is listed
  Array<std::uint32_t> spare_;       ///< numbers of wholes that nobody has
  Array<std::uint32_t> place_;       ///< by particle: that in a cutout which is made, else none
};

}  // namespace plumb::detail
