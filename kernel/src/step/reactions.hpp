#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Adds up what rods ask of the anchors that they hang from. It remembers how they began a step, since a mean
/// pull acts along the mean of directions.
class Reactions {
 public:
  /// Has no rods unless the settings ask for tensions.
  Reactions(const Scene& scene, const Settings& settings);

  static constexpr std::uint32_t no_rod = 0xffffffff;
  /// A rod goes from an anchor to a movable particle. Of its mass matrix the anchor has `own` and `shared`.
  /// The mass of a body has no rod.
  struct Held {
    std::uint32_t anchor, rod, other;
    double own, shared;      ///< kg
    Vec3 way{};              ///< m, from the anchor at the start of the last step
    Vec3 velocity{};         ///< m/s, of the other end then, if there is shared mass
    Vec3 anchor_velocity{};  ///< m/s, of the anchor in the last step
    Vec3 anchor_change{};    ///< m/s, from that of the step before
  };
  /// Returns what hangs from an anchor.
  std::span<const Held> at(std::uint32_t anchor) const;

  /// Begins a step. position(particle), velocity(particle) and path(anchor) are those of its start.
  template <class Position, class Velocity, class Path>
  void begin_step(Position&& position, Velocity&& velocity, Path&& path) {
    for (Held& held : held_) {
      held.way = position(held.other) - position(held.anchor);
      if (held.shared != 0) held.velocity = velocity(held.other);
      const Vec3 now = path(held.anchor);
      held.anchor_change = now - held.anchor_velocity;
      held.anchor_velocity = now;
    }
  }

  template <class Archive>
  void archive(Archive& archive) {
    for (Held& each : held_) {
      auto& [anchor, rod, other, own, shared, way, velocity, anchor_velocity, anchor_change] = each;
      archive(way, velocity, anchor_velocity, anchor_change);
    }
  }

  void set_gravity(Vec3 gravity) { gravity_ = gravity; }
  /// Learns how fast anchors went in the last step.
  template <class Anchors>
  void go_on(const Anchors& anchors) {
    for (Held& held : held_) held.anchor_velocity = anchors.last_velocity(held.anchor);
  }
  /// Looks again at rods of which an end was fixed or freed.
  template <class Anchors>
  void refix(const Scene& scene, MassModel model, std::span<const std::uint32_t> rods,
             const Anchors& anchors) {
    std::erase_if(
        held_, [&](const Held& held) { return std::find(rods.begin(), rods.end(), held.rod) != rods.end(); });
    for (const std::uint32_t rod : rods) insert_rod(scene, model, rod, anchors);
  }
  /// Looks at a rod that is new.
  template <class Anchors>
  void insert_rod(const Scene& scene, MassModel model, std::uint32_t rod, const Anchors& anchors) {
    const std::size_t before = held_.size();
    add_rod(scene, model, rod, [&](std::uint32_t particle) { return anchors.is_fixed(particle); });
    insert_from(before, anchors);
  }
  /// Looks again at all bodies, of which particles were fixed or freed. is_there(body) says which there are.
  template <class IsThere, class Anchors>
  void refix_bodies(const Scene& scene, IsThere&& is_there, const Anchors& anchors) {
    std::erase_if(held_, [](const Held& held) { return held.rod == no_rod; });
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
      if (is_there(i)) insert_body(scene, i, anchors);
  }
  /// Looks at a body that is new. Its particles have the world's numbers.
  template <class Anchors>
  void insert_body(const Scene& scene, std::uint32_t body, const Anchors& anchors) {
    const std::size_t before = held_.size();
    add_body(scene, body, [&](std::uint32_t particle) { return anchors.is_fixed(particle); });
    insert_from(before, anchors);
  }
  /// Forgets an anchor that is freed, with rods that hung from it and were cut.
  void end(std::uint32_t anchor) {
    std::erase_if(held_, [&](const Held& held) { return held.anchor == anchor; });
  }
  /// Forgets what hangs from an anchor by rods that are listed, which ascend.
  void remove(std::uint32_t anchor, std::span<const std::uint32_t> rods);
  /// Forgets what hangs from anchors by bodies of particles that are listed, which ascend.
  void remove_bodies_of(std::span<const std::uint32_t> particles);

  /// Returns the force (N) on the anchor that balances a rod's mean pull (N) and its mass, after a step of
  /// `dt` (s) that led the other end to `way` and `velocity`.
  Vec3 holding(const Held& held, double pull, Vec3 way, Vec3 velocity, double dt) const;

 private:
  template <class IsFixed>
  void add_rod(const Scene& scene, MassModel model, std::uint32_t number, IsFixed&& is_fixed) {
    const auto [a, b] = std::pair{scene.rods[number].a, scene.rods[number].b};
    const bool from_a = is_fixed(a);
    if (from_a == is_fixed(b)) return;
    const RodMass mass = rod_mass(scene, number, model);
    held_.push_back({from_a ? a : b, number, from_a ? b : a, from_a ? mass.aa : mass.bb, mass.ab});
  }
  /// What fixed particles of a body share with each other counts as the own mass of both.
  template <class IsFixed>
  void add_body(const Scene& scene, std::uint32_t number, IsFixed&& is_fixed) {
    const auto& particles = scene.bodies[number].particles;
    if (std::none_of(particles.begin(), particles.end(), is_fixed)) return;
    const auto mass = body_mass(scene, number);
    for (std::size_t j = 0; j < 4; ++j) {
      if (!is_fixed(particles[j])) continue;
      double own = 0;
      for (std::size_t k = 0; k < 4; ++k) own += is_fixed(particles[k]) ? mass[j][k] : 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (is_fixed(particles[k])) continue;
        held_.push_back({particles[j], no_rod, particles[k], std::exchange(own, 0), mass[j][k]});
      }
    }
  }
  /// Puts those from the place `from` on in the order of anchors.
  template <class Anchors>
  void insert_from(std::size_t from, const Anchors& anchors) {
    for (std::size_t i = from; i < held_.size(); ++i)
      held_[i].anchor_velocity = anchors.last_velocity(held_[i].anchor);
    const auto middle = held_.begin() + static_cast<std::ptrdiff_t>(from);
    std::stable_sort(middle, held_.end(), comes_first);
    std::inplace_merge(held_.begin(), middle, held_.end(), comes_first);
  }
  static bool comes_first(const Held& first, const Held& second) { return first.anchor < second.anchor; }
  void add_rods(const Scene& scene, MassModel model);

  Vec3 gravity_;
  Array<Held> held_;  ///< by anchor
};

}  // namespace plumb::detail
