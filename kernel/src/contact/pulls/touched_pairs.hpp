#pragma once

#include <cstdint>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Says how a shape of an island is pushed at one point in a substep.
struct TouchPush {
  Vec3 impulse{};       ///< N s, on the island's shape
  Vec3 place{};         ///< m
  Vec3 normal{};        ///< unit vector out of the other
  double approach = 0;  ///< m/s
};

/// Says how a shape of an island touched another shape, or ground, in a step.
struct TouchedPair {
  static constexpr std::uint32_t ground = 0xffffffff;

  std::uint32_t shape = 0;        ///< the island's
  std::uint32_t island = ground;  ///< number of the other's island
  std::uint32_t other = 0;        ///< its shape there, or the number of the ground
  std::uint32_t order = 0;        ///< among all that was added in the step
  Vec3 impulse{};                 ///< N s, on the island's shape
  double weight = 0;              ///< N s, of the sizes of impulses
  Vec3 place{}, normal{};         ///< times those, m N s and N s
  double approach = 0;            ///< m/s, the largest

  void add(const TouchPush& push);
  void add(const TouchedPair& of_same);
};

/// Adds up what an island's shapes touched in a step. It takes in nothing unless it counts.
///
/// Points are listed as they come, those of several substeps, and are added up by pairs whenever there are
/// four times as many as there were pairs the last time. Sums run in the order in which points came, so that
/// their bits do not depend on when that is.
class TouchedPairs {
 public:
  static constexpr std::uint32_t none = 0xffffffff;
  bool counts = false;

  void begin_step();
  /// Takes in how a shape is pushed by another of an island, or by ground. What is not finite is left out:
  /// its island freezes. So is what is too small to weigh a place.
  void add(std::uint32_t shape, std::uint32_t island, std::uint32_t other, const TouchPush& push);
  /// Adds up all of a pair, and sorts pairs by their numbers.
  void merge();
  /// Lets pairs name other islands by the numbers that these have `now`. Of those that have `none` they go.
  void renumber(std::span<const std::uint32_t> now);
  /// Lists the pairs of the last step.
  template <class Archive>
  void archive(Archive& archive) {
    auto& [is_counting, pairs, merged, keys, added, few] = *this;
    archive(pairs);
  }
  /// Returns the pairs of the last step, once they are merged.
  const Array<TouchedPair>& pairs() const { return pairs_; }

 private:
  static constexpr std::size_t least = 64;
  /// Names a pair and when it came, in order, and where it is listed.
  struct Key {
    std::uint64_t own, other;  ///< the shape; the island and its shape, or ground
    std::uint32_t order, index;
  };

  Array<TouchedPair> pairs_, merged_;  ///< the latter while they are merged
  Array<Key> keys_;                    ///< likewise
  std::uint32_t added_ = 0;
  std::size_t few_ = least;  ///< at so many they are merged
};

template <class Archive>
void visit_members(Archive& archive, TouchedPair& of) {
  auto& [shape, island, other, order, impulse, weight, place, normal, approach] = of;
  archive(shape, island, other, order, impulse, weight, place, normal, approach);
}

}  // namespace plumb::detail
