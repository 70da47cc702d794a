#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"
#include "plumb/world.hpp"

/// @file
/// This file hands positions to whoever draws between steps: interpolated, in the layout of a vertex buffer,
/// and only those that moved.
namespace plumb {

/// Says where vectors of `Real`, which is float or double, are written. The three numbers of each lie
/// together, `stride` bytes after those of the vector before.
template <class Real>
struct StridedVectors {
  Real* first = nullptr;                  ///< First number of the first vector.
  std::size_t count = 0;                  ///< Number of vectors.
  std::size_t stride = 3 * sizeof(Real);  ///< Distance of vectors in bytes, a multiple of sizeof(Real).
};

/// Names particles in a row.
struct ParticleRange {
  std::uint32_t first = 0;  ///< The first one.
  std::uint32_t count = 0;  ///< How many they are.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const ParticleRange&, const ParticleRange&) = default;
};

/// Keeps the positions of a world's particles after the last two steps that it was shown.
///
///     frames.update(world);                                        // after each step
///     frames.copy({vertices, frames.positions().size(), 32}, 0.4); // 0.4 of the way to the last one
///
/// Positions go along straight lines between steps. A program that steps at a fixed length so draws at any
/// rate, by less than one step late.
class PLUMB_API Frames {
 public:
  /// Takes positions as they are now. Those of before are then the ones that it had. Particles that are new,
  /// by a number that others had or not, were where they are, and so were removed ones, and those that
  /// teleport() moved in between: they jump. Allocates only if the world has more particles than ever before,
  /// or numbers that others had, or a teleport, for the first time.
  void update(const World& world);

  /// Returns positions (m) of the last update.
  std::span<const Vec3> positions() const { return now_; }
  /// Returns those of the update before it.
  std::span<const Vec3> before() const { return before_; }
  /// Lists in ascending order the particles whose positions differ between the two in any bit, new ones and
  /// those that jump. What sleeps is not among them. After the first update these are all.
  std::span<const ParticleRange> moved() const { return moved_; }

  /// Writes positions (m) at `share` of the way from the update before (0) to the last one (1), at which they
  /// are these to the bit. Other shares extrapolate.
  ///
  /// Throws InputError, and writes nothing, on a share that is not finite, and unless `out` has as many
  /// vectors as there are particles. So it does if its stride is no multiple of the size of a number, or less
  /// than three of them.
  void copy(const StridedVectors<float>& out, double share = 1) const;
  /// Writes them in double, likewise.
  void copy(const StridedVectors<double>& out, double share = 1) const;
  /// Writes only what moved() lists, and leaves all else in `out` as it is. Throws as copy() does.
  void copy_moved(const StridedVectors<float>& out, double share = 1) const;
  /// Writes them in double, likewise.
  void copy_moved(const StridedVectors<double>& out, double share = 1) const;

 private:
  template <class Real>
  void write(const StridedVectors<Real>& out, double share, std::span<const ParticleRange> ranges) const;

  std::vector<Vec3> now_, before_;
  std::vector<std::uint32_t> generations_;  ///< Of numbers, as handles have them; empty while all are 1.
  std::vector<std::uint32_t> teleports_;    ///< Of particles, their counts; empty while all are 0.
  std::vector<ParticleRange> moved_;
};

}  // namespace plumb
