#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/relaxed/crowd.hpp"
#include "contact/shapes/bounds.hpp"

namespace plumb::detail {

/// Says of every particle of a crowd how far it moves in a substep, and past which side of a box. A line
/// whose ends both pass the same side never comes into the box, which is seen without its own bounds.
class ParticleWays {
 public:
  /// Looks at all particles with their displacements of now, beside a box from the crowd's origin.
  template <class T>
  void find(const Crowd<T>& crowd, const Bounds& box) {
    const std::uint32_t end = crowd.padding();
    moves2_.resize(end / record);
    passed_.resize(end / record);
    for (std::uint32_t at = 0; at < end; at += record) {
      const Vec3 from = crowd.position(at), by = crowd.moved(at), to = from + by;
      moves2_[at / record] = dot(by, by);
      passed_[at / record] = side_passed(from, to, box);
    }
  }
  /// Returns the square of how far (m²) the record that starts at a number moves.
  double moves2(std::uint32_t at) const { return moves2_[at / record]; }
  /// Returns whether the line between two records stays out of the box.
  bool stays_out(std::uint32_t a, std::uint32_t b) const {
    return passed_[a / record] != 0 && passed_[a / record] == passed_[b / record];
  }

 private:
  /// Returns the first side that the way from one place to another stays beyond, or 0. One side is enough:
  /// the ends of a line are near each other.
  static std::uint8_t side_passed(Vec3 from, Vec3 to, const Bounds& box) {
    if (std::max(from.z, to.z) < box.low.z) return 1;
    if (std::min(from.z, to.z) > box.high.z) return 2;
    if (std::max(from.x, to.x) < box.low.x) return 3;
    if (std::min(from.x, to.x) > box.high.x) return 4;
    if (std::max(from.y, to.y) < box.low.y) return 5;
    return std::min(from.y, to.y) > box.high.y ? 6 : 0;
  }

  static constexpr std::uint32_t record = 4;
  std::vector<double> moves2_;        ///< by particle
  std::vector<std::uint8_t> passed_;  ///< by particle, see side_passed()
};

}  // namespace plumb::detail
