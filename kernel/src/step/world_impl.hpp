#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "interface/archive.hpp"
#include "plumb/executor.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/world.hpp"
#include "scene/poses/body_poses.hpp"
#include "scene/refuse.hpp"
#include "step/memory/world_memory.hpp"
#include "step/snapshot/fingerprint.hpp"
#include "step/state/step_log.hpp"

namespace plumb {

/// Returns the farthest coordinate (m) whose square still fits the precision, with room for masses and
/// forces.
constexpr double farthest_coordinate(Precision precision) {
  return precision == Precision::single ? 1e15 : 1e100;
}

/// Holds what a world is made of, and refuses what its scene does not have.
struct PLUMB_HIDDEN World::Impl {
  explicit Impl(MemoryResource* from) : memory(from) {}

  detail::WorldMemory memory;  ///< It outlives all else.
  detail::StepInMemory step{memory};
  Array<std::uint8_t> fixed;
  Precision precision = Precision::double_;
  std::uint32_t twists = 0;
  Array<std::uint32_t> of_kind;    ///< Shapes and ground with which it began, by ShapeKind.
  Array<Pose> platforms, targets;  ///< Where they are, and will be after the next step.
  Array<double> chains;            ///< Lengths of the chains of reels, in m.
  detail::BodyPoses bodies;
  Array<Vec3> positions, velocities;  ///< Room to read them for bodies; empty without.
  /// Says how often each particle was teleported, which Frames compare; empty before the first time.
  Array<std::uint32_t> teleports;
  bool tensions = false, contacts = false, events = false;
  double time = 0;
  detail::StepLog log;
  detail::Fingerprint fingerprint{};  ///< What snapshots must fit to.

  /// Refuses settings that no world takes.
  static void require_sound(const Settings& settings) {
    validate(settings);
    if (settings.executor && settings.executor->concurrency() == 0)
      detail::refuse("the executor has a concurrency of 0: it must run at least one task at a time");
  }
  /// Takes note of settings, those that a scene was compiled with.
  void take(const Settings& settings) {
    fingerprint.settings = detail::fingerprint_of({}, settings).settings;
    precision = settings.precision;
    tensions = settings.tensions;
    contacts = settings.contacts;
    events = settings.events;
  }
  /// Lists all of a snapshot but its header.
  void archive(detail::Archive& archive);
  /// Lists what steps and programs change of the world itself. `step` is listed by itself.
  static void archive_own(detail::Archive& archive, Impl& of);

  void require_known(std::uint32_t particle) const {
    require_there(step->population().particles, "particle", particle);
  }
  /// Refuses the number of what the world does not have, or no more.
  static void require_there(const detail::Numbers& numbers, const char* what, std::uint32_t number) {
    require_one_of(numbers.count(), what, number);
    if (numbers.generation(number) == 0)
      detail::refuse(what, ' ', number, ": is reserved, and not added yet");
    if (!numbers.has(number)) detail::refuse(what, ' ', number, ": was removed");
  }
  /// Lets lists have as many particles as there are numbers.
  void fit_numbers();
  void require(std::uint32_t particle, bool want_fixed, const char* reason) const {
    require_known(particle);
    if ((fixed[particle] != 0) != want_fixed)
      detail::refuse("particle ", particle, want_fixed ? ": is movable, " : ": is fixed, ", reason);
  }
  void require_rod(std::uint32_t rod) const { require_there(step->population().rods, "rod", rod); }
  void require_tackle(std::uint32_t tackle) const {
    require_there(step->population().tackles, "tackle", tackle);
  }
  void require_reel(std::uint32_t reel) const {
    require_one_of(static_cast<std::uint32_t>(chains.size()), "reel", reel);
  }
  void require_body(std::uint32_t body) const {
    const std::uint32_t all = step->population().bodies.count();
    if (body >= all)
      detail::refuse("body ", body, ": unknown, the world has ", all, all == 1 ? " body" : " bodies");
    require_there(step->population().bodies, "body", body);
  }
  /// Returns whether a shape moves, as capsules and hulls do. Refuses an unknown one.
  bool moves(ShapeId shape) const {
    const auto kind = static_cast<std::size_t>(shape.kind);
    if (kind >= of_kind.size()) detail::refuse("shape ", shape.number, ": its kind ", kind, " is unknown");
    const bool is_capsule = shape.kind == ShapeKind::capsule, is_hull = shape.kind == ShapeKind::hull;
    const detail::Population& all = step->population();
    const std::uint32_t count = is_capsule ? all.capsules.count()
                                : is_hull  ? all.hulls.count()
                                           : of_kind[kind];
    if (shape.number >= count)
      detail::refuse(to_string(shape.kind), ' ', shape.number, ": unknown, the world has ", count,
                     " of them");
    return is_capsule || is_hull;
  }
  std::uint32_t shape_count() const {
    return step->population().capsules.count() + step->population().hulls.count();
  }
  /// Names a shape by its number among all: capsules and hulls with which the world began, then capsules and
  /// hulls that were added.
  ShapeId shape(std::uint32_t number) const {
    const auto began_with = [&](ShapeKind kind) { return of_kind[static_cast<std::size_t>(kind)]; };
    const std::uint32_t capsules = began_with(ShapeKind::capsule), hulls = began_with(ShapeKind::hull);
    if (number < capsules) return {ShapeKind::capsule, number};
    if (number < capsules + hulls) return {ShapeKind::hull, number - capsules};
    const std::uint32_t all = step->population().capsules.count();
    if (number < all + hulls) return {ShapeKind::capsule, number - hulls};
    return {ShapeKind::hull, number - all};
  }
  void require_twist(std::uint32_t twist) const { require_one_of(twists, "twist", twist); }
  /// Refuses a number that the world does not have. `what` is one of them, `all` how many it has.
  static void require_one_of(std::uint32_t all, const char* what, std::uint32_t number) {
    if (number >= all)
      detail::refuse(what, ' ', number, ": unknown, the world has ", all, ' ', what, all == 1 ? "" : "s");
  }
  /// Refuses the number of an item whose law cannot change: what the world does not have yet, or no more.
  template <class Item>
  void require_law(std::uint32_t number) const {
    constexpr std::size_t kind = detail::kind_of<Item>();
    require_there(*step->population().all()[kind], detail::names_of_kinds[kind], number);
    if (step->waits<Item>(number))
      detail::refuse(detail::names_of_kinds[kind], ' ', number,
                     ": is joined in the next step, and acts then");
  }
  /// Returns the mean over the last step that the contact solver knows of a joint. One that is joined in the
  /// next step has none yet.
  template <class Item, class Value>
  Value mean_of(std::uint32_t number, Value (detail::ContactSolver::*mean)(std::uint32_t) const) const {
    constexpr std::size_t kind = detail::kind_of<Item>();
    require_there(*step->population().all()[kind], detail::names_of_kinds[kind], number);
    require_tensions();
    if (step->waits<Item>(number)) return std::numeric_limits<double>::quiet_NaN() * Value{};
    return (step->contact().*mean)(number);
  }
  void require_tensions() const {
    if (!tensions) detail::refuse("tensions are not known: Settings::tensions asks for them");
  }
  void require_fit(std::span<const Vec3> out, const char* what) const {
    if (out.size() != fixed.size())
      detail::refuse(what, " of ", fixed.size(), " particles cannot be copied into ", out.size(),
                     " elements");
  }
};

}  // namespace plumb
