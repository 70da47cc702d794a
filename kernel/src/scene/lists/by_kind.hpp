#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Holds one thing for each kind of what islands are made of, such as numbers or owners.
template <class T>
struct ByKind {
  T particles{}, rods{}, bends{}, tackles{}, bodies{}, pins{}, alignments{}, angles{}, springs{}, torsions{},
      capsules{}, hulls{};

  static constexpr std::size_t kinds = 12;
  std::array<T*, kinds> all() {
    return {&particles,  &rods,   &bends,   &tackles,  &bodies,   &pins,
            &alignments, &angles, &springs, &torsions, &capsules, &hulls};
  }
  std::array<const T*, kinds> all() const {
    return {&particles,  &rods,   &bends,   &tackles,  &bodies,   &pins,
            &alignments, &angles, &springs, &torsions, &capsules, &hulls};
  }

  friend bool operator==(const ByKind&, const ByKind&) = default;
};
/// Says how messages call items, by kind.
inline constexpr std::array names_of_kinds{"particle",  "rod",   "bend",   "tackle",  "body",    "pin",
                                           "alignment", "angle", "spring", "torsion", "capsule", "hull"};
static_assert(names_of_kinds.size() == ByKind<int>::kinds);

/// Lists numbers of each kind.
using Names = ByKind<Array<std::uint32_t>>;
/// Returns whether numbers of any kind are listed.
inline bool lists_any(const Names& names) {
  const auto all = names.all();
  return std::any_of(all.begin(), all.end(), [](const auto* numbers) { return !numbers->empty(); });
}

template <class Archive, class T>
void visit_members(Archive& archive, ByKind<T>& of) {
  for (T* const each : of.all()) archive(*each);
}

/// Returns references to the lists of what a world can have more and less of, in the order of kinds.
template <class SceneOrConst>
auto lists_of(SceneOrConst& scene) {
  auto lists =
      std::tie(scene.particles, scene.rods, scene.bends, scene.tackles, scene.bodies, scene.pins,
               scene.alignments, scene.angles, scene.springs, scene.torsions, scene.capsules, scene.hulls);
  static_assert(std::tuple_size_v<decltype(lists)> == ByKind<int>::kinds);
  return lists;
}

/// Returns the place of an item's kind in the order of kinds.
template <class Item>
constexpr std::size_t kind_of() {
  const auto find = []<class... Lists>(const std::tuple<Lists...>*) {
    std::size_t kind = 0;
    (void)((std::is_same_v<typename std::remove_cvref_t<Lists>::value_type, Item> || (++kind, false)) || ...);
    return kind;
  };
  using Lists = decltype(lists_of(std::declval<Scene&>()));
  constexpr std::size_t kind = find(static_cast<const Lists*>(nullptr));
  static_assert(kind < ByKind<int>::kinds);
  return kind;
}

/// Returns the list of a scene that has items of a kind.
template <class Item, class SceneOrConst>
auto& list_of(SceneOrConst& scene) {
  return std::get<kind_of<Item>()>(lists_of(scene));
}

/// Calls f(kind, list...) for each kind, with its lists of these scenes.
template <class F, class... Scenes>
void for_lists(F&& f, Scenes&... scenes) {
  const auto call = [&]<std::size_t... kind>(std::index_sequence<kind...>) {
    const auto one = [&]<std::size_t of>() { f(of, std::get<of>(lists_of(scenes))...); };
    (one.template operator()<kind>(), ...);
  };
  call(std::make_index_sequence<ByKind<int>::kinds>());
}

/// Returns how many a scene has of each kind.
inline ByKind<std::uint32_t> sizes_of(const Scene& scene) {
  ByKind<std::uint32_t> out;
  for_lists(
      [&](std::size_t kind, const auto& list) { *out.all()[kind] = static_cast<std::uint32_t>(list.size()); },
      scene);
  return out;
}

// --- Their particles, those of unread slots of places included

template <class F>
void for_particles(const Particle&, F&&) {}
template <class F>
void for_particles(Rod& of, F&& f) {
  f(of.a);
  f(of.b);
}
template <class F>
void for_particles(Bend& of, F&& f) {
  f(of.a);
  f(of.b);
  f(of.c);
}
template <class F>
void for_particles(Tackle& of, F&& f) {
  for (std::uint32_t& particle : of.particles) f(particle);
}
template <class F>
void for_particles(Body& of, F&& f) {
  for (std::uint32_t& particle : of.particles) f(particle);
}
template <class F>
void for_particles(const Hull&, F&&) {}

/// Calls f(point) for all places of what has some: pins, springs, capsules, directions and what turns.
template <class F>
void for_points(Direction& of, F&& f) {
  f(of.from);
  f(of.to);
}
template <class F>
void for_points(Torsion& of, F&& f) {
  for_points(of.axis, f);
  for_points(of.u, f);
  for_points(of.v, f);
}
/// Pins, springs and capsules have two places.
template <class Item, class F>
requires requires(Item& of) {
  of.a.weights;
}
void for_points(Item& of, F&& f) {
  f(of.a);
  f(of.b);
}
/// Alignments and angles have two directions.
template <class Item, class F>
requires requires(Item& of) {
  of.u.from;
  requires !requires {
    of.axis;
  };
}
void for_points(Item& of, F&& f) {
  for_points(of.u, f);
  for_points(of.v, f);
}
template <class Item, class F>
requires requires(Item& of) {
  for_points(of, [](Point&) {});
}
void for_particles(Item& of, F&& f) {
  for_points(of, [&](Point& point) {
    for (std::uint32_t& particle : point.particles) f(particle);
  });
}

}  // namespace plumb::detail
